"""Pairs, workspaces and blocks in the program that is built."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_programs import built, mover, scene_of

from radmpc.experiments.families import circle
from radmpc.model.dynamics import LinearSystem, double_integrator
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Workspace
from radmpc.program.restrict import avoidance_blocks, restrict


def test_a_pair_far_apart_is_settled_and_charged_at_its_bound():
    scenario = scene_of(mover("a"), mover("b", (0.0, 90.0), (8.0, 90.0)), avoidance="steps")
    program = built(scenario)
    assert program.num_avoidances == 0
    assert 0.0 <= program.initial_risk <= 1e-12 * scenario.horizon


def test_risk_at_the_start_is_charged_before_anything_else():
    scenario = scene_of(mover("a"), mover("b", (1.2, 0.0), (0.0, 8.0)), avoidance="steps")
    program = built(scenario)
    # 0.2 m of clearance at a deviation of sqrt(0.02).
    [(risk_item, risk)] = program.initial
    assert (risk_item.cause, risk_item.step) == ("pair", 0)
    assert risk == pytest.approx(0.0786496, rel=1e-5)
    assert program.budget < 0.0


def test_the_workspace_is_one_avoidance_per_face_with_a_single_alternative():
    scenario = scene_of(
        mover(),
        avoidance="steps",
        workspace=Workspace(np.array([-1.0, -1.0]), np.array([9.0, 1.0])),
    )
    program = built(scenario)
    assert program.num_avoidances > 0
    assert set(np.diff(program.avoidance_starts)) == {1}
    assert {e.cause for e in program.risk_items} == {"workspace"}


def test_two_goals_on_one_point_leave_an_avoidance_without_alternatives():
    scenario = scene_of(mover("a"), mover("b", (16.0, 0.0), (8.0, 0.0)), avoidance="steps")
    program = built(scenario)
    infeasible = np.flatnonzero(np.diff(program.avoidance_starts) == 0)
    assert [program.avoidances[int(i)].step for i in infeasible][-1] == 8


def test_a_moving_obstacle_has_the_faces_of_both_ends_of_an_interval():
    triangle = np.array([[4.0, -1.0], [5.0, -1.0], [4.5, 1.0]])
    square = np.array([[4.0, -1.0], [5.0, -1.0], [5.0, 1.0], [4.0, 1.0]])
    drift = np.array([0.0, 0.1])
    outlines = [triangle + k * drift if k % 2 else square for k in range(9)]
    scenario = scene_of(
        mover(), avoidance="intervals", obstacles=(Obstacle.moving("ferry", outlines),)
    )
    program = built(scenario)
    sizes = np.diff(program.avoidance_starts)
    assert sizes.max() > 4


def test_a_system_without_a_continuous_model_has_no_sagitta():
    base = double_integrator(1.0, 2)
    # The control moves velocities alone: nothing tells what happens between steps.
    euler = LinearSystem(base.A, np.vstack([np.zeros((2, 2)), np.eye(2)]), (0, 1), (2, 3))
    vehicle = mover()
    wall = Obstacle.box("wall", [3, -1], [4, 1])
    straight = built(scene_of(replace(vehicle, system=euler), obstacles=(wall,)))
    curved = built(scene_of(vehicle, obstacles=(wall,)))
    assert _pulls(straight) == {False}
    # An end whose share of the reserve is nothing has a row without it.
    assert _pulls(curved) == {True, False}


def _pulls(program):
    """Return whether rows of faces look at controls, not at positions alone."""
    width = program.output_lower.size
    positions = 9 * 2
    assert width > positions
    entries = program.rows.normals.tocsr()
    return {bool(entries[[row]][:, positions:].nnz) for row in range(program.rows.count)}


def test_space_has_six_faces_around_a_pair():
    scenario = scene_of(
        mover("a", (0.0, 0.0, 0.0), (8.0, 0.0, 0.0)),
        mover("b", (8.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
        avoidance="steps",
    )
    program = built(scenario)
    assert np.diff(program.avoidance_starts).max() == 6


def test_feedback_keeps_the_reserve_of_the_control_limit():
    gain = np.array([[-0.3, 0, -0.9, 0], [0, -0.3, 0, -0.9]])
    vehicle = mover(gain=gain)
    sigma = vehicle.covariances(8)
    bounds = vehicle.control_bounds(sigma)
    expected = 2.0 - 3.0 * np.sqrt(gain[0] @ sigma[5] @ gain[0])
    assert bounds[5, 0] == pytest.approx(expected)
    program = built(scene_of(vehicle))
    assert program.upper.max() == pytest.approx(bounds.max())


def test_the_restriction_to_some_blocks_keeps_only_what_concerns_them():
    program = built(circle(4))
    touched = avoidance_blocks(program)
    assert touched.shape == (program.num_avoidances, 4)
    part = restrict(program, np.array([0, 2]), touched)
    names = {(e.vehicle, e.other) for e in part.program.avoidances}
    assert names == {("v1", "v3")}
    z = np.random.default_rng(0).uniform(size=program.num_columns)
    assert part.program.slacks(z[part.columns]) == pytest.approx(program.slacks(z)[part.rows])


def test_the_restriction_to_all_blocks_is_the_program_itself():
    program = built(circle(3))
    assert restrict(program, np.arange(3)).program is program


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_programs_hold_no_coefficient_that_is_zero(avoidance):
    box = Obstacle.box("box", np.array([3.0, -0.5]), np.array([5.0, 0.5]))
    scenario = scene_of(mover("a"), mover("b", (0.0, 2.0)), avoidance=avoidance, obstacles=(box,))
    normals = built(scenario).rows.normals
    assert np.all(normals.data != 0.0)
    if avoidance == "steps":
        # Faces along the axes ask for one coordinate of the one who avoids, or of both.
        assert set(np.diff(normals.indptr)) == {1, 2}
