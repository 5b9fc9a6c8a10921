"""What a drift does to the program: where vehicles get, and what plans there are."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog

import radmpc
from radmpc.model.dynamics import double_integrator, rollout
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.program.build import build_program, condensed_models, controls_of

NOISE = [1e-3, 1e-3, 1e-4, 1e-4]


def vehicle(name="a", start=(0.0, 0.0), goal=(8.0, 0.0), **more):
    return Vehicle(
        name=name,
        **{
            "system": double_integrator(1.0, 2),
            "start": start,
            "goal": Goal(np.array(goal) - 0.2, np.array(goal) + 0.2, np.full(2, 0.05)),
            "radius": 0.4,
            "control_limit": 1.0,
            "speed_limit": 3.0,
            "initial_covariance": NOISE,
            "disturbance_covariance": NOISE,
            **more,
        },
    )


def scenario(*vehicles, **more):
    options = {"name": "s", "dt": 1.0, "horizon": 8, "risk_bound": 0.05, **more}
    return Scenario(vehicles=vehicles, **options)


CURRENT = [0.3, -0.2, 0.0, 0.0]
WIND = [0.05, -0.1, 0.1, -0.05]


def test_outputs_are_the_mean_positions_under_drift():
    craft = vehicle(drift=WIND)
    models = condensed_models(scenario(craft))
    program = build_program(scenario(craft), models, risk_bound=0.05)
    z = np.random.default_rng(0).uniform(program.lower, program.upper)
    outputs = program.outputs @ z + program.constant
    means = rollout(craft.system, craft.start, controls_of(models, z)[0], craft.drift)
    assert outputs[: 2 * 9] == pytest.approx(means[:, :2].ravel(), abs=1e-9)
    assert not np.allclose(means, rollout(craft.system, craft.start, controls_of(models, z)[0]))


def extremes(craft, k, axis, horizon=8):
    """Return how far below and above one axis is at a step, by linear programs."""
    system, place = craft.system, [axis, axis + 2]
    A, B = system.A[np.ix_(place, place)], system.B[place, axis]
    drift = np.zeros(2) if craft.drift is None else craft.drift[place]
    free, reply = [craft.start[place]], [np.zeros((2, horizon))]
    for step in range(horizon):
        free.append(A @ free[-1] + drift)
        reply.append(A @ reply[-1] + np.outer(B, np.eye(horizon)[step]))
    goal, arrival = craft.goal, np.minimum(craft.goal.speed, craft.speed_limit)[axis]
    rows = [r[1] for r in reply[1:]] + [reply[-1][0], reply[-1][1]]
    off = [f[1] for f in free[1:]] + [free[-1][0], free[-1][1]]
    high = [craft.speed_limit[axis]] * horizon + [goal.upper[axis], arrival]
    low = [-craft.speed_limit[axis]] * horizon + [goal.lower[axis], -arrival]
    held = np.vstack([rows, np.negative(rows)])
    most = np.concatenate([np.subtract(high, off), np.subtract(off, low)])
    ends = []
    for sign in (1.0, -1.0):
        limits = (-craft.control_limit[axis], craft.control_limit[axis])
        found = linprog(sign * reply[k][0], A_ub=held, b_ub=most, bounds=limits)
        assert found.status == 0
        ends.append(free[k][0] + sign * found.fun)
    return ends


@pytest.mark.sampled(6)
@pytest.mark.parametrize("drift", [None, CURRENT, WIND, np.negative(WIND)])
@pytest.mark.parametrize("speed", [3.0, 1.2])
@pytest.mark.parametrize("start", [(0.0, 0.0), (0.0, 0.0, 0.4, -0.5)])
def test_no_admissible_control_leaves_the_reachable_box_and_some_touch_it(drift, speed, start):
    craft = vehicle(start=start, goal=(6.0, -1.0), drift=drift, speed_limit=speed)
    fleet = scenario(craft)
    model = condensed_models(fleet)[0]
    touched = 0
    for k in range(1, 9):
        for axis in (0, 1):
            low, high = extremes(craft, k, axis)
            assert model.reach_lower[k, axis] <= low + 1e-6
            assert high - 1e-6 <= model.reach_upper[k, axis]
            touched += high > model.reach_upper[k, axis] - 1e-6
    assert touched >= 4


def test_a_current_pays_the_way_and_a_plan_against_it_pays_more():
    costs = [
        radmpc.plan(scenario(vehicle(drift=drift))).require().cost
        for drift in ([0.4, 0.0, 0.0, 0.0], None, [-0.4, 0.0, 0.0, 0.0])
    ]
    assert costs[0] < costs[1] < costs[2]
