"""Directions in space, parted into patches, all around a point."""

from __future__ import annotations

from functools import cache

import numpy as np

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.records import dataclass

__all__ = ["Patches", "Splitting", "around_point"]


@dataclass(frozen=True, slots=True, eq=False)
class Patches:
    """Patches that together hold every direction: spherical triangles, arcs and single directions.

    Attributes
    ----------
    directions : (k, 3) array
        Unit vectors.
    corners : (p, c) int array
        The directions at the corners of each patch, the last repeated where there are fewer.
    supports : (p, 3) array
        A point of the hazard that is as far along the patch's axis as any that is farthest along
        one of its directions [m].
    parents : (p,) int array
        The wider patch that each is part of, which comes later; -1 where there is none.
    axes : (p,) int array or None
        The direction of each patch's half-space; None for the mean of its corners.
    is_even : bool
        Whether directions are of the metric in which the noise is the same all around.
    """

    directions: Matrix
    corners: Indices
    supports: Matrix
    parents: Indices
    axes: Indices | None
    is_even: bool


@cache
def around_point(levels: int) -> Patches:
    """Return the eight octants, each parted into four patches, and so on.

    Parameters
    ----------
    levels : int
        How often they are parted.
    """
    split = Splitting([np.array(v) for v in (*np.eye(3), *-np.eye(3))])
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
        axes=None,
        is_even=True,
    )


class Splitting:
    """Directions, and those in the middle of others, each made once.

    Parameters
    ----------
    directions : list of (3,) array
        Unit vectors to begin with; others are appended.
    """

    def __init__(self, directions: list[Vector]) -> None:
        self.directions = directions
        self._middles: dict[tuple[int, ...], int] = {}

    def middle(self, *some: int) -> int:
        """Return the number of the direction in the middle of several.

        Parameters
        ----------
        *some : int
            Their numbers.
        """
        key = tuple(sorted(some))
        if key not in self._middles:
            between = np.sum([self.directions[i] for i in some], axis=0)
            self._middles[key] = len(self.directions)
            self.directions.append(between / np.linalg.norm(between))
        return self._middles[key]

    def triangle(self, corners: tuple[int, int, int]) -> list[tuple[int, int, int]]:
        """Return the four triangles that one is made of.

        Parameters
        ----------
        corners : tuple of int
            The directions at its corners.
        """
        a, b, c = corners
        ab, bc, ca = self.middle(a, b), self.middle(b, c), self.middle(c, a)
        return [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
