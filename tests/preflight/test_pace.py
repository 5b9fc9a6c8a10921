from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog

from radmpc import Goal, LinearSystem, Vehicle, double_integrator
from radmpc.preflight.pace import Pace

DT = 0.7


def drifter(rng: np.random.Generator, dimension: int = 2) -> Vehicle:
    """A vehicle under way, with limits on some of what can be limited."""
    d = dimension
    return Vehicle(
        name="drifter",
        system=double_integrator(DT, d),
        start=np.concatenate([rng.uniform(-8, 8, d), rng.uniform(-2, 2, d)]),
        goal=Goal.at(rng.uniform(-8, 8, d), rng.uniform(0, 1, d), rng.choice([None, 0.0, 0.5])),
        radius=0.5,
        control_limit=rng.uniform(0.3, 2.0, d),
        initial_covariance=np.zeros((2 * d, 2 * d)),
        disturbance_covariance=np.zeros((2 * d, 2 * d)),
        speed_limit=None if rng.random() < 0.4 else rng.uniform(0.5, 3.0, d),
    )


def least_effort(vehicle: Vehicle, bounds: np.ndarray) -> float:
    """Least sum of absolute controls to the goal, by another solver; inf if none leads there."""
    horizon, m = bounds.shape
    system, goal = vehicle.system, vehicle.goal
    d = system.dimension
    reply = [np.zeros((2 * d, horizon * m))]
    free = [vehicle.start]
    for k in range(horizon):
        further = system.A @ reply[-1]
        further[:, k * m : (k + 1) * m] += system.B
        reply.append(further)
        free.append(system.A @ free[-1])
    rows, most = [], []

    def between(row: np.ndarray, offset: np.ndarray, low: np.ndarray, high: np.ndarray) -> None:
        rows.extend([row, -row])
        most.extend([high - offset, offset - low])

    between(reply[-1][:d], free[-1][:d], goal.lower, goal.upper)
    for k in range(1, horizon + 1):
        limit = np.full(d, np.inf) if vehicle.speed_limit is None else vehicle.speed_limit
        if k == horizon and goal.speed is not None:
            limit = np.minimum(limit, goal.speed)
        if np.all(np.isfinite(limit)):
            between(reply[k][d:], free[k][d:], -limit, limit)
    A, b = np.vstack(rows), np.concatenate(most)
    answer = linprog(
        np.ones(2 * horizon * m),
        A_ub=np.hstack([A, -A]),
        b_ub=b + 1e-9,
        bounds=[(0.0, high) for high in np.tile(bounds.ravel(), 2)],
    )
    return float(answer.fun) if answer.status == 0 else np.inf


@pytest.mark.parametrize("seed", range(12))
def test_a_goal_is_in_reach_when_a_linear_program_says_so_and_costs_as_much(seed: int) -> None:
    rng = np.random.default_rng(seed)
    vehicle = drifter(rng, dimension=2 + seed % 2)
    pace = Pace.of(vehicle)
    assert pace is not None
    for horizon in (1, 2, 5, 9, 14):
        # Feedback keeps back another share at every step.
        bounds = vehicle.control_limit * rng.uniform(0.2, 1.0, (horizon, len(pace.controls)))
        effort = least_effort(vehicle, bounds)
        assert pace.arrives(bounds) == np.isfinite(effort)
        controls = pace.cheapest(bounds)
        if controls is None:
            assert not np.isfinite(effort)
        else:
            assert np.abs(controls).sum() == pytest.approx(effort, abs=1e-5)
            assert np.all(np.abs(controls) <= bounds + 1e-9)


def test_some_seed_arrives_and_some_does_not() -> None:
    answers = set()
    for seed in range(12):
        pace = Pace.of(drifter(np.random.default_rng(seed)))
        assert pace is not None
        answers |= {pace.arrives(np.tile(pace.vehicle.control_limit, (k, 1))) for k in (1, 14)}
    assert answers == {True, False}


def test_every_mean_on_the_way_is_in_the_boxes_of_its_reach() -> None:
    rng = np.random.default_rng(5)
    seen = 0
    for _ in range(40):
        pace = Pace.of(drifter(rng))
        assert pace is not None
        bounds = np.tile(pace.vehicle.control_limit, (9, 1))
        controls = pace.cheapest(bounds)
        if controls is None:
            continue
        seen += 1
        system = pace.vehicle.system
        state, lower_upper = pace.vehicle.start, pace.reach(bounds)
        for k in range(10):
            assert np.all(state[:2] >= lower_upper[0][k] - 1e-6)
            assert np.all(state[:2] <= lower_upper[1][k] + 1e-6)
            if k < 9:
                state = system.A @ state + system.B @ controls[k]
    assert seen >= 5


def test_axes_that_share_a_control_have_no_closed_form() -> None:
    vehicle = drifter(np.random.default_rng(0))
    turned = np.array([[0.8, 0.6], [-0.6, 0.8]])
    shared = LinearSystem(
        vehicle.system.A, vehicle.system.B @ turned, (0, 1), (2, 3), is_double_integrator=True
    )
    assert Pace.of(replace(vehicle, system=shared)) is None
    single = LinearSystem(np.eye(2), DT * np.eye(2), (0, 1), None)
    assert (
        Pace.of(Vehicle("s", single, [0, 0], Goal.at([1, 1], speed=None), 0.5, 1.0, 0.0, 0.0))
        is None
    )


def test_states_and_controls_in_another_order_are_no_slower() -> None:
    vehicle = drifter(np.random.default_rng(3))
    order = [2, 3, 0, 1]
    system = LinearSystem(
        vehicle.system.A[np.ix_(order, order)], -vehicle.system.B[order][:, ::-1], (2, 3), (0, 1)
    )
    same = replace(
        vehicle,
        system=system,
        start=vehicle.start[order],
        control_limit=vehicle.control_limit[::-1],
    )
    one, other = Pace.of(vehicle), Pace.of(same)
    assert one is not None
    assert other is not None
    for horizon in range(1, 20):
        bounds = np.tile(vehicle.control_limit, (horizon, 1))
        assert one.arrives(bounds) == other.arrives(bounds[:, ::-1])
