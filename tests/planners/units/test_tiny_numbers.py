"""Scenes whose numbers are far from one are planned in units in which they are not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import radmpc
from radmpc.model.dynamics import LinearSystem, double_integrator
from radmpc.model.noise.measurement import Measurement
from radmpc.model.noise.shared import SharedDisturbance
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.relations.keep import Keep
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.model.visits import Visit
from radmpc.planners import Branch, Certified, Optimal, Planner
from radmpc.planners.outcome.trajectories import trajectories_of
from radmpc.planners.units.choosing import other_units
from radmpc.planners.units.scenario import scenario_in_units
from rescaling import in_units

KILO = 1e-3, 1e3
"""Kilometers, and seconds that a thousand of pass where one did."""


SHORT = Planner(Optimal(), Branch(), Certified(0.0, is_persistent=False))


def craft(name: str, goal: list[float], **more: object) -> Vehicle:
    options: dict[str, object] = {
        "start": [0.0, 0.0],
        "control_limit": 0.3,
        "initial_covariance": np.diag([1e-2, 1e-2, 1e-4, 1e-4]),
        "disturbance_covariance": np.diag([4e-4] * 4),
        "speed_limit": 1.5,
    }
    return Vehicle(
        name=name,
        system=double_integrator(1.0, 2),
        goal=Goal.at(goal, 0.2),
        radius=0.3,
        **(options | more),  # type: ignore[arg-type] # keys by name
    )


def past_a_box(far: float = 7.0, **more: object) -> Scenario:
    box = Obstacle.box("box", [3, -1.2], [4, 0.4])
    return Scenario("box", 1.0, 12, 0.02, (craft("a", [far, 0.0], **more),), obstacles=(box,))


def of_all_kinds() -> Scenario:
    """A scenario of every part that has a unit."""
    gain = -np.hstack([0.2 * np.eye(2), 0.6 * np.eye(2)])
    wind = SharedDisturbance("wind", np.vstack([np.zeros((2, 2)), np.eye(2)]), 1e-4, 0.5)
    sluggish = LinearSystem(np.diag([1.0, 1.0, 0.5]), np.eye(3, 2), (0, 1), None)
    fleet = (
        craft("a", [7, 0], gain=gain, shared=(wind,), drift=[0.01, 0, 0, 0], control_norm=0.3),
        craft(
            "b", [7, 3], start=[0, 3], gain=gain, shared=(wind,), speed_norm=1.4,
            disturbance_correlation=0.3, measurement=Measurement.of([0, 1], 4, 0.01),
            via=(Visit([3, 3], [4, 4], speed=[1.0, 1.0]),),
        ),
        Vehicle("c", sluggish, [0, 6, 0], Goal([6.8, 5.8], [7.2, 6.2], None, (10, 12)), 0.3, 1.0,
                np.diag([1e-2, 1e-2, 1.0]), 1e-4),
    )  # fmt: skip
    obstacles = (
        Obstacle.box("box", [3, -1.2], [4, -0.8]),
        Obstacle.polygon(
            "basin", [[0, 8], [9, 8], [9, 9], [0, 9]], [[[1, 8.2], [2, 8.2], [2, 8.6]]]
        ),
        Obstacle.line("fence", [[-2, -3], [9, -3]]),
        Obstacle.halfspaces("plates", [[2, 0], [-2, 0], [0, 1], [0, -1]], [20, -19, 5, 0]),
        Obstacle.moving("ferry", [[[k, 7], [k + 1, 7], [k, 7.5]] for k in range(13)]),
        Obstacle.tracked("boat", [[0, 0], [0.5, 0], [0, 0.5]], [9, 1.5, -0.5, 0], 1e-3, 1e-5),
    )
    return Scenario(
        "all", 1.0, 12, 0.02, fleet, obstacles, workspace=Workspace([-5, -5], [12, 12]),
        time_weight=0.1, keep=(Keep(("a", "b"), 4.0),),
    )  # fmt: skip


def with_pushes(scenario: Scenario, factors: tuple[float, ...]) -> Plan:
    """Some plan of a scenario, whatever becomes of it."""
    ramp = np.outer(np.linspace(0.2, -0.2, scenario.horizon), [1.0, 0.1])
    controls = tuple(factor * ramp for factor in factors)
    plan = radmpc.plan(replace(past_a_box(), obstacles=())).require()
    return replace(
        plan, scenario=scenario, trajectories=trajectories_of(scenario, controls), sets=()
    )


def in_far_units(scenario: Scenario, length: float, time: float) -> Scenario:
    """The same scenario in such units, its costs in units of control."""
    odd = in_units(replace(scenario, vehicles=tuple(map(_free, scenario.vehicles))), length, time)
    return replace(odd, vehicles=tuple(replace(v, cost_weight=1.0) for v in odd.vehicles))


def _free(vehicle: Vehicle) -> Vehicle:
    """A vehicle whose weight in the cost is nothing, which stays in range in any units."""
    return replace(vehicle, cost_weight=0.0)


@pytest.mark.parametrize("scenario", [past_a_box(), past_a_box(7.39, control_limit=0.2)])
def test_a_plan_of_control_limits_below_all_tolerances_keeps_them(scenario: Scenario) -> None:
    push = KILO[0] / KILO[1] ** 2
    here, there = radmpc.plan(scenario).require(), radmpc.plan(in_far_units(scenario, *KILO)).plan
    assert there is not None
    assert radmpc.certify(there).holds
    assert there.status is here.status
    assert there.cost == pytest.approx(push * here.cost, rel=2e-3)
    assert there.certified_lower_bound == pytest.approx(push * here.certified_lower_bound, rel=5e-3)


def test_scenes_in_two_far_units_have_the_same_plan_bit_for_bit() -> None:
    far, farther = (2.0**-20, 2.0**11), (2.0**-24, 2.0**5)
    one, other = (radmpc.plan(in_far_units(past_a_box(), *u)).require() for u in (far, farther))
    scale = (farther[0] / farther[1] ** 2) / (far[0] / far[1] ** 2)
    assert other.cost == scale * one.cost
    assert other.lower_bound == scale * one.lower_bound
    assert other.sets == one.sets
    pushes = other.trajectories[0].controls
    np.testing.assert_array_equal(scale * one.trajectories[0].controls, pushes)
    assert other.risk.certified == pytest.approx(one.risk.certified, rel=1e-9)


def test_scenes_of_usual_numbers_are_planned_as_they_are() -> None:
    for units in ((1.0, 1.0), (4.0, 0.5), (100.0, 10.0)):
        assert other_units(in_units(past_a_box(), *units)) is None


def test_every_part_of_a_scenario_changes_its_unit() -> None:
    scenario = of_all_kinds()
    shifted = replace(
        scenario, vehicles=tuple(replace(v, control_limit=1e-6) for v in scenario.vehicles)
    )
    units = other_units(shifted)
    assert units is not None
    assert units.length != 1.0 or units.time != 1.0
    here = radmpc.certify(with_pushes(scenario, (1.0,) * 3))
    there = radmpc.certify(with_pushes(scenario_in_units(scenario, units), units.controls))
    assert 0.0 < here.certified < 1e3
    assert there.certified == pytest.approx(here.certified, rel=1e-9)
    assert there.saturation == pytest.approx(here.saturation, rel=1e-9)
    assert len(there.problems) == len(here.problems)


def test_what_is_told_while_planning_is_in_the_units_of_the_scenario() -> None:
    costs: list[float] = []
    plans: list[Plan] = []
    result = radmpc.plan(
        in_units(past_a_box(), *KILO),
        found=lambda cost, bound: costs.append(cost),
        improved=plans.append,
    )
    plan = result.require()
    assert min(costs) == pytest.approx(plan.cost, rel=1e-2)
    assert plans[-1].cost >= plan.cost * (1.0 - 1e-9)
    assert all(radmpc.certify(each).holds for each in plans)
    assert plan.first is not None
    assert plan.first.cost == pytest.approx(costs[0], rel=1e-9)


def test_why_there_is_no_plan_is_told_in_the_units_of_the_scenario() -> None:
    too_far = past_a_box(7.41, control_limit=0.2)
    explanation = radmpc.plan(in_units(too_far, *KILO)).explanation
    assert explanation is not None
    assert "within 12 steps (12000 s)" in explanation


def test_a_reason_found_by_search_says_in_which_units_it_is_told() -> None:
    walls = (Obstacle.box("a", [3, -9], [4, -0.33]), Obstacle.box("b", [3, 0.33], [4, 9]))
    tight = replace(past_a_box(), obstacles=walls, workspace=Workspace([-2, -9], [9, 9]))
    result = radmpc.plan(in_far_units(tight, *KILO), planner=SHORT)
    assert result.plan is None
    assert result.explanation is not None
    assert "lengths are 1024 " in result.explanation
