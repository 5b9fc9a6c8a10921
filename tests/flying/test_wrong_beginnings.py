"""What missions refuse to begin with."""

from __future__ import annotations

import numpy as np
import pytest

import radmpc

SYSTEM = radmpc.double_integrator(1.0, 2)
BOAT = radmpc.Vehicle("a", SYSTEM, [0, 0], radmpc.Goal.at([3, 0], 0.3), 0.3, 2.0, 0.0, 1e-3)
SCENE = radmpc.Scenario("s", 1.0, 4, 0.05, [BOAT])


@pytest.fixture(scope="module")
def plan() -> radmpc.Plan:
    return radmpc.plan(SCENE, "multi-vehicle").require()


def test_a_mission_under_way_is_not_flown_from_the_beginning(plan: radmpc.Plan) -> None:
    mission = radmpc.Mission(plan, planner=None)
    model = radmpc.Model(SCENE, 1)
    states, _ = model.reset()
    mission.step(states)
    message = "mission must be at its beginning, got one that has flown 1 step$"
    with pytest.raises(radmpc.ArgumentError, match=message):
        radmpc.fly(mission, model)


def test_states_of_vehicles_that_there_are_not_are_refused(plan: radmpc.Plan) -> None:
    mission = radmpc.Mission(plan, planner=None)
    message = r"^states: must be of the vehicles \['a'\], got \['zz'\]$"
    with pytest.raises(radmpc.ScenarioError, match=message):
        mission.step({"a": np.zeros(4), "zz": np.zeros(4)})


def test_a_state_beyond_all_range_is_no_measurement(plan: radmpc.Plan) -> None:
    mission = radmpc.Mission(plan)
    tick = mission.step([np.array([1e300, 0.0, 0.0, 0.0])])
    assert tick.segments[0].position.tolist() == [0.0, 0.0]


@pytest.mark.parametrize("share", [0.0, -1.0, 2.0, float("nan")])
def test_a_share_out_of_its_range_is_refused_with_all_of_the_range(
    plan: radmpc.Plan, share: float
) -> None:
    message = f"^share must be above 0 and at most 1, got {share:.6g}$"
    with pytest.raises(radmpc.ArgumentError, match=message):
        radmpc.Mission(plan, share=share)
