"""Directions in space, parted into patches: around a point, and around a polytope."""

from __future__ import annotations

from functools import cache
from itertools import combinations, pairwise

import numpy as np

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.geometry import Polytope
from radmpc.records import dataclass

__all__ = ["Patches", "around_point", "around_polytope"]

_TOUCHES = 1e-9
"""Distance up to which a corner lies on a face, by the size of the coordinates [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Patches:
    """Patches that together hold every direction: spherical triangles, arcs and single directions.

    Attributes
    ----------
    directions : (k, 3) array
        Unit vectors.
    corners : (p, 3) int array
        The directions at the corners of each patch, repeated for arcs and single directions.
    supports : (p, 3) array
        The point of the hazard that is farthest along every direction of each patch [m]; along an
        arc, a point of the edge.
    parents : (p,) int array
        The wider patch that each is part of, which comes later; -1 where there is none.
    is_even : bool
        Whether directions are of the metric in which the noise is the same all around.
    """

    directions: Matrix
    corners: Indices
    supports: Matrix
    parents: Indices
    is_even: bool


@cache
def around_point(levels: int) -> Patches:
    """Return the eight octants, each parted into four patches, and so on.

    Parameters
    ----------
    levels : int
        How often they are parted.
    """
    split = _Splitting([np.array(v) for v in (*np.eye(3), *-np.eye(3))])
    layers = [[(x, y, z) for x in (0, 3) for y in (1, 4) for z in (2, 5)]]
    for _ in range(levels):
        layers.append([finer for triangle in layers[-1] for finer in split.triangle(triangle)])
    sizes = [len(one) for one in reversed(layers)]
    starts = np.cumsum([0, *sizes])
    parents = [start + np.arange(size) // 4 for start, size in zip(starts[1:], sizes, strict=True)]
    parents[-1] = np.full(sizes[-1], -1)
    corners = np.array([corner for one in reversed(layers) for corner in one])
    return Patches(
        np.array(split.directions),
        corners,
        np.zeros((len(corners), 3)),
        np.concatenate(parents),
        is_even=True,
    )


def around_polytope(polytope: Polytope) -> Patches | None:
    """Return the normals of faces, the arcs at edges, and what lies between at corners.

    Parameters
    ----------
    polytope : Polytope
        With inner points.

    Returns
    -------
    Patches or None
        None for what is flat: there, opposite faces meet at every corner.
    """
    normals, vertices = polytope.normals, polytope.vertices
    scale = _TOUCHES * (1.0 + float(np.abs(vertices).max()))
    is_on = np.abs(vertices @ normals.T - polytope.offsets) <= scale
    if np.any(is_on.all(axis=0)) or np.any(is_on.sum(axis=1) < 3):
        return None
    split = _Splitting(list(normals))
    found: list[tuple[tuple[int, int, int], int]] = []
    for face in range(len(normals)):
        found.append(((face, face, face), int(is_on[:, face].argmax())))
    for one, two in combinations(range(len(vertices)), 2):
        shared = np.flatnonzero(is_on[one] & is_on[two])
        if shared.size >= 2:
            pairs = combinations(shared.tolist(), 2)
            first, second = min(pairs, key=lambda p: float(normals[p[0]] @ normals[p[1]]))
            middle = split.middle(first, second)
            found += [((first, middle, middle), one), ((middle, second, second), one)]
    for vertex in range(len(vertices)):
        around = _in_turn(normals, np.flatnonzero(is_on[vertex]))
        for second, third in pairwise(around[1:]):
            whole = (around[0], second, third)
            found += [(finer, vertex) for finer in split.triangle(whole)]
    return Patches(
        np.array(split.directions),
        np.array([corners for corners, _ in found]),
        np.array([vertices[vertex] for _, vertex in found]),
        np.full(len(found), -1),
        is_even=False,
    )


class _Splitting:
    """Directions, and those halfway between two of them, each made once."""

    def __init__(self, directions: list[Vector]) -> None:
        self.directions = directions
        self._middles: dict[tuple[int, int], int] = {}

    def middle(self, i: int, j: int) -> int:
        """Return the number of the direction halfway between two."""
        key = (min(i, j), max(i, j))
        if key not in self._middles:
            between = self.directions[i] + self.directions[j]
            self._middles[key] = len(self.directions)
            self.directions.append(between / np.linalg.norm(between))
        return self._middles[key]

    def triangle(self, corners: tuple[int, int, int]) -> list[tuple[int, int, int]]:
        """Return the four triangles that one is made of."""
        a, b, c = corners
        ab, bc, ca = self.middle(a, b), self.middle(b, c), self.middle(c, a)
        return [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]


def _in_turn(normals: Matrix, faces: Indices) -> list[int]:
    """Return the faces at a corner in turn around their mean normal."""
    mean = normals[faces].mean(axis=0)
    first = normals[faces[0]] - mean * (normals[faces[0]] @ mean) / (mean @ mean)
    second = np.cross(mean, first)
    angles = np.arctan2(normals[faces] @ second / np.linalg.norm(mean), normals[faces] @ first)
    return [int(face) for face in faces[angles.argsort()]]
