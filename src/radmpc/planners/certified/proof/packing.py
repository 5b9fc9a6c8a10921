"""What bounds of sets that share vehicles prove together: fractional packings.

Let ``gain(S)`` be what the vehicles of a set S cost more together than what is proven of each of
them alone. Weights y(S) >= 0 with which no vehicle counts more than once prove that a fleet costs
Σ y(S) gain(S) more than that: risks between two vehicles are counted at most once as well. The
best weights are a linear program with a row per vehicle.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import combinations
from math import comb

import numpy as np
from scipy.sparse import csr_array

from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.proof.tuning import TUNING
from radmpc.solvers.lp.choosing import bounded_lp
from radmpc.solvers.lp.outcome import LpOutcome

__all__ = ["expected_gains", "gains_of", "packed"]

_TRIPLE = 3
"""Vehicles of the sets that larger ones are judged by [-]."""

_ROUNDING = 1e-12
"""Relative excess by which a sum of rounded weights may miss what it is a sum of [-]."""


def gains_of(
    bounds: Mapping[Members, float], base: Mapping[int, float]
) -> tuple[float, dict[Members, float]]:
    """Return what vehicles cost alone at least, and what sets cost more together than that.

    Parameters
    ----------
    bounds : mapping of tuple of int to float
        What is proven of sets.
    base : mapping of int to float
        What each vehicle costs at least in empty space.

    Returns
    -------
    (float, dict of tuple of int to float)
        The sum over all vehicles; and of the sets of two and more those that gain anything.
    """
    alone = {i: max(bounds.get((i,), least), least) for i, least in base.items()}
    gains = {m: bound - sum(alone[i] for i in m) for m, bound in bounds.items() if len(m) > 1}
    return sum(alone.values()), {members: gain for members, gain in gains.items() if gain > 0.0}


def packed(gains: Mapping[Members, float]) -> tuple[float, tuple[Members, ...]]:
    """Return the most that gains add up to, and of which sets that is made.

    Parameters
    ----------
    gains : mapping of tuple of int to float
        Of sets, proven or expected.

    Returns
    -------
    (float, tuple of tuple of int)
        A sum that is proven where its gains are, whatever the linear program says.
    """
    if not gains:
        return 0.0, ()
    sets, values = list(gains), np.array(list(gains.values()))
    if values.max() == np.inf:
        # A vehicle without a plan at any price has none together with others either.
        return float("inf"), (sets[int(values.argmax())],)
    place = {i: row for row, i in enumerate(sorted({i for members in sets for i in members}))}
    counted = np.zeros((len(place), len(sets)))
    for column, members in enumerate(sets):
        counted[[place[i] for i in members], column] = 1.0
    lp = bounded_lp(-values / values.max(), np.zeros(len(sets)), np.ones(len(sets)))
    lp.add_rows(csr_array(counted), np.full(len(place), -np.inf), np.ones(len(place)))
    if lp.solve()[0] is not LpOutcome.OPTIMAL:
        return float(values.max()), (sets[int(values.argmax())],)
    weights = np.maximum(lp.point(), 0.0)
    # No vehicle counts more than once, whatever tolerances the solver has.
    weights /= max(1.0, float((counted @ weights).max()) * (1.0 + _ROUNDING))
    chosen = np.flatnonzero(weights > TUNING.least_weight)
    return float(values @ weights), tuple(sets[int(k)] for k in chosen)


def expected_gains(
    gains: Mapping[Members, float], vehicles: Members, size: int
) -> dict[Members, float]:
    """Return what sets of a size that are not searched yet may gain.

    Of what its triples gain, each vehicle counted once, a set gains so many times: as many as those
    of its size that are searched do in the mean, or somewhat more than the next smaller ones
    suggest.

    Parameters
    ----------
    gains : mapping of tuple of int to float
        What is proven of sets.
    vehicles : tuple of int
        Those that sets are made of, ascending.
    size : int
        Vehicles of a set, three or more [-].

    Returns
    -------
    dict of tuple of int to float
        Of all sets of few vehicles; of more those that have one more than a set that gains.
    """
    by_triples = _ByTriples(gains)
    growth = _growth(gains, size, by_triples)
    chosen: Iterable[Members] = combinations(vehicles, size)
    if len(vehicles) > TUNING.most_together:
        grown = (
            {tuple(sorted((*members, i))) for i in vehicles if i not in members}
            for members in gains
            if len(members) == size - 1
        )
        chosen = sorted(set().union(*grown))
    return {m: growth * by_triples.gain(m) for m in chosen if m not in gains}


def _growth(gains: Mapping[Members, float], size: int, by_triples: _ByTriples) -> float:
    """Return how many times what its triples gain a set of a size gains [-]."""
    if size == _TRIPLE:
        return 1.0
    ratios = [
        gain / least
        for members, gain in gains.items()
        if len(members) == size and (least := by_triples.gain(members)) > 0.0
    ]
    if ratios:
        return max(sum(ratios) / len(ratios), 1.0)
    if size == _TRIPLE + 1:
        return TUNING.first_growth
    # Each vehicle more multiplies it by as much as those before, as far as they tell.
    before = _growth(gains, size - 1, by_triples)
    power = (size - _TRIPLE) / (size - 1 - _TRIPLE)
    return float(max(before, TUNING.first_growth) ** power)


class _ByTriples:
    """What sets gain by their triples, and those that are not searched by their pairs.

    Parameters
    ----------
    gains : mapping of tuple of int to float
        What is proven of sets.
    """

    def __init__(self, gains: Mapping[Members, float]) -> None:
        self._gains = gains
        self._pairs = TUNING.first_growth
        known = [m for m in gains if len(m) == _TRIPLE]
        pairs = sum(map(self._by_pairs, known))
        if pairs > 0.0:
            self._pairs = max(sum(gains[m] for m in known) / pairs, 1.0)

    def gain(self, members: Members) -> float:
        """Return what the triples of a set gain, each vehicle counted once."""
        total: float = sum(map(self._of_triple, combinations(members, _TRIPLE)))
        return total / comb(len(members) - 1, _TRIPLE - 1)

    def _of_triple(self, triple: Members) -> float:
        """Return what a triple gains, or what its pairs suggest."""
        gain = self._gains.get(triple)
        return self._pairs * self._by_pairs(triple) if gain is None else gain

    def _by_pairs(self, members: Members) -> float:
        """Return what the pairs of a triple gain, each vehicle counted once."""
        return 0.5 * sum(self._gains.get(pair, 0.0) for pair in combinations(members, 2))
