"""Problems drawn on a map: obstacles, an area, starts and goals by latitude and longitude."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from radmpc.errors import ScenarioError
from radmpc.geodesy import Origin
from radmpc.importing.geo.area import Area, area_of
from radmpc.importing.geo.feature import Feature
from radmpc.importing.geo.local_plane import (
    CONTROL_LIMIT,
    RADIUS,
    SPEED_LIMIT,
    Placed,
    describe_choices,
    describe_losses,
)
from radmpc.importing.geo.moving import moving_obstacle
from radmpc.importing.geo.visits import describe_visits, visits_of, window_of
from radmpc.importing.problem import ForeignProblem, ForeignVehicle
from radmpc.io.text.files import shown
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Workspace

__all__ = ["Ground", "geo_problem", "ground_of"]

_UNNAMED = {"Polygon": "polygon", "LineString": "line", "Point": "post"}

_DIGITS = 6
"""Decimals of the origin's degrees: 0.1 m."""


@dataclass(frozen=True, slots=True, eq=False)
class _Ends:
    """Where a vehicle starts and ends, and what it visits, as drawn."""

    start: Feature
    goal: Feature
    via: tuple[Feature, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """What stands on a map, whoever moves there.

    Attributes
    ----------
    obstacles : tuple of Obstacle
        Those of the area, too.
    workspace : Workspace or None
        None if no area is drawn.
    origin : Origin
        Where the plane touches the earth.
    has_vehicles : bool
        Whether somebody starts or ends there.
    """

    obstacles: tuple[Obstacle, ...]
    workspace: Workspace | None
    origin: Origin
    has_vehicles: bool


def ground_of(features: Sequence[Feature], origin: Origin | None = None) -> Ground:
    """Return what stands on a map, in a local east-north plane.

    Parameters
    ----------
    features : sequence of Feature
        Checked one by one.
    origin : Origin or None
        Of the plane; None is the one that is drawn, else the middle of everything.

    Raises
    ------
    ScenarioError
        If nothing is drawn, or it does not fit together.
    """
    by_role = _by_role(features)
    origin = origin or _origin(features, by_role.get("origin", []))
    placed = Placed(origin)
    placed.check(features)
    area, obstacles = _standing(by_role, placed)
    has_vehicles = any(role in by_role for role in ("start", "goal", "via"))
    return Ground(obstacles, area.workspace, origin, has_vehicles)


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
    by_role = _by_role(features)
    ends = _ends(by_role.get("start", []), by_role.get("goal", []), by_role.get("via", []))
    origin = _origin(features, by_role.get("origin", []))
    placed = Placed(origin)
    placed.check(features)
    area, obstacles = _standing(by_role, placed)
    vehicles = tuple(_vehicle(key, both, placed, area) for key, both in ends.items())
    return ForeignProblem(
        name="",
        format="",
        file="",
        vehicles=vehicles,
        obstacles=obstacles,
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
                area.told,
            ),
            *describe_visits(by_role.get("via", [])),
        ),
        warnings=describe_losses(features, placed),
    )


def _by_role(features: Sequence[Feature]) -> dict[str, list[Feature]]:
    """Return features by what they stand for."""
    if not features:
        raise ScenarioError("needs Points and Polygons or LineStrings, got none of them")
    by_role: dict[str, list[Feature]] = {}
    for feature in features:
        by_role.setdefault(feature.role, []).append(feature)
    return by_role


def _standing(
    by_role: dict[str, list[Feature]], placed: Placed
) -> tuple[Area, tuple[Obstacle, ...]]:
    """Return the area, and all obstacles: its own, too."""
    area = area_of(by_role.get("area", []), placed.outlines)
    obstacles = _obstacles(by_role.get("obstacle", []), placed)
    taken = {obstacle.name for obstacle in obstacles}
    clashes = sorted(taken & {piece.name for piece in area.outside})
    if clashes:
        raise ScenarioError(f"names of obstacles must not be {clashes[0]!r}: the area's are")
    return area, (*obstacles, *area.outside)


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


def _origin(features: Sequence[Feature], stated: Sequence[Feature]) -> Origin:
    """Return the stated origin, or the middle of everything drawn."""
    if len(stated) > 1:
        raise ScenarioError("must be one origin only, got a second", stated[1].path)
    if stated:
        longitude, latitude, height = stated[0].rings[0][0].tolist()
        if "height" in stated[0].properties:
            height = stated[0].number("height")
        try:
            return Origin(latitude, longitude, height)
        except ScenarioError as error:
            path = (*stated[0].properties_path, *error.path)
            raise ScenarioError(error.message, path) from error
    degrees = np.radians(np.vstack([ring for feature in features for ring in feature.rings])[:, :2])
    longitude, latitude = degrees.T
    # The middle of unit vectors: longitudes jump at the antimeridian and mean nothing at poles.
    x, y, z = np.mean(
        [
            np.cos(latitude) * np.cos(longitude),
            np.cos(latitude) * np.sin(longitude),
            np.sin(latitude),
        ],
        axis=1,
    )
    return Origin(
        round(float(np.degrees(np.arctan2(z, np.hypot(x, y)))), _DIGITS),
        round(float(np.degrees(np.arctan2(y, x))), _DIGITS),
    )


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


def _obstacles(features: Sequence[Feature], placed: Placed) -> list[Obstacle]:
    """Return obstacles under their names; polygon1, line2, … where they have none."""
    obstacles: list[Obstacle] = []
    taken: dict[str, Feature] = {}
    counts: dict[str, int] = {}
    for i, feature in enumerate(features):
        name = feature.name or f"{_UNNAMED[feature.kind]}{i + 1}"
        if taken.setdefault(name, feature).path != feature.path:
            raise ScenarioError(
                f"must be unique among obstacles, got {shown(name)} twice",
                (*feature.properties_path, "name"),
            )
        # The parts of one feature share its name.
        count = counts[name] = counts.get(name, 0) + 1
        full = name if count == 1 else f"{name} ({count})"
        outline, *free = placed.outlines(feature)
        moving = moving_obstacle(full, feature, outline)
        try:
            if moving is not None:
                obstacle = moving
            elif feature.kind == "LineString":
                obstacle = Obstacle.line(full, outline)
            else:
                obstacle = Obstacle.polygon(full, outline, free)
            obstacles.append(obstacle)
        except ScenarioError as error:
            raise ScenarioError(error.message, feature.shape_path) from error
    return obstacles
