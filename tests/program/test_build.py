"""The program says what the scenario means."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from radmpc.experiments.families import circle, paper
from radmpc.model.dynamics import LinearSystem, covariances, double_integrator, rollout
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.program.build import build_program, condensed_models, controls_of
from radmpc.program.restrict import avoidance_blocks, restrict
from radmpc.solvers.lp.highs_lp import LpOutcome
from radmpc.solvers.lp.warm_lp import WarmLp
from sampling import examples


def _vehicle(name="a", start=(0.0, 0.0), goal=(8.0, 0.0), **more):
    d = len(start)
    options = {
        "radius": 0.5,
        "control_limit": np.full(d, 2.0),
        "speed_limit": np.full(d, 3.0),
        "initial_covariance": 0.01,
        "disturbance_covariance": 0.01,
    }
    return Vehicle(
        name=name,
        system=double_integrator(1.0, d),
        start=np.concatenate([start, np.zeros(d)]),
        goal=Goal(np.array(goal) - 0.1, np.array(goal) + 0.1, np.full(d, 0.05)),
        **(options | more),
    )


def _scenario(*vehicles, **more):
    return Scenario(
        name="s", dt=1.0, horizon=more.pop("horizon", 8), risk_bound=0.05, vehicles=vehicles, **more
    )


def _build(scenario):
    return build_program(scenario, condensed_models(scenario), risk_bound=scenario.risk_bound)


def _random_point(program, rng):
    return rng.uniform(program.lower, program.upper)


@settings(max_examples=examples(25), deadline=None)
@given(seed=st.integers(0, 10**6))
def test_outputs_are_the_mean_positions_of_the_rollout(seed):
    scenario = paper(2, 3)
    models = condensed_models(scenario)
    program = _build(scenario)
    z = _random_point(program, np.random.default_rng(seed))
    outputs = program.outputs @ z + program.constant
    expected = []
    for vehicle, controls in zip(scenario.vehicles, controls_of(models, z), strict=True):
        expected.append(rollout(vehicle.system, vehicle.start, controls)[:, :2].ravel())
    assert outputs[: 2 * 2 * 11] == pytest.approx(np.concatenate(expected), abs=1e-9)


@settings(max_examples=examples(20), deadline=None)
@given(seed=st.integers(0, 10**6))
def test_every_plan_that_holds_the_hard_rows_stays_within_reach(seed):
    scenario = paper(1, 3)
    program = _build(scenario)
    rng = np.random.default_rng(seed)
    cost = rng.normal(size=program.num_columns)
    lp = WarmLp(replace(program, cost=cost), np.zeros(program.rows.count))
    outcome, _ = lp.solve()
    assert outcome is LpOutcome.OPTIMAL
    outputs = program.outputs @ lp.point() + program.constant
    assert np.all(outputs >= program.output_lower - 1e-6)
    assert np.all(outputs <= program.output_upper + 1e-6)


def test_a_face_row_is_the_obstacle_moved_out_by_the_radius():
    scenario = _scenario(
        _vehicle(), avoidance="steps", obstacles=(Obstacle.box("wall", [3, -1], [4, 1]),)
    )
    program = _build(scenario)
    z = np.zeros(program.num_columns)
    slacks = program.slacks(z)
    # Without control the vehicle stays at the origin: 2.5 m left of the grown wall's left face.
    assert slacks.max() == pytest.approx(2.5)
    deviations = program.rows.deviations
    step = np.array([program.risk_items[e].step for e in program.rows.risk_items])
    sigma = covariances(scenario.vehicles[0].system, 0.01 * np.eye(4), 0.01 * np.eye(4), None, 8)
    for row, event in enumerate(program.rows.events):
        assert deviations[row] == pytest.approx(np.sqrt(sigma[step[event], 0, 0]))


def test_under_intervals_an_alternative_holds_one_face_at_both_ends():
    scenario = _scenario(
        _vehicle(), avoidance="intervals", obstacles=(Obstacle.box("wall", [3, -1], [4, 1]),)
    )
    program = _build(scenario)
    assert set(np.diff(program.alternative_starts)) == {2}
    for alternative in range(program.num_alternatives):
        first, second = program.rows_of(alternative)
        steps = [
            program.risk_items[program.rows.risk_items[program.rows.events[r]]].step
            for r in (first, second)
        ]
        assert steps[1] == steps[0] + 1


def test_neighboring_intervals_share_the_event_of_a_face_at_their_common_step():
    scenario = _scenario(
        _vehicle(), avoidance="intervals", obstacles=(Obstacle.box("wall", [3, -1], [4, 1]),)
    )
    program = _build(scenario)
    rows = program.rows
    label_of = np.repeat(np.arange(program.num_alternatives), np.diff(program.alternative_starts))
    window_of = np.array([program.avoidances[a].step for a in _avoidance_of(program)])[label_of]
    shared = 0
    for event in range(rows.events.max() + 1):
        held = np.flatnonzero(rows.events == event)
        assert len(set(rows.deviations[held])) == 1
        # Alternatives of one face that differ in their reserve share events too.
        windows = set(window_of[held].tolist())
        assert max(windows) - min(windows) <= 1
        shared += len(windows) == 2
    assert shared > 0


def _avoidance_of(program):
    """Return the avoidance of each alternative."""
    return np.repeat(np.arange(program.num_avoidances), np.diff(program.avoidance_starts))


def test_feedback_adds_an_event_of_its_own_to_every_interval():
    gain = np.array([[-0.3, 0, -0.9, 0], [0, -0.3, 0, -0.9]])
    vehicle = _vehicle(gain=gain)
    wall = Obstacle.box("wall", [3, -1], [4, 1])
    program = _build(_scenario(vehicle, avoidance="intervals", obstacles=(wall,)))
    assert set(np.diff(program.alternative_starts)) == {3}
    sigma = vehicle.covariances(8)
    # Held over the step, a control of 1 m/s² moves the position by dt²/2 = 0.5 m.
    bent = np.eye(2, 4) - 0.5 * gain
    step_of = np.array([e.step for e in program.risk_items])
    avoidance = _avoidance_of(program)
    for alternative in range(program.num_alternatives):
        near, held, far = program.rows_of(alternative)
        k = program.avoidances[avoidance[alternative]].step
        events = program.rows.events[[near, held, far]]
        assert step_of[program.rows.risk_items[events]].tolist() == [k, k, k + 1]
        assert len(set(events.tolist())) == 3
        expected = [np.sqrt(c[0, 0]) for c in (sigma[k], bent @ sigma[k] @ bent.T, sigma[k + 1])]
        assert program.rows.deviations[[near, held, far]] == pytest.approx(expected, rel=1e-9)


def test_the_sagitta_of_a_turn_toward_an_obstacle_is_in_the_rows():
    scenario = _scenario(
        _vehicle(), avoidance="intervals", obstacles=(Obstacle.box("wall", [3, -1], [4, 1]),)
    )
    program = _build(scenario)
    models = condensed_models(scenario)
    rng = np.random.default_rng(0)
    z = np.zeros(program.num_columns)
    span = z.size // 2
    controls = rng.uniform(-2.0, 2.0, (8, 2))
    z[:span] = np.maximum(controls, 0.0).ravel()
    z[span:] = np.maximum(-controls, 0.0).ravel()
    means = rollout(scenario.vehicles[0].system, scenario.vehicles[0].start, controls)
    assert controls_of(models, z)[0] == pytest.approx(controls)
    wall = scenario.obstacles[0].at(0)[0]
    slacks = program.slacks(z)
    for avoidance, label in enumerate(program.avoidances):
        k = label.step
        tau = np.linspace(0.0, 1.0, 50)[:, None]
        curve = means[k, :2] + tau * means[k, 2:] + 0.5 * tau**2 * controls[k]
        clear = (curve @ wall.normals.T - wall.offsets - 0.5).min(axis=0)
        # The rows never promise more than the curve keeps.
        for alternative in program.alternatives_of(avoidance):
            rows = program.rows_of(alternative)
            places = program.rows.normals[rows[:1]].toarray()[0, : program.num_positions]
            normal = -places.reshape(-1, 2).sum(axis=0)
            face = int(np.linalg.norm(wall.normals - normal, axis=1).argmin())
            assert wall.normals[face] == pytest.approx(normal)
            assert slacks[rows].min() <= clear[face] + 1e-9


@pytest.mark.parametrize("seed", range(4))
def test_the_rows_of_a_pair_reserve_the_sagitta_of_their_relative_path(seed):
    rng = np.random.default_rng(seed)
    scenario = _scenario(
        _vehicle("a"), _vehicle("b", (0.0, 2.5), (8.0, 2.5)), avoidance="intervals"
    )
    program = _build(scenario)
    models = condensed_models(scenario)
    both = [rng.uniform(-1.0, 1.0, (8, 2)) for _ in range(2)]
    z = np.concatenate([_halves(controls) for controls in both])
    for controls, read in zip(both, controls_of(models, z), strict=True):
        assert read == pytest.approx(controls)
    means = [rollout(v.system, v.start, u) for v, u in zip(scenario.vehicles, both, strict=True)]
    relative, control = means[0] - means[1], both[0] - both[1]
    radii = sum(v.radius for v in scenario.vehicles)
    slacks = program.slacks(z)
    kept = []
    for avoidance, label in enumerate(program.avoidances):
        k = label.step
        for alternative in program.alternatives_of(avoidance):
            rows = program.rows_of(alternative)
            places = program.rows.normals[rows[:1]].toarray()[0, : program.num_positions]
            normal = -places[: program.num_positions // 2].reshape(-1, 2).sum(axis=0)
            near, far = ((relative[j, :2] @ normal) - radii for j in (k, k + 1))
            toward = 0.125 * control[k] @ normal
            if toward <= 0.0:
                # A path that bends away needs no more than its chord does.
                assert slacks[rows].min() == pytest.approx(min(near, far))
                kept.append("away")
            else:
                tau = np.linspace(0.0, 1.0, 50)
                gap = (1.0 - tau) * near + tau * far - 4.0 * tau * (1.0 - tau) * toward
                assert slacks[rows].min() <= gap.min() + 1e-9
                kept.append("toward")
    assert kept.count("away") >= 5
    assert kept.count("toward") >= 5


def test_vehicles_that_accelerate_alike_keep_formation_within_a_hand_of_contact():
    """Side by side, both turn together: their relative path is straight."""
    scenario = _scenario(
        _vehicle("a", (0.0, 0.0), (2.0, 8.0)),
        _vehicle("b", (1.3, 0.0), (3.3, 8.0)),
        avoidance="intervals",
        horizon=4,
    )
    program = _build(scenario)
    controls = np.array([[0.5, 2.0], [0.5, 2.0], [-0.5, -2.0], [-0.5, -2.0]])
    z = np.tile(_halves(controls), 2)
    slacks = program.slacks(z)
    for avoidance in range(program.num_avoidances):
        best = max(slacks[program.rows_of(a)].min() for a in program.alternatives_of(avoidance))
        assert best == pytest.approx(0.3)


def _halves(controls):
    """Return the variables of one vehicle's controls."""
    return np.concatenate([np.maximum(controls, 0.0).ravel(), np.maximum(-controls, 0.0).ravel()])


def test_a_pair_far_apart_is_settled_and_charged_at_its_bound():
    scenario = _scenario(_vehicle("a"), _vehicle("b", (0.0, 90.0), (8.0, 90.0)), avoidance="steps")
    program = _build(scenario)
    assert program.num_avoidances == 0
    assert 0.0 <= program.initial_risk <= 1e-12 * scenario.horizon


def test_risk_at_the_start_is_charged_before_anything_else():
    scenario = _scenario(_vehicle("a"), _vehicle("b", (1.2, 0.0), (0.0, 8.0)), avoidance="steps")
    program = _build(scenario)
    # 0.2 m of clearance at a deviation of sqrt(0.02).
    [(risk_item, risk)] = program.initial
    assert (risk_item.cause, risk_item.step) == ("pair", 0)
    assert risk == pytest.approx(0.0786496, rel=1e-5)
    assert program.budget < 0.0


def test_the_workspace_is_one_avoidance_per_face_with_a_single_alternative():
    scenario = _scenario(
        _vehicle(),
        avoidance="steps",
        workspace=Workspace(np.array([-1.0, -1.0]), np.array([9.0, 1.0])),
    )
    program = _build(scenario)
    assert program.num_avoidances > 0
    assert set(np.diff(program.avoidance_starts)) == {1}
    assert {e.cause for e in program.risk_items} == {"workspace"}


def test_two_goals_on_one_point_leave_an_avoidance_without_alternatives():
    scenario = _scenario(_vehicle("a"), _vehicle("b", (16.0, 0.0), (8.0, 0.0)), avoidance="steps")
    program = _build(scenario)
    hopeless = np.flatnonzero(np.diff(program.avoidance_starts) == 0)
    assert [program.avoidances[int(i)].step for i in hopeless][-1] == 8


def test_a_moving_obstacle_has_the_faces_of_both_ends_of_an_interval():
    triangle = np.array([[4.0, -1.0], [5.0, -1.0], [4.5, 1.0]])
    square = np.array([[4.0, -1.0], [5.0, -1.0], [5.0, 1.0], [4.0, 1.0]])
    drift = np.array([0.0, 0.1])
    outlines = [triangle + k * drift if k % 2 else square for k in range(9)]
    scenario = _scenario(
        _vehicle(), avoidance="intervals", obstacles=(Obstacle.moving("ferry", outlines),)
    )
    program = _build(scenario)
    sizes = np.diff(program.avoidance_starts)
    assert sizes.max() > 4


def test_a_system_without_a_continuous_model_has_no_sagitta():
    base = double_integrator(1.0, 2)
    # The control moves velocities alone: nothing tells what happens between steps.
    euler = LinearSystem(base.A, np.vstack([np.zeros((2, 2)), np.eye(2)]), (0, 1), (2, 3))
    vehicle = _vehicle()
    wall = Obstacle.box("wall", [3, -1], [4, 1])
    straight = _build(_scenario(replace(vehicle, system=euler), obstacles=(wall,)))
    curved = _build(_scenario(vehicle, obstacles=(wall,)))
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
    scenario = _scenario(
        _vehicle("a", (0.0, 0.0, 0.0), (8.0, 0.0, 0.0)),
        _vehicle("b", (8.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
        avoidance="steps",
    )
    program = _build(scenario)
    assert np.diff(program.avoidance_starts).max() == 6


def test_feedback_keeps_the_reserve_of_the_control_limit():
    gain = np.array([[-0.3, 0, -0.9, 0], [0, -0.3, 0, -0.9]])
    vehicle = _vehicle(gain=gain)
    sigma = vehicle.covariances(8)
    bounds = vehicle.control_bounds(sigma)
    expected = 2.0 - 3.0 * np.sqrt(gain[0] @ sigma[5] @ gain[0])
    assert bounds[5, 0] == pytest.approx(expected)
    program = _build(_scenario(vehicle))
    assert program.upper.max() == pytest.approx(bounds.max())


def test_the_restriction_to_some_blocks_keeps_only_what_concerns_them():
    program = _build(circle(4))
    touched = avoidance_blocks(program)
    assert touched.shape == (program.num_avoidances, 4)
    part = restrict(program, np.array([0, 2]), touched)
    names = {(e.vehicle, e.other) for e in part.program.avoidances}
    assert names == {("v1", "v3")}
    z = np.random.default_rng(0).uniform(size=program.num_columns)
    assert part.program.slacks(z[part.columns]) == pytest.approx(program.slacks(z)[part.rows])


def test_the_restriction_to_all_blocks_is_the_program_itself():
    program = _build(circle(3))
    assert restrict(program, np.arange(3)).program is program
