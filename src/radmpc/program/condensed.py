"""A vehicle condensed to its controls: prediction matrices, noise, and the box it can reach."""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.model.dynamics import LinearSystem
from radmpc.model.noise.positions import PositionResponse
from radmpc.model.vehicle import Vehicle
from radmpc.program.reach import reach_by_boxes, reach_by_speeds
from radmpc.records import Kept, dataclass, field

__all__ = [
    "CondensedModel",
    "PredictionMatrices",
    "bent_covariances",
    "condense",
]


@dataclass(frozen=True, slots=True, eq=False)
class PredictionMatrices:
    """Positions and velocities as linear functions of the controls of earlier steps.

    Attributes
    ----------
    powers : (T+1, n, n) array
        ``A^k``.
    states : (T+1, n, T*m) array
        State at k per control, controls step by step; a view of 2 T n m numbers.
    position : (T+1, d, T*m) array
        Its position part.
    velocity : (T+1, d, T*m) array or None
        Its velocity part.
    """

    powers: Tensor
    states: Tensor
    position: Tensor
    velocity: Tensor | None

    @classmethod
    def of(cls, system: LinearSystem, horizon: int) -> PredictionMatrices:
        """Compute the matrices over a horizon; their first steps serve shorter ones.

        Parameters
        ----------
        system : LinearSystem
            n states, m controls.
        horizon : int
            Steps T.
        """
        n, m = system.num_states, system.num_controls
        powers = np.empty((horizon + 1, n, n))
        powers[0] = np.eye(n)
        for k in range(horizon):
            powers[k + 1] = system.A @ powers[k]
        # What was done at step j acts at step k as at step k - j what is done at first, and not at
        # all before: each step's rows are a window of the same line, a step on for the one before.
        line = np.zeros((n, 2 * horizon, m))
        line[:, :horizon] = (powers[:horizon] @ system.B)[::-1].transpose(1, 0, 2)
        rows = sliding_window_view(line.reshape(n, 2 * horizon * m), horizon * m, axis=1)[:, ::-m]

        def laid_out(axes: tuple[int, ...]) -> Tensor:
            # Axis by axis, as programs and boxes read them.
            return np.array([rows[axis] for axis in axes]).transpose(1, 0, 2)

        velocity = None if system.velocity is None else laid_out(system.velocity)
        return cls(powers, rows.transpose(1, 0, 2), laid_out(system.position), velocity)

    def coasting(self, start: Vector, drift: Vector | Matrix | None, horizon: int) -> Matrix:
        """Return the mean states without any control, (T+1, n).

        Parameters
        ----------
        start : (n,) array
            Mean state at the first step.
        drift : (n,) or (T, n) array or None
            What every step adds to the state, the same or step by step; None is nothing.
        horizon : int
            Steps T, no more than these matrices hold.
        """
        states: Matrix = self.powers[: horizon + 1] @ start
        if drift is not None and drift.ndim == 1:
            states[1:] += np.cumsum(self.powers[:horizon] @ drift, axis=0)
        elif drift is not None:
            carried = np.zeros(len(start))
            for k in range(horizon):
                carried = self.powers[1] @ carried + drift[k]
                states[k + 1] += carried
        return states


@dataclass(frozen=True, slots=True, eq=False)
class CondensedModel:
    """One vehicle over the horizon of one program.

    Attributes
    ----------
    vehicle : Vehicle
        The vehicle.
    horizon : int
        Steps of the program.
    control_bounds : (T, m) array
        Largest nominal |ū|; negative where feedback needs more than the limit.
    position_covariances : (T+1, d, d) array
        Position covariance at each step [m²].
    bent_covariances : (T, d, d) array or None
        See `bent_covariances` [m²]; None where the path between steps needs no feedback.
    position, velocity : (T+1, d, T*m) array
        Their dependence on the controls; velocity None where the model has none.
    drift_position, drift_velocity : (T+1, d) array
        Positions and velocities without control, the vehicle's drift included.
    reach_lower, reach_upper : (T+1, d) array
        Box that holds the mean position under every admissible control [m].
    common : PositionResponse or None
        How its position answers disturbances that others meet, too; None is not at all.
    time_cost : float
        What the time of the whole horizon costs until arrival; 0 where that is not free.
    face_bounds : (T, f) array or None
        Largest nominal control along each normal of a polytope, see `control_face_bounds`; None
        where the control's norm is free.
    face_normals : (T, f, m) array or None
        Those normals; None is those of `inner_faces` at every step.
    speed_faces : ((T, f, d) array, (f,) array) or None
        The same of velocities at steps 1..T, and how much each face leaves of their norm [-].
    kept : Kept
        What was computed of it.
    """

    vehicle: Vehicle
    horizon: int
    control_bounds: Matrix
    position_covariances: Tensor
    bent_covariances: Tensor | None
    position: Tensor
    velocity: Tensor | None
    drift_position: Matrix
    drift_velocity: Matrix | None
    reach_lower: Matrix
    reach_upper: Matrix
    common: PositionResponse | None = None
    time_cost: float = 0.0
    face_bounds: Matrix | None = None
    face_normals: Tensor | None = None
    speed_faces: tuple[Tensor, Vector] | None = None
    kept: Kept = field(default_factory=Kept, init=False, repr=False)

    def path(self, controls: Matrix) -> Matrix:
        """Return the mean positions under some controls, (T+1, d) [m].

        Parameters
        ----------
        controls : (T, m) array
            Mean controls.
        """
        at: Matrix = self.drift_position + self.position @ controls.ravel()
        return at


def condense(
    vehicle: Vehicle,
    prediction: PredictionMatrices,
    start: Vector,
    covariances: Tensor,
    bounds: Matrix,
    first_step: int = 0,
    common: PositionResponse | None = None,
) -> CondensedModel:
    """Return a vehicle condensed over the steps that are left, from its state at the first of them.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    prediction : PredictionMatrices
        Of its system, over at least this horizon.
    start : (n,) array
        Mean state at the program's first step.
    covariances : (T+1, n, n) array
        State covariances from the first step on.
    bounds : (T, m) array
        Largest nominal |ū|, see `Vehicle.control_bounds`.
    first_step : int
        Step of the vehicle's noise at which the covariances begin.
    common : PositionResponse or None
        See `CondensedModel.common`.

    Returns
    -------
    CondensedModel
        With its reachable box computed.
    """
    horizon, num_controls = bounds.shape
    system = vehicle.system
    span = horizon * num_controls
    axes = list(system.position)
    # What was learned of a disturbance was learned at the vehicle's own first step.
    drift = vehicle.pushes(first_step + horizon)
    if drift is not None and drift.ndim > 1:
        drift = drift[first_step:]
    states = prediction.coasting(start, drift, horizon)
    position = prediction.position[: horizon + 1, :, :span]
    velocity = None if prediction.velocity is None else prediction.velocity[: horizon + 1, :, :span]
    still = states[:, axes]
    drift_velocity = None if system.velocity is None else states[:, list(system.velocity)]
    lower, upper = reach_by_boxes(vehicle, position, still, np.maximum(bounds, 0.0).ravel())
    if system.rates is not None and (drift is None or drift.ndim == 1):
        low, high = reach_by_speeds(vehicle, system.rates, start, np.maximum(bounds, 0.0))
        lower, upper = np.maximum(lower, low), np.minimum(upper, high)
    # The start is fixed, even where no admissible control leads from it to the goal.
    lower[0] = upper[0] = still[0]
    face_bounds = None
    if vehicle.control_norm is not None:
        from radmpc.model.limits import control_face_bounds  # noqa: PLC0415 - few have any

        face_bounds = control_face_bounds(vehicle, first_step, horizon)
    return CondensedModel(
        vehicle=vehicle,
        horizon=horizon,
        control_bounds=bounds,
        position_covariances=covariances[:, axes, :][:, :, axes],
        bent_covariances=bent_covariances(vehicle, covariances, first_step),
        position=position,
        velocity=velocity,
        drift_position=still,
        drift_velocity=drift_velocity,
        reach_lower=lower,
        reach_upper=upper,
        common=common,
        face_bounds=face_bounds,
    )


def bent_covariances(vehicle: Vehicle, covariances: Tensor, first_step: int = 0) -> Tensor | None:
    """Return the covariances of ``(P − B_p K) δ_k``, or None without feedback on a parabola.

    Under ``u = ū + K δ_k`` held over the step the deviation is, at a share s of it,
    ``(1 − s) (P δ_k − s B_p K δ_k) + s P δ_{k+1}``: the first bracket runs from ``P δ_k`` to this.
    With a measurement, ``K δ̂_k`` replaces ``K δ_k``.

    Parameters
    ----------
    vehicle : Vehicle
        With its feedback gain K, if any.
    covariances : (T+1, n, n) array
        State covariances.
    first_step : int
        Step of the vehicle's noise at which they begin.

    Returns
    -------
    (T, d, d) array or None
        See `CondensedModel.bent_covariances` [m²].
    """
    system = vehicle.system
    if vehicle.gain is None or not system.is_double_integrator:
        return None
    place = list(system.position)
    if vehicle.measurement is not None:
        last = first_step + len(covariances) - 1
        picked, bend = np.eye(system.num_states)[place], system.B[place] @ vehicle.gain
        return vehicle.spread(last).of_sums(slice(first_step, last), picked, -bend)
    bent = np.eye(system.num_states)[place] - system.B[place] @ vehicle.gain
    return np.asarray(bent @ covariances[:-1] @ bent.T)
