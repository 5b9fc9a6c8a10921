"""Cones that vehicles alike have in common are those that each would have by itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import paper
from radmpc.model.scenario import Scenario
from radmpc.program.build import condensed_models
from radmpc.program.program import DisjunctiveProgram
from radmpc.program.relaxed.build import build_relaxation
from radmpc.program.relaxed.shared_rows import SharedCones, SharedRows
from radmpc.program.relaxed.tails import tails_of


def relaxed(
    scenario: Scenario, members: tuple[int, ...], cones: SharedCones | None
) -> DisjunctiveProgram:
    """Build the relaxation of some vehicles with cones that others may have asked for."""
    models = condensed_models(scenario)
    tails = tails_of(scenario.risk_bound, are_integrated=scenario.avoidance == "steps")
    alone = replace(scenario, vehicles=tuple(scenario.vehicles[i] for i in members))
    chosen = [models[i] for i in members]
    return build_relaxation(alone, chosen, tails, 16, SharedRows(cones)).program


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


def test_vehicles_out_of_reach_of_everything_have_no_rows() -> None:
    scenario = paper(2, 0)
    near = min(v.start[0] for v in scenario.vehicles)
    far = replace(scenario.vehicles[0], start=(near - 500.0, *scenario.vehicles[0].start[1:]))
    program = relaxed(replace(scenario, vehicles=(far, scenario.vehicles[1])), (0,), None)
    assert program.rows.count == program.num_avoidances == 0
