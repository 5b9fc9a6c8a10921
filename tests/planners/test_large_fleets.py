"""Fleets in which no single set matters much: short searches first, long ones only where needed."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import fleet
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.pricing import price_alone
from radmpc.planners.certified.rounds import run_round
from radmpc.planners.certified.set_searches import solve_sets
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.tuning import TUNING
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
