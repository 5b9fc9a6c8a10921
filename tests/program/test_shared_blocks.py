"""Rows that programs of several sets have in common are those that each would have by itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from comparing import differences
from radmpc.experiments.families import clutter, paper
from radmpc.model.scenario import Scenario, Workspace
from radmpc.planners.certified.nearby import Surroundings
from radmpc.program.build import SharedBlocks, build_program, condensed_models
from radmpc.program.program import DisjunctiveProgram

SETS = [(0,), (2,), (0, 1), (1, 2), (0, 1, 2), (2,)]


def walled(scenario: Scenario) -> Scenario:
    """Put a wall around a scene."""
    return replace(scenario, workspace=Workspace(np.full(2, -30.0), np.full(2, 30.0)))


def programs_of(
    scenario: Scenario, members: tuple[int, ...], shared: SharedBlocks
) -> tuple[DisjunctiveProgram, DisjunctiveProgram]:
    """Build the program of some vehicles with rows of other sets, and without."""
    models = condensed_models(scenario)
    alone = replace(scenario, vehicles=tuple(scenario.vehicles[i] for i in members))
    chosen, risk_bound = [models[i] for i in members], scenario.risk_bound
    one = build_program(alone, chosen, risk_bound=risk_bound, shared=shared)
    return one, build_program(alone, chosen, risk_bound=risk_bound)


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
@pytest.mark.parametrize("scenario", [walled(paper(3, 1)), clutter(3, 8, 0)])
def test_shared_rows_make_the_same_programs(scenario: Scenario, avoidance: str) -> None:
    scenario, shared = replace(scenario, avoidance=avoidance), SharedBlocks()
    for members in SETS:
        one, other = programs_of(scenario, members, shared)
        assert one.rows.count > 0
        # Sums of what is presolved are rounded in another order.
        assert one.presolved_risk == pytest.approx(other.presolved_risk, rel=1e-9)
        assert one.initial_risk == pytest.approx(other.initial_risk, rel=1e-9)
        same = {"presolved_risk": other.presolved_risk, "initial_risk": other.initial_risk}
        assert differences(replace(one, **same), other) == []


def test_what_was_given_up_is_made_anew() -> None:
    scenario, shared = paper(3, 1), SharedBlocks()
    programs_of(scenario, (0, 1), shared)
    shared.clear()
    one, other = programs_of(scenario, (0, 1, 2), shared)
    assert differences(one.rows, other.rows) == []
    assert differences(one.rows.offsets, programs_of(scenario, (1, 2), shared)[0].rows.offsets)


def test_obstacles_that_a_vehicle_cannot_meet_add_no_rows_of_its_own() -> None:
    scenario, shared = clutter(3, 40, 1), SharedBlocks()
    models = condensed_models(scenario)
    surroundings = Surroundings.of(scenario, models)
    for members in ((0,), (1,), (0, 1)):
        met = surroundings.scenario_of(members)
        chosen = [models[i] for i in members]
        build_program(met, chosen, risk_bound=met.risk_bound, shared=shared)
    both = surroundings.scenario_of((0, 1))
    program = build_program(both, models[:2], risk_bound=both.risk_bound, shared=shared)
    met_by = [
        {obstacle.name for obstacle in surroundings.scenario_of((i,)).obstacles} for i in range(2)
    ]
    names = [scenario.vehicles[i].name for i in range(2)]
    of_obstacles = [item for item in program.avoidances if item.cause == "obstacle"]
    assert of_obstacles
    for item in of_obstacles:
        assert item.other in met_by[names.index(item.vehicle)]
