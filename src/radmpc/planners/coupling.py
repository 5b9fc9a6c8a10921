"""Who must be planned together (paper, section Identifying Couplings)."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from radmpc.arrays import Matrix, Vector
from radmpc.gaussian import tail_probability

__all__ = ["connected_sets", "face_risk"]


def face_risk(
    faces: tuple[Matrix, Vector], radius: float, position: Vector, covariance: Matrix
) -> float:
    """Return the collision probability of the active face: the one with the least risk.

    Parameters
    ----------
    faces : (f, d) and (f,) array
        Normals and offsets of a temporal obstacle at one step.
    radius : float
        Radius of the vehicle that avoids it [m].
    position : (d,) array
        Its mean position [m].
    covariance : (d, d) array
        Its position covariance [m²].

    Returns
    -------
    float
        ``Pr[h·x > g]`` of that face.
    """
    normals, offsets = faces
    slack = normals @ position - offsets - radius
    variances = np.einsum("fa,ab,fb->f", normals, covariance, normals)
    deviations = np.sqrt(np.maximum(variances, 0.0))
    noisy = deviations > 0.0
    certain = np.where(slack >= 0.0, np.inf, -np.inf)
    clearances = np.where(noisy, slack / np.where(noisy, deviations, 1.0), certain)
    return float(tail_probability(clearances.max()))


def connected_sets(
    pair_risk: Matrix, threshold: float, forced: Iterable[tuple[int, int]] = ()
) -> tuple[tuple[int, ...], ...]:
    """Return the connected components of the coupling graph.

    Parameters
    ----------
    pair_risk : (N, N) array
        Largest collision probability found, either way round.
    threshold : float
        Ψ: an edge where it is exceeded.
    forced : iterable of (int, int)
        Edges in any case.

    Returns
    -------
    tuple of tuple of int
        Sets of vehicles, each ascending, ordered by their first vehicle.
    """
    edges = np.maximum(pair_risk, pair_risk.T) > threshold
    for i, j in forced:
        edges[i, j] = True
    count, labels = connected_components(coo_array(edges), directed=False)
    sets = [tuple(int(i) for i in np.flatnonzero(labels == c)) for c in range(count)]
    return tuple(sorted(sets))
