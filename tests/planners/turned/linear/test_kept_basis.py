"""Linear programs of turning begin where the last one ended, and end where they would anyhow."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import circle, clutter, paper
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.linear.group_lp import GroupLp
from radmpc.planners.certified.turned.linear.group_plan import GroupPlan
from radmpc.planners.certified.turned.linear.kept_basis import KeptBasis, Offered
from radmpc.planners.certified.turned.linear.margins import far_of, priced_margins
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.solvers.lp.quiet_highs import BASIC, LOWER, UPPER
from radmpc.solvers.solution import Limits

PRICE, PENALTY = 30.0, 1e3


def value(plan: GroupPlan, hazards: Hazards, price: float) -> float:
    """Return what the program minimizes."""
    weights = [model.vehicle.cost_weight for model in hazards.models]
    effort = [w * np.abs(u).sum() for w, u in zip(weights, plan.controls, strict=True)]
    return float(sum(effort)) + price * plan.risk + PENALTY * plan.shortfall


def turned(scenario: Scenario, *, keeps: bool, turns: int = 4) -> tuple[list[float], float]:
    """Turn half-spaces at a falling price; return the values, and the work of all but the first."""
    hazards = Hazards.of(scenario, condensed_models(scenario))
    successive = SuccessiveLp(hazards, Limits())
    assert successive.begin_alone()
    successive.keep_apart(2.5, 20)
    everyone = tuple(range(hazards.count))
    near = Near(far_of(hazards.tail, 6.5), float(hazards.reaches.max()), is_refined=True)
    program, values, first = GroupLp(hazards, everyone), [], 0.0
    program.keeps_basis = keeps
    for number in range(turns):
        price = PRICE / (1 + number)
        spaces = half_spaces(hazards, successive.paths, everyone, near)
        costs = price, PENALTY
        margins = priced_margins(spaces.deviations, spaces.clearances, costs, 0.1 / (1 + number))
        plan = program.solve(spaces, successive.paths, margins)
        assert plan is not None
        # Both go the same way, so that every program is asked of both.
        alike = GroupLp(hazards, everyone).solve(spaces, successive.paths, margins)
        assert alike is not None
        values.append(value(plan, hazards, price))
        assert values[-1] == pytest.approx(value(alike, hazards, price), rel=1e-7)
        first = first or program.work
        for i, controls in zip(everyone, alike.controls, strict=True):
            successive.paths.fly(i, controls)
    return values, program.work - first


@pytest.mark.parametrize(
    "scenario",
    [paper(5, 0), replace(paper(4, 1), avoidance="intervals"), clutter(3, 30, 0)],
    ids=["steps", "intervals", "boxes"],
)
def test_a_program_that_begins_where_the_last_ended_has_the_same_optimum_in_fewer_pivots(
    scenario: Scenario,
) -> None:
    values, work = turned(scenario, keeps=True)
    from_nothing, more_work = turned(scenario, keeps=False)
    assert values == pytest.approx(from_nothing, rel=1e-7)
    assert work < 0.8 * more_work


def test_paths_that_move_far_do_not_keep_a_program_from_its_optimum() -> None:
    values, _ = turned(circle(6), keeps=True)
    assert values == pytest.approx(turned(circle(6), keeps=False)[0], rel=1e-7)


def test_who_was_active_is_and_gives_up_what_the_latest_paths_do() -> None:
    kept = KeptBasis(
        columns=np.array([BASIC, LOWER]),
        rows=np.array([LOWER]),
        nearest=np.array([LOWER, LOWER]),
        order=np.array([0]),
        active=np.array([70]),
        basic=np.array([7]),
    )
    lengths = np.tile([1.0, 2.0, 3.0], (2, 1, 1))
    offered = Offered(
        end_keys=np.array([[7], [8]]),
        row_keys=np.array([70, 80]),
        row_ends=np.array([0, 1]),
        lengths=lengths,
        given_up=np.array([[1.5], [1.5]]),
    )
    columns, rows = kept.in_program(offered)
    assert columns.tolist() == [BASIC, LOWER, UPPER, BASIC, LOWER, LOWER, *[LOWER] * 4]
    assert rows.tolist() == [LOWER, LOWER, BASIC]


def test_columns_that_nothing_determines_any_more_go_to_the_nearer_bound() -> None:
    kept = KeptBasis(
        columns=np.array([BASIC, BASIC, BASIC]),
        rows=np.array([LOWER]),
        nearest=np.array([LOWER, UPPER, LOWER]),
        order=np.array([1, 0, 2]),
        active=np.array([70, 90]),
        basic=np.zeros(0, dtype=np.int64),
    )
    offered = Offered(
        end_keys=np.array([[7]]),
        row_keys=np.array([70]),
        row_ends=np.array([0]),
        lengths=np.ones((1, 1, 2)),
        given_up=np.zeros((1, 1)),
    )
    columns, rows = kept.in_program(offered)
    # Two rows, so two of the three stay basic: the one nearest to a bound does not.
    assert columns[:3].tolist() == [BASIC, UPPER, BASIC]
    assert rows.tolist() == [LOWER, LOWER]
