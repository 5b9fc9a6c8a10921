"""Obstacles, ready to be drawn."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix
from radmpc.facets import surface
from radmpc.model.obstacle import (
    BoxShape,
    HalfspaceShape,
    LineShape,
    MovingShape,
    Obstacle,
    PolygonShape,
    TrackShape,
)
from radmpc.serving.protocol import Content, Handle, ObstacleView, Path
from radmpc.serving.views.ellipses import ellipses_of
from radmpc.serving.views.handles import box_handles, corner_handles, handle_of, value_at
from radmpc.serving.views.numbers import Rounding

__all__ = ["obstacle_view"]

_MOST_NAMES = 3
"""Vehicles that are named of those whom an obstacle concerns [-]."""

_TURNS = 48
"""Directions in which the corners of outlines are found that differ in number from step to step."""


def obstacle_view(
    obstacle: Obstacle, index: int, content: Content, rounding: Rounding
) -> ObstacleView:
    """Return an obstacle as the page draws it.

    Parameters
    ----------
    obstacle : Obstacle
        Laid out by its scenario.
    index : int
        Its number in the document.
    content : mapping
        The document.
    rounding : Rounding
        Of the map.
    """
    path: Path = ["obstacles", index]
    spread = obstacle.spread
    view: ObstacleView = {
        "name": obstacle.name,
        "path": path,
        "kind": "solid",
        "rings": [],
        "corners": [],
        "triangles": [],
        "moving": None,
        "uncertain": None if spread is None else ellipses_of(spread.positions),
        "only": _whom(obstacle),
        "handles": _handles(obstacle, path, content, rounding),
    }
    if obstacle.dimension == 2:
        rings, is_open, outlines = _rings(obstacle)
        view["kind"] = "line" if is_open else "polygon"
        view["rings"] = [rounding.points(ring) for ring in rings]
    else:
        corners, triangles, outlines = _solid(obstacle)
        view["corners"], view["triangles"] = rounding.points(corners), triangles
    if outlines is not None:
        view["moving"] = [rounding.points(outline - outlines[0]) for outline in outlines]
    return view


def _whom(obstacle: Obstacle) -> str | None:
    """Return whom an obstacle concerns, in words; None where everybody."""
    concerns = obstacle.concerns
    if concerns is None:
        return None
    names = ", ".join(concerns.names[:_MOST_NAMES])
    if len(concerns.names) > _MOST_NAMES:
        names += f" and {len(concerns.names) - _MOST_NAMES} more"
    return f"{'not for' if concerns.are_exempt else 'for'} {names}"


def _rings(obstacle: Obstacle) -> tuple[list[Matrix], bool, list[Matrix] | None]:
    """Return outlines at step 0, whether they have no inside, and outlines at all steps."""
    shape = obstacle.shape
    if isinstance(shape, LineShape):
        return [shape.points], True, None
    is_open = all(len(piece.vertices) < 3 for piece in obstacle.steps[0])
    if isinstance(shape, PolygonShape):
        return [shape.vertices, *shape.holes], is_open, None
    outlines = _outlines(obstacle)
    return [outlines[0]], is_open, outlines if obstacle.is_moving else None


def _outlines(obstacle: Obstacle) -> list[Matrix]:
    """Return the hull of one piece at every step, with the same corners at each."""
    hulls = [pieces[0].vertices for pieces in obstacle.steps]
    if isinstance(obstacle.shape, TrackShape):
        # It does not turn: its corners come in the same order wherever it is.
        start = obstacle.shape.start[: obstacle.dimension]
        places = obstacle.shape.outlines(obstacle.dt or 0.0, len(hulls) - 1)
        moves = [place[0] - obstacle.shape.outline[0] - start for place in places]
        return [hulls[0] + move for move in moves]
    if len(hulls) == 1:
        return hulls
    angles = np.arange(_TURNS) * (2.0 * np.pi / _TURNS)
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    if len({len(hull) for hull in hulls}) == 1 and _turns_little(hulls):
        return hulls
    return [hull[(directions @ hull.T).argmax(axis=1)] for hull in hulls]


def _turns_little(hulls: list[Matrix]) -> bool:
    """Whether corners of the same number are the same corners, seen from the middle."""
    first = hulls[0] - hulls[0].mean(axis=0)
    largest = float(np.abs(first).max())
    return all(
        np.abs((hull - hull.mean(axis=0)) - first).max() <= 0.5 * largest for hull in hulls[1:]
    )


def _solid(obstacle: Obstacle) -> tuple[Matrix, list[list[int]], list[Matrix] | None]:
    """Return corners, triangles, and corners at all steps of what stands in space."""
    corners: list[Matrix] = []
    triangles: list[list[int]] = []
    for piece in obstacle.steps[0]:
        faces = surface(piece.vertices)
        first = sum(len(part) for part in corners)
        corners.append(piece.vertices)
        for face in faces:
            apart = np.abs(piece.vertices[:, None] - face[None]).sum(axis=2)
            triangles.append([first + int(i) for i in apart.argmin(axis=0)])
    whole = np.vstack(corners)
    if not obstacle.is_moving:
        return whole, triangles, None
    if isinstance(obstacle.shape, TrackShape):
        return whole, triangles, _outlines(obstacle)
    same = all(len(pieces[0].vertices) == len(whole) for pieces in obstacle.steps)
    if same:
        return whole, triangles, [pieces[0].vertices for pieces in obstacle.steps]
    middle = whole.mean(axis=0)
    moves = [pieces[0].vertices.mean(axis=0) - middle for pieces in obstacle.steps]
    return whole, triangles, [whole + move for move in moves]


def _handles(obstacle: Obstacle, path: Path, content: Content, rounding: Rounding) -> list[Handle]:
    """Return what of an obstacle can be dragged, by how the document describes it."""
    shape = obstacle.shape
    if isinstance(shape, PolygonShape):
        places: list[Path] = [[*path, "vertices", j] for j in range(len(shape.vertices))]
        points = [shape.vertices]
        for h, hole in enumerate(shape.holes):
            places += [[*path, "holes", h, j] for j in range(len(hole))]
            points.append(hole)
        return corner_handles(content, np.vstack(points), places, rounding)
    if isinstance(shape, LineShape):
        along: list[Path] = [[*path, "line", j] for j in range(len(shape.points))]
        return corner_handles(content, shape.points, along, rounding)
    if isinstance(shape, BoxShape):
        return box_handles(content, shape.lower, shape.upper, path, rounding)
    if isinstance(shape, TrackShape):
        return _track_handles(shape, path, content, rounding)
    if isinstance(shape, MovingShape):
        return _moving_handles(shape, path, content, rounding)
    has_corners = isinstance(shape, HalfspaceShape) and obstacle.dimension == 2
    return _face_handles(obstacle.steps[0][0].vertices, path, rounding) if has_corners else []


def _face_handles(corners: Matrix, path: Path, rounding: Rounding) -> list[Handle]:
    """Return the corners of what is described by half-spaces.

    No number of the document is theirs: whoever moves one puts ``vertices`` in place of the
    half-spaces, and their paths are those that they have then.
    """
    places: list[Path] = [[*path, "vertices", j] for j in range(len(corners))]
    entry = {"vertices": corners.tolist()}
    then = {"obstacles": [*([None] * int(path[1])), entry]}
    return corner_handles(then, corners, places, rounding)


def _track_handles(
    shape: TrackShape, path: Path, content: Content, rounding: Rounding
) -> list[Handle]:
    """Return the place where a track begins, then the corners of its outline."""
    place = shape.start[: shape.dimension]
    corners: list[Path] = [[*path, "moving", "outline", j] for j in range(len(shape.outline))]
    stated = [key for key in ("start", "position") if value_at(content, [*path, "moving", key])]
    # A velocity alone: the outline stands where the obstacle is.
    vectors = [[*path, "moving", stated[0]]] if stated else corners
    whole = handle_of(content, place + shape.outline.mean(axis=0), vectors, rounding)
    ones = corner_handles(content, shape.outline + place, corners, rounding)[1:]
    return [] if whole is None else [whole, *ones]


def _moving_handles(
    shape: MovingShape, path: Path, content: Content, rounding: Rounding
) -> list[Handle]:
    """Return a whole motion, then its corners where all outlines have as many."""
    steps = range(len(shape.outlines))
    places: list[Path] = [
        [*path, "moving", k, j] for k in steps for j in range(len(shape.outlines[k]))
    ]
    first = shape.outlines[0]
    whole = handle_of(content, first.mean(axis=0), places, rounding)
    if whole is None:
        return []
    if any(len(outline) != len(first) for outline in shape.outlines):
        return [whole]
    ones = [
        handle_of(content, first[j], [[*path, "moving", k, j] for k in steps], rounding)
        for j in range(len(first))
    ]
    return [whole, *(one for one in ones if one is not None)]
