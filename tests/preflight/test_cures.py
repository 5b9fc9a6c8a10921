"""What a check advises cures what it warns of."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from scenes_checked import of_scene, warned, warned_in

import radmpc
from radmpc import Scenario, Vehicle
from radmpc.planners.cures.variants import with_noise
from radmpc.preflight.outlook import outlook_of


def number(text: str, before: str) -> float:
    """The number that follows some words."""
    found = re.search(re.escape(before) + r" ?([0-9.e+-]*[0-9])", text)
    assert found is not None, text
    return float(found[1])


def with_vehicle(scenario: Scenario, **changes: object) -> Scenario:
    (vehicle,) = scenario.vehicles
    return replace(scenario, vehicles=(replace(vehicle, **changes),))  # type: ignore[arg-type] # fields by name


def alone(**more: object) -> Scenario:
    """A vehicle that is late with its limits, alone."""
    vehicle = Vehicle(
        **{
            "name": "a",
            "system": radmpc.double_integrator(1.0, 2),
            "start": [0.0, 0.0],
            "goal": radmpc.Goal.at([30.0, 0.0], 0.5),
            "radius": 0.5,
            "control_limit": 1.0,
            "speed_limit": 20.0,
            "initial_covariance": 1e-4,
            "disturbance_covariance": 1e-4,
        }
        | more,  # type: ignore[arg-type] # fields by name
    )
    return Scenario("late", 1.0, 9, 0.05, [vehicle])


def regulated(vehicle: Vehicle, weight: float) -> Vehicle:
    n, m = vehicle.system.num_states, vehicle.system.num_controls
    return replace(vehicle, gain=radmpc.lqr_gain(vehicle.system, np.eye(n), weight * np.eye(m)))


def test_every_cure_of_a_gain_that_eats_the_control_cures_it() -> None:
    scenario = of_scene("soft-gain-is-the-cure")
    (concern,) = warned(scenario, "control")
    limit = number(concern.text, "raise control_limit to")
    assert warned(with_vehicle(scenario, control_limit=limit), "control") == []
    assert warned(with_vehicle(scenario, control_limit=0.98 * limit), "control") != []
    softer = regulated(scenario.vehicles[0], number(concern.text, "R ="))
    assert warned(replace(scenario, vehicles=(softer,)), "control") == []
    factor = number(concern.text, "reduce the noise to")
    vehicle = scenario.vehicles[0]
    quiet = {
        "initial_covariance": factor**2 * vehicle.initial_covariance,
        "disturbance_covariance": factor**2 * vehicle.disturbance_covariance,
    }
    assert warned(with_vehicle(scenario, **quiet), "control") == []


def test_every_cure_of_a_saturating_gain_cures_it() -> None:
    scenario = of_scene("saturates")
    (concern,) = warned(scenario, "saturation")
    cures = {
        "control_sigmas": "raise control_sigmas to",
        "control_limit": "raise control_limit to",
    }
    told = {key: words for key, words in cures.items() if words in concern.text}
    for key, words in told.items():
        assert (
            warned(with_vehicle(scenario, **{key: number(concern.text, words)}), "saturation") == []
        )
    if "R =" in concern.text:
        softer = regulated(scenario.vehicles[0], number(concern.text, "R ="))
        assert warned(replace(scenario, vehicles=(softer,)), "saturation") == []
    else:
        assert told


def test_a_limit_is_named_only_where_raising_it_alone_is_enough() -> None:
    scenario = alone()
    (concern,) = warned(scenario, "time")
    assert concern.is_fatal
    assert "speed_limit" not in concern.text  # it never gets that fast
    limit = number(concern.text, "raise control_limit to")
    cured = warned(with_vehicle(scenario, control_limit=limit), "time")
    assert not any(one.is_fatal for one in cured)
    slow = alone(speed_limit=3.5, control_limit=4.0)
    (concern,) = warned(slow, "time")
    assert "control_limit" not in concern.text
    limit = number(concern.text, "raise speed_limit to")
    cured = warned(with_vehicle(slow, speed_limit=limit), "time")
    assert not any(one.is_fatal for one in cured)


@pytest.mark.parametrize("limits", [(1e-3, 20.0), (1.0, 1e-3)])
def test_a_goal_out_of_reach_names_the_limit_that_was_tried(limits: tuple[float, float]) -> None:
    control, speed = limits
    scenario = alone(control_limit=control, speed_limit=speed)
    (concern,) = warned(scenario, "time")
    assert "check units" in concern.text
    # A hundred times as much of either is too little still.
    assert "raise" not in concern.text


def helps(text: str) -> str:
    """What a concern says was tried and helps."""
    assert "What helps, as tried: " in text, text
    return text.partition("What helps, as tried: ")[2]


def place(text: str) -> list[float]:
    found = re.search(r"\(([^()]+)\)", text)
    assert found is not None, text
    return [float(x) for x in found[1].split(",")]


def quieter(scenario: Scenario, factor: float) -> Scenario:
    return with_noise(scenario, factor**2)


@pytest.mark.parametrize("risk_bound", [0.02, 0.1], ids=["above the bound", "much of it"])
def test_every_cure_of_a_goal_that_risks_too_much_cures_it(risk_bound: float) -> None:
    scenario = replace(of_scene("goal-too-near"), risk_bound=risk_bound)
    (concern,) = warned(scenario, "endpoint")
    told = helps(concern.text)
    (vehicle,) = scenario.vehicles
    half = 0.5 * (vehicle.goal.upper - vehicle.goal.lower)
    goal = radmpc.Goal.at(place(told), half, vehicle.goal.speed)
    assert warned(with_vehicle(scenario, goal=goal), "endpoint") == []
    factor = number(told, "reduce the noise to")
    assert warned(quieter(scenario, factor), "endpoint") == []
    assert warned(quieter(scenario, 1.2 * factor), "endpoint") != []
    if "raise risk_bound" in told:
        bound = number(told, "raise risk_bound to")
        left = warned(replace(scenario, risk_bound=bound), "endpoint")
        assert not any(one.is_fatal for one in left)
        # Only what is said to take half of it takes more than a small part.
        assert bool(left) == ("of which starts and goals take half" in told)


def test_a_bound_that_leaves_half_of_it_is_advised_where_no_sensible_one_leaves_more() -> None:
    scenario = of_scene("goal-too-near")
    # It risks 0.05: ten times that is no bound that anybody wants, twice that is.
    louder = quieter(scenario, 1.2)
    risk = outlook_of(louder).least_risk
    (concern,) = warned(replace(louder, risk_bound=0.02), "endpoint")
    bound = number(concern.text, "raise risk_bound to")
    assert "of which starts and goals take half" in concern.text
    assert bound == pytest.approx(2.0 * risk, rel=0.02)
    (left,) = warned(replace(louder, risk_bound=bound), "endpoint")
    assert not left.is_fatal


@pytest.mark.slow
def test_starts_that_overlap_are_moved_but_not_better_known() -> None:
    scenario = of_scene("starts-clash")
    concern = warned_in("starts-clash", "endpoint")[0]
    told = helps(concern.text)
    assert "move the start of 'usv1' to" in told
    assert "initial_covariance" not in told
    first, *others = scenario.vehicles
    start = first.start.copy()
    start[:2] = place(told)
    moved = replace(scenario, vehicles=(replace(first, start=start), *others))
    assert not any("usv1" in one.vehicles for one in warned(moved, "endpoint"))


def adrift(**more: object) -> Scenario:
    """A vehicle with room and time, but noise that adds up."""
    noise = np.diag([0.1, 0.1, 0.01, 0.01])
    changes = {"disturbance_covariance": noise, "control_limit": 4.0} | more
    return replace(alone(**changes), horizon=20, risk_bound=0.02)


def test_feedback_is_advised_with_a_weight_that_holds_the_vehicle_and_leaves_control() -> None:
    scenario = adrift()
    (concern,) = warned(scenario, "deviation")
    weight = number(concern.text, "add feedback (lqr with Q = 1, R =")
    steered = replace(scenario, vehicles=(regulated(scenario.vehicles[0], weight),))
    assert warned(steered, "deviation") == warned(steered, "control") == []
    factor = number(concern.text, "reduce the noise to")
    assert warned(quieter(scenario, factor), "deviation") == []
    assert warned(quieter(scenario, 1.1 * factor), "deviation") != []


def test_no_feedback_is_advised_where_none_holds_the_vehicle() -> None:
    # One step's noise is more than the hull bears, whatever is done about it.
    noise = np.diag([4.0, 4.0, 0.01, 0.01])
    (concern,) = warned(adrift(disturbance_covariance=noise), "deviation")
    assert "feedback" not in concern.text
    assert "reduce the noise to" in concern.text


def gate(width: float, length: float, horizon: int = 16) -> Scenario:
    """A gate in a wall, which is as long as that."""
    vehicle = Vehicle(
        name="boat",
        system=radmpc.double_integrator(1.0, 2),
        start=[0.0, 0.0],
        goal=radmpc.Goal.at([20.0, 0.0], 0.5),
        radius=0.5,
        control_limit=2.0,
        initial_covariance=np.diag([0.01, 0.01, 0.0, 0.0]),
        disturbance_covariance=0.0,
        speed_limit=2.0,
    )
    walls = (
        radmpc.Obstacle.box("south", [9.0, -length], [10.0, -0.5 * width]),
        radmpc.Obstacle.box("north", [9.0, 0.5 * width], [10.0, length]),
    )
    return Scenario("gate", 1.0, horizon, 0.02, (vehicle,), walls)


@pytest.mark.slow
def test_every_cure_of_a_narrow_gate_cures_it() -> None:
    (concern,) = warned(gate(1.4, 200.0), "narrow")
    wider = number(concern.text, "widen it by")
    assert warned(gate(1.4 + wider, 200.0), "narrow") == []
    assert warned(gate(1.4 + 0.8 * wider, 200.0), "narrow") != []
    factor = number(concern.text, "reduce the noise to")
    assert warned(quieter(gate(1.4, 200.0), factor), "narrow") == []
    # The wall is too long to go around it at any horizon that is tried.
    assert "horizon" not in concern.text


@pytest.mark.slow
def test_a_horizon_is_advised_where_it_leads_around_what_is_narrow() -> None:
    (concern,) = warned(gate(0.6, 22.0), "narrow")
    horizon = int(number(concern.text, "lengthen the horizon to"))
    assert warned(gate(0.6, 22.0, horizon), "narrow") == []
    # What lacks room lacks it without noise, too.
    assert "noise" not in concern.text
