"""The proof around the first plan: what it makes needless, and that its bounds hold."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import circle, paper
from radmpc.model.plan import Status
from radmpc.planners import Branch, Centralized, Certified, Ira, Optimal, Planner
from radmpc.planners.certified import certified
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.phases import ahead, around
from radmpc.planners.certified.proof.grouping import parts_of, proven_within
from radmpc.planners.certified.proof.relaxed_set import RelaxedSet
from radmpc.planners.certified.proof.search import BoundSearch
from radmpc.planners.certified.search import PriceSearch
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planning import plan
from radmpc.solvers.priced.rating import Rater
from radmpc.solvers.solution import Limits


def incumbent_of(result):
    """Return a plan as proofs are handed it, everyone alone."""
    controls = tuple(t.controls for t in result.require().trajectories)
    sets = tuple((i,) for i in range(len(controls)))
    certified = result.certificate.certified
    return FleetIncumbent(controls, result.cost, sets, certified=certified)


def bound_by_faces(scenario, incumbent, price, gap=1e-3):
    """Return the bound on plans by faces, searched with a plan at hand."""
    fleet = Fleet.of(scenario, gap, Limits())
    search = BoundSearch(fleet, incumbent, price, float(sum(fleet.base)), 4000.0, is_by_faces=True)
    search.run()
    return search.best


def no_search(*_):
    raise AssertionError("nothing is left for the search")


@pytest.mark.slow
def test_at_steps_a_fleet_is_proven_without_a_search_over_its_faces(monkeypatch):
    monkeypatch.setattr(PriceSearch, "run", no_search)
    result = plan(paper(4, 0))
    assert result.status is Status.OPTIMAL
    assert result.is_certified
    assert result.lower_bound >= result.cost * (1.0 - 1.001e-3)
    assert result.cost * 0.995 <= result.certified_lower_bound <= result.cost
    assert result.record.risk.price > 0.0


@pytest.mark.slow
def test_its_plan_is_as_cheap_as_that_of_the_search(monkeypatch):
    without = plan(paper(3, 2))
    monkeypatch.setattr(ahead, "prove_ahead", given_up)
    searched = plan(paper(3, 2))
    assert without.cost == pytest.approx(searched.cost, rel=1e-3)
    for one, other in ((without, searched), (searched, without)):
        assert one.certified_lower_bound <= other.cost * (1.0 + 1e-6)


def given_up(fleet, first, judge, proof_seconds):
    """Stand for a proof that came to nothing."""
    state = replace(certified.SearchState.of(fleet), incumbent=first)
    return ahead.Ahead(state, -np.inf, False)


@pytest.mark.parametrize("seed", [0, 3])
def test_no_plan_within_the_union_bound_is_below_the_bound_by_faces(seed: int):
    scenario = paper(2, seed)
    by_faces = plan(scenario, Planner(Ira(), Branch(), Centralized()))
    dear = replace(incumbent_of(by_faces), cost=1.5 * by_faces.cost)
    bounds = [bound_by_faces(scenario, dear, price) for price in (0.5, 2.0, 8.0)]
    assert max(bounds) <= by_faces.cost * (1.0 + 1e-6)
    assert max(bounds) >= 0.9 * by_faces.cost
    assert max(bounds) > 1.02 * sum(Fleet.of(scenario, 1e-3, Limits()).base)


@pytest.mark.slow
def test_the_search_for_it_ends_at_the_cost_of_the_plan_at_hand():
    scenario = circle(3)
    result = plan(scenario)
    incumbent = incumbent_of(result)
    cheap = replace(incumbent, cost=0.99 * incumbent.cost, sets=((0, 1, 2),))
    nodes = []
    for one in (replace(cheap, cost=1.2 * incumbent.cost), cheap):
        fleet = Fleet.of(scenario, 1e-3, Limits())
        price = result.record.risk.price
        search = BoundSearch(fleet, one, price, float(sum(fleet.base)), 1e4, is_by_faces=True)
        search.run()
        nodes.append(search.nodes)
    assert nodes[1] < nodes[0]
    assert search.best >= cheap.cost * (1.0 - 1.001e-3)


def test_a_gap_that_cones_prove_needs_no_bound_by_faces(monkeypatch):
    monkeypatch.setattr(around.Around, "bound_faces", no_search)
    result = plan(paper(4, 0), Planner(Optimal(), Branch(), Certified(), gap=0.02))
    assert result.status is Status.OPTIMAL
    assert result.certified_lower_bound >= 0.98 * result.cost


def test_without_time_for_a_proof_the_search_is_next(monkeypatch):
    calls = []
    run = PriceSearch.run
    monkeypatch.setattr(PriceSearch, "run", lambda *a: calls.append(1) or run(*a))
    result = plan(paper(2, 0), "certified(0)")
    assert calls
    assert result.status is Status.OPTIMAL


@pytest.mark.parametrize("seed", [0, 3])
def test_what_cones_prove_of_vehicles_is_no_more_than_faces_charge_them(seed: int):
    scenario = paper(2, seed)
    incumbent = replace(incumbent_of(plan(scenario)), sets=((0, 1),))
    dear = replace(incumbent, cost=2.0 * incumbent.cost)
    fleet = Fleet.of(scenario, 1e-3, Limits())
    base, price = float(sum(fleet.base)), 3.0
    by_cones = BoundSearch(fleet, dear, price, base, 2000.0)
    by_cones.advance(300, 3, by_cones.order)
    by_faces = BoundSearch(fleet, dear, price, base, 4000.0, is_by_faces=True)
    by_faces.advance(300, 3, by_faces.order)
    [below], [above] = by_cones.proven.values(), by_faces.proven.values()
    assert (0, 1) in below
    for blocks, known in below.items():
        best = above[blocks].value if blocks in above else np.inf
        assert known.bound <= best * (1.0 + 1e-9)
    aided = BoundSearch(fleet, dear, price, base, 4000.0, is_by_faces=True, below=by_cones.proven)
    aided.advance(300, 3, aided.order)
    assert aided.best == pytest.approx(by_faces.best, rel=5e-3)
    assert aided.best <= sum(above[blocks].value for blocks in [(0, 1)])


def test_faces_that_leave_a_vehicle_no_plan_bound_nothing_from_above(monkeypatch):
    scenario = paper(2, 0)
    incumbent = replace(incumbent_of(plan(scenario)), sets=((0, 1),))
    fleet = Fleet.of(scenario, 1e-3, Limits())
    by_faces = RelaxedSet.by_faces

    def blocked(alone, models, base, most=np.inf, shared=None):
        found = by_faces(alone, models, base, most, shared)
        if len(models) == 1:
            program = replace(found.built.program, upper=found.built.program.lower - 1.0)
            rater = Rater(program, alone.risk_bound)
            return replace(found, built=replace(found.built, program=program, rater=rater))
        return found

    monkeypatch.setattr(RelaxedSet, "by_faces", blocked)
    base = float(sum(fleet.base))
    search = BoundSearch(fleet, incumbent, 2.0, base, 1000.0, is_by_faces=True)
    search.run()
    assert search.best == np.inf


def test_what_is_known_of_sets_is_found_again_when_they_are_merged():
    known = {(1,): {(0,): "one"}, (0, 2): {(0,): "zero", (1,): "two", (0, 1): "both"}, (5,): {}}
    within = proven_within((0, 1, 2), known)
    assert within == {(1,): "one", (0,): "zero", (2,): "two", (0, 2): "both"}
    assert proven_within((0, 1), known) == {(1,): "one"}


def test_vehicles_of_large_sets_are_parted_among_many_obstacles():
    sets = [(3, 1), tuple(range(4, 14))]
    assert parts_of(sets, 12) == ((1, 3), *((i,) for i in range(4, 14)))
    assert parts_of(sets, 11) == ((1, 3), tuple(range(4, 14)))
    assert parts_of([tuple(range(25))], 0) == tuple((i,) for i in range(25))
