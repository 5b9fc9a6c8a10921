"""Candidates that are no better than the tail."""

import re

import numpy as np
from adversary import beside_a_wall

from radmpc.flying.leg import leg_of
from radmpc.flying.mission import Mission
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario


def test_a_candidate_that_is_the_tail_again_is_said_to_be_as_good_and_not_adopted() -> None:
    scenario = beside_a_wall()
    plan = leg_of(scenario, [np.vstack([[0.0, 0.1], np.zeros((9, 2))])], 0).plan

    def again(left: Scenario, seconds: float | None) -> Plan:
        return leg_of(left, [plan.trajectories[0].controls[-left.horizon :]], 0).plan

    tick = Mission(plan, planner=again).step([scenario.vehicles[0].start])
    assert tick.choice == "tail"
    assert re.fullmatch(r"the tail is as good: (\S+) against \1 still to come", tick.reason)
