"""What happens between steps: plans that jump through things, seen by flying the true path."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.model.dynamics import double_integrator
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planners import Centralized, Ira, Planner
from radmpc.planners.presets import PRESETS
from radmpc.planning import plan
from radmpc.referee import certify, simulate
from radmpc.solvers.branch.branch import Branch

HORIZON = 5
SAMPLES = 4_000
CENTRAL = Planner(Ira(), Branch(), Centralized())
MULTI = PRESETS["multi-vehicle"].planner


def vehicle(name: str, start: list[float], goal: list[float]) -> Vehicle:
    """A vehicle fast enough to cross 3 m in a step."""
    d = len(start)
    return Vehicle(
        name=name,
        system=double_integrator(1.0, d),
        start=np.concatenate([start, np.zeros(d)]),
        goal=Goal(np.array(goal) - 0.2, np.array(goal) + 0.2, np.full(d, 0.1)),
        radius=0.4,
        control_limit=np.full(d, 3.0),
        initial_covariance=1e-3 * np.eye(2 * d),
        disturbance_covariance=1e-3 * np.eye(2 * d),
    )


def swap() -> Scenario:
    """Two vehicles that change places."""
    return scenario(vehicle("east", [0, 0], [9, 0]), vehicle("west", [9, 0], [0, 0]))


def thin_wall() -> Scenario:
    """A wall 10 cm thick right across the way."""
    wall = Obstacle.box("wall", [4.0, -3.0], [4.1, 2.0])
    return scenario(vehicle("a", [0, 0], [9, 0]), obstacles=(wall,))


def thin_wall_in_space() -> Scenario:
    """The same with a height."""
    wall = Obstacle.box("wall", [4.0, -3.0, -3.0], [4.1, 3.0, 2.0])
    return scenario(vehicle("a", [0, 0, 0], [9, 0, 0]), obstacles=(wall,))


def fence() -> Scenario:
    """A wall without thickness."""
    wall = Obstacle.line("fence", [[4.0, -3.0], [4.0, 2.0]])
    return scenario(vehicle("a", [0, 0], [9, 0]), obstacles=(wall,))


def plate() -> Scenario:
    """The same with a height, askew."""
    wall = [[3.8, -3.0, -3.0], [4.2, 3.0, -3.0], [4.2, 3.0, 2.0], [3.8, -3.0, 2.0]]
    return scenario(
        vehicle("a", [0, 0, 0], [9, 0, 0]), obstacles=(Obstacle.polygon("plate", wall),)
    )


def sliding_gate() -> Scenario:
    """A wall without thickness that crosses the way from one step to the next."""
    sides = [2.5, 2.5, 2.5, -2.5, -2.5, -2.5]
    places = [[[4.2, side - 1.0], [4.8, side + 1.0]] for side in sides]
    return scenario(vehicle("a", [0, 0], [9, 0]), obstacles=(Obstacle.moving("gate", places),))


def moving_wall() -> Scenario:
    """A wall that comes toward the vehicle as fast as the vehicle goes."""
    outline = np.array([[0.0, -3.0], [0.1, -3.0], [0.1, 2.0], [0.0, 2.0]])
    places = [outline + np.array([9.5 - 2.0 * k, 0.0]) for k in range(HORIZON + 1)]
    return scenario(vehicle("a", [0, 0], [9, 0]), obstacles=(Obstacle.moving("gate", places),))


def crossing_ferry() -> Scenario:
    """A ferry that crosses the way from one step to the next, and is on it at none."""
    outline = np.array([[4.2, -1.0], [4.8, -1.0], [4.8, 1.0], [4.2, 1.0]])
    sides = [2.5, 2.5, 2.5, -2.5, -2.5, -2.5]
    places = [outline + np.array([0.0, side]) for side in sides]
    return scenario(vehicle("a", [0, 0], [9, 0]), obstacles=(Obstacle.moving("ferry", places),))


def scenario(*vehicles: Vehicle, **more: object) -> Scenario:
    """Five steps of a second, Δ = 0.05."""
    return Scenario("between", 1.0, HORIZON, 0.05, vehicles, **more)  # type: ignore[arg-type] # keys by name


def planned(question: Scenario, avoidance: str, planner: Planner) -> Plan:
    """The plan, certified under its own avoidance."""
    result = plan(replace(question, avoidance=avoidance), planner, rng=0)
    assert result.is_certified, result.explanation
    return result.require()


def between_steps(flown: Plan) -> Plan:
    """The same trajectories, judged along the whole path."""
    return replace(flown, scenario=replace(flown.scenario, avoidance="intervals"))


QUESTIONS = [
    pytest.param(swap, CENTRAL, id="swap-central"),
    pytest.param(swap, MULTI, id="swap-multi-vehicle"),
    pytest.param(thin_wall, CENTRAL, id="wall"),
    pytest.param(thin_wall_in_space, CENTRAL, id="wall-in-space"),
    pytest.param(fence, CENTRAL, id="fence"),
    pytest.param(plate, CENTRAL, id="plate"),
    pytest.param(sliding_gate, CENTRAL, id="sliding-gate"),
    pytest.param(moving_wall, CENTRAL, id="moving-wall"),
    pytest.param(crossing_ferry, CENTRAL, id="ferry"),
]


@pytest.mark.sampled(4)
@pytest.mark.parametrize(("question", "planner"), QUESTIONS)
def test_plans_at_steps_jump_through_what_is_in_the_way(question, planner):
    jumping = planned(question(), "steps", planner)
    assert simulate(jumping, SAMPLES, rng=1).rate_low <= 0.05
    true_path = between_steps(jumping)
    assert simulate(true_path, SAMPLES, rng=1).rate > 0.9
    assert certify(true_path).certified > 0.9


@pytest.mark.sampled(4)
@pytest.mark.parametrize(("question", "planner"), QUESTIONS)
def test_plans_along_intervals_keep_the_bound_on_the_true_path(question, planner):
    kept = planned(question(), "intervals", planner)
    assert simulate(kept, SAMPLES, rng=1).rate_low <= 0.05
    assert certify(kept).certified <= 0.05


@pytest.mark.slow
@pytest.mark.sampled(3)
@pytest.mark.parametrize(("question", "planner"), QUESTIONS)
def test_what_holds_along_intervals_holds_at_steps_and_costs_no_less(question, planner):
    kept = planned(question(), "intervals", planner)
    at_steps = replace(kept, scenario=replace(kept.scenario, avoidance="steps"))
    assert certify(at_steps).certified <= certify(kept).certified * (1.0 + 1e-6)
    jumping = planned(question(), "steps", planner)
    assert jumping.cost <= kept.cost * (1.0 + 2.0 * planner.gap)


def test_the_ferry_is_the_only_thing_in_the_way():
    # Without it the straight flight is free: what the tests above see is the ferry between steps.
    alone = replace(crossing_ferry(), obstacles=())
    assert simulate(planned(alone, "intervals", CENTRAL), SAMPLES, rng=1).collisions == 0
