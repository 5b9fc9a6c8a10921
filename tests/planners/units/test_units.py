"""Scenes in other units are planned alike: the same answers, costs and probabilities."""

from __future__ import annotations

import functools

import numpy as np
import pytest

import radmpc
from radmpc.model.dynamics import double_integrator
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.model.visits import Visit
from radmpc.result import Result
from rescaling import in_units

UNITS = pytest.mark.parametrize(
    ("length", "time"), [(1e3, 1.0), (1e-3, 1.0), (1.0, 3600.0), (1.0, 1e-3), (1e-3, 1.0 / 3600.0)]
)

GAIN = -np.hstack([0.2 * np.eye(2), 0.6 * np.eye(2)])


def craft(name: str, start: list[float], goal: Goal, **more: object) -> Vehicle:
    options: dict[str, object] = {
        "control_limit": [0.35, 0.35],
        "initial_covariance": np.diag([1e-2, 1e-2, 1e-4, 1e-4]),
        "disturbance_covariance": np.diag([4e-4] * 4),
        "speed_limit": [1.5, 1.5],
        "control_sigmas": 2.0,
    }
    return Vehicle(
        name=name,
        system=double_integrator(1.0, 2),
        start=np.array([*start, 0.0, 0.0]),
        goal=goal,
        radius=0.3,
        **(options | more),  # type: ignore[arg-type] # keys by name
    )


def around_a_box() -> Scenario:
    fleet = (
        craft("a", [0, 0], Goal.at([7, 0], 0.2), gain=GAIN),
        craft("b", [7, 1.5], Goal.at([0, 1.5], 0.2), via=(Visit([3, 2.5], [4, 3.5]),)),
    )
    box = Obstacle.box("box", [3, -1.2], [4, 0.4])
    room = Workspace([-2, -5], [9, 6])
    return Scenario("box", 1.0, 12, 0.02, fleet, obstacles=(box,), workspace=room)


def through_a_gap(width: float) -> Scenario:
    still = np.zeros((4, 4))
    exact = {"initial_covariance": still, "disturbance_covariance": still}
    walls = (
        Obstacle.box("low", [3, -9], [4, -0.5 * width]),
        Obstacle.box("high", [3, 0.5 * width], [4, 9]),
    )
    room = Workspace([-2, -5], [9, 5])
    fleet = (craft("a", [0, 0], Goal.at([7, 0], 0.2), **exact),)
    return Scenario("gap", 1.0, 12, 0.02, fleet, obstacles=walls, workspace=room)


def as_far_as_it_gets(share: float) -> Scenario:
    far = share * 0.2 * 36.0
    goal = Goal.at([far + 0.2, 0.0], 0.2)
    return Scenario("far", 1.0, 12, 0.02, (craft("a", [0, 0], goal, control_limit=[0.2, 0.2]),))


@functools.cache
def in_own_units(scenario: Scenario) -> Result:
    """The answer, which is frozen, for all other units to be held against."""
    return radmpc.plan(scenario)


@pytest.mark.sampled(2)
@UNITS
@pytest.mark.parametrize(
    "scenario",
    [around_a_box(), through_a_gap(0.602), as_far_as_it_gets(0.999)],
    ids=lambda scenario: scenario.name,
)
def test_a_plan_costs_and_risks_the_same_in_other_units(
    scenario: Scenario, length: float, time: float
) -> None:
    here, there = in_own_units(scenario).plan, radmpc.plan(in_units(scenario, length, time)).plan
    assert here is not None
    assert there is not None
    assert there.status is here.status
    assert there.cost == pytest.approx(here.cost, rel=2e-3)
    assert there.certified_lower_bound == pytest.approx(here.certified_lower_bound, rel=1e-2)
    assert there.risk.saturation == pytest.approx(here.risk.saturation, rel=1e-6)
    assert radmpc.certify(there).holds


@UNITS
@pytest.mark.parametrize(
    "scenario", [through_a_gap(0.599), as_far_as_it_gets(1.001)], ids=lambda scenario: scenario.name
)
def test_what_cannot_be_planned_cannot_in_other_units(
    scenario: Scenario, length: float, time: float
) -> None:
    here, there = in_own_units(scenario), radmpc.plan(in_units(scenario, length, time))
    assert here.plan is None
    assert there.plan is None
    assert there.status is here.status
