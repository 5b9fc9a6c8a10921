"""From a scenario file's content to a `Scenario`."""

from __future__ import annotations

from radmpc.arrays import as_vector
from radmpc.errors import ScenarioError
from radmpc.io.native.checking import check_format, validated
from radmpc.io.native.plain import plain_mapping
from radmpc.io.native.ranges import check_range
from radmpc.io.native.schema import SCENARIO_FORMAT, ObstacleSpec, ScenarioSpec
from radmpc.io.native.vehicle_decoding import Shared, build_vehicle
from radmpc.io.text.files import shown
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Vehicle

__all__ = ["decode_scenario"]

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
    spec = validated(ScenarioSpec, check_format(data, SCENARIO_FORMAT))
    try:
        return _build(spec)
    except ScenarioError as error:
        raise _at_origin(error, spec) from error


def _build(spec: ScenarioSpec) -> Scenario:
    """Return the scenario of a file whose shapes are right."""
    return Scenario(
        name=spec.name,
        dt=spec.dt,
        horizon=spec.horizon,
        risk_bound=spec.risk_bound,
        avoidance=spec.avoidance,
        pair_faces=spec.pair_faces,
        workspace=_workspace(spec),
        obstacles=tuple(_obstacle(i, entry) for i, entry in enumerate(spec.obstacles)),
        vehicles=_vehicles(spec),
        source=None if spec.source is None else plain_mapping(spec.source, ("source",)),
    )


def _vehicles(spec: ScenarioSpec) -> tuple[Vehicle, ...]:
    """Return the vehicles, their own fields before the defaults."""
    check_range(spec.dt, "s", ("dt",))
    shared = Shared(spec.dt)
    vehicles = []
    for i, entry in enumerate(spec.vehicles):
        own = {name: getattr(entry, name) for name in entry.model_fields_set}
        try:
            vehicles.append(build_vehicle(spec.defaults.model_copy(update=own), shared))
        except ScenarioError as error:
            raise error.under("vehicles", i) from error
    return tuple(vehicles)


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
    """Return an obstacle from whichever description is given."""
    path = ("obstacles", index)
    given = [key for kind in _OBSTACLE_KINDS for key in kind if getattr(spec, key) is not None]
    try:
        if spec.vertices is not None and given == ["vertices"]:
            return Obstacle.polygon(spec.name, spec.vertices)
        if spec.line is not None and given == ["line"]:
            return Obstacle.line(spec.name, spec.line)
        if spec.min is not None and spec.max is not None and given == ["min", "max"]:
            return Obstacle.box(spec.name, spec.min, spec.max)
        if spec.normals is not None and spec.offsets is not None and len(given) == 2:
            return Obstacle.halfspaces(spec.name, spec.normals, spec.offsets)
        if spec.moving is not None and given == ["moving"]:
            return Obstacle.moving(spec.name, spec.moving)
    except ScenarioError as error:
        raise error.under(*path) from error
    allowed = ", ".join(" and ".join(kind) for kind in _OBSTACLE_KINDS)
    raise ScenarioError(
        f"needs exactly one of: {allowed}; got {' and '.join(given) or 'none of them'}", path
    )
