"""Cones and rows that relaxations have in common are those that each would have by itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from comparing import differences
from radmpc.arrays import Tensor
from radmpc.experiments.families import clutter, paper
from radmpc.model.scenario import Scenario, Workspace
from radmpc.program.build import condensed_models
from radmpc.program.program import DisjunctiveProgram
from radmpc.program.relaxed.build import build_relaxation
from radmpc.program.relaxed.shared_rows import SharedCones, SharedRows
from radmpc.program.relaxed.tails import tails_of

WALLED = replace(paper(3, 1), workspace=Workspace(np.full(2, -30.0), np.full(2, 30.0)))


def relaxed(
    scenario: Scenario, members: tuple[int, ...], cones: SharedCones | None
) -> DisjunctiveProgram:
    """Build the relaxation of some vehicles with cones that others may have asked for."""
    models = condensed_models(scenario)
    tails = tails_of(scenario.risk_bound, are_integrated=scenario.avoidance == "steps")
    alone = replace(scenario, vehicles=tuple(scenario.vehicles[i] for i in members))
    chosen = [models[i] for i in members]
    return build_relaxation(alone, chosen, tails, 16, SharedRows(cones)).program


def lines(scenario: Scenario) -> Tensor:
    """Return straight lines from starts to goals."""
    ends = [
        (model.drift_position[0], model.vehicle.goal.center) for model in condensed_models(scenario)
    ]
    return np.array([np.linspace(start, goal, scenario.horizon + 1) for start, goal in ends])


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_shared_cones_make_the_same_programs(avoidance: str) -> None:
    scenario = replace(paper(3, 1), avoidance=avoidance)
    wider = replace(scenario.vehicles[2], radius=1.5 * scenario.vehicles[2].radius)
    scenario = replace(scenario, vehicles=(*scenario.vehicles[:2], wider))
    cones = SharedCones()
    for members in [(0,), (1,), (2,), (0, 1), (0, 2), (0, 1, 2)]:
        one, other = relaxed(scenario, members, cones), relaxed(scenario, members, None)
        assert one.rows.count == other.rows.count > 0
        assert (one.rows.normals != other.rows.normals).nnz == 0
        assert np.array_equal(one.rows.offsets, other.rows.offsets)
        assert np.array_equal(one.rows.deviations, other.rows.deviations)
        assert np.array_equal(one.alternative_starts, other.alternative_starts)
        assert np.array_equal(one.avoidance_starts, other.avoidance_starts)


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
@pytest.mark.parametrize("scenario", [WALLED, clutter(3, 8, 0)])
@pytest.mark.parametrize("is_around", [True, False])
def test_rows_of_vehicles_and_pairs_are_the_same_in_every_set(
    scenario: Scenario, avoidance: str, is_around: bool
) -> None:
    scenario = replace(scenario, avoidance=avoidance)
    models = condensed_models(scenario)
    tails = tails_of(scenario.risk_bound, are_integrated=avoidance == "steps")
    straight = lines(scenario)
    rows = SharedCones(keeps_rows=True).rows()
    for members in [(0,), (2,), (0, 1), (1, 2), (2,), (0, 2), (0, 1, 2)]:
        alone = replace(scenario, vehicles=tuple(scenario.vehicles[i] for i in members))
        asked = alone, [models[i] for i in members], tails, 16
        around = straight[list(members)] if is_around else None
        one = build_relaxation(*asked, rows, around)
        other = build_relaxation(*asked, SharedRows(), around)
        assert differences(one, other) == []
        assert bool(one.left_out) <= is_around
    assert one.program.rows.count > 0


def test_rows_around_another_plan_are_made_anew() -> None:
    scenario = clutter(3, 8, 0)
    models = condensed_models(scenario)
    tails = tails_of(scenario.risk_bound, are_integrated=True)
    straight = lines(scenario)
    rows = SharedCones(keeps_rows=True).rows()
    for shift in [0.0, 3.0, 0.0]:
        asked = scenario, models, tails, 16
        one = build_relaxation(*asked, rows, straight + shift)
        assert differences(one, build_relaxation(*asked, SharedRows(), straight + shift)) == []


def test_vehicles_out_of_reach_of_everything_have_no_rows() -> None:
    scenario = paper(2, 0)
    near = min(v.start[0] for v in scenario.vehicles)
    far = replace(scenario.vehicles[0], start=(near - 500.0, *scenario.vehicles[0].start[1:]))
    program = relaxed(replace(scenario, vehicles=(far, scenario.vehicles[1])), (0,), None)
    assert program.rows.count == program.num_avoidances == 0
