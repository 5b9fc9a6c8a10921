"""Obstacles without thickness: planned around, certified, flown."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from radmpc.importing.formats import import_scenario
from radmpc.model.dynamics import double_integrator
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planning import plan
from radmpc.referee import certify, simulate
from running import first_plan

HORIZON = 8
SAMPLES = 20_000
WALL = np.array([[0.0, -1.5], [0.0, 1.0]])
PLATE = [[5, -1, -1.5], [5, 1.5, -1.5], [5, 1.5, 3], [5, -1, 3]]


def spun(angle: float) -> np.ndarray:
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return np.asarray(WALL @ turn + np.array([5.0, 0.2]))


OBSTACLES = {
    "two corners": Obstacle.polygon("wall", [[5, -1.5], [5, 1]]),
    "corners on a line": Obstacle.polygon("wall", [[4, -1.5], [5, -0.25], [6, 1]]),
    "a flat box": Obstacle.box("wall", [5, -1.5], [5, 1]),
    "half-spaces": Obstacle.halfspaces("wall", [[1, 0], [-1, 0], [0, 1], [0, -1]], [5, -5, 1, 1.5]),
    "a line": Obstacle.line("wall", [[4, -2], [5.5, 0], [4, 1.5]]),
    "a post": Obstacle.polygon("wall", [[5, 0.1]]),
    "a moving wall": Obstacle.moving(
        "wall", [WALL + np.array([5, 0.1 * k]) for k in range(HORIZON + 1)]
    ),
    "a turning wall": Obstacle.moving("wall", [spun(0.2 * k) for k in range(HORIZON + 1)]),
    "a growing wall": Obstacle.moving(
        "wall", [(1 + 0.05 * k) * WALL + np.array([5, 0]) for k in range(HORIZON + 1)]
    ),
    "a plate": Obstacle.polygon("wall", PLATE),
    "a flat box in space": Obstacle.box("wall", [5, -1, -1.5], [5, 1.5, 3]),
    "a wire": Obstacle.line("wall", [[5, -2, 0.2], [5, 2, 0.1], [5, 2, 5]]),
    "a point in space": Obstacle.polygon("wall", [[5, 0, 0.1]]),
}


def scene(obstacle: Obstacle, avoidance: str) -> Scenario:
    """A vehicle whose straight way leads through the obstacle."""
    d = obstacle.dimension
    east = np.eye(d)[0]
    vehicle = Vehicle(
        name="a",
        system=double_integrator(1.0, d),
        start=np.zeros(2 * d),
        goal=Goal.at(10.0 * east, 0.3),
        radius=0.3,
        control_limit=np.full(d, 1.5),
        initial_covariance=np.zeros((2 * d, 2 * d)),
        disturbance_covariance=np.diag([3e-3] * d + [0.0] * d),
    )
    return Scenario(
        name="walls", dt=1.0, horizon=HORIZON, risk_bound=0.02, avoidance=avoidance,
        vehicles=(vehicle,), obstacles=(obstacle,),
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
@pytest.mark.parametrize("kind", OBSTACLES)
def test_what_has_no_thickness_is_planned_around(kind: str, avoidance: str) -> None:
    found = plan(scene(OBSTACLES[kind], avoidance), time_limit=20.0)
    assert found.is_certified
    certified = certify(found.record).certified
    assert certified <= 0.02
    flown = simulate(found.record, SAMPLES, rng=1)
    # In the plane, at steps, the certificate is nearly what happens: four deviations of a share.
    assert flown.rate <= certified + 4.0 * np.sqrt(certified / SAMPLES)
    # The straight way leads through: whoever keeps all of the bound runs some of it.
    assert flown.obstacle_rate > 0.0


@pytest.mark.slow
def test_a_published_problem_with_plates_is_planned_and_holds() -> None:
    folder = Path(__file__).parent.parent.parent / "instances" / "s2m2"
    scenario = import_scenario(folder / "mit.yaml").scenario
    assert [len(o.at(0)[0].vertices) for o in scenario.obstacles] == [4, 4]
    found = first_plan(scenario, time_limit=60.0)
    assert found.is_certified
    assert simulate(found.record, 4_000, rng=1).rate_low <= found.record.risk.certified
