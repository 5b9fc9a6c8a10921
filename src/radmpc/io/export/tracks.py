"""What every export needs of a plan: one track per vehicle, checked against the scenario."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from radmpc.arguments import field_integer
from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.errors import NoPlanError, ScenarioError
from radmpc.model.plan import Plan, Trajectory
from radmpc.model.vehicle import Vehicle
from radmpc.records import dataclass, replace

__all__ = ["TimedPath", "check_duration", "thinned_tracks", "tracks_of", "velocities_over_ground"]


@dataclass(frozen=True, slots=True, eq=False)
class TimedPath:
    """Where a vehicle is meant to be, and how sure that is.

    Attributes
    ----------
    vehicle : Vehicle
        Whose track it is.
    times : (T+1,) array
        Of all steps, or of those that are written, since the start of the mission [s].
    positions : (T+1, d) array
        Mean positions [m].
    velocities : (T+1, d) array or None
        Mean velocities over ground [m/s]: those of the states, and what a drift adds. None where
        the dynamics have none.
    three_sigma : (T+1, d) array
        Three standard deviations of the position per axis [m].
    controls : (T, m) array
        Nominal controls of all steps.
    visits : tuple of int
        Rows of ``times`` at which it visits the boxes of ``vehicle.via``, up to the first that it
        misses.
    """

    vehicle: Vehicle
    times: Vector
    positions: Matrix
    velocities: Matrix | None
    three_sigma: Matrix
    controls: Matrix
    visits: tuple[int, ...] = ()

    @property
    def name(self) -> str:
        """The vehicle's name."""
        return self.vehicle.name


def tracks_of(plan: Plan) -> tuple[TimedPath, ...]:
    """Return the tracks of a plan, in the scenario's order.

    Parameters
    ----------
    plan : Plan
        As read from a file: its arrays have not met its scenario yet.

    Raises
    ------
    NoPlanError
        If the plan has no trajectories.
    ScenarioError
        If a vehicle is missing or strange, or an array does not fit the scenario.
    """
    if not plan.trajectories:
        why = f"no plan: {plan.explanation}" if plan.explanation else plan.status.sentence
        raise NoPlanError(f"nothing to export, {why}")
    vehicles = plan.scenario.vehicles
    names = [trajectory.name for trajectory in plan.trajectories]
    expected = [vehicle.name for vehicle in vehicles]
    if names != expected:
        raise ScenarioError(
            f"must be those of the scenario, in its order: {expected}, got {names}", ("vehicles",)
        )
    pairs = zip(vehicles, plan.trajectories, strict=True)
    return tuple(_track(plan, i, vehicle, part) for i, (vehicle, part) in enumerate(pairs))


def thinned_tracks(
    tracks: Sequence[TimedPath], steps: Mapping[str, Sequence[int]]
) -> tuple[TimedPath, ...]:
    """Return tracks of some of their steps.

    Parameters
    ----------
    tracks : sequence of TimedPath
        Of all steps.
    steps : mapping
        Those that stay, by the vehicle's name.

    Raises
    ------
    ScenarioError
        If a vehicle has none, or they do not lead from the first step to the last.
    """
    chosen = []
    for track in tracks:
        path, last = ("steps", track.name), len(track.times) - 1
        if track.name not in steps:
            raise ScenarioError("is required: the steps of this vehicle", path)
        kept = np.array([field_integer(step, path) for step in steps[track.name]], dtype=np.int64)
        if len(kept) < 2 or kept[0] != 0 or kept[-1] != last or np.any(np.diff(kept) <= 0):
            got = kept.tolist()
            raise ScenarioError(f"must rise from 0 to the horizon {last}, got {got}", path)
        chosen.append(
            replace(
                track,
                times=track.times[kept],
                positions=track.positions[kept],
                velocities=None if track.velocities is None else track.velocities[kept],
                three_sigma=track.three_sigma[kept],
                visits=_visits_among(track.visits, kept),
            )
        )
    return tuple(chosen)


def _visits_among(visits: Sequence[int], kept: Indices) -> tuple[int, ...]:
    """Return where steps of visits are among those that stay, up to the first that does not."""
    rows = []
    for step in visits:
        row = int(np.searchsorted(kept, step))
        if kept[row] != step:
            break
        rows.append(row)
    return tuple(rows)


def check_duration(plan: Plan, longest: float, what: str) -> None:
    """Refuse a mission that ends after the last time a format can write.

    Parameters
    ----------
    plan : Plan
        Whose horizon counts.
    longest : float
        What the format can hold [s].
    what : str
        What holds it, for the message.

    Raises
    ------
    ScenarioError
        If it does.
    """
    duration = plan.scenario.horizon * plan.scenario.dt
    if duration > longest:
        raise ScenarioError(
            f"the mission takes {duration:.6g} s, longer than the {longest:.6g} s {what} can hold"
        )


def _track(plan: Plan, index: int, vehicle: Vehicle, part: Trajectory) -> TimedPath:
    """Return a vehicle's track, its arrays checked."""
    system, steps = vehicle.system, plan.scenario.horizon
    n, m = system.num_states, system.num_controls
    for field, shape in (
        ("controls", (steps, m)),
        ("means", (steps + 1, n)),
        ("covariances", (steps + 1, n, n)),
    ):
        found = getattr(part, field).shape
        if found != shape:
            raise ScenarioError(f"must have shape {shape}, got {found}", ("vehicles", index, field))
    axes = list(system.position)
    return TimedPath(
        vehicle=vehicle,
        times=np.arange(steps + 1, dtype=np.float64) * plan.scenario.dt,
        positions=part.means[:, axes],
        velocities=velocities_over_ground(vehicle, part.means, plan.scenario.dt),
        three_sigma=_three_sigma(part.covariances, axes),
        controls=part.controls,
        visits=_visits(vehicle, part.means) if vehicle.via else (),
    )


def _visits(vehicle: Vehicle, means: Matrix) -> tuple[int, ...]:
    """Return the steps at which a vehicle makes its visits."""
    from radmpc.model.visits import steps_visited  # noqa: PLC0415 - few visit anything

    velocity = vehicle.system.velocity
    speeds = None if velocity is None else means[:, list(velocity)]
    return steps_visited(vehicle.via, means[:, list(vehicle.system.position)], speeds)


def velocities_over_ground(vehicle: Vehicle, means: Matrix, dt: float) -> Matrix | None:
    """Return velocities over ground, because receivers of these know of no current.

    A state's velocity is that through water or air. What a drift adds to the position beyond the
    push of a steady wind, it adds to the way over ground.

    Parameters
    ----------
    vehicle : Vehicle
        Whose states they are.
    means : (T+1, n) array
        Mean states.
    dt : float
        Step [s].

    Returns
    -------
    (T+1, d) array or None
        None where the dynamics have no velocity [m/s].
    """
    if vehicle.system.velocity is None:
        return None
    velocity = list(vehicle.system.velocity)
    if vehicle.drift is None:
        return means[:, velocity]
    carried = vehicle.drift[list(vehicle.system.position)] / dt - 0.5 * vehicle.drift[velocity]
    return np.asarray(means[:, velocity] + carried)


def _three_sigma(covariances: Tensor, axes: list[int]) -> Matrix:
    """Return three standard deviations per step and axis; rounding may leave a variance below 0."""
    variances = covariances[:, axes, axes]
    return np.asarray(3.0 * np.sqrt(np.maximum(variances, 0.0)))
