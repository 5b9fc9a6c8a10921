"""A vehicle: its dynamics, limits, noise, start and goal. Not its plan."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from radmpc.arguments import field_number, field_text, value_text
from radmpc.arrays import Frozen, Matrix, Tensor, Vector, as_covariance, as_matrix, as_vector
from radmpc.errors import ScenarioError, all_checked
from radmpc.model import numbers
from radmpc.model.dynamics import LinearSystem, covariances
from radmpc.model.goal import Goal
from radmpc.model.states import as_state
from radmpc.ranges import sized, steps_ahead
from radmpc.records import dataclass

if TYPE_CHECKING:
    from radmpc.model.noise.belief import Belief
    from radmpc.model.noise.measurement import Measurement
    from radmpc.model.noise.shared import SharedDisturbance
    from radmpc.model.noise.spread import Noise, Spread
    from radmpc.model.visits import Visit

__all__ = ["Goal", "Vehicle"]


@dataclass(frozen=True, slots=True, eq=False)
class Vehicle(Frozen):
    """A disc (a ball in space) that must be carried from a start to a goal.

    A position alone is taken as a start at rest, one number as a limit of every axis, one number
    or a diagonal as a covariance.

    Attributes
    ----------
    name : str
        Unique within its scenario; tables, plots and files use it.
    system : LinearSystem
        Its dynamics.
    start : (n,) array
        Mean state at k = 0: positions [m] and velocities [m/s] for a double integrator.
    goal : Goal
        Where its mean must be at the horizon.
    radius : float
        Hull radius [m], > 0.
    control_limit : (m,) array
        Largest |u| per axis, > 0; for a double integrator [m/s²].
    initial_covariance : (n, n) array
        Covariance of the state at k = 0 [m², m²/s²], positive semi-definite.
    disturbance_covariance : (n, n) array
        Covariance W of the disturbance of every step [m², m²/s²], positive semi-definite.
    speed_limit : (d,) array or None
        Largest mean speed per axis [m/s], > 0; None is no limit.
    gain : (m, n) array or None
        Feedback K of ``u = ū + K (x − x̄)``, see `measurement`; None is open loop.
    control_sigmas : float
        Standard deviations of the feedback that the control limit holds in reserve, >= 0.
    cost_weight : float
        Factor of this vehicle's effort in the cost, >= 0.
    drift : (n,) array or None
        What a current or a steady wind adds to the state at every step [m, m/s], in proportion to
        time as the disturbance: c of ``x⁺ = A x + B u + c + w``. None is no drift.
    disturbance_correlation : float
        Correlation ρ of the disturbances of consecutive steps, 0 (new at every step) to below 1: a
        stationary first-order autoregression. A time constant τ makes ``exp(−dt/τ)``.
    measurement : Measurement or None
        What the vehicle measures of its state: feedback is then ``u = ū + K (x̂ − x̄)`` with the
        estimate x̂ of a Kalman filter. None is that the state is known exactly.
    shared : tuple of SharedDisturbance
        Its part in disturbances that others meet, too; names distinct.
    via : tuple of Visit
        Boxes that its mean visits on the way, one after the other.
    control_norm, speed_norm : float or None
        Largest Euclidean norm of the control, of the mean velocity, > 0; None is free.
    belief : Belief or None
        What is known at k = 0 of a vehicle under way whose disturbances last or that measures, in
        place of `initial_covariance`; it shares no disturbance. Not written to scenario files.

    Examples
    --------
    >>> from radmpc import Goal, Vehicle, double_integrator
    >>> Vehicle("tug", double_integrator(1.0, 2), [1.0, 1.0], Goal.at([9.0, 9.0], 0.5), radius=0.4,
    ...         control_limit=2.0, initial_covariance=0.001, disturbance_covariance=0.001).start
    array([1., 1., 0., 0.])
    """

    name: str
    system: LinearSystem
    start: Vector
    goal: Goal
    radius: float
    control_limit: Vector
    initial_covariance: Matrix
    disturbance_covariance: Matrix
    speed_limit: Vector | None = None
    gain: Matrix | None = None
    control_sigmas: float = 3.0
    cost_weight: float = 1.0
    drift: Vector | None = None
    disturbance_correlation: float = 0.0
    measurement: Measurement | None = None
    shared: tuple[SharedDisturbance, ...] = ()
    via: tuple[Visit, ...] = ()
    control_norm: float | None = None
    speed_norm: float | None = None
    belief: Belief | None = None

    if TYPE_CHECKING:  # what it takes is wider than what it holds

        def __init__(
            self,
            name: str,
            system: LinearSystem,
            start: npt.ArrayLike,
            goal: Goal,
            radius: float,
            control_limit: npt.ArrayLike,
            initial_covariance: npt.ArrayLike,
            disturbance_covariance: npt.ArrayLike,
            speed_limit: npt.ArrayLike | None = None,
            gain: npt.ArrayLike | None = None,
            control_sigmas: float = 3.0,
            cost_weight: float = 1.0,
            drift: npt.ArrayLike | None = None,
            disturbance_correlation: float = 0.0,
            measurement: Measurement | None = None,
            shared: Sequence[SharedDisturbance] = (),
            via: Iterable[Visit] = (),
            control_norm: float | None = None,
            speed_norm: float | None = None,
            belief: Belief | None = None,
        ) -> None: ...

    def __post_init__(self) -> None:
        """Freeze the arrays and reject what cannot be flown."""
        self._check_kinds()
        n, m, d = self.system.num_states, self.system.num_controls, self.system.dimension
        put = object.__setattr__
        put(self, "start", as_state(self.start, self.system))
        for name in ("initial_covariance", "disturbance_covariance"):
            put(self, name, as_covariance(getattr(self, name), n, (name,)))
        if self.gain is not None:
            path = ("feedback", "gain")
            put(self, "gain", sized(as_matrix(self.gain, (m, n), path), path))
        if self.drift is not None:
            put(self, "drift", sized(as_vector(self.drift, n, path := ("drift", "state")), path))
        for name, size in (("control", m), ("speed", d)):
            norm, axes = getattr(self, f"{name}_norm"), getattr(self, f"{name}_limit")
            norm, axes = numbers.consistent_limits(norm, axes, size, f"{name}_limit")
            put(self, f"{name}_norm", norm)
            put(self, f"{name}_limit", axes)
        limit, sizes = self.speed_limit, (self.radius, self.control_sigmas, self.cost_weight)
        all_checked(
            lambda: None if limit is None else numbers.check_positive(limit, "speed_limit", "m/s"),
            lambda: numbers.check_positive(self.control_limit, "control_limit", "per axis"),
            lambda: numbers.check_vehicle_numbers(*sizes),
            lambda: numbers.check_correlation(self.disturbance_correlation),
        )
        if self.measurement is not None and (found := self.measurement.matrix.shape[1]) != n:
            message = f"must have {n} columns like the state, got {found}"
            raise ScenarioError(message, ("measurement", "matrix"))
        if (found := self.goal.lower.size) != d:
            message = f"must have {d} coordinates like the position, got {found}"
            raise ScenarioError(message, ("goal",))
        if self.system.velocity is None:
            numbers.check_speedless(speed_limit=self.speed_limit, goal=self.goal.speed)

    def _check_kinds(self) -> None:
        """Refuse parts of another kind, and make numbers Python's."""
        field_text(self.name, ("name",))
        kinds: dict[str, type] = {"system": LinearSystem, "goal": Goal}
        if self.measurement is not None:
            from radmpc.model.noise.measurement import Measurement  # noqa: PLC0415 - few measure

            kinds["measurement"] = Measurement
        if self.belief is not None:
            from radmpc.model.noise.belief import Belief  # noqa: PLC0415 - of vehicles under way

            kinds["belief"] = Belief
        put = object.__setattr__
        for name, kind in kinds.items():
            part = getattr(self, name)
            if not isinstance(part, kind):
                raise ScenarioError(f"must be a {kind.__name__}, got {value_text(part)}", (name,))
        if not isinstance(self.shared, tuple) or self.shared:
            from radmpc.model.noise.shared import as_shared  # noqa: PLC0415 - few share

            put(self, "shared", as_shared(self.shared, self.system.num_states))
        if not isinstance(self.via, tuple) or self.via:
            from radmpc.model.visits import checked_visits  # noqa: PLC0415 - few visit anything

            put(self, "via", checked_visits(self.via, self.system))
        for name in ("radius", "control_sigmas", "cost_weight", "disturbance_correlation"):
            put(self, name, field_number(getattr(self, name), (name,)))

    @property
    def start_position(self) -> Vector:
        """Mean position at k = 0 [m]."""
        return self.start[list(self.system.position)]

    @property
    def noise(self) -> Noise:
        """Disturbances and measurement noise of the vehicle."""
        from radmpc.model.noise.spread import Noise  # noqa: PLC0415 - few need it

        own = self.disturbance_covariance, self.disturbance_correlation
        return Noise(self.initial_covariance, *own, self.measurement, self.shared, self.belief)

    def pushes(self, horizon: int) -> Vector | Matrix | None:
        """Return what steps add to the mean besides control.

        Parameters
        ----------
        horizon : int
            Number of steps T.

        Returns
        -------
        (n,) or (T, n) array or None
            The same at every step, or one row each; None is nothing.
        """
        belief, noise = self.belief, (self.disturbance_correlation, self.shared)
        return self.drift if belief is None else belief.pushes(noise, self.drift, horizon)

    @property
    def has_memory(self) -> bool:
        """Whether more than the state's own deviation and noise decides what becomes of it."""
        return bool(self.disturbance_correlation or self.measurement is not None or self.shared)

    def spread(self, horizon: int) -> Spread:
        """Return covariances of the deviation, of the disturbance, and of what is known of both.

        Parameters
        ----------
        horizon : int
            Number of steps T.

        Returns
        -------
        Spread
            At steps 0..T.

        Raises
        ------
        ArgumentError, ScenarioError
            If the horizon is no integer, below 0, or longer than that of any scenario.
        """
        from radmpc.model.noise.kept import kept_spread  # noqa: PLC0415 - few need it

        return kept_spread(self, steps_ahead(horizon))

    def covariances(self, horizon: int) -> Tensor:
        """Return the state covariances that follow from start, noise and feedback.

        Parameters
        ----------
        horizon : int
            Number of steps T.

        Returns
        -------
        (T+1, n, n) array
            Covariances at k = 0..T.

        Raises
        ------
        ArgumentError, ScenarioError
            If the horizon is no integer, below 0, or longer than that of any scenario.
        """
        if self.has_memory:
            return self.spread(horizon).states
        own = self.initial_covariance, self.disturbance_covariance
        return covariances(self.system, *own, self.gain, steps_ahead(horizon))

    def control_bounds(self, covariances: Tensor) -> Matrix:
        """Return the largest nominal |ū| at each step.

        Parameters
        ----------
        covariances : (T+1, n, n) array
            State covariances at k = 0..T.

        Returns
        -------
        (T, m) array
            The limit less ``control_sigmas`` standard deviations of the feedback ``K (x − x̄)``,
            with a measurement ``K (x̂ − x̄)``; negative where the reserve eats the limit.
        """
        horizon = len(covariances) - 1
        if self.gain is None:
            return np.tile(self.control_limit, (horizon, 1))
        if self.measurement is not None:
            covariances = self.spread(horizon).estimates
        variances = np.einsum("an,knm,am->ka", self.gain, covariances[:horizon], self.gain)
        kept = self.control_sigmas * np.sqrt(np.maximum(variances, 0.0))
        return np.asarray(self.control_limit - kept)
