"""Problems drawn on a map: obstacles, an area, starts and goals by latitude and longitude."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.errors import ScenarioError
from radmpc.importing.geo.area import Area
from radmpc.importing.geo.feature import Feature
from radmpc.importing.geo.ground import origin_of, sorted_by_role, standing
from radmpc.importing.geo.local_plane import (
    CONTROL_LIMIT,
    RADIUS,
    SPEED_LIMIT,
    Placed,
    describe_choices,
    describe_losses,
)
from radmpc.importing.geo.relations import (
    check_places,
    keep_of,
)
from radmpc.importing.geo.visits import describe_visits, visits_of, window_of
from radmpc.importing.problem import ForeignProblem, ForeignVehicle
from radmpc.io.text.files import shown
from radmpc.records import dataclass

__all__ = ["geo_problem"]


@dataclass(frozen=True, slots=True, eq=False)
class _Ends:
    """Where a vehicle starts and ends, and what it visits, as drawn."""

    start: Feature
    goal: Feature
    via: tuple[Feature, ...] = ()


def geo_problem(features: Sequence[Feature]) -> ForeignProblem:
    """Return the problem that features on a map describe, in a local east-north plane.

    Parameters
    ----------
    features : sequence of Feature
        Checked one by one.

    Returns
    -------
    ForeignProblem
        Still without the names of file and format.

    Raises
    ------
    ScenarioError
        If they do not fit together; its path says which.
    """
    by_role = sorted_by_role(features)
    check_places(features)
    ends = _ends(by_role.get("start", []), by_role.get("goal", []), by_role.get("via", []))
    origin = origin_of(features, by_role.get("origin", []))
    placed = Placed(origin)
    placed.check(features)
    area, obstacles = standing(by_role, placed, ends)
    vehicles = tuple(_vehicle(key, both, placed, area) for key, both in ends.items())
    keep = keep_of([*by_role.get("start", []), *by_role.get("goal", [])], ends)
    return ForeignProblem(
        name="",
        format="",
        file="",
        vehicles=vehicles,
        obstacles=obstacles,
        keep=keep,
        workspace=area.workspace,
        origin={
            "latitude": origin.latitude,
            "longitude": origin.longitude,
            "height": origin.height,
        },
        reasons=(
            *describe_choices(
                [both.start.settings() | both.goal.settings() for both in ends.values()],
                origin,
                "origin" in by_role,
                area.note,
            ),
            *describe_visits(by_role.get("via", [])),
        ),
        warnings=describe_losses(features, placed),
    )


def _ends(
    starts: Sequence[Feature], goals: Sequence[Feature], visits: Sequence[Feature]
) -> dict[str, _Ends]:
    """Return starts, goals and visits by vehicle, in the order of the starts."""
    by_kind: list[dict[str, Feature]] = []
    for kind, points in (("start", starts), ("goal", goals)):
        found: dict[str, Feature] = {}
        for point in points:
            if point.vehicle in found:
                raise ScenarioError(
                    f"must be unique among {kind}s, got {shown(point.vehicle)} twice",
                    (*point.properties_path, "vehicle"),
                )
            found[point.vehicle] = point
        by_kind.append(found)
    for here, kind in ((0, "goal"), (1, "start")):
        for key, point in by_kind[here].items():
            if key not in by_kind[1 - here]:
                raise ScenarioError(
                    f"vehicle {shown(key)} needs a {kind}, a Point with role {kind!r}, got none",
                    (*point.properties_path, "vehicle"),
                )
    if not by_kind[0]:
        raise ScenarioError("needs at least one vehicle: Points with role 'start' and 'goal'")
    for visit in visits:
        if visit.vehicle not in by_kind[0]:
            raise ScenarioError(
                f"must be a vehicle that starts somewhere, got {shown(visit.vehicle)}",
                (*visit.properties_path, "vehicle"),
            )
    return {
        key: _Ends(start, by_kind[1][key], tuple(one for one in visits if one.vehicle == key))
        for key, start in by_kind[0].items()
    }


def _vehicle(name: str, ends: _Ends, placed: Placed, area: Area) -> ForeignVehicle:
    """Return a vehicle, at rest at both ends."""
    settings = ends.start.settings()
    for key, value in ends.goal.settings().items():
        if settings.setdefault(key, value) != value:
            raise ScenarioError(
                f"must be {settings[key]:g} as at the start of {shown(name)}, got {value:g}",
                (*ends.goal.properties_path, key),
            )
    start, goal = placed.point(ends.start), placed.point(ends.goal)
    radius = settings.get("radius", RADIUS)
    via = visits_of(ends.via, placed, radius)
    drawn = [(start, ends.start), (goal, ends.goal)]
    for point, feature in [*drawn, *((placed.point(one), one) for one in ends.via)]:
        if not area.holds(point):
            raise ScenarioError(
                f"must lie in the area, got {feature.rings[0][0, :2].tolist()}", feature.shape_path
            )
    return ForeignVehicle(
        name=name,
        start=start,
        goal=goal,
        start_velocity=np.zeros(2),
        goal_velocity=np.zeros(2),
        radius=radius,
        speed_limit=settings.get("speed_limit", SPEED_LIMIT),
        control_limit=settings.get("control_limit", CONTROL_LIMIT),
        via=via,
        arrival=window_of(ends.goal),
    )
