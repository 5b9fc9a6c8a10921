"""Directions in space, parted into patches around a polytope: wide ones, made of narrow ones."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import combinations, pairwise

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix
from radmpc.geometry import Polytope
from radmpc.program.relaxed.patches import Patches, Splitting
from radmpc.records import dataclass

__all__ = ["around_polytope"]

_NARROW = 0.8
"""Cosine of the angle between the axis of a patch and its corners from which on it is made of no
others [-]: 37 degrees, at corners of boxes it is 28. Made of narrower ones these take four times
the rows, and leave 0.5, 0.2 and 6 % where 0.5, 1.1 and 7 % are left past one and two boxes."""

_TOUCHES = 1e-9
"""Distance up to which a corner lies on a face, by the size of the coordinates [-]."""


def around_polytope(polytope: Polytope) -> Patches | None:
    """Return a wide patch per face, and those that it is made of.

    These are the normal of the face, at each of its edges half the arc to the next normal, and at
    each corner a share of what lies between. All of them are supported by the face, so that the
    level surface there lies beyond one half-space along the normal.

    Parameters
    ----------
    polytope : Polytope
        A body or a plate.

    Returns
    -------
    Patches or None
        None for what has no face: segments and points.
    """
    normals, vertices = polytope.normals, polytope.vertices
    scale = _TOUCHES * (1.0 + float(np.abs(vertices).max()))
    if np.linalg.matrix_rank(vertices - vertices[0], tol=scale) < 2:
        return None
    is_on = np.abs(vertices @ normals.T - polytope.offsets) <= scale
    layout = _layout_of(normals.tobytes(), is_on.tobytes(), len(vertices))
    return Patches(
        layout.directions,
        layout.corners,
        vertices[layout.supports],
        layout.parents,
        axes=layout.axes,
        is_even=False,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Layout:
    """The patches of all polytopes with the same normals that meet at the same vertices.

    As in `Patches`, but for the numbers of the vertices that support each.
    """

    directions: Matrix
    corners: Indices
    supports: Indices
    parents: Indices
    axes: Indices


@lru_cache(maxsize=64)
def _layout_of(normals: bytes, is_on: bytes, num_vertices: int) -> _Layout:
    """Return the layout of a polytope; there are few, and many boxes."""
    faces = np.frombuffer(normals).reshape(-1, 3)
    on = np.frombuffer(is_on, dtype=bool).reshape(num_vertices, -1)
    split = Splitting(list(faces))
    at_corners = [*_at_edges(faces, on, split), *_at_vertices(faces, on, split)]
    wide = []
    for face in range(len(faces)):
        support = int(on[:, face].argmax())
        mine = [(c, vertex) for c, vertex in at_corners if c[0] == face]
        parts = [_Patch((face,), face, support), *(_parted(split, *one) for one in mine)]
        corners = tuple(sorted({i for part in parts for i in part.corners}))
        wide.append(_Patch(corners, face, support, parts))
    return _laid_out(wide, np.array(split.directions))


@dataclass(frozen=True, slots=True, eq=False)
class _Patch:
    """Directions between some, the one along its half-space, a vertex, and what it is made of."""

    corners: tuple[int, ...]
    axis: int
    vertex: int
    parts: Sequence[_Patch] = ()


def _laid_out(wide: Sequence[_Patch], directions: Matrix) -> _Layout:
    """Return patches and all that they are made of, narrow ones first."""
    layers: list[list[tuple[_Patch, int]]] = [[(patch, -1) for patch in wide]]
    while layers[-1]:
        above = enumerate(layers[-1], start=sum(map(len, layers[:-1])))
        layers.append([(part, i) for i, (patch, _) in above for part in patch.parts])
    found = [one for layer in layers for one in layer][::-1]
    most, last = max(len(patch.corners) for patch, _ in found), len(found) - 1
    return _Layout(
        directions,
        np.array([p.corners + p.corners[-1:] * (most - len(p.corners)) for p, _ in found]),
        np.array([patch.vertex for patch, _ in found]),
        np.array([-1 if outer < 0 else last - outer for _, outer in found]),
        np.array([patch.axis for patch, _ in found]),
    )


def _parted(split: Splitting, corners: tuple[int, ...], vertex: int) -> _Patch:
    """Return an arc, made of its halves if it is wide, or a triangle, made of its quarters."""
    axis, finer = split.middle(*corners), list[tuple[int, ...]]()
    if min(split.directions[axis] @ split.directions[i] for i in corners) < _NARROW:
        if len(corners) == 2:
            finer = [(corners[0], axis), (axis, corners[1])]
        else:
            a, b, c = corners
            finer = [*split.triangle((a, b, c))]
    return _Patch(corners, axis, vertex, [_parted(split, each, vertex) for each in finer])


def _at_edges(
    normals: Matrix, is_on: npt.NDArray[np.bool_], split: Splitting
) -> Iterator[tuple[tuple[int, ...], int]]:
    """Yield half arcs from one normal toward the next one at an edge, and an end of the edge."""
    for one, two in combinations(range(len(is_on)), 2):
        faces = np.flatnonzero(is_on[one] & is_on[two])
        # Both sides of a plate meet nowhere but at its edges.
        if faces.size < 2 or np.abs(np.cross(normals[faces[0]], normals[faces])).max() <= _TOUCHES:
            continue
        for i, j in pairwise(_across(normals, faces)):
            middle = split.middle(i, j)
            yield (i, middle), one
            yield (j, middle), one


def _at_vertices(
    normals: Matrix, is_on: npt.NDArray[np.bool_], split: Splitting
) -> Iterator[tuple[tuple[int, ...], int]]:
    """Yield triangles with a normal at their first corner, which together lie between them all."""
    for vertex, faces in enumerate(is_on):
        around = _in_turn(normals, np.flatnonzero(faces))
        for second, third in pairwise(around[1:]):
            a, b, c = around[0], second, third
            center = split.middle(a, b, c)
            for i, j in ((a, b), (b, c), (c, a)):
                yield (i, split.middle(i, j), center), vertex
                yield (j, split.middle(i, j), center), vertex


def _across(normals: Matrix, faces: Indices) -> list[int]:
    """Return the faces at an edge from one side of it to the other."""
    mean = normals[faces].mean(axis=0)
    turn = np.cross(normals[faces], mean)
    signs = np.sign(turn @ turn[np.abs(turn).sum(axis=1).argmax()])
    angles = signs * np.arccos(np.clip(normals[faces] @ mean / np.linalg.norm(mean), -1.0, 1.0))
    return [int(face) for face in faces[angles.argsort()]]


def _in_turn(normals: Matrix, faces: Indices) -> list[int]:
    """Return the faces at a corner in turn, from the one that is farthest from no other."""
    mean = normals[faces].mean(axis=0)
    first = normals[faces[0]] - mean * (normals[faces[0]] @ mean) / (mean @ mean)
    second = np.cross(mean, first)
    angles = np.arctan2(normals[faces] @ second / np.linalg.norm(mean), normals[faces] @ first)
    around = faces[angles.argsort()]
    begin = (normals[around] @ normals[around].T).min(axis=1).argmax()
    return [int(face) for face in np.roll(around, -begin)]
