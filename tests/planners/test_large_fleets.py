"""Fleets in which no single set matters much: short searches first, long ones only where needed."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import fleet
from radmpc.planners.certified import acceptance
from radmpc.planners.certified.acceptance import accept_round
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.pricing import price_alone
from radmpc.planners.certified.rescaling import rescaled
from radmpc.planners.certified.rounds import run_round
from radmpc.planners.certified.set_searches import solve_sets
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.tuning import TUNING
from radmpc.planners.verdict import Verdict
from radmpc.planning import plan
from radmpc.solvers.solution import Limits, never

GAP = 1e-3


@pytest.fixture(scope="module")
def large():
    return Fleet.of(fleet(64, 0), GAP, Limits(float("inf"), never))


@pytest.fixture(scope="module")
def rounds(large):
    """The first two rounds at one price, each with the state after it."""
    state, first = run_round(large, price_alone(large, SearchState.of(large)))
    return (state, first), run_round(large, state)


@pytest.mark.slow
def test_sets_are_searched_briefly_until_who_meets_whom_is_known(rounds):
    state, first = rounds[0]

    assert first.is_initial
    for members in first.sets:
        each = TUNING.sets.trial_nodes if len(members) > 1 else TUNING.sets.trial_nodes_alone
        # A node and its last children are solved to the end.
        assert state.set_states[members].nodes <= each * len(members) + 20


@pytest.mark.slow
def test_then_those_that_leave_much_open_are_searched_at_length(rounds):
    (before, first), (after, second) = rounds
    kept = [m for m in second.sets if m in before.set_states]

    assert not second.is_initial
    assert second.open_gap < first.open_gap
    assert max(after.set_states[m].nodes - before.set_states[m].nodes for m in kept) > 0
    for members in kept:
        if not before.set_states[members].is_limited:
            assert after.set_states[members].nodes == before.set_states[members].nodes


@pytest.mark.slow
def test_a_set_of_a_large_fleet_may_leave_open_what_matters_little_to_the_fleet(large, rounds):
    state, found = rounds[1]
    hardest = max(found.sets, key=lambda m: state.set_states[m].nodes)
    assert len(hardest) > 2
    known = state.set_states[hardest]
    value = known.best.cost + known.unit_price * known.best.risk / large.unit
    may_leave = TUNING.sets.gap_share * GAP * TUNING.sets.fleet_share * sum(large.base)

    assert 0.0 < value - known.bound <= may_leave
    # By itself it is searched on.
    scene = large.scenario.subset(hardest, large.scenario.risk_bound)
    own = Fleet.of(scene, GAP, large.limits)
    everyone = tuple(range(len(hardest)))
    start = replace(SearchState.of(own), has_tried_initial_plan=True)
    alone = solve_sets(own, start, [everyone], known.unit_price, 1).set_states[everyone]
    assert alone.nodes > known.nodes


@pytest.mark.nightly
def test_other_processes_search_a_large_fleet_to_the_same_end(large, rounds):
    here = rounds[0][1]
    with ProcessPoolExecutor(2) as pool:
        elsewhere = replace(large, executor=pool)
        alone = price_alone(elsewhere, SearchState.of(elsewhere))
        there = run_round(elsewhere, alone)[1]

    assert there.sets == here.sets
    for one, other in zip(there.plans, here.plans, strict=True):
        np.testing.assert_array_equal(one.z, other.z)


@pytest.mark.nightly
def test_other_processes_plan_a_large_fleet_alike():
    here = plan(fleet(64, 0), rng=0)
    with ProcessPoolExecutor(2) as pool:
        there = plan(fleet(64, 0), rng=0, executor=pool)

    assert (there.cost, there.certified_lower_bound) == (here.cost, here.certified_lower_bound)
    for one, other in zip(there.require().trajectories, here.require().trajectories, strict=True):
        np.testing.assert_array_equal(one.controls, other.controls)


@pytest.mark.parametrize(
    ("count", "certificate", "calls"), [(49, 0.65, 1), (49, 0.4, 2), (24, 0.65, 2)]
)
def test_budgets_of_a_large_fleet_end_with_one_of_which_most_is_used(count, certificate, calls):
    problem = Fleet.of(fleet(count, 1), GAP, Limits(float("inf"), never))
    state, found = run_round(problem, price_alone(problem, SearchState.of(problem)))
    asked = []

    def judge(controls):
        """Find a little more every time, so that no budget leads to the plan of another."""
        asked.append(controls)
        return Verdict(problem.scenario.risk_bound * (certificate + 1e-4 * len(asked)), ())

    candidate = replace(found, is_initial=True)
    accepted = accept_round(problem, state, candidate, judge)
    assert min(len(asked), 2) == calls
    assert accepted.state.has_plan
    if calls == 1:
        # The next budget follows in proportion.
        assert accepted.state.budget > 1.2 * state.budget
        # After the first plan the budget is one that was tried.
        later = accept_round(problem, state, replace(found, is_initial=False), judge)
        assert later.state.budget == pytest.approx(state.budget)


@pytest.mark.parametrize(
    ("count", "certificate", "is_kept"), [(49, 0.9, True), (49, 1.1, False), (24, 0.9, False)]
)
def test_a_large_round_that_is_certified_as_it_is_is_not_rescaled(
    monkeypatch: pytest.MonkeyPatch, count: int, certificate: float, is_kept: bool
) -> None:
    problem = Fleet.of(fleet(count, 1), GAP, Limits(float("inf"), never))
    state, found = run_round(problem, price_alone(problem, SearchState.of(problem)))
    rescalings = []
    monkeypatch.setattr(
        acceptance, "rescaled", lambda *given: rescalings.append(given) or rescaled(*given)
    )
    share = certificate * problem.scenario.risk_bound
    accepted = accept_round(problem, state, found, lambda controls: Verdict(share, ()))
    assert (rescalings == []) is is_kept
    if is_kept:
        expected = problem.programs.controls(found.sets, [each.z for each in found.plans])
        kept = accepted.state.incumbent.controls
        assert all(np.array_equal(a, b) for a, b in zip(kept, expected, strict=True))
        assert accepted.first_certificate == share


def test_a_large_round_just_above_the_bound_is_rescaled_by_what_the_referee_found() -> None:
    problem = Fleet.of(fleet(49, 1), GAP, Limits(float("inf"), never))
    state, found = run_round(problem, price_alone(problem, SearchState.of(problem)))
    risk_bound, shares, judged = problem.scenario.risk_bound, iter([1.1, 0.9]), []

    def judge(controls):
        judged.append(controls)
        return Verdict(next(shares) * risk_bound, ())

    accepted = accept_round(problem, state, found, judge)
    union_bound = found.risk + found.inter_set_risk
    assert len(judged) == 2
    assert accepted.state.incumbent.union_bound == pytest.approx(
        TUNING.acceptance.aim / 1.1 * union_bound
    )
    stayed = [np.array_equal(a, b) for a, b in zip(*judged, strict=True)]
    assert not all(stayed)
    # Most had risk to spare, and none of it was asked for.
    assert sum(stayed) > len(stayed) / 2


def test_programs_of_sets_are_given_up_once_these_are_merged_and_no_others():
    programs = Fleet.of(fleet(8, 0), GAP, Limits(float("inf"), never)).programs
    all_members = ((0, 1), (2, 3), (1, 2), (4, 5), (0,), (0, 1, 2, 3))
    first = {members: programs.problem(members) for members in all_members}
    kept = {members for members in all_members if programs.problem(members) is first[members]}
    assert kept == {(4, 5), (0,), (0, 1, 2, 3)}
    # Asked for again, a part is built again, and given up with the next set that holds it.
    again = programs.problem((0, 1))
    assert again is programs.problem((0, 1))
    programs.problem((0, 1, 4))
    assert programs.problem((0, 1)) is not again
    assert programs.problem((4, 5)) is first[(4, 5)]
