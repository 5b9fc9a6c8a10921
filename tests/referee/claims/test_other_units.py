"""The referee says the same of a plan in whatever units its numbers are."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from referee_scenes import make_plan

from radmpc.model.dynamics import double_integrator
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.model.visits import Visit
from radmpc.referee import certify, simulate
from rescaling import plan_in_units

DI = double_integrator(1.0, 2)
GAIN = -np.hstack([0.2 * np.eye(2), 0.6 * np.eye(2)])
STEPS = 8

UNITS = pytest.mark.parametrize(
    ("length", "time"),
    [
        (1e3, 1.0),
        (1e-3, 1.0),
        (1.0, 3600.0),
        (1.0, 1e-3),
        (1e-3, 1e3),
        (1e3, 1e-3),
        (1e-3, 1e-3),
    ],
)


def craft(name: str, start: list[float], goal: list[float], **more: object) -> Vehicle:
    options: dict[str, object] = {
        "system": DI,
        "radius": 0.3,
        "control_limit": [0.34, 0.33],
        "initial_covariance": np.diag([1e-2, 1e-2, 1e-4, 1e-4]),
        "disturbance_covariance": np.diag([4e-4] * 4),
        "speed_limit": [1.5, 1.5],
    }
    place = np.array([*start, 0.0, 0.0])
    return Vehicle(name=name, start=place, goal=Goal.at(goal, 0.2), **(options | more))  # type: ignore[arg-type] # keys by name


def there(way: float) -> np.ndarray:
    """Controls that go some way along the first axis and stop."""
    push = way / (0.25 * STEPS**2)
    return np.array([[push, 0.0]] * (STEPS // 2) + [[-push, 0.0]] * (STEPS // 2))


def sound(**more: object) -> Plan:
    """Two vehicles past a box, one of them with feedback that now and then asks for too much."""
    fleet = (
        craft("ann", [0, 0], [5, 0], gain=GAIN, control_sigmas=0.5, **more),
        craft("bob", [0, 3], [5, 3], via=(Visit([2, 2.9], [3, 3.1], speed=[1.3, 0.1]),)),
    )
    scenario = Scenario(
        "units",
        1.0,
        STEPS,
        0.45,
        fleet,
        obstacles=(Obstacle.box("box", [2.0, -2.0], [3.0, -0.45]),),
        workspace=Workspace([-1, -4], [6, 5]),
    )
    return make_plan(scenario, [there(5.0), there(5.0)])


@pytest.mark.parametrize("more", [{}, {"control_norm": 0.34}], ids=["axes", "norm"])
@UNITS
def test_a_certificate_states_the_same_probabilities_in_other_units(
    more: dict[str, object], length: float, time: float
) -> None:
    plan = sound(**more)
    here, other = certify(plan), certify(plan_in_units(plan, length, time))
    assert here.holds, here.problems
    assert other.holds, other.problems
    assert here.saturation > 0.1
    assert other.saturation == pytest.approx(here.saturation, rel=1e-9)
    assert other.certified == pytest.approx(here.certified, rel=1e-6)
    assert here.certified > 1e-4


@UNITS
def test_a_simulation_counts_the_same_in_other_units(length: float, time: float) -> None:
    plan = sound()
    here = simulate(plan, samples=4000, rng=1)
    other = simulate(plan_in_units(plan, length, time), samples=4000, rng=1)
    for name in ("collisions", "saturated"):
        assert getattr(here, name) > 0.0
        assert getattr(other, name) == getattr(here, name)


def feedback_aside(plan: Plan) -> Plan:
    """Without feedback limits alone count, which hold less of the control back."""
    ann, bob = plan.scenario.vehicles
    scenario = replace(plan.scenario, vehicles=(replace(ann, gain=None), bob))
    return make_plan(scenario, [t.controls for t in plan.trajectories])


def moved(plan: Plan, number: int, **arrays: np.ndarray) -> Plan:
    paths = list(plan.trajectories)
    paths[number] = replace(paths[number], **arrays)
    return replace(plan, trajectories=tuple(paths))


def with_limits(plan: Plan, number: int, **more: object) -> Plan:
    vehicles = list(plan.scenario.vehicles)
    vehicles[number] = replace(vehicles[number], **more)
    return replace(plan, scenario=replace(plan.scenario, vehicles=tuple(vehicles)))


def pushing_too_hard(plan: Plan) -> Plan:
    plan = feedback_aside(plan)
    return with_limits(plan, 0, control_limit=[0.31, 0.33])


def pushing_too_hard_with_feedback(plan: Plan) -> Plan:
    return with_limits(plan, 0, control_sigmas=3.0)


def beyond_the_norm(plan: Plan) -> Plan:
    return with_limits(plan, 1, control_norm=0.31)


def too_fast(plan: Plan) -> Plan:
    return with_limits(plan, 0, speed_limit=[1.2, 1.2])


def beyond_the_norm_of_speed(plan: Plan) -> Plan:
    return with_limits(plan, 1, speed_norm=1.24)


def beside_the_goal(plan: Plan) -> Plan:
    return with_limits(plan, 1, goal=Goal([5.003, 2.9], [5.1, 3.1], [0.1, 0.1]))


def too_fast_at_the_goal(plan: Plan) -> Plan:
    ann, bob = plan.scenario.vehicles
    last = np.array(plan.trajectories[1].controls)
    last[-1, 0] += 3e-3
    bob = replace(bob, goal=Goal.at([5, 3], 0.2, 1e-3))
    scenario = replace(plan.scenario, vehicles=(ann, bob))
    return make_plan(scenario, [plan.trajectories[0].controls, last])


def beside_a_visit(plan: Plan) -> Plan:
    return with_limits(plan, 1, via=(Visit([2, 3.003], [3, 3.1]),))


def too_fast_for_a_visit(plan: Plan) -> Plan:
    return with_limits(plan, 1, via=(Visit([2, 2.9], [3, 3.1], speed=[1.24, 0.1]),))


def late(plan: Plan) -> Plan:
    goal = Goal([4.93, 2.9], [5.1, 3.1], [1.0, 1.0], within=(2, STEPS - 1))
    plan = replace(plan, scenario=replace(plan.scenario, time_weight=0.1))
    return with_limits(plan, 1, goal=goal)


def another_mean(plan: Plan) -> Plan:
    means = np.array(plan.trajectories[0].means)
    means[3, 0] += 3e-3
    return moved(plan, 0, means=means)


def another_speed(plan: Plan) -> Plan:
    means = np.array(plan.trajectories[0].means)
    means[3, 2] += 3e-3
    return moved(plan, 0, means=means)


def another_covariance(plan: Plan) -> Plan:
    return moved(plan, 0, covariances=1.01 * plan.trajectories[0].covariances)


def no_covariance(plan: Plan) -> Plan:
    return moved(plan, 1, covariances=0.0 * plan.trajectories[1].covariances)


def another_gain(plan: Plan) -> Plan:
    return moved(plan, 0, gain=1.01 * GAIN)


def another_cost(plan: Plan) -> Plan:
    return replace(plan, cost=1.01 * (plan.cost or 0.0))


FAULTS: list[Callable[[Plan], Plan]] = [
    pushing_too_hard,
    pushing_too_hard_with_feedback,
    beyond_the_norm,
    too_fast,
    beyond_the_norm_of_speed,
    beside_the_goal,
    too_fast_at_the_goal,
    beside_a_visit,
    too_fast_for_a_visit,
    late,
    another_mean,
    another_speed,
    another_covariance,
    no_covariance,
    another_gain,
    another_cost,
]


@pytest.mark.sampled(24)
@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.__name__)
@UNITS
def test_what_is_wrong_with_a_plan_is_wrong_in_other_units(
    fault: Callable[[Plan], Plan], length: float, time: float
) -> None:
    plan = fault(sound())
    here = certify(plan).problems
    assert here
    other = certify(plan_in_units(plan, length, time)).problems
    assert [problem.split(":")[0] for problem in other] == [p.split(":")[0] for p in here]


@UNITS
def test_vehicles_that_touch_as_they_part_count_the_same_in_other_units(
    length: float, time: float
) -> None:
    apart = {"initial_covariance": np.zeros((4, 4)), "control_limit": [1.0, 1.0]}
    fleet = (
        craft("ann", [0, 0], [5, 0], **apart),
        craft("bob", [0.55, 0], [5, 3], **(apart | {"radius": 0.2499})),
    )
    scenario = Scenario("parting", 1.0, 2, 0.45, fleet)
    plan = make_plan(scenario, [np.zeros((2, 2)), np.array([[1.0, 0.3], [0.0, 0.0]])])
    here = simulate(plan, samples=4000, rng=1)
    other = simulate(plan_in_units(plan, length, time), samples=4000, rng=1)
    assert 0 < here.collisions < 4000
    # Contact has a tolerance of a nanometer, in whatever units.
    assert other.collisions == pytest.approx(here.collisions, rel=0.01)


FAR = np.array([1e6, -1e6])


def placed(place: np.ndarray) -> Plan:
    """A plan with some millimeters of noise and of room beside a box, somewhere."""
    plan = sound()
    shift = np.concatenate([place, np.zeros(2)])
    vehicles = tuple(
        replace(
            v,
            start=v.start + shift,
            goal=replace(v.goal, lower=v.goal.lower + place, upper=v.goal.upper + place),
            initial_covariance=1e-4 * v.initial_covariance,
            disturbance_covariance=1e-4 * v.disturbance_covariance,
            via=tuple(Visit(x.lower + place, x.upper + place, speed=x.speed) for x in v.via),
        )
        for v in plan.scenario.vehicles
    )
    corners = np.array([[2.0, -2.0], [3.0, -0.3012]]) + place
    scenario = replace(
        plan.scenario,
        vehicles=vehicles,
        obstacles=(Obstacle.box("box", *corners),),
        workspace=Workspace(place - 5.0, place + 7.0),
    )
    return make_plan(scenario, [t.controls for t in plan.trajectories])


def test_a_certificate_a_thousand_kilometers_away_is_the_same_at_millimeters_of_noise() -> None:
    here, there = certify(placed(np.zeros(2))), certify(placed(FAR))
    assert here.problems == there.problems == ()
    assert 1e-3 < here.certified < 0.45
    assert there.certified == pytest.approx(here.certified, rel=1e-5)


@pytest.mark.parametrize("miss", [1e-3, 0.9])
def test_a_mean_that_is_off_is_told_a_thousand_kilometers_away(miss: float) -> None:
    plan = placed(FAR)
    means = np.array(plan.trajectories[1].means)
    means[4, 0] += miss
    (problem,) = certify(moved(plan, 1, means=means)).problems
    assert problem.startswith("vehicle 'bob': mean [0] at step 4 is stated as ")
