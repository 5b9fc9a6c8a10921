"""Which vehicles must be planned together (paper, section Identifying Couplings)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.gaussian import GAUSSIAN, Tail, clearance
from radmpc.model.plan import Coupling
from radmpc.model.scenario import Scenario
from radmpc.planners.components import components

__all__ = ["connected_sets", "couplings_of", "face_risk", "share_couplings"]

Place = tuple[Vector, Matrix]


_ROUNDS = 40
"""Halvings of the share of the reserve: to 1e-12 of it."""


def face_risk(
    faces: tuple[Matrix, Vector],
    radius: float,
    near: Sequence[Place],
    far: Place | None = None,
    sagitta: Vector | None = None,
    tail: Tail = GAUSSIAN,
) -> float:
    """Return the collision probability of the active face: the one with the least risk.

    Along an interval one face is held from end to end, with the reserve for the curve between
    shared as suits it best (`radmpc.program.reserve`).

    Parameters
    ----------
    faces : (f, d) and (f,) array
        Normals and offsets of a temporal obstacle at one step.
    radius : float
        Radius of the vehicle that avoids it [m].
    near : sequence of ((d,) array, (d, d) array)
        Its mean position [m] and position covariance [m²] at a step; along an interval at its
        beginning, also as feedback bends it.
    far : ((d,) array, (d, d) array) or None
        The same at the interval's end; None where a step alone counts.
    sagitta : (d,) array or None
        How far its path is from the chord at the middle of the interval, chord minus path [m];
        None where it is straight.
    tail : Tail
        Of what positions deviate by.

    Returns
    -------
    float
        ``Pr[h·x > g]`` of that face, at the end where it is larger.
    """
    before = [_margins(faces, radius, place) for place in near]
    if far is None:
        return float(tail.probability(_held(before, 0.0).max()))
    after = [_margins(faces, radius, far)]
    height = np.zeros(len(faces[1]))
    if sagitta is not None:
        height = np.maximum(faces[0] @ sagitta, 0.0)
    low, high = np.zeros(height.size), np.ones(height.size)
    best = np.full(height.size, -np.inf)
    # The near end has less left the more of the reserve it keeps, the far end more.
    for _ in range(_ROUNDS):
        share = 0.5 * (low + high)
        ends = (
            _held(before, 4.0 * height * share**2),
            _held(after, 4.0 * height * (1.0 - share) ** 2),
        )
        best = np.maximum(best, np.minimum(*ends))
        has_spare = ends[0] > ends[1]
        low, high = np.where(has_spare, share, low), np.where(has_spare, high, share)
    return float(tail.probability(best.max()))


def _margins(faces: tuple[Matrix, Vector], radius: float, place: Place) -> tuple[Vector, Vector]:
    """Return what a place keeps clear of each face and the deviation there [m]."""
    normals, offsets = faces
    mean, covariance = place
    variances = np.einsum("fa,ab,fb->f", normals, covariance, normals)
    return normals @ mean - offsets - radius, np.sqrt(np.maximum(variances, 0.0))


def _held(places: Sequence[tuple[Vector, Vector]], reserve: Vector | float) -> Vector:
    """Return the least clearance of some places, a reserve kept, in standard deviations."""
    return np.asarray(
        np.minimum.reduce([clearance(margins - reserve, spread) for margins, spread in places])
    )


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
    return components(len(edges), [*((int(i), int(j)) for i, j in np.argwhere(edges)), *forced])


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
        As in `connected_sets`.

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
