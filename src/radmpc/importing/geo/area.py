"""The area that vehicles operate in, as a workspace and obstacles around it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import shapely

from radmpc.arrays import Matrix, Vector
from radmpc.errors import ScenarioError
from radmpc.importing.geo.feature import Feature
from radmpc.importing.rounding import rounded
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Workspace
from radmpc.records import dataclass
from radmpc.wording import count_text

__all__ = ["Area", "area_of"]

_ALIGNED = 0.01
"""Share of a rectangle [-] that its largest axis-parallel box may miss to stand for it."""

_STRAIGHT = 0.05
"""Corners this close to the line between their neighbors are dropped [m]."""

_INSET = 1e-3
"""Share of its size [-] that a bounding box gives up for sides that nearly lie on it."""

_SLIVER = 1e-6
"""Areas below are rounding, not ground [m²]."""


@dataclass(frozen=True, slots=True, eq=False)
class Area:
    """Where vehicles may be.

    Attributes
    ----------
    workspace : Workspace or None
        None if no area is drawn.
    outside : tuple of Obstacle
        What of the workspace lies outside the area, and the area's holes.
    polygon : shapely.Polygon or None
        As drawn [m].
    note : str
        What became of it, in words.
    """

    workspace: Workspace | None = None
    outside: tuple[Obstacle, ...] = ()
    polygon: shapely.Polygon | None = None
    note: str = "none drawn"

    def holds(self, point: Vector) -> bool:
        """Whether a point [m] lies in the area."""
        return self.polygon is None or bool(self.polygon.intersects(shapely.Point(point)))


def area_of(features: Sequence[Feature], outlines: Callable[[Feature], tuple[Matrix, ...]]) -> Area:
    """Return the area that is drawn.

    A rectangle along the axes is the workspace itself. Of any other shape the bounding box, a
    thousandth within, is the workspace, and what the shape leaves of it becomes obstacles, as holes
    do.

    Parameters
    ----------
    features : sequence of Feature
        Polygons, at most one.
    outlines : callable
        From a feature to its rings in the plane, each (r, 2) [m].

    Raises
    ------
    ScenarioError
        If there are several.
    """
    if len(features) > 1:
        raise ScenarioError("must be one area only, got a second", features[1].path)
    if not features:
        return Area()
    outer, *holes = outlines(features[0])
    polygon = shapely.Polygon(outer, holes)
    if not polygon.is_valid:
        why = shapely.is_valid_reason(polygon)
        raise ScenarioError(f"holes must lie within the area, got {why}", features[0].shape_path)
    low, high, is_rectangle = _box(outer)
    try:
        outside = [] if is_rectangle else _pieces(shapely.box(*low, *high) - shapely.Polygon(outer))
        named = [(f"outside{i + 1}", piece) for i, piece in enumerate(outside)]
        named += [(f"hole{i + 1}", hole) for i, hole in enumerate(holes)]
        obstacles = tuple(Obstacle.polygon(name, piece) for name, piece in named)
    except ScenarioError as error:
        raise ScenarioError(error.message, features[0].shape_path) from error
    note = "a rectangle: the workspace of the vehicles' centers"
    if not is_rectangle:
        rest = count_text(len(outside), "obstacle")
        note = f"its bounding box is the workspace, the rest of that {rest}"
    if holes:
        is_one = len(holes) == 1
        note += "; its hole is an obstacle" if is_one else f"; its {len(holes)} holes are obstacles"
    return Area(Workspace(low, high), obstacles, polygon, note)


def _box(outer: Matrix) -> tuple[Vector, Vector, bool]:
    """Return the box of an outline (r, 2), and whether the outline is that box.

    Lines of equal latitude bend and those of equal longitude lean in the plane: what is a
    rectangle on the map is nearly one here, and the box within it counts.
    """
    low, high = outer.min(axis=0), outer.max(axis=0)
    corners = np.array(shapely.Polygon(outer).simplify(_STRAIGHT).exterior.coords)[:-1]
    if len(corners) == 4:
        ordered = np.sort(corners, axis=0)
        inner_low, inner_high = ordered[1], ordered[2]
        missed = 1.0 - np.prod(inner_high - inner_low) / np.prod(high - low)
        if missed <= _ALIGNED:
            return inner_low, inner_high, True
    inset = _INSET * (high - low)
    return rounded(low + inset), rounded(high - inset), False


def _pieces(rest: shapely.Geometry) -> list[Matrix]:
    """Return the outlines of what is left over, slivers aside."""
    parts = [part for part in shapely.get_parts(rest) if part.area > _SLIVER]
    return [rounded(np.array(part.exterior.coords)[:-1]) for part in parts]
