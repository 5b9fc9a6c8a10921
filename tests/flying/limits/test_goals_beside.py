"""Where no plan to the goals is affordable, candidates end beside them by what effort is worth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog

from radmpc.experiments.families import paper
from radmpc.flying.leg import leg_of
from radmpc.flying.mission import Mission
from radmpc.flying.remainder import left_of
from radmpc.flying.warm.ahead import Ahead
from radmpc.flying.warm.goals import reached
from radmpc.flying.warm.kept_lp import KeptLp
from radmpc.model.dynamics import LinearSystem
from radmpc.model.goal import Goal
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle

SIGMA, STEPS = 0.05, 4


def to_a_wall() -> Scenario:
    """A vehicle without inertia whose goal is two deviations from a wall."""
    eye = np.eye(2)
    vehicle = Vehicle(
        name="v",
        system=LinearSystem(eye, eye, (0, 1), None),
        start=[0.0, 1.0],
        goal=Goal([-1e3, 0.30], [1e3, 0.32], None),
        radius=0.1,
        control_limit=1.0,
        initial_covariance=0.0,
        disturbance_covariance=SIGMA**2 * eye,
    )
    wall = Obstacle.box("wall", [-1e3, -50.0], [1e3, 0.0])
    return Scenario("wall", 1.0, STEPS, 0.0205, (vehicle,), (wall,), avoidance="steps")


def pushed_away(miss_price: float) -> tuple[Mission, np.ndarray]:
    """Return a mission after one step, and where the vehicle is then: off the wall by far."""
    scenario = to_a_wall()
    controls = np.zeros((STEPS, 2))
    controls[:2, 1] = -0.34
    plan = leg_of(scenario, [controls], 0).plan
    mission = Mission(plan, planner=None, warm=True, miss_price=miss_price)
    mission.step(None)
    return mission, np.array([0.0, 0.66 + 6.0 * SIGMA])


def test_who_cannot_afford_its_goal_comes_as_near_as_it_can() -> None:
    mission, place = pushed_away(20.0)
    tick = mission.step([place])
    assert tick.choice == "candidate"
    assert tick.price <= tick.wealth
    [end] = [path.means[-1] for path in mission.leg.plan.trajectories]
    assert 0.32 < end[1] < 0.5
    # To the goal itself it would be too dear.
    there = np.zeros((STEPS - 1, 2))
    there[0, 1] = 0.32 - place[1]
    left = left_of(to_a_wall(), 1, [place], 0.0205)
    assert leg_of(left, [there], 1).price > tick.wealth


def test_where_missing_costs_nothing_the_tail_is_flown() -> None:
    mission, place = pushed_away(0.0)
    assert mission.step([place]).choice == "tail"


@pytest.mark.parametrize("price", [0.1, 2.0, 50.0])
def test_effort_and_miss_are_the_least_there_is(price: float) -> None:
    [vehicle] = paper(1, 0).vehicles
    vehicle = replace(vehicle, goal=replace(vehicle.goal, speed=None), speed_limit=None)
    scenario = replace(paper(1, 0), vehicles=(vehicle,), obstacles=(), workspace=None, horizon=5)
    ahead, system = Ahead.of(scenario), vehicle.system
    kept = KeptLp(ahead.whole, (0,), price)
    for passed in (0, 2):
        hazards = ahead.left(passed, scenario.vehicles, [vehicle.goal])
        kept.move(hazards)
        [controls] = kept.alone()
        [wider] = reached(scenario, hazards.models, [controls]).vehicles
        off = wider.goal.upper - vehicle.goal.upper
        paid = vehicle.cost_weight * np.abs(controls).sum() + price * off.sum()
        assert paid == pytest.approx(least(scenario, 5 - passed, price), rel=1e-5)
        end = vehicle.start
        for control in controls:
            end = system.A @ end + system.B @ control
        assert wider.goal.contains(end[:2], None)


def least(scenario: Scenario, steps: int, price: float) -> float:
    """Return the least effort and price of missing, by a program of states of its own."""
    [vehicle] = scenario.vehicles
    A, B, limit = vehicle.system.A, vehicle.system.B, vehicle.control_limit
    # Columns: u⁺ and u⁻ of every step, what is missed along both axes.
    reach = np.hstack([np.linalg.matrix_power(A, steps - 1 - k) @ B for k in range(steps)])[:2]
    coasting = (np.linalg.matrix_power(A, steps) @ vehicle.start)[:2]
    count = 2 * steps
    rows = np.vstack(
        [
            np.hstack([reach, -reach, -np.eye(2)]),
            np.hstack([-reach, reach, -np.eye(2)]),
        ]
    )
    most = np.concatenate([vehicle.goal.upper - coasting, coasting - vehicle.goal.lower])
    cost = np.concatenate([np.full(2 * count, vehicle.cost_weight), np.full(2, price)])
    bounds = [(0.0, u) for u in np.tile(np.broadcast_to(limit, (steps, 2)).ravel(), 2)]
    answer = linprog(cost, A_ub=rows, b_ub=most, bounds=[*bounds, (0, None), (0, None)])
    return float(answer.fun)
