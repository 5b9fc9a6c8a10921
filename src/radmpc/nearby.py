"""Pairs of points near each other; few of them without a tree, which takes long to load."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector, distinct

__all__ = ["near_pairs", "near_pairs_ever"]

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
        return _near_of_all(points[:, None], np.array([distance]))
    from scipy.spatial import cKDTree  # noqa: PLC0415 - loads slowly; short lists do without

    found = cKDTree(points).query_pairs(distance, output_type="ndarray").astype(np.int64)
    return np.asarray(found[np.lexsort((found[:, 1], found[:, 0]))])


def near_pairs_ever(paths: Tensor, distances: Vector) -> Indices:
    """Return the pairs of moving points that are at most a distance apart at any step.

    Parameters
    ----------
    paths : (N, T, d) array
        Any number of them [m].
    distances : (T,) array
        The distance at each step [m].

    Returns
    -------
    (P, 2) int array
        As in `near_pairs`.
    """
    count = len(paths)
    if count <= _FEW:
        return _near_of_all(paths, distances)
    each = [near_pairs(paths[:, k], float(d)) for k, d in enumerate(distances)]
    pairs = np.concatenate(each)
    return np.column_stack(np.divmod(distinct(pairs[:, 0] * count + pairs[:, 1]), count))


def _near_of_all(paths: Tensor, distances: Vector) -> Indices:
    """Return the same by all distances."""
    one, two = np.triu_indices(len(paths), 1)
    apart = np.linalg.norm(paths[one] - paths[two], axis=2)
    is_near = np.any(apart <= distances, axis=1)
    return np.column_stack([one[is_near], two[is_near]])
