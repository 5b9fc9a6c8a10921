"""Pairs of points near each other; few of them without a tree, which takes long to load."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Matrix

__all__ = ["near_pairs"]

_FEW = 64
"""Points up to which all distances are computed: as quick as a tree from some 50 points down, and
scipy's trees take a tenth of a second to load."""


def near_pairs(points: Matrix, distance: float) -> Indices:
    """Return the pairs of points that are at most a distance apart.

    Parameters
    ----------
    points : (N, d) array
        Any number of them [m].
    distance : float
        The distance; at itself rounding decides [m].

    Returns
    -------
    (P, 2) int array
        First below second, in ascending order.
    """
    if len(points) <= _FEW:
        one, two = np.triu_indices(len(points), 1)
        is_near = np.linalg.norm(points[one] - points[two], axis=1) <= distance
        return np.column_stack([one[is_near], two[is_near]])
    from scipy.spatial import cKDTree  # noqa: PLC0415 - see the first line

    found = cKDTree(points).query_pairs(distance, output_type="ndarray").astype(np.int64)
    return np.asarray(found[np.lexsort((found[:, 1], found[:, 0]))])
