"""The obstacles of a plane picture."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.patches import Patch, PathPatch, Polygon
from matplotlib.path import Path

from radmpc.arrays import Matrix
from radmpc.geometry import Polytope, planar
from radmpc.model.obstacle import Obstacle
from radmpc.plotting.artists.relations import FOR_SOME, PASSED, name_text
from radmpc.plotting.canvas.labels import LabelBoard
from radmpc.plotting.canvas.style import (
    MUTED,
    NUMBER_SIZE,
    OBSTACLE_EDGE,
    OBSTACLE_FILL,
    POST_SIZE,
    WALL_WIDTH,
    numbered_steps,
)
from radmpc.plotting.curves import ABOVE, Plane

__all__ = ["along_lines", "draw_obstacle", "name_obstacle", "patch_of", "ring_of", "seen"]


def draw_obstacle(
    ax: Axes,
    obstacle: Obstacle,
    board: LabelBoard,
    *,
    plane: Plane = ABOVE,
    strength: float = 1.0,
) -> None:
    """Draw an obstacle without its name.

    A moving one fades in from its first step to its last, with an arrow along its way and the
    numbers of some steps. A strength below 1 makes it paler.

    Parameters
    ----------
    ax : Axes
        Axes to draw on.
    obstacle : Obstacle
        The obstacle to draw.
    board : LabelBoard
        Where other texts stand.
    plane : (int, int)
        The two coordinates that are drawn.
    strength : float
        Opacity of a moving obstacle, as a share of the usual [-].
    """
    last = len(obstacle.steps) - 1
    outlines = [shapely.union_all([seen(p, plane) for p in pieces]) for pieces in obstacle.steps]
    for step, outline in enumerate(outlines):
        alpha = strength * (1.0 if last == 0 else 0.12 + 0.58 * (step / last) ** 2)
        if outline.area == 0.0:
            for piece in obstacle.at(step):
                ends = shapely.get_coordinates(seen(piece, plane))
                _draw_wall(ax, obstacle, ends, alpha)
                board.avoid(along_lines(np.vstack([ends, ends[:1]])))
            continue
        patch = patch_of(outline)
        patch.set(
            **({"facecolor": OBSTACLE_FILL} if obstacle.concerns is None else FOR_SOME),
            edgecolor=OBSTACLE_EDGE,
            linewidth=0.6,
            alpha=alpha,
            zorder=2,
            gid=f"obstacle:{obstacle.name}",
        )
        ax.add_patch(patch)
        board.avoid(along_lines(ring_of(outline)))
    if last > 0:
        _draw_way(ax, obstacle.name, np.array([_center(outline) for outline in outlines]), board)


def _draw_wall(ax: Axes, obstacle: Obstacle, ends: Matrix, alpha: float) -> None:
    """Draw a wall without thickness as a line, a post as a dot; dashed or open if for some only."""
    is_for_all = obstacle.concerns is None
    ax.plot(
        *ends.T,
        color=OBSTACLE_EDGE,
        linewidth=WALL_WIDTH,
        marker="o",
        markersize=POST_SIZE if len(ends) == 1 else 0.0,
        linestyle="solid" if is_for_all else PASSED,
        markeredgewidth=0.0 if is_for_all else 0.6,
        markerfacecolor=OBSTACLE_EDGE if is_for_all else "none",
        alpha=alpha,
        zorder=2,
        gid=f"obstacle:{obstacle.name}",
    )


def _draw_way(ax: Axes, name: str, centers: Matrix, board: LabelBoard) -> None:
    """Draw an arrow from first to last step and the numbers of some steps on it."""
    if np.ptp(centers, axis=0).max() < 1e-9:
        return
    ax.plot(*centers.T, color=MUTED, linewidth=0.5, zorder=2.4, gid=f"way:{name}")
    moved = [k for k in range(len(centers) - 1) if np.any(centers[k] != centers[-1])]
    ax.annotate(
        "",
        (float(centers[-1, 0]), float(centers[-1, 1])),
        xytext=(float(centers[moved[-1], 0]), float(centers[moved[-1], 1])),
        arrowprops={
            "arrowstyle": "-|>,head_length=0.4,head_width=0.2", "color": MUTED, "linewidth": 0.5,
            "shrinkA": 0.0, "shrinkB": 0.0,
        },
        zorder=2.4,
        gid=f"direction:{name}",
    )  # fmt: skip
    board.avoid(along_lines(centers))
    for k in numbered_steps(len(centers) - 1):
        board.beside(
            str(k), centers[k], np.zeros(2), MUTED, size=NUMBER_SIZE, gid=f"step:{name}:{k}"
        )


def name_obstacle(obstacle: Obstacle, board: LabelBoard, plane: Plane = ABOVE) -> None:
    """Write an obstacle's name in its largest piece at the first step, else beside that.

    Parameters
    ----------
    obstacle : Obstacle
        Whose name.
    board : LabelBoard
        Where other texts stand.
    plane : (int, int)
        The two coordinates that are drawn.
    """
    largest = max(obstacle.steps[0], key=lambda p: (seen(p, plane).area, seen(p, plane).length))
    corners = largest.vertices[:, list(plane)]
    half_size, center = 0.5 * np.ptp(corners, axis=0), corners.mean(axis=0)
    text, gid = name_text(obstacle, board.most_letters()), f"label:{obstacle.name}"
    outline = seen(largest, plane)
    is_still = len(obstacle.steps) == 1 and isinstance(outline, shapely.Polygon)
    if not (is_still and board.within(text, outline, MUTED, gid=gid)):
        board.beside(text, center, half_size, MUTED, gid=gid)


def _center(outline: shapely.Geometry) -> tuple[float, float]:
    """Return the centroid."""
    return float(outline.centroid.x), float(outline.centroid.y)


def seen(piece: Polytope, plane: Plane) -> shapely.Geometry:
    """Return a convex piece as a flat picture shows it; in space, what hides behind its outline.

    Parameters
    ----------
    piece : Polytope
        In the plane or in space.
    plane : (int, int)
        The two coordinates that are drawn.
    """
    if piece.vertices.shape[1] == 2:
        return planar(piece)
    return shapely.MultiPoint(piece.vertices[:, list(plane)]).convex_hull


def patch_of(polygon: shapely.Geometry) -> Patch:
    """Return a polygon, perhaps with holes, as something to draw.

    Parameters
    ----------
    polygon : Geometry
        In the coordinates of the axes.
    """
    if polygon.geom_type != "Polygon" or not polygon.interiors:
        return Polygon(ring_of(polygon))
    # Renderers leave free what goes round the other way.
    turned = shapely.orient_polygons(polygon)
    rings = [Path(np.asarray(ring.coords)) for ring in (turned.exterior, *turned.interiors)]
    return PathPatch(Path.make_compound_path(*rings))


def ring_of(polygon: shapely.Geometry) -> Matrix:
    """Return the outer corners of a polygon."""
    outline = polygon if polygon.geom_type == "Polygon" else polygon.convex_hull
    return np.asarray(outline.exterior.coords)


def along_lines(corners: Matrix, count: int = 8) -> Matrix:
    """Return points along a line, ``count`` per side, so that texts notice its sides too.

    Parameters
    ----------
    corners : (c, d) array
        Of an open line [m].
    count : int
        Points per side.
    """
    share = np.linspace(0.0, 1.0, count, endpoint=False)[:, None]
    return np.vstack([a + share * (b - a) for a, b in pairwise(corners)])
