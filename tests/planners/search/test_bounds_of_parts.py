"""What is proven of a part of a fleet that was not searched to the end."""

from __future__ import annotations

from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest

from radmpc.experiments.families import circle
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.proof.grouping import bound_together
from radmpc.planners.certified.proof.relaxed_set import RelaxedSet
from radmpc.planners.certified.proof.search import BoundSearch
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planning import plan
from radmpc.solvers.solution import Limits

BASE = (1.0, 2.0, 3.0, 4.0)
PRICE = 5.0


def proven(bounds: dict[tuple[int, ...], float], price: float = PRICE) -> dict:
    return {places: SimpleNamespace(bound=bound, price=price) for places, bound in bounds.items()}


def best_packing(bounds: dict[tuple[int, ...], float], left: frozenset[int]) -> float:
    """Return the most that bounds on vehicles which share none sum to, by trying all."""
    if not left:
        return 0.0
    first = min(left)
    found = [bounds.get((first,), BASE[first]) + best_packing(bounds, left - {first})]
    found += [
        bound + best_packing(bounds, left - set(places))
        for places, bound in bounds.items()
        if first in places and left.issuperset(places)
    ]
    return max(found)


@pytest.mark.parametrize("seed", range(20))
def test_what_is_proven_of_vehicles_that_share_none_adds_up(seed: int) -> None:
    rng = np.random.default_rng(seed)
    alone = {(i,): BASE[i] + rng.exponential() for i in range(4) if rng.random() < 0.7}
    least = [alone.get((i,), BASE[i]) for i in range(4)]
    pairs = {
        (i, j): least[i] + least[j] + rng.normal()
        for i, j in combinations(range(4), 2)
        if rng.random() < 0.7
    }
    whole = {(0, 1, 2, 3): sum(least) + rng.normal()} if seed % 2 else {}
    bounds = {**alone, **pairs, **whole}
    found = bound_together(proven(bounds), BASE, PRICE)
    gains = [0.0, *(bound - least[i] - least[j] for (i, j), bound in pairs.items())]
    assert found <= best_packing(bounds, frozenset(range(4))) + 1e-12
    assert found >= max([sum(least) + max(gains), *whole.values()]) - 1e-12


def test_what_is_proven_at_another_price_does_not_count() -> None:
    assert bound_together(proven({(0,): 9.0}, 2.0 * PRICE), BASE, PRICE) == sum(BASE)


def test_a_proof_that_is_stopped_keeps_what_it_has_proven_of_single_vehicles(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scenario = circle(4)
    result = plan(scenario)
    assert result.plan is not None
    controls = tuple(each.controls for each in result.plan.trajectories)
    incumbent = FleetIncumbent(controls, result.cost, ((0, 1, 2, 3),))
    built: list[int] = []
    of = RelaxedSet.of.__func__

    def counted(cls, scenario, models, *args):
        built.append(len(models))
        return of(cls, scenario, models, *args)

    monkeypatch.setattr(RelaxedSet, "of", classmethod(counted))
    fleet = Fleet.of(scenario, 1e-3, Limits(np.inf, lambda: len(built) > 5))
    search = BoundSearch(fleet, incumbent, result.record.risk.price, float(sum(fleet.base)), 1e4)
    search.run()
    # Everyone alone, then pairs; the whole, which is larger than all of them, is not even built.
    assert set(built) == {1, 2}
    assert float(sum(fleet.base)) < search.best <= result.cost
