"""The program says what the scenario means."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_programs import built, mover, scene_of

from radmpc.experiments.families import paper
from radmpc.model.dynamics import covariances, rollout
from radmpc.model.obstacle import Obstacle
from radmpc.program.build import condensed_models, controls_of
from radmpc.solvers.lp.outcome import LpOutcome
from radmpc.solvers.lp.warm_lp import WarmLp
from sampling import examples


def _random_point(program, rng):
    return rng.uniform(program.lower, program.upper)


@settings(max_examples=examples(25), deadline=None)
@given(seed=st.integers(0, 10**6))
def test_outputs_are_the_mean_positions_of_the_rollout(seed):
    scenario = paper(2, 3)
    models = condensed_models(scenario)
    program = built(scenario)
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
    program = built(scenario)
    rng = np.random.default_rng(seed)
    cost = rng.normal(size=program.num_columns)
    lp = WarmLp(replace(program, cost=cost), np.zeros(program.rows.count))
    outcome, _ = lp.solve()
    assert outcome is LpOutcome.OPTIMAL
    outputs = program.outputs @ lp.point() + program.constant
    assert np.all(outputs >= program.output_lower - 1e-6)
    assert np.all(outputs <= program.output_upper + 1e-6)


def test_a_face_row_is_the_obstacle_moved_out_by_the_radius():
    scenario = scene_of(
        mover(), avoidance="steps", obstacles=(Obstacle.box("wall", [3, -1], [4, 1]),)
    )
    program = built(scenario)
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
    scenario = scene_of(
        mover(), avoidance="intervals", obstacles=(Obstacle.box("wall", [3, -1], [4, 1]),)
    )
    program = built(scenario)
    assert set(np.diff(program.alternative_starts)) == {2}
    for alternative in range(program.num_alternatives):
        first, second = program.rows_of(alternative)
        steps = [
            program.risk_items[program.rows.risk_items[program.rows.events[r]]].step
            for r in (first, second)
        ]
        assert steps[1] == steps[0] + 1


def test_neighboring_intervals_share_the_event_of_a_face_at_their_common_step():
    scenario = scene_of(
        mover(), avoidance="intervals", obstacles=(Obstacle.box("wall", [3, -1], [4, 1]),)
    )
    program = built(scenario)
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
    vehicle = mover(gain=gain)
    wall = Obstacle.box("wall", [3, -1], [4, 1])
    program = built(scene_of(vehicle, avoidance="intervals", obstacles=(wall,)))
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
    scenario = scene_of(
        mover(), avoidance="intervals", obstacles=(Obstacle.box("wall", [3, -1], [4, 1]),)
    )
    program = built(scenario)
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
    scenario = scene_of(mover("a"), mover("b", (0.0, 2.5), (8.0, 2.5)), avoidance="intervals")
    program = built(scenario)
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
    scenario = scene_of(
        mover("a", (0.0, 0.0), (2.0, 8.0)),
        mover("b", (1.3, 0.0), (3.3, 8.0)),
        avoidance="intervals",
        horizon=4,
    )
    program = built(scenario)
    controls = np.array([[0.5, 2.0], [0.5, 2.0], [-0.5, -2.0], [-0.5, -2.0]])
    z = np.tile(_halves(controls), 2)
    slacks = program.slacks(z)
    for avoidance in range(program.num_avoidances):
        best = max(slacks[program.rows_of(a)].min() for a in program.alternatives_of(avoidance))
        assert best == pytest.approx(0.3)


def _halves(controls):
    """Return the variables of one vehicle's controls."""
    return np.concatenate([np.maximum(controls, 0.0).ravel(), np.maximum(-controls, 0.0).ravel()])
