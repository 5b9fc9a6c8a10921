"""From a scenario file's content to a `Scenario`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING, TypeVar

from radmpc.arrays import as_vector
from radmpc.errors import ScenarioError, raise_together
from radmpc.io.native.checking import check_format, validated
from radmpc.io.native.dimensions import blaming_goal, odd_goal, usual_axes
from radmpc.io.native.moving import build_tracked
from radmpc.io.native.plain import plain_mapping
from radmpc.io.native.schema import (
    SCENARIO_FORMAT,
    ObstacleSpec,
    ScenarioSpec,
    TrackSpec,
    VehicleSpec,
)
from radmpc.io.native.vehicle_decoding import Shared, build_goal, build_vehicle, check_step
from radmpc.io.ranges import MOST_OBSTACLES, MOST_VEHICLES
from radmpc.io.text.files import shown
from radmpc.model.numbers import check_not_negative, check_scenario_numbers
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Goal, Vehicle

if TYPE_CHECKING:
    from radmpc.model.relations.keep import Keep

__all__ = ["check_entries", "decode_scenario"]

_Part = TypeVar("_Part")

_DISTURBANCES = frozenset({"disturbance", "disturbance_covariance"})

_OBSTACLE_KINDS = (
    ("vertices",),
    ("line",),
    ("min", "max"),
    ("normals", "offsets"),
    ("moving",),
)


def decode_scenario(data: object) -> Scenario:
    """Return the scenario that plain data describe.

    Parameters
    ----------
    data : mapping
        The content of a scenario file: None, bool, int, float, str, list and dict only.

    Returns
    -------
    Scenario
        Checked in full.

    Raises
    ------
    ScenarioError
        If anything is missing, unknown or not allowed; its path says where in the data.
    """
    content = check_format(data, SCENARIO_FORMAT)
    check_entries(content)
    spec = validated(ScenarioSpec, content)
    try:
        return _build(spec)
    except ScenarioError as error:
        alone = ScenarioError(error.message, error.path)
        raise_together(_at_origin(blaming_goal(one, spec), spec) for one in (alone, *error.more))
        raise


def check_entries(data: Mapping[str, object]) -> None:
    """Refuse lists that are too long before anything in them is looked at, which takes long.

    Raises
    ------
    ScenarioError
        With how many entries there are and how many are allowed.
    """
    for key, most in (("vehicles", MOST_VEHICLES), ("obstacles", MOST_OBSTACLES)):
        entries = data.get(key)
        if isinstance(entries, list) and len(entries) > most:
            raise ScenarioError(f"must have at most {most:,} entries, got {len(entries):,}", (key,))


def _build(spec: ScenarioSpec) -> Scenario:
    """Return the scenario of a file whose shapes are right."""
    parts = _Attempts()
    workspace = parts.attempt(lambda: _workspace(spec))
    obstacles = parts.attempt(lambda: _obstacles(spec))
    num_errors = len(parts.errors)
    parts.attempt(lambda: check_step(spec))
    # With any step the other errors of vehicles show, too.
    dt = spec.dt if len(parts.errors) == num_errors else 1.0
    vehicles = parts.attempt(lambda: _vehicles(spec, dt))
    parts.attempt(lambda: _check_objective(spec))
    numbers = (spec.dt, spec.horizon, spec.risk_bound, spec.covariance_samples)
    parts.attempt(lambda: check_scenario_numbers(*numbers))
    raise_together(parts.errors)
    if spec.shared_disturbances and vehicles:
        from radmpc.io.native.shared import with_shared  # noqa: PLC0415 - few share

        vehicles = with_shared(vehicles, spec.shared_disturbances, spec.dt)
    return Scenario(
        name=spec.name,
        dt=spec.dt,
        horizon=spec.horizon,
        risk_bound=spec.risk_bound,
        avoidance=spec.avoidance,
        pair_faces=spec.pair_faces,
        workspace=workspace,
        obstacles=obstacles or (),
        vehicles=vehicles or (),
        source=None if spec.source is None else plain_mapping(spec.source, ("source",)),
        covariance_samples=spec.covariance_samples,
        time_weight=spec.objective.time,
        keep=_keep(spec),
        goals=_goals(spec, vehicles or ()),
    )


def _goals(spec: ScenarioSpec, vehicles: tuple[Vehicle, ...]) -> tuple[Goal, ...]:
    """Return the goals that are assigned."""
    if not spec.assign:
        if spec.goals is not None:
            raise ScenarioError("stand beside assign: true alone", ("goals",))
        return ()
    if spec.goals is None or not vehicles:
        return tuple(vehicle.goal for vehicle in vehicles)
    if not spec.goals:
        raise _too_few_goals(spec)
    system = vehicles[0].system
    return tuple(build_goal(one, system, "goals", k) for k, one in enumerate(spec.goals))


def _too_few_goals(spec: ScenarioSpec) -> ScenarioError:
    """Return the error of a list of goals that is shorter than that of vehicles."""
    lacking = 0 if spec.defaults.goal else sum(entry.goal is None for entry in spec.vehicles)
    hint = f"; without a goal of their own are {lacking}" if lacking else ""
    counts = f"{len(spec.vehicles)}, got {len(spec.goals or ())}{hint}"
    return ScenarioError(f"must be as many as vehicles at least, {counts}", ("goals",))


def _keep(spec: ScenarioSpec) -> tuple[Keep, ...]:
    """Return the ranges that vehicles keep."""
    if not spec.keep:
        return ()
    from radmpc.model.relations.keep import Keep  # noqa: PLC0415 - few keep a range

    found = []
    for k, entry in enumerate(spec.keep):
        try:
            found.append(Keep(entry.vehicles, entry.within))
        except ScenarioError as error:
            raise error.under("keep", k) from error
    return tuple(found)


def _check_objective(spec: ScenarioSpec) -> None:
    """Refuse another price of effort than 1, and a negative one of time."""
    try:
        if spec.objective.effort != 1.0:
            raise ScenarioError(
                f"must be 1, time is priced against it; got {spec.objective.effort:g}", ("effort",)
            )
        check_not_negative(spec.objective.time, "time")
    except ScenarioError as error:
        raise error.under("objective") from error


class _Attempts:
    """Parts made one after the other, whatever is wrong with those before."""

    def __init__(self) -> None:
        self.errors: list[ScenarioError] = []

    def attempt(self, make: Callable[[], _Part]) -> _Part | None:
        """Return a part, None where it is wrong."""
        try:
            return make()
        except ScenarioError as error:
            self.errors.append(error)
            return None


def _vehicles(spec: ScenarioSpec, dt: float) -> tuple[Vehicle, ...]:
    """Return the vehicles, their own fields before the defaults."""
    shared = Shared(dt)
    parts = _Attempts()
    usual = usual_axes(spec)
    vehicles = [
        parts.attempt(partial(_vehicle, spec, i, shared, usual)) for i in range(len(spec.vehicles))
    ]
    raise_together(parts.errors)
    return tuple(vehicle for vehicle in vehicles if vehicle is not None)


def _vehicle(spec: ScenarioSpec, index: int, shared: Shared, usual: int | None) -> Vehicle:
    """Return one vehicle."""
    entry = spec.vehicles[index]
    own = {name: getattr(entry, name) for name in entry.model_fields_set}
    defaults = spec.defaults
    if spec.goals is not None and "goal" not in own:
        if index < len(spec.goals):
            own["goal"] = spec.goals[index]
        elif spec.assign and defaults.goal is None:
            raise _too_few_goals(spec)
    if own.keys() & _DISTURBANCES:
        # They say the same thing in two ways: one of its own replaces either default.
        kept = defaults.model_fields_set - _DISTURBANCES
        defaults = VehicleSpec.model_construct(**{name: getattr(defaults, name) for name in kept})
    try:
        return build_vehicle(defaults.model_copy(update=own), shared)
    except ScenarioError as error:
        # A goal says how many states there are: lists that are right would be blamed for it.
        told = odd_goal(spec.vehicles[index].goal, usual) or error
        raise told.under("vehicles", index) from error


def _obstacles(spec: ScenarioSpec) -> tuple[Obstacle, ...]:
    """Return the obstacles."""
    parts = _Attempts()
    obstacles = [
        parts.attempt(partial(_obstacle, i, entry)) for i, entry in enumerate(spec.obstacles)
    ]
    raise_together(parts.errors)
    return tuple(obstacle for obstacle in obstacles if obstacle is not None)


def _at_origin(error: ScenarioError, spec: ScenarioSpec) -> ScenarioError:
    """Return an error where its value stands: with the vehicle or in the defaults."""
    path = error.path
    if len(path) < 3 or path[0] != "vehicles" or not isinstance(path[1], int):
        return error
    vehicle = spec.vehicles[path[1]]
    if path[2] in vehicle.model_fields_set or path[2] not in spec.defaults.model_fields_set:
        return error
    # What is wrong for every vehicle shows with the first.
    whose = f" (for vehicle {shown(vehicle.name)})" if path[1] > 0 else ""
    return ScenarioError(error.message + whose, ("defaults", *path[2:]))


def _workspace(spec: ScenarioSpec) -> Workspace | None:
    """Return the workspace."""
    if spec.workspace is None:
        return None
    try:
        return Workspace(as_vector(spec.workspace.min), as_vector(spec.workspace.max))
    except ScenarioError as error:
        raise error.under("workspace") from error


def _obstacle(index: int, spec: ObstacleSpec) -> Obstacle:
    """Return an obstacle, for the vehicles it concerns."""
    obstacle = _shaped(index, spec)
    if spec.only is None and spec.exempt is None:
        return obstacle
    from radmpc.model.relations.concerns import all_but, only_for  # noqa: PLC0415 - few tell them apart

    try:
        if spec.exempt is None:
            return only_for(obstacle, spec.only or ())
        if spec.only is None:
            return all_but(obstacle, spec.exempt)
    except ScenarioError as error:
        raise error.under("obstacles", index) from error
    raise ScenarioError("must be left out beside for", ("obstacles", index, "except"))


def _shaped(index: int, spec: ObstacleSpec) -> Obstacle:
    """Return an obstacle from whichever description is given."""
    path = ("obstacles", index)
    given = [key for kind in _OBSTACLE_KINDS for key in kind if getattr(spec, key) is not None]
    try:
        if spec.vertices is not None and given == ["vertices"]:
            return Obstacle.polygon(spec.name, spec.vertices, spec.holes or ())
        if spec.holes is not None:
            raise ScenarioError("stand beside vertices alone", ("holes",))
        if spec.line is not None and given == ["line"]:
            return Obstacle.line(spec.name, spec.line)
        if spec.min is not None and spec.max is not None and given == ["min", "max"]:
            return Obstacle.box(spec.name, spec.min, spec.max)
        if spec.normals is not None and spec.offsets is not None and len(given) == 2:
            return Obstacle.halfspaces(spec.name, spec.normals, spec.offsets)
        if isinstance(spec.moving, TrackSpec) and given == ["moving"]:
            return build_tracked(spec.name, spec.moving)
        if isinstance(spec.moving, list) and given == ["moving"]:
            return Obstacle.moving(spec.name, spec.moving)
    except ScenarioError as error:
        raise error.under(*path) from error
    allowed = ", ".join(" and ".join(kind) for kind in _OBSTACLE_KINDS)
    raise ScenarioError(
        f"needs exactly one of: {allowed}; got {' and '.join(given) or 'none of them'}", path
    )
