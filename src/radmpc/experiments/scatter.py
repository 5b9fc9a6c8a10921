"""Points at random that keep their distance."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from itertools import product

import numpy as np
import shapely

from radmpc.arrays import Matrix, Vector
from radmpc.errors import ScenarioError
from radmpc.records import dataclass

__all__ = ["Arena"]


def _anywhere(number: int, point: Vector) -> bool:
    """Accept every point."""
    del number, point
    return True


@dataclass(frozen=True, slots=True, eq=False)
class Arena:
    """A box to draw points in.

    Attributes
    ----------
    lower, upper : (d,) array
        Corners [m].
    outlines : tuple of Polygon
        Shapes to stay clear of; in the plane only.
    clearance : float
        By how much [m].
    apart : float
        Least distance between points [m].
    around : tuple of (N, d) array and float, or None
        Draw point i within this distance per axis of the i-th of these points.
    draws_each : int
        Draws of one point before it is given up [-].
    """

    lower: Vector
    upper: Vector
    outlines: tuple[shapely.Polygon, ...] = ()
    clearance: float = 0.0
    apart: float = 0.0
    around: tuple[Matrix, float] | None = None
    draws_each: int = 20_000

    def scatter(
        self,
        rng: np.random.Generator,
        count: int,
        accept: Callable[[int, Vector], bool] = _anywhere,
    ) -> Matrix:
        """Draw points one by one, each until it fits.

        Parameters
        ----------
        rng : Generator
            Source of the draws.
        count : int
            Number of points.
        accept : callable
            Further condition on the i-th point.

        Returns
        -------
        (count, d) array
            The points [m].

        Raises
        ------
        ScenarioError
            If some point finds no place.
        """
        tree = shapely.STRtree(self.outlines)
        points = np.empty((count, self.lower.size))
        taken: dict[tuple[int, ...], list[int]] = defaultdict(list)
        for i in range(count):
            for _ in range(self.draws_each):
                point = self._draw(rng, i)
                if accept(i, point) and self._is_free(point, points, taken, tree):
                    break
            else:
                raise ScenarioError(f"no room for {count} points {self.apart:g} m apart")
            points[i] = point
            taken[self._cell(point)].append(i)
        return points

    def _draw(self, rng: np.random.Generator, number: int) -> Vector:
        """Draw one point."""
        low, high = self.lower, self.upper
        if self.around is not None:
            center, reach = self.around[0][number], self.around[1]
            low, high = np.maximum(low, center - reach), np.minimum(high, center + reach)
        return rng.uniform(low, high)

    def _cell(self, point: Vector) -> tuple[int, ...]:
        """Return the cell of a grid as wide as points are apart."""
        width = max(self.apart, 1e-9)
        return tuple(int(place // width) for place in point)

    def _is_free(
        self,
        point: Vector,
        points: Matrix,
        taken: dict[tuple[int, ...], list[int]],
        tree: shapely.STRtree,
    ) -> bool:
        """Whether a point keeps its distance from points and shapes."""
        cells = product(*((c - 1, c, c + 1) for c in self._cell(point)))
        near = [i for cell in cells for i in taken.get(cell, ())]
        if near and np.linalg.norm(points[near] - point, axis=1).min() < self.apart:
            return False
        if not self.outlines:
            return True
        spot = shapely.Point(point)
        return bool(tree.query(spot, "dwithin", distance=self.clearance).size == 0)
