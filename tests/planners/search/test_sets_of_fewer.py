"""Bounds of sets that share vehicles: what they prove together, and which are searched."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from radmpc.experiments.families import circle
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.proof import fewer, part, part_search
from radmpc.planners.certified.proof.packing import expected_gains, gains_of, packed
from radmpc.planners.certified.proof.search import BoundSearch
from radmpc.planners.certified.proof.tuning import TUNING
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planning import plan
from radmpc.records import replace
from radmpc.solvers.solution import Limits


def least_of_sets(costs: np.ndarray, most: int) -> dict[tuple[int, ...], float]:
    """Return what each set costs at least, where a fleet chooses a row of costs."""
    vehicles = range(costs.shape[1])
    return {
        members: float(costs[:, members].sum(axis=1).min())
        for size in range(1, most + 1)
        for members in combinations(vehicles, size)
    }


@pytest.mark.parametrize("seed", range(40))
def test_what_sets_prove_together_is_no_more_than_a_fleet_costs(seed: int) -> None:
    rng = np.random.default_rng(seed)
    costs = rng.exponential(size=(rng.integers(2, 9), 6))
    bounds = least_of_sets(costs, 4)
    kept = {m: bound for m, bound in bounds.items() if rng.random() < 0.7}
    total, gains = gains_of(kept, dict.fromkeys(range(6), 0.0))
    together, chosen = packed(gains)
    assert total + together <= costs.sum(axis=1).min() * (1.0 + 1e-9)
    # At least what the best of these sets proves with all others alone, to the solver's tolerance.
    assert together >= max(gains.values(), default=0.0) * (1.0 - 1e-6)
    assert set(chosen) <= set(gains)


def test_sets_that_share_vehicles_prove_more_than_those_that_share_none() -> None:
    gains = {(0, 1): 1.0, (1, 2): 1.0, (0, 2): 1.0}
    together, chosen = packed(gains)
    assert together == pytest.approx(1.5)
    assert set(chosen) == set(gains)


def test_who_has_no_plan_with_another_has_none_with_all() -> None:
    assert packed({(0, 1): float("inf"), (2, 3): 1.0})[0] == float("inf")
    assert packed({}) == (0.0, ())


def test_of_sets_that_are_not_searched_those_of_vehicles_that_gain_most_are_expected_to() -> None:
    gains = {(0, 1): 1.0, (1, 2): 1.0, (0, 2): 1.0, (3, 4): 0.1}
    expected = expected_gains(gains, tuple(range(5)), 3)
    assert max(expected, key=expected.__getitem__) == (0, 1, 2)
    gains |= expected
    larger = expected_gains(gains, tuple(range(5)), 4)
    assert {len(members) for members in larger} == {4}
    assert larger[0, 1, 2, 3] > larger[0, 1, 3, 4]


def test_of_many_vehicles_only_sets_with_one_more_than_one_that_gains_are_looked_at() -> None:
    many = tuple(range(TUNING.most_together + 4))
    expected = expected_gains({(0, 1): 1.0, (2, 3): 1.0}, many, 3)
    assert set(expected) == {
        tuple(sorted((*pair, i))) for pair in ((0, 1), (2, 3)) for i in many if i not in pair
    }


@pytest.fixture(scope="module")
def crossing() -> tuple[Fleet, FleetIncumbent, float]:
    """Five who meet in the middle, the best plan, and its price."""
    scenario = circle(5)
    result = plan(scenario)
    controls = tuple(each.controls for each in result.require().trajectories)
    together = (tuple(range(5)),)
    assert result.cost is not None
    incumbent = FleetIncumbent(controls, result.cost, together)
    return Fleet.of(scenario, 1e-3, Limits()), incumbent, float(result.record.risk.price)


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("is_by_faces", [True, False], ids=["by faces", "any"])
def test_sets_of_fewer_prove_no_more_than_all_together_cost(
    crossing: tuple[Fleet, FleetIncumbent, float],
    monkeypatch: pytest.MonkeyPatch,
    *,
    is_by_faces: bool,
) -> None:
    climbing = replace(TUNING, nodes_of_pairs=1, least_climbed=4, most_together=4)
    for module in (fewer, part, part_search):
        if hasattr(module, "TUNING"):
            monkeypatch.setattr(module, "TUNING", climbing)
    problem, incumbent, price = crossing
    base = float(sum(problem.base))
    search = BoundSearch(problem, incumbent, price, base, 8000, is_by_faces=is_by_faces)
    for effort in range(4):
        search.advance(TUNING.nodes, effort, search.order)
    sizes = {len(members) for members in search.proven[0, 1, 2, 3, 4]}
    assert {1, 2, 3, 4} <= sizes
    # What the plan costs is proven to a gap of 0.1 %, and its certificate is at most Δ.
    assert base * 1.03 < search.bound_here() <= incumbent.cost * (1.0 + 1e-6)
