"""Boxes that hold a mean, and the convex pieces of obstacles near them."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from itertools import product

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.geometry import Polytope
from radmpc.model.scenario import Scenario

__all__ = ["Box", "Shapes"]


@dataclass(frozen=True, slots=True, eq=False)
class Box:
    """Where a mean may be, and how it scatters."""

    lower: Vector
    upper: Vector
    covariance: Matrix

    def corners(self, cells: int) -> Matrix:
        """Return the corners of its cells, ((cells+1)^d, d), the last axis fastest."""
        axes = [np.linspace(a, b, cells + 1) for a, b in zip(self.lower, self.upper, strict=True)]
        return np.array(list(product(*axes)))

    @property
    def spread(self) -> float:
        """The largest standard deviation along any direction [m]."""
        return float(np.sqrt(max(np.linalg.eigvalsh(self.covariance)[-1], 0.0)))


@dataclass(frozen=True, slots=True, eq=False)
class Shapes:
    """The convex pieces of all obstacles at a step, with the boxes around them."""

    owners: tuple[str, ...]
    pieces: tuple[Polytope, ...]
    lower: Matrix
    upper: Matrix

    @classmethod
    def of(cls, scenario: Scenario, step: int) -> Shapes:
        """Collect them."""
        found = [(o.name, piece) for o in scenario.obstacles for piece in o.at(step)]
        d = scenario.dimension
        lower = np.array([piece.vertices.min(axis=0) for _, piece in found]).reshape(-1, d)
        upper = np.array([piece.vertices.max(axis=0) for _, piece in found]).reshape(-1, d)
        return cls(tuple(n for n, _ in found), tuple(p for _, p in found), lower, upper)

    def near(self, box: Box, radius: float, far: float) -> dict[str, list[Polytope]]:
        """Return the pieces from which anything is to be feared in a box, by obstacle."""
        reach = radius + far * box.spread + 1e-6
        gaps = np.maximum(np.maximum(self.lower - box.upper, box.lower - self.upper), 0.0)
        close = np.linalg.norm(gaps, axis=1) < reach
        if np.count_nonzero(close) == 1:
            # What can be kept away from by itself is nothing; several may leave no place for it.
            corners = box.corners(1)[:, None]
            gaps = np.maximum(np.maximum(self.lower - corners, corners - self.upper), 0.0)
            close &= np.linalg.norm(gaps, axis=2).max(axis=0) < reach
        found: dict[str, list[Polytope]] = defaultdict(list)
        for k in np.flatnonzero(close).tolist():
            found[self.owners[k]].append(self.pieces[k])
        return found
