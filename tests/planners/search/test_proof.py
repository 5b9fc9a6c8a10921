"""The bound on any certified plan: where vehicles may be, sets apart, and what is told of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog

from radmpc.arrays import Vector
from radmpc.errors import ScenarioError
from radmpc.experiments.families import clutter, paper
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.planners import Branch, Certified, Optimal, Planner
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.proof import grouping
from radmpc.planners.certified.proof.relaxed_set import RelaxedSet
from radmpc.planners.certified.proof.tubes import in_empty_space, within_tube
from radmpc.planners.certified.proof.tuning import TUNING
from radmpc.planning import plan
from radmpc.program.build import build_program, condensed_models, point_of
from radmpc.program.relaxed.tails import tails_of
from radmpc.solvers.solution import Limits


@pytest.mark.parametrize("step", [1, 4, 7, 9])
def test_a_tube_is_as_wide_as_plans_up_to_a_cost_may_go(step: int) -> None:
    scenario = paper(1, 0)
    [model] = condensed_models(scenario)
    program = build_program(scenario, [model], risk_bound=scenario.risk_bound)
    most_cost = 5.0
    tube = within_tube(model, program, most_cost, Limits())
    hard = program.hard.toarray()
    rows = np.vstack([hard, -hard, program.cost])
    bounds = np.concatenate([program.hard_upper, -program.hard_lower, [most_cost]])
    is_row = np.isfinite(bounds)
    for axis in range(2):
        entry = 2 * step + axis
        along = program.outputs[[entry]].toarray()[0]
        for sign, reach in ((1.0, tube.reach_lower), (-1.0, tube.reach_upper)):
            solved = linprog(
                sign * along,
                A_ub=rows[is_row],
                b_ub=bounds[is_row],
                bounds=list(zip(program.lower, program.upper, strict=True)),
            )
            place = sign * solved.fun + program.constant[entry]
            assert sign * (place - reach[step, axis]) >= -1e-6
            assert reach[step, axis] == pytest.approx(place, abs=1e-4)


def test_a_tube_needs_no_obstacles_in_the_program() -> None:
    scenario = clutter(1, 20, 3)
    [model] = condensed_models(scenario)
    program = build_program(scenario, [model], risk_bound=scenario.risk_bound)
    bare = in_empty_space(scenario, model)
    assert bare.rows.count < program.rows.count
    wide, tube = (within_tube(model, one, 5.0, Limits()) for one in (program, bare))
    assert (wide.reach_lower == tube.reach_lower).all()
    assert (wide.reach_upper == tube.reach_upper).all()


@pytest.mark.slow
def test_a_narrowed_reach_leaves_the_bound_below_what_others_plan() -> None:
    scenario = replace(clutter(2, 20, 3), avoidance="steps")
    result = plan(scenario, time_limit=20.0)
    assert result.cost is not None
    assert result.certified_lower_bound is not None
    assert result.certified_lower_bound <= result.cost
    for planner in ("ira", "radmpc"):
        other = plan(scenario, planner, time_limit=20.0)
        if other.is_certified and other.cost is not None:
            assert result.certified_lower_bound <= other.cost * (1.0 + 1e-9)


@pytest.mark.slow
def test_more_time_for_the_proof_never_lowers_the_bound() -> None:
    scenario = paper(6, 0)
    bounds = []
    for seconds in (0.0, 30.0):
        planner = Planner(Optimal(), Branch(), Certified(seconds))
        result = plan(scenario, planner, time_limit=60.0)
        assert result.cost is not None
        assert result.certified_lower_bound is not None
        bounds.append(result.certified_lower_bound)
        assert result.certified_lower_bound <= result.cost
    assert bounds[0] < bounds[1]


@pytest.fixture(scope="module")
def among_boxes() -> Plan:
    """A plan of a vehicle among boxes."""
    return plan(replace(clutter(1, 40, 2), avoidance="steps"), "certified(0)").require()


@pytest.mark.parametrize("scenario", [paper(6, 2), paper(8, 3)], ids=lambda s: s.name)
def test_a_proof_that_leaves_behind_what_it_built_proves_the_same(
    scenario: Scenario, monkeypatch: pytest.MonkeyPatch
) -> None:
    scenario = replace(scenario, avoidance="steps")
    usual = plan(scenario, "certified", rng=0)
    left = []
    leave = RelaxedSet.left_behind
    monkeypatch.setattr(RelaxedSet, "left_behind", lambda a: left.append(a.built) or leave(a))
    monkeypatch.setattr(grouping, "TUNING", replace(TUNING, most_rows=0))
    thrifty = plan(scenario, "certified", rng=0)
    assert any(built is not None for built in left)
    assert thrifty.certified_lower_bound == usual.certified_lower_bound
    assert thrifty.cost == usual.cost


def relaxed_up_to(made: Plan, most: float) -> tuple[RelaxedSet, Vector]:
    """Its vehicle's relaxation up to a value, and the point of the plan."""
    scenario = made.scenario
    fleet = Fleet.of(scenario, 1e-3, Limits())
    model, program = fleet.programs.models[0], fleet.programs.problem((0,)).program
    tails = tails_of(scenario.risk_bound, are_integrated=True)
    if np.isfinite(most):
        model = within_tube(model, program, most, Limits())
    relaxed = RelaxedSet.of(scenario, [model], fleet.base[0], tails, 16, most)
    return relaxed, point_of([model], [made.trajectories[0].controls])


@pytest.mark.slow
def test_a_set_searched_up_to_a_value_proves_that_value_or_its_own(among_boxes: Plan) -> None:
    whole, hint = relaxed_up_to(among_boxes, np.inf)
    price, gap = 2.0, 1e-3
    found = whole.searched(Limits(), price, (), gap, 4000, hint)
    assert found.value - found.bound <= 2.0 * gap * found.value
    assert found.base < 0.98 * found.value
    for share in (0.3, 0.7, 1.5):
        most = found.base + share * (found.value - found.base)
        narrow = relaxed_up_to(among_boxes, most)[0].searched(Limits(), price, (), gap, 4000, hint)
        assert narrow.bound <= min(most, found.value) * (1.0 + 1e-9)
        assert narrow.bound >= min(most, found.bound) * (1.0 - 2.0 * gap)
        assert narrow.built.program.num_avoidances <= found.built.program.num_avoidances


@pytest.mark.slow
def test_a_set_is_searched_no_further_than_to_the_bound_that_is_enough(among_boxes: Plan) -> None:
    whole, hint = relaxed_up_to(among_boxes, np.inf)
    price, gap = 2.0, 1e-3
    found = whole.searched(Limits(), price, (), gap, 4000, hint)
    enough = found.base + 0.6 * (found.bound - found.base)
    less = whole.searched(Limits(), price, (), gap, 4000, hint, enough)
    assert enough <= less.bound <= found.value * (1.0 + 1e-9)
    assert less.nodes < found.nodes
    # What it left open is still there.
    more = less.searched(Limits(), price, (), gap, 4000, hint)
    assert more.bound == pytest.approx(found.bound, rel=2.0 * gap)


@pytest.mark.slow
def test_what_is_proven_at_one_price_is_carried_to_others_within_their_values(
    among_boxes: Plan,
) -> None:
    whole, hint = relaxed_up_to(among_boxes, np.inf)
    before = whole.searched(Limits(), 4.0, (), 1e-3, 4000, hint)
    for price in (1.0, 8.0):
        value = whole.searched(Limits(), price, (), 1e-3, 4000, hint).value
        carried = whole.continued(before).searched(Limits(), price, (), 1e-3, 1, hint)
        assert carried.widenings == 1
        assert carried.base < carried.bound <= value * (1.0 + 1e-9)


@pytest.mark.parametrize("seconds", [-1.0, float("nan"), float("inf"), "2"])
def test_what_is_no_time_for_a_proof_is_refused(seconds: object) -> None:
    with pytest.raises(ScenarioError, match="proof_seconds must be a number >= 0"):
        Certified(seconds)
