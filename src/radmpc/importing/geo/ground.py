"""What stands on a map, in a local east-north plane, whatever vehicles move there."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from radmpc.errors import ScenarioError
from radmpc.geodesy import Origin
from radmpc.importing.geo.area import Area, area_of
from radmpc.importing.geo.feature import Feature
from radmpc.importing.geo.local_plane import Placed
from radmpc.importing.geo.moving import moving_obstacle
from radmpc.importing.geo.relations import concerning
from radmpc.io.text.files import shown
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Workspace
from radmpc.records import dataclass

__all__ = ["Ground", "ground_of", "origin_of", "sorted_by_role", "standing"]

_UNNAMED = {"Polygon": "polygon", "LineString": "line", "Point": "post"}

_DIGITS = 6
"""Decimals of the origin's degrees: 0.1 m."""


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """What stands on a map, whatever vehicles move there.

    Attributes
    ----------
    obstacles : tuple of Obstacle
        Those of the area, too.
    workspace : Workspace or None
        None if no area is drawn.
    origin : Origin
        Where the plane touches the earth.
    has_vehicles : bool
        Whether any vehicle starts or ends there.
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
    by_role = sorted_by_role(features)
    origin = origin or origin_of(features, by_role.get("origin", []))
    placed = Placed(origin)
    placed.check(features)
    area, obstacles = standing(by_role, placed, None)
    has_vehicles = any(role in by_role for role in ("start", "goal", "via"))
    return Ground(obstacles, area.workspace, origin, has_vehicles)


def sorted_by_role(features: Sequence[Feature]) -> dict[str, list[Feature]]:
    """Return features by what they stand for.

    Parameters
    ----------
    features : sequence of Feature
        What is drawn.

    Raises
    ------
    ScenarioError
        If there is nothing.
    """
    if not features:
        raise ScenarioError("needs Points and Polygons or LineStrings, got none of them")
    by_role: dict[str, list[Feature]] = {}
    for feature in features:
        by_role.setdefault(feature.role, []).append(feature)
    return by_role


def standing(
    by_role: Mapping[str, Sequence[Feature]], placed: Placed, vehicles: Collection[str] | None
) -> tuple[Area, tuple[Obstacle, ...]]:
    """Return the area, and all obstacles: its own, too.

    Parameters
    ----------
    by_role : mapping of str to sequence of Feature
        What is drawn, by what it stands for.
    placed : Placed
        The plane.
    vehicles : collection of str or None
        Which vehicles obstacles may concern; None for any.

    Raises
    ------
    ScenarioError
        If names of obstacles are not one thing's, or name others than these vehicles.
    """
    area = area_of(by_role.get("area", []), placed.outlines)
    obstacles = _obstacles(by_role.get("obstacle", []), placed, vehicles)
    taken = {obstacle.name for obstacle in obstacles}
    clashes = sorted(taken & {piece.name for piece in area.outside})
    if clashes:
        raise ScenarioError(f"names of obstacles must not be {clashes[0]!r}: the area's are")
    return area, (*obstacles, *area.outside)


def origin_of(features: Sequence[Feature], stated: Sequence[Feature]) -> Origin:
    """Return the stated origin, or the middle of everything drawn.

    Parameters
    ----------
    features : sequence of Feature
        What is drawn, one at least.
    stated : sequence of Feature
        Those among them that state an origin.

    Raises
    ------
    ScenarioError
        If there are several, or one is no place on earth.
    """
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


def _obstacles(
    features: Sequence[Feature], placed: Placed, vehicles: Collection[str] | None
) -> list[Obstacle]:
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
        obstacles.append(concerning(feature, _obstacle(full, feature, placed), vehicles))
    return obstacles


def _obstacle(name: str, feature: Feature, placed: Placed) -> Obstacle:
    """Return an obstacle for everybody."""
    outline, *free = placed.outlines(feature)
    moving = moving_obstacle(name, feature, outline)
    if moving is not None:
        return moving
    try:
        if feature.kind == "LineString":
            return Obstacle.line(name, outline)
        return Obstacle.polygon(name, outline, free)
    except ScenarioError as error:
        raise ScenarioError(error.message, feature.shape_path) from error
