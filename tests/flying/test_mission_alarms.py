"""What a mission raises alarms about, and what is flown where nothing is measured."""

from dataclasses import replace

import numpy as np
import pytest
from adversary import beside_a_wall

from comparing import differences
from radmpc import Measurement
from radmpc.errors import ScenarioError
from radmpc.flying.knowing import expected_start
from radmpc.flying.leg import leg_of
from radmpc.flying.mission import Mission
from radmpc.flying.sensing.gaps import flown_by
from radmpc.result import Result


def test_what_is_not_measured_is_flown_on(result: Result) -> None:
    mission = Mission(result)
    tick = mission.step(None)
    assert (tick.choice, tick.value, tick.reason) == ("tail", None, "nothing was measured")
    assert tick.alarms == ("no measurement: the tail flies on as expected",)
    states = [np.full(4, np.nan) for _ in range(2)]
    assert mission.step(states).alarms == tick.alarms
    off = [
        x + 5.0 * np.sqrt(np.diag(result.record.scenario.vehicles[0].disturbance_covariance))
        for x in mission._expected
    ]
    assert mission.step(off).alarms == ()
    # Nothing was spent, and what the legs to come risk is part of what there is.
    assert mission.account[-1].wealth == mission.account[0].bank


def test_only_who_is_not_measured_flies_as_expected(result: Result) -> None:
    given = result.record
    gain = -np.hstack([0.2 * np.eye(2), 0.6 * np.eye(2)])
    scenario = given.scenario.with_vehicles(
        [replace(v, gain=gain) for v in given.scenario.vehicles]
    )
    plan = leg_of(scenario, [path.controls for path in given.trajectories], 0).plan
    mission, blind = (Mission(plan, planner=None) for _ in range(2))
    first = scenario.vehicles[0]
    off = first.start + 0.1
    for missing in (np.full(first.start.size, np.nan), None):
        tick, none = mission.step([off, missing]), blind.step(None)
        assert tick.alarms == ("no measurement of 'v2': the tail flies on as expected",)
        assert (tick.value, tick.reason) == (None, "not all vehicles were measured")
        assert none.reason == "nothing was measured"
        assert tick.segments[0].position.tolist() == off[:2].tolist()
        assert np.abs(tick.controls[0] - none.controls[0]).max() > 1e-3
        assert differences(tick.segments[1], none.segments[1]) == []
        off = mission._expected[0] + 0.1
    with pytest.raises(ScenarioError, match=r"states\[1\]"):
        mission.step([off, "nowhere"])


@pytest.mark.parametrize(
    "change", [{"disturbance_correlation": 0.5}, {"measurement": Measurement(np.eye(4), 1e-6)}]
)
def test_who_tells_more_than_a_state_is_measured_with_all_or_not_at_all(
    result: Result, change: dict[str, object]
) -> None:
    scenario = result.record.scenario
    first, second = scenario.vehicles
    given = scenario.with_vehicles([replace(first, **change), second])
    expected = [expected_start(v) for v in given.vehicles]
    for i in range(2):
        states = [v.start + 0.1 if i == k else None for k, v in enumerate(given.vehicles)]
        known, [alarm] = flown_by(given, expected, states)
        assert np.array_equal(known[i], expected[i]) == (i == 0)
        # Told is who was not measured, whoever flies as expected.
        whose = given.vehicles[1 - i].name
        assert alarm == f"no measurement of {whose!r}: the tail flies on as expected"
    counted = replace(scenario, covariance_samples=200)
    known, [alarm] = flown_by(counted, expected, [first.start + 0.1, None])
    assert all(np.array_equal(one, hoped) for one, hoped in zip(known, expected, strict=True))
    assert alarm == f"no measurement of {second.name!r}: the tail flies on as expected"
    _, [alarm] = flown_by(counted, expected, None)
    assert alarm == "no measurement: the tail flies on as expected"


def test_states_by_name_are_states_in_order(result: Result) -> None:
    starts = {v.name: v.start for v in result.record.scenario.vehicles}
    by_name, in_order = Mission(result, planner=None), Mission(result, planner=None)
    turned = dict(reversed(starts.items()))
    assert differences(by_name.step(turned).value, in_order.step([*starts.values()]).value) == []
    with pytest.raises(ScenarioError, match=r"must have a state of every vehicle, lacks \['v2'\]"):
        by_name.step({"v1": starts["v1"]})


def test_disturbances_beyond_the_model_are_alarms(result: Result) -> None:
    mission = Mission(result, planner=None)
    states = [v.start for v in result.record.scenario.vehicles]
    assert mission.step(states).alarms == ()
    expected = [x.copy() for x in mission._expected]
    expected[1][0] += 1.0
    alarms = mission.step(expected).alarms
    assert any("vehicle 'v2': a disturbance of" in alarm for alarm in alarms)
    assert any("have a χ² of" in alarm for alarm in alarms)


def test_small_disturbances_in_a_row_are_an_alarm_together(result: Result) -> None:
    mission = Mission(result, planner=None)
    states = [v.start for v in result.record.scenario.vehicles]
    found = []
    for _ in range(6):
        found.append(mission.step(states).alarms)
        states = [
            x + 2.5 * np.sqrt(np.diag(v.disturbance_covariance))
            for x, v in zip(mission._expected, result.record.scenario.vehicles, strict=True)
        ]
    assert found[0] == ()
    assert any("the last 5 disturbances" in alarm for alarm in found[-1])
    assert not any("a disturbance of" in alarm for alarms in found for alarm in alarms)


def test_controls_that_saturate_are_an_alarm_and_are_cut_off() -> None:
    scenario = beside_a_wall()
    (vehicle,) = scenario.vehicles
    tight = replace(vehicle, control_limit=0.1, gain=-0.5 * np.eye(2), control_sigmas=0.0)
    scenario = replace(scenario, vehicles=(tight,))
    mission = Mission(leg_of(scenario, [np.zeros((10, 2))], 0).plan, planner=None)
    tick = mission.step([tight.start + np.array([1.0, 0.0])])
    assert tick.controls[0] == pytest.approx([-0.1, 0.0])
    assert any("its control saturates by 0.4" in alarm for alarm in tick.alarms)


def test_controls_of_tiny_limits_that_saturate_are_an_alarm_too() -> None:
    scenario = beside_a_wall()
    (vehicle,) = scenario.vehicles
    tight = replace(vehicle, control_limit=1e-8, gain=-5e-8 * np.eye(2), control_sigmas=0.0)
    scenario = replace(scenario, vehicles=(tight,))
    mission = Mission(leg_of(scenario, [np.zeros((10, 2))], 0).plan, planner=None)
    tick = mission.step([tight.start + np.array([1.0, 0.0])])
    assert tick.controls[0] == pytest.approx([-1e-8, 0.0], abs=1e-14)
    assert any("its control saturates by 4e-08" in alarm for alarm in tick.alarms)
