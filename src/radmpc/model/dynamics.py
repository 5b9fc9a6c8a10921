"""Linear vehicle dynamics and what follows from them without planning: means and covariances."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from radmpc.arguments import check_integer, check_kind, field_integer, field_parts, value_text
from radmpc.arrays import Frozen, Matrix, Tensor, Vector, as_array, as_matrix, as_vector
from radmpc.errors import ScenarioError
from radmpc.model.integrator import check_stated, closed_loop, integrator_rates
from radmpc.model.numbers import positive_definite
from radmpc.ranges import LARGEST, check_range, sized
from radmpc.records import dataclass, field

__all__ = ["LinearSystem", "covariances", "double_integrator", "lqr_gain", "rollout"]

_NO_GAIN = "no stabilizing gain for these dynamics and weights; Q must be positive semi-definite"


@dataclass(frozen=True, slots=True, eq=False)
class LinearSystem(Frozen):
    """Discrete linear dynamics ``x⁺ = A x + B u + c + w`` (paper, Eq. 2).

    Attributes
    ----------
    A : (n, n) array
        State matrix.
    B : (n, m) array
        Control matrix.
    position : tuple of int
        State indices that hold the position, one per axis.
    velocity : tuple of int or None
        State indices that hold the velocity; None where the model has none.
    is_double_integrator : bool
        Whether the path between steps is the parabola of constant acceleration, not the straight
        segment. Found from A and B, in any order of the states; wrong to say of another system.
    """

    A: Matrix
    B: Matrix
    position: tuple[int, ...]
    velocity: tuple[int, ...] | None
    is_double_integrator: bool = False
    _rates: tuple[tuple[int, ...], float] | None = field(init=False, repr=False)

    if TYPE_CHECKING:  # what it takes is wider than what it holds

        def __init__(
            self,
            A: npt.ArrayLike,
            B: npt.ArrayLike,
            position: Sequence[int],
            velocity: Sequence[int] | None,
            is_double_integrator: bool = False,
        ) -> None: ...

    def __post_init__(self) -> None:
        """Freeze the matrices and check that the indices point into the state."""
        A = sized(as_matrix(self.A, path=("A",)), ("A",))
        n = A.shape[0]
        object.__setattr__(self, "A", as_matrix(A, (n, n), ("A",)))
        object.__setattr__(self, "B", sized(as_matrix(self.B, (n, None), ("B",)), ("B",)))
        for name, indices in (("position", self.position), ("velocity", self.velocity)):
            if indices is not None or name == "position":
                object.__setattr__(self, name, _as_indices(indices, n, name))
        if len(self.position) not in (2, 3):
            raise ScenarioError(f"must name 2 or 3 axes, got {len(self.position)}", ("position",))
        if self.velocity is not None and len(self.velocity) != len(self.position):
            raise ScenarioError(
                f"must name as many axes as position ({len(self.position)}), "
                f"got {len(self.velocity)}",
                ("velocity",),
            )
        rates = integrator_rates(self.A, self.B, self.position)
        check_stated(self.is_double_integrator, rates)
        for name, value in (("is_double_integrator", rates is not None), ("_rates", rates)):
            object.__setattr__(self, name, value)

    @property
    def rates(self) -> tuple[tuple[int, ...], float] | None:
        """State indices of the velocities and the step [s] of a double integrator, else None."""
        return self._rates

    @property
    def sagitta(self) -> Matrix:
        """Deviation of the path from its chord at mid-step, per control, (d, m).

        Under a control u held over the step, a double integrator is at a share s of it at
        ``chord(s) − 4 s (1 − s) sagitta @ u`` (``a dt²/8`` at s = ½); 0 for all other systems.
        """
        carried = self.B[list(self.position)]
        return 0.25 * carried if self.is_double_integrator else np.zeros_like(carried)

    @property
    def num_states(self) -> int:
        """Length n of the state."""
        return int(self.A.shape[0])

    @property
    def num_controls(self) -> int:
        """Length m of the control."""
        return int(self.B.shape[1])

    @property
    def dimension(self) -> int:
        """Number of position axes, 2 or 3."""
        return len(self.position)


def _as_indices(given: object, num_states: int, name: str) -> tuple[int, ...]:
    """Return distinct indices into a state as a tuple."""
    allowed = f"distinct state indices from 0 to {num_states - 1}"
    parts = field_parts(given, allowed, (name,))
    indices = tuple(field_integer(i, (name, k)) for k, i in enumerate(parts))
    if any(not 0 <= i < num_states for i in indices) or len(set(indices)) != len(indices):
        raise ScenarioError(f"must be {allowed}, got {list(indices)}", (name,))
    return indices


def double_integrator(dt: float, dimension: int) -> LinearSystem:
    """Return the paper's vehicle: position and velocity, driven by acceleration (section Results).

    Parameters
    ----------
    dt : float
        Step [s], > 0.
    dimension : int
        2 or 3 axes.

    Returns
    -------
    LinearSystem
        State (positions, velocities), control (accelerations) [m/s²].

    Raises
    ------
    ScenarioError
        If the step is not from 1e-6 to 44,721 s, or there are neither 2 nor 3 axes.

    Examples
    --------
    >>> double_integrator(2.0, 2).B
    array([[2., 0.],
           [0., 2.],
           [2., 0.],
           [0., 2.]])
    """
    dt = check_range(dt, "s", ("dt",))
    longest = (2.0 * LARGEST) ** 0.5  # of which B holds half the square
    if dt > longest:
        what = f"must be at most {longest:.0f} s for a double integrator"
        raise ScenarioError(f"{what}, got {value_text(dt)}", ("dt",))
    if field_integer(dimension, ("dimension",)) not in (2, 3):
        raise ScenarioError(f"must be 2 or 3, got {value_text(dimension)}", ("dimension",))
    eye, zero = np.eye(dimension), np.zeros((dimension, dimension))
    return LinearSystem(
        A=np.block([[eye, dt * eye], [zero, eye]]),
        B=np.vstack([0.5 * dt**2 * eye, dt * eye]),
        position=tuple(range(dimension)),
        velocity=tuple(range(dimension, 2 * dimension)),
        is_double_integrator=True,
    )


def lqr_gain(system: LinearSystem, Q: npt.ArrayLike, R: npt.ArrayLike) -> Matrix:
    """Return the gain K of ``u = ū + K (x − x̄)`` that minimizes ``Σ xᵀQx + uᵀRu``.

    Parameters
    ----------
    system : LinearSystem
        The dynamics.
    Q : (n, n) array
        Weight of the state's deviation, positive semi-definite.
    R : (m, m) array
        Weight of the feedback, positive definite.

    Returns
    -------
    (m, n) array
        The gain K of the linear-quadratic regulator, from the discrete algebraic Riccati equation.

    Raises
    ------
    ScenarioError
        If Q or R has the wrong shape, R is not positive definite, or no stabilizing gain exists.

    Examples
    --------
    >>> import numpy as np
    >>> lqr_gain(double_integrator(1.0, 2), np.eye(4), np.eye(2))[0, ::2].round(2)  # along x
    array([-0.43, -1.03])
    """
    check_kind(system, LinearSystem, "system", "a LinearSystem")
    state_weight = as_matrix(Q, (system.num_states, system.num_states), ("Q",))
    control_weight = positive_definite(R, system.num_controls, ("R",))
    from scipy.linalg import solve_discrete_are  # noqa: PLC0415 - loads slowly

    try:
        # What overflows is refused by the last line, or by the solver itself.
        with np.errstate(all="ignore"):
            P = solve_discrete_are(system.A, system.B, state_weight, control_weight)
            PB = P @ system.B
            gain = -np.linalg.solve(control_weight + system.B.T @ PB, PB.T @ system.A)
    except (np.linalg.LinAlgError, ValueError) as error:
        raise ScenarioError(_NO_GAIN) from error
    gain = as_matrix(gain)
    # Where only a mode on the unit circle is not seen by Q, the equation has a solution all the
    # same, under which that mode stays as it is.
    if not np.abs(np.linalg.eigvals(system.A + system.B @ gain)).max() < 1.0:
        raise ScenarioError(_NO_GAIN)
    return gain


def rollout(
    system: LinearSystem,
    start: npt.ArrayLike,
    controls: npt.ArrayLike,
    drift: Vector | Matrix | None = None,
) -> Matrix:
    """Return the mean states under nominal controls.

    Parameters
    ----------
    system : LinearSystem
        The dynamics.
    start, controls : (n,) and (T, m) array
        Mean state at k = 0, and nominal controls.
    drift : (n,) or (T, n) array or None
        Drift c, added to the state at every step, the same or step by step; None is none.

    Returns
    -------
    (T+1, n) array
        Mean states at k = 0..T.

    Raises
    ------
    ScenarioError
        If a shape does not fit the dynamics, or a number is not finite.
    """
    check_kind(system, LinearSystem, "system", "a LinearSystem")
    steps = as_matrix(controls, (None, system.num_controls), ("controls",))
    means = np.empty((len(steps) + 1, system.num_states))
    means[0] = as_vector(start, system.num_states, ("start",))
    if drift is not None:
        is_same = np.ndim(drift) == 1
        shape = (system.num_states,) if is_same else (len(steps), system.num_states)
        drift = np.broadcast_to(as_array(drift, shape, ("drift",)), (len(steps), shape[-1]))
    for k, control in enumerate(steps):
        moved = system.A @ means[k] + system.B @ control
        means[k + 1] = moved if drift is None else moved + drift[k]
    return means


def covariances(
    system: LinearSystem,
    initial: npt.ArrayLike,
    disturbance: npt.ArrayLike,
    gain: npt.ArrayLike | None,
    horizon: int,
) -> Tensor:
    """Return the state covariances, open loop or under linear feedback.

    Parameters
    ----------
    system : LinearSystem
        The dynamics.
    initial, disturbance : (n, n) array
        Covariance at k = 0, and W, added at every step (paper, Eq. 4); one number or a diagonal is
        taken as well.
    gain : (m, n) array or None
        Feedback K; None is open loop.
    horizon : int
        Number of steps T.

    Returns
    -------
    (T+1, n, n) array
        ``Σ⁺ = F Σ Fᵀ + W`` with ``F = A + B K``.
    """
    check_kind(system, LinearSystem, "system", "a LinearSystem")
    horizon = check_integer(horizon, "horizon", 0)
    first, added, F = closed_loop(system.A, system.B, initial, disturbance, gain)
    result = np.empty((horizon + 1, *first.shape))
    result[0] = first
    for k in range(horizon):
        propagated = F @ result[k] @ F.T + added
        result[k + 1] = 0.5 * (propagated + propagated.T)
    return result
