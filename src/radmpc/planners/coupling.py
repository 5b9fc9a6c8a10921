"""Who must be planned together (paper, section Identifying Couplings)."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from radmpc.arrays import Matrix, Vector
from radmpc.gaussian import tail_probability
from radmpc.model.plan import Coupling
from radmpc.model.scenario import Scenario

__all__ = ["connected_sets", "couplings_of", "face_risk", "share_couplings"]


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


def couplings_of(
    scenario: Scenario,
    pair_risk: Matrix,
    threshold: float,
    forced: Iterable[tuple[int, int]],
) -> tuple[Coupling, ...]:
    """Return the edges of the coupling graph, each with its reason.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    pair_risk, threshold, forced
        As of `connected_sets`.

    Returns
    -------
    tuple of Coupling
        Ordered by vehicles; what both exceeds Ψ and was blocked counts as the former.
    """
    names = [vehicle.name for vehicle in scenario.vehicles]
    largest = np.maximum(pair_risk, pair_risk.T)
    risky = [(int(i), int(j)) for i, j in np.argwhere(np.triu(largest > threshold, k=1))]
    blocked = {(min(pair), max(pair)) for pair in forced} - set(risky)
    edges = {(i, j): Coupling(names[i], names[j], "risk", float(largest[i, j])) for i, j in risky}
    edges |= {(i, j): Coupling(names[i], names[j], "blocked") for i, j in blocked}
    return tuple(edges[pair] for pair in sorted(edges))


def share_couplings(scenario: Scenario, sets: tuple[tuple[int, ...], ...]) -> tuple[Coupling, ...]:
    """Return edges that join sets because their shares of Δ were too small apart.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    sets : tuple of tuple of int
        A partition of it.

    Returns
    -------
    tuple of Coupling
        From each set's first vehicle to the next set's.
    """
    firsts = [scenario.vehicles[members[0]].name for members in sets]
    return tuple(Coupling(one, two, "share") for one, two in pairwise(firsts))
