"""The bound on plans by faces after a search that left a gap: it holds, and is worth asking for."""

from __future__ import annotations

from dataclasses import replace

import pytest

from radmpc.experiments.families import clutter, fleet, paper
from radmpc.model.scenario import Scenario
from radmpc.planners import Branch, Centralized, Ira, Planner
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.phases import by_faces, time_shares
from radmpc.planners.certified.phases.by_faces import bound_faces_of_each
from radmpc.planners.certified.proof.grouping import bounds_within
from radmpc.planners.certified.proof.relaxed_set import RelaxedSet
from radmpc.planners.certified.proof.search import BoundSearch
from radmpc.planners.certified.state.bounds import reported_bound
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planning import plan
from radmpc.solvers.solution import Limits


def left_open(
    scenario: Scenario, planner: Planner, factor: float, price: float
) -> tuple[Fleet, SearchState, float]:
    """A search that proved nothing, with a plan said to be dearer than it is; and its true cost."""
    result = plan(scenario, planner)
    controls = tuple(t.controls for t in result.require().trajectories)
    cost = result.cost
    assert cost is not None
    together = (tuple(range(len(controls))),)
    incumbent = FleetIncumbent(
        controls, factor * cost, together, certified=scenario.risk_bound, turned_price=price
    )
    problem = Fleet.of(scenario, 1e-3, Limits())
    return problem, replace(SearchState.of(problem), incumbent=incumbent), cost


@pytest.mark.sampled(1)
@pytest.mark.parametrize("price", [0.5, 2.0, 8.0])
def test_no_plan_within_the_union_bound_is_below_it(price: float) -> None:
    centralized = Planner(Ira(), Branch(), Centralized())
    problem, state, cost = left_open(paper(2, 0), centralized, 1.5, price)
    bounded = bound_faces_of_each(problem, state, 4000.0)
    bound = reported_bound(problem, bounded, problem.gap)
    assert sum(problem.base) * 1.02 < bound <= cost * (1.0 + 1e-6)


def test_a_price_that_is_far_too_high_is_moved() -> None:
    centralized = Planner(Ira(), Branch(), Centralized())
    bounds = {}
    for price in (2.0, 20.0):
        problem, state, cost = left_open(paper(2, 0), centralized, 1.5, price)
        bounded = bound_faces_of_each(problem, state, 4000.0)
        bounds[price] = reported_bound(problem, bounded, problem.gap)
        assert bounds[price] <= cost * (1.0 + 1e-6)
    assert bounds[20.0] > 0.999 * bounds[2.0]


@pytest.mark.slow
def test_among_boxes_it_comes_near_what_each_vehicle_has_to_go_around() -> None:
    scenario = replace(clutter(2, 20, 3), avoidance="steps")
    centralized = Planner(Ira(), Branch(), Centralized())
    problem, state, cost = left_open(scenario, centralized, 1.3, 1.0)
    bounded = bound_faces_of_each(problem, state, 20_000.0)
    bound = reported_bound(problem, bounded, problem.gap)
    assert 0.9 * cost <= bound <= cost * (1.0 + 1e-6)


def test_it_ends_with_its_nodes() -> None:
    problem, state, _ = left_open(paper(2, 0), Planner(Ira(), Branch(), Centralized()), 1.5, 2.0)
    few, many = (bound_faces_of_each(problem, state, nodes) for nodes in (20.0, 4000.0))
    bounds = [reported_bound(problem, one, problem.gap) for one in (few, many)]
    assert bounds[0] < bounds[1]


@pytest.mark.parametrize(
    "case", ["proven", "stopped", "large"], ids=["gap proven", "time is up", "large fleet"]
)
def test_it_is_asked_for_only_where_it_may_count(
    case: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    scenario = fleet(49, 0) if case == "large" else paper(2, 0)
    problem = Fleet.of(scenario, 1e-3, Limits())
    assert problem.is_large == (case == "large")
    cost = 1.2 * float(sum(problem.base))
    state = replace(SearchState.of(problem), incumbent=FleetIncumbent((), cost, problem.singles))
    monkeypatch.setattr(by_faces, "shadow_price", lambda *_: pytest.fail("a bound is searched"))
    if case == "proven":
        state = replace(state, budget_bounds=((scenario.risk_bound, cost),))
    if case == "stopped":
        problem = problem.with_limits(Limits(is_stopped=lambda: True))
    assert bound_faces_of_each(problem, state, 1000.0) is state


def test_a_plan_is_not_called_the_best_where_faces_leave_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    problem, state, _ = left_open(paper(2, 0), Planner(Ira(), Branch(), Centralized()), 1.5, 2.0)

    def blocked(self: RelaxedSet, _: Limits, price: float, *rest: object) -> RelaxedSet:
        return replace(self, bound=float("inf"), price=price)

    monkeypatch.setattr(RelaxedSet, "searched", blocked)
    bounded = bound_faces_of_each(problem, state, 4000.0)
    assert not bounded.budget_bounds


def test_a_search_leaves_it_time_of_the_limit() -> None:
    limits = Limits().within(100.0)
    search = time_shares.limits_of_search(limits)
    left = search.seconds_left - time_shares.but_for_faces(search, limits, 0.25).seconds_left
    assert left == pytest.approx(25.0, abs=1.0)
    assert time_shares.but_for_faces(Limits(), Limits(), 0.25).seconds_left == float("inf")


def test_what_relaxations_prove_counts_at_a_lower_price_as_what_it_proves_there() -> None:
    centralized = Planner(Ira(), Branch(), Centralized())
    problem, state, _ = left_open(paper(3, 0), centralized, 1.05, 4.0)
    incumbent, base = state.incumbent, float(sum(problem.base))
    relaxed = BoundSearch(problem, incumbent, 4.0, base, 4000.0)
    relaxed.advance(100, 0, relaxed.order)
    search = BoundSearch(
        problem, incumbent, 4.0, base, 4000.0, is_by_faces=True, below=relaxed.proven
    )
    for price in (4.0, 1.0):
        search.go_on_at(price)
        search.advance(100, 0, search.order)
        for members, part in search.parts.items():
            assert part.below == bounds_within(members, relaxed.proven, price)


def test_vehicles_that_risk_nothing_alone_do_not_move_its_price() -> None:
    centralized = Planner(Ira(), Branch(), Centralized())
    problem, state, _ = left_open(replace(paper(2, 0), obstacles=()), centralized, 1.05, 2.0)
    base = float(sum(problem.base))
    search = BoundSearch(problem, state.incumbent, 2.0, base, 4000.0, is_by_faces=True)
    search.regroup(problem.singles)
    search.advance(100, 0, search.order)
    assert not search.moves_price(10.0)
    assert search.price == 2.0
