"""Vehicles that would reach their goals without any effort if nothing were in their way."""

from __future__ import annotations

import pytest

from radmpc.model.dynamics import double_integrator
from radmpc.model.goal import Goal
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.planning import plan

BOX = Obstacle.box("box", [4.0, -1.0], [6.0, 1.0])
SWEEPS = Obstacle.moving(
    "sweeps",
    [[[x - 6.0, -0.5], [x - 5.0, -0.5], [x - 5.0, 0.5], [x - 6.0, 0.5]] for x in range(11)],
)


def coasts(**more: object) -> Vehicle:
    """Return a vehicle that coasts to its goal through the box."""
    goal = Goal.at([10.0, 0.0], half_width=0.3, speed=None)
    return moved([0.0, 0.0, 1.0, 0.0], goal, **more)


def moved(start: list[float], goal: Goal, **more: object) -> Vehicle:
    """Return a vehicle."""
    noise = {"initial_covariance": 1e-3, "disturbance_covariance": 1e-3}
    made = {"system": double_integrator(1.0, 2), "radius": 0.3, "control_limit": 2.0} | noise
    return Vehicle(name="v", start=start, goal=goal, **(made | more))


@pytest.mark.sampled(2)
@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
@pytest.mark.parametrize(
    ("vehicle", "obstacle"),
    [
        (coasts(), BOX),
        (coasts(cost_weight=0.0), BOX),
        (moved([0.0, 0.0], Goal.at([10.0, 0.0], half_width=0.3), drift=[1.0, 0.0, 0.0, 0.0]), BOX),
        (moved([0.0, 0.0], Goal.at([0.0, 0.0], half_width=0.3)), SWEEPS),
    ],
    ids=["coasts", "pays nothing", "drifts", "hovers"],
)
def test_who_needs_no_effort_but_for_an_obstacle_is_planned_around_it(
    vehicle: Vehicle, obstacle: Obstacle, avoidance: str
) -> None:
    scenario = Scenario(
        name="s",
        dt=1.0,
        horizon=10,
        risk_bound=0.01,
        avoidance=avoidance,
        vehicles=[vehicle],
        obstacles=[obstacle],
    )
    result = plan(scenario, "certified")
    assert result.is_certified
    assert result.cost is not None
    assert (result.cost > 0.0) == (vehicle.cost_weight > 0.0)
