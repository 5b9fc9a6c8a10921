"""The grid of positions that a coarse path search goes over."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.program.condensed import CondensedModel
from radmpc.records import dataclass

__all__ = ["CoarseGrid", "coarse_grid"]

_CELLS_PER_STEP = 5
"""Cells to the longest displacement along each axis [-]."""

_MAX_CELLS = 6_000
"""Cells of a grid at most [-]: they grow until there are no more."""


@dataclass(frozen=True, slots=True, eq=False)
class CoarseGrid:
    """Positions a vehicle may be at.

    Attributes
    ----------
    points : (c, 2) array
        Cell centers [m], row by row.
    shape : (int, int)
        Cells per axis.
    reach : tuple of int
        Cells per axis that one step can cross.
    stride : (2,) array
        Size of a cell [m].
    """

    points: Matrix
    shape: tuple[int, int]
    reach: tuple[int, int]
    stride: Vector


def coarse_grid(model: CondensedModel) -> CoarseGrid:
    """Return a grid over the vehicle's reach, some cells to the longest step."""
    low, high = model.reach_lower.min(axis=0), model.reach_upper.max(axis=0)
    steps = np.maximum(
        np.diff(model.reach_upper, axis=0).max(axis=0),
        -np.diff(model.reach_lower, axis=0).min(axis=0),
    )
    stride = np.maximum(steps, 1e-6) / _CELLS_PER_STEP
    while np.prod(np.floor((high - low) / stride) + 1) > _MAX_CELLS:
        stride = stride * 1.25
    axes = [np.arange(a, b + s, s) for a, b, s in zip(low, high, stride, strict=True)]
    x, y = np.meshgrid(*axes, indexing="ij")
    # One cell more than a step covers: rounding to centers takes up to half a cell at each end.
    reach = np.floor(steps / stride + 1e-9).astype(int) + 1
    points = np.column_stack([x.ravel(), y.ravel()])
    return CoarseGrid(points, (len(axes[0]), len(axes[1])), (int(reach[0]), int(reach[1])), stride)
