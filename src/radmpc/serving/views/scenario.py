"""A scenario, ready to be drawn and dragged."""

from __future__ import annotations

from radmpc.io.native.encoding import encode_scenario
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.model.visits import Visit
from radmpc.serving.protocol import (
    Content,
    GoalView,
    Handle,
    Path,
    ScenarioView,
    VehicleView,
)
from radmpc.serving.views.handles import box_handles, corner_handles, handle_of, value_at
from radmpc.serving.views.numbers import Rounding, extent_of
from radmpc.serving.views.obstacles import obstacle_view

__all__ = ["scenario_view"]


def scenario_view(scenario: Scenario, content: Content | None = None) -> ScenarioView:
    """Return a scenario as the page draws it.

    Parameters
    ----------
    scenario : Scenario
        What the document says.
    content : mapping or None
        The document; None is the scenario's own file.

    Returns
    -------
    ScenarioView
        Places rounded to what a screen shows.
    """
    document = encode_scenario(scenario) if content is None else content
    lower, upper = extent_of(scenario)
    rounding = Rounding.of(lower, upper)
    workspace = scenario.workspace
    return {
        "name": scenario.name,
        "dimension": scenario.dimension,
        "dt": scenario.dt,
        "horizon": scenario.horizon,
        "riskBound": scenario.risk_bound,
        "avoidance": scenario.avoidance,
        "workspace": None
        if workspace is None
        else {"min": rounding.point(workspace.lower), "max": rounding.point(workspace.upper)},
        "workspaceHandles": []
        if workspace is None
        else box_handles(document, workspace.lower, workspace.upper, ["workspace"], rounding)[1:],
        "vehicles": [
            _vehicle(vehicle, i, document, rounding) for i, vehicle in enumerate(scenario.vehicles)
        ],
        "obstacles": [
            obstacle_view(obstacle, i, document, rounding)
            for i, obstacle in enumerate(scenario.obstacles)
        ],
        "ranges": [
            {"vehicles": list(keep.vehicles), "within": rounding.length(keep.within)}
            for keep in scenario.keep
        ],
        "extent": {"min": rounding.point(lower), "max": rounding.point(upper)},
    }


def _vehicle(vehicle: Vehicle, index: int, content: Content, rounding: Rounding) -> VehicleView:
    """Return one vehicle."""
    path: Path = ["vehicles", index]
    start = vehicle.start_position
    return {
        "name": vehicle.name,
        "path": path,
        "radius": rounding.length(vehicle.radius),
        "start": rounding.point(start),
        "startHandle": handle_of(content, start, [[*path, "start"]], rounding),
        "goal": _box(vehicle.goal, [*path, "goal"], f"goal of {vehicle.name}", content, rounding),
        "via": _visits(vehicle, path, content, rounding),
    }


def _visits(vehicle: Vehicle, path: Path, content: Content, rounding: Rounding) -> list[GoalView]:
    """Return what a vehicle visits: boxes of its own or of all, then the ends of survey lines."""
    # Where a vehicle says nothing of its own, the defaults speak for it, and cannot be dragged.
    stated = value_at(content, [*path, "via"])
    count = len(stated) if isinstance(stated, list) else 0
    if "via" not in _entries(content, path):
        of_all = value_at(content, ["defaults", "via"])
        count = len(of_all) if isinstance(of_all, list) else 0
    views: list[GoalView] = []
    for j, visit in enumerate(vehicle.via):
        is_stated = j < count
        place: Path = [*path, "via", j] if is_stated else [*path, "survey"]
        view = _box(visit, place, f"{vehicle.name} {j + 1}", content, rounding)
        if j == count:
            view["handles"] = _survey_handles(place, content, rounding)
        views.append(view)
    return views


def _entries(content: Content, path: Path) -> dict[str, object]:
    """Return the mapping at a path, empty where there is none."""
    found = value_at(content, path)
    return found if isinstance(found, dict) else {}


def _survey_handles(path: Path, content: Content, rounding: Rounding) -> list[Handle]:
    """Return the area of a survey and its corners: the lines follow."""
    area = value_at(content, [*path, "area"])
    if not isinstance(area, list):
        return []
    return corner_handles(content, area, [[*path, "area", j] for j in range(len(area))], rounding)


def _box(
    box: Goal | Visit, path: Path, label: str, content: Content, rounding: Rounding
) -> GoalView:
    """Return a goal or a visit, by its center or its corners as the document has it."""
    stated = _entries(content, path)
    handles: list[Handle] = []
    if "center" in stated:
        one = handle_of(content, box.center, [[*path, "center"]], rounding)
        handles = [] if one is None else [one]
    elif "min" in stated:
        handles = box_handles(content, box.lower, box.upper, path, rounding)
    return {
        "box": {"min": rounding.point(box.lower), "max": rounding.point(box.upper)},
        "path": path,
        "label": label,
        "handles": handles,
    }
