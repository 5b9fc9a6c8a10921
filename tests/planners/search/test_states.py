"""The state of a search for a fleet's plan: a value that phases are handed and hand on."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, fields, replace

import numpy as np
import pytest

from radmpc.experiments.families import clutter, paper
from radmpc.planners.certified import search
from radmpc.planners.certified.acceptance import accept_round
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.pricing import price_alone
from radmpc.planners.certified.rounds import run_round
from radmpc.planners.certified.search import PriceSearch
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.outdone import is_outdone
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.tuning import TUNING
from radmpc.planners.verdict import Verdict
from radmpc.solvers.solution import Limits


@pytest.fixture(scope="module")
def fleet():
    return Fleet.of(paper(3, 2), 1e-3, Limits())


@pytest.fixture(scope="module")
def begun(fleet):
    """Return the state after every vehicle was planned alone."""
    return price_alone(fleet, SearchState.of(fleet))


def contents(state):
    """Copy what a state holds, mappings one level deep."""
    held = {field.name: getattr(state, field.name) for field in fields(state)}
    return {name: dict(v) if isinstance(v, dict) else v for name, v in held.items()}


def judge_as(certified):
    return lambda controls: Verdict(certified, ())


def test_neither_the_problem_nor_the_state_of_a_search_can_be_written_to(fleet, begun):
    for held, name in ((fleet, "limits"), (begun, "budget"), (begun.incumbent, "cost")):
        with pytest.raises(FrozenInstanceError):
            setattr(held, name, None)


def test_tuned_numbers_cannot_be_written_to():
    with pytest.raises(FrozenInstanceError):
        TUNING.sets.nodes = 1
    with pytest.raises(TypeError):
        TUNING.budgets.slack["steps"] = (1.0, 1.0)


def test_phases_leave_the_state_that_they_are_handed_as_it_was(fleet, begun):
    before = contents(begun)
    after, candidate = run_round(fleet, begun)
    accepted = accept_round(fleet, after, candidate, judge_as(0.5 * fleet.scenario.risk_bound))
    assert contents(begun) == before
    assert accepted.state.has_plan
    assert not after.has_plan


def test_from_the_same_state_a_round_is_the_same_again(fleet, begun):
    (one, first), (two, second) = run_round(fleet, begun), run_round(fleet, begun)
    assert first.sets == second.sets
    for plan, again in zip(first.plans, second.plans, strict=True):
        assert np.array_equal(plan.z, again.z)
    assert list(one.set_states) == list(two.set_states)


def test_no_budget_is_tried_between_two_whose_plans_are_all_there_are(fleet, begun):
    # Passed, rejected, then the first plan again: nothing else lies between.
    shares = iter([0.6, 1.2, 0.6, 0.7, 0.8])
    asked = []

    def judge(controls):
        asked.append(next(shares))
        return Verdict(asked[-1] * fleet.scenario.risk_bound, ())

    after, candidate = run_round(fleet, begun)
    accept_round(fleet, after, candidate, judge)
    assert asked == [0.6, 1.2, 0.6]


def test_what_the_referee_rejects_lowers_the_budget_of_the_next_state_only(fleet, begun):
    after, candidate = run_round(fleet, begun)
    rejected = accept_round(fleet, after, candidate, judge_as(0.9))
    assert not rejected.state.has_plan
    assert rejected.state.has_failed
    assert rejected.first_certificate == 0.9
    assert rejected.state.budget < after.budget == begun.budget


def test_a_stopped_search_goes_on_from_the_state_that_it_returned(fleet, begun):
    judge = judge_as(0.9 * fleet.scenario.risk_bound)
    stopped = PriceSearch.of(fleet.with_limits(Limits(is_stopped=lambda: True)), judge)
    halted = stopped.run(begun)
    ended = stopped.with_limits(Limits()).run(halted)
    assert len(ended.steps) > len(halted.steps)
    assert ended.has_plan


@pytest.fixture(scope="module")
def among_boxes():
    return Fleet.of(replace(clutter(2, 12, 3), avoidance="steps"), 1e-3, Limits())


@pytest.mark.parametrize(
    ("rival", "bound", "is_left"),
    [(80.0, 10.0, True), (80.0, 60.0, False), (99.0, 10.0, False), (float("inf"), 10.0, False)],
    ids=["far dearer, far from proven", "half proven", "hardly dearer", "no other plan"],
)
def test_a_search_is_left_for_a_far_cheaper_plan_that_it_proves_little_of(
    rival, bound, is_left, among_boxes
):
    plan = FleetIncumbent((np.zeros((1, 2)),), 100.0)
    begun = SearchState.of(among_boxes)
    state = replace(begun, incumbent=plan, round_bounds=((bound, 0.0),))
    assert is_outdone(among_boxes, state, rival) == is_left
    assert not is_outdone(among_boxes, begun, rival)


def test_a_search_that_is_outdone_ends_with_its_first_plan(among_boxes, monkeypatch):
    judge = judge_as(0.9 * among_boxes.scenario.risk_bound)
    begun = SearchState.of(among_boxes)
    whole = PriceSearch.of(among_boxes, judge, rival=2.0).run(begun)
    monkeypatch.setattr(search, "is_outdone", lambda _, state, rival: rival == 2.0)
    left = PriceSearch.of(among_boxes, judge, rival=2.0).run(begun)
    assert left.has_plan
    assert len(left.steps) == 1 < len(whole.steps)
