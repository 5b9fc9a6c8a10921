"""Scenarios and hand-made plans small enough to know every artist of their pictures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.model.dynamics import double_integrator, rollout
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan, Risk, Status, Trajectory
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Goal, Vehicle

HORIZON = 4


def make_vehicle(name: str, start: list[float], goal: list[float]) -> Vehicle:
    """A double integrator in as many dimensions as its start has."""
    d = len(start)
    return Vehicle(
        name=name,
        system=double_integrator(1.0, d),
        start=np.concatenate([start, np.zeros(d)]),
        goal=Goal(np.array(goal) - 0.2, np.array(goal) + 0.2, np.full(d, 0.05)),
        radius=0.5,
        control_limit=np.full(d, 3.0),
        initial_covariance=0.001 * np.eye(2 * d),
        disturbance_covariance=0.001 * np.eye(2 * d),
    )


def fly(vehicle: Vehicle) -> Trajectory:
    """Straight to the goal: push for two steps, brake for two."""
    push = (vehicle.goal.center - vehicle.start_position) / 4.0
    controls = np.vstack([push, push, -push, -push])
    return Trajectory(
        name=vehicle.name,
        controls=controls,
        means=rollout(vehicle.system, vehicle.start, controls),
        covariances=vehicle.covariances(HORIZON),
    )


def make_plan(scenario: Scenario, sets: tuple[tuple[str, ...], ...] = ()) -> Plan:
    """A certified plan of straight flights."""
    return Plan(
        scenario=scenario,
        planner="ira, branch, centralized",
        seed=0,
        status=Status.FEASIBLE,
        cost=12.0,
        lower_bound=None,
        risk=Risk(scenario.risk_bound, 0.0125),
        sets=sets,
        seconds={"total": 0.25},
        trajectories=tuple(fly(vehicle) for vehicle in scenario.vehicles),
    )


@pytest.fixture
def flat_scenario() -> Scenario:
    """Three vehicles, a hook, a wall and a ferry that moves."""
    hook = [[6, 2], [10, 2], [10, 6], [9, 6], [9, 3], [6, 3]]
    ferry = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    return Scenario(
        name="bay",
        dt=1.0,
        horizon=HORIZON,
        risk_bound=0.05,
        vehicles=(
            make_vehicle("a", [1.0, 1.0], [1.0, 9.0]),
            make_vehicle("b", [3.0, 9.0], [3.0, 1.0]),
            make_vehicle("c", [12.0, 8.0], [12.0, 8.0]),
        ),
        obstacles=(
            Obstacle.polygon("hook", hook),
            Obstacle.box("wall", [5.0, 8.0], [5.2, 9.0]),
            Obstacle.moving("ferry", [ferry + np.array([7 + k, 7]) for k in range(HORIZON + 1)]),
        ),
        workspace=Workspace(np.zeros(2), np.array([14.0, 10.0])),
    )


@pytest.fixture
def space_scenario() -> Scenario:
    """Two vehicles and a tower in space."""
    return Scenario(
        name="sky",
        dt=1.0,
        horizon=HORIZON,
        risk_bound=0.05,
        vehicles=(
            make_vehicle("up", [1.0, 1.0, 1.0], [5.0, 5.0, 5.0]),
            make_vehicle("down", [9.0, 9.0, 9.0], [7.0, 1.0, 1.0]),
        ),
        obstacles=(Obstacle.box("tower", [3.0, 6.0, 0.0], [4.0, 7.0, 8.0]),),
        workspace=Workspace(np.zeros(3), np.full(3, 10.0)),
    )


@pytest.fixture
def flat_plan(flat_scenario: Scenario) -> Plan:
    """A and b planned together, c alone."""
    return make_plan(flat_scenario, (("a", "b"), ("c",)))


@pytest.fixture
def space_plan(space_scenario: Scenario) -> Plan:
    """Both planned alone."""
    return make_plan(space_scenario, (("up",), ("down",)))


@pytest.fixture
def empty_plan(flat_plan: Plan) -> Plan:
    """No plan was found."""
    return replace(
        flat_plan,
        status=Status.INFEASIBLE,
        cost=None,
        risk=Risk(0.05),
        sets=(),
        trajectories=(),
        explanation="too tight",
    )
