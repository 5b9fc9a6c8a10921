"""Missions in one line each, and why a long one is stranded."""

from __future__ import annotations

from adversary import beside_a_wall, waiting
from executors import steering
from test_long_mission import far, straight

from radmpc.flying.flight import fly
from radmpc.flying.mission import Mission
from radmpc.flying.model import Model
from radmpc.flying.receding.long_mission import LongMission
from radmpc.flying.tick import Contact


def test_a_mission_is_shown_in_one_line() -> None:
    mission = Mission(waiting(beside_a_wall()), planner=None)
    assert (
        repr(mission)
        == "Mission('wall': step 0 of 10; remaining risk 0.05 of Δ = 0.05; no collision)"
    )
    fly(mission, Model(mission.scenario, 3))
    assert repr(mission).startswith("Mission('wall': over after 10 steps; remaining risk 0.0")
    struck = Mission(waiting(beside_a_wall()), planner=None)
    struck.step([v.start for v in struck.scenario.vehicles])
    hit = [Contact(1, "obstacle", "v", "wall")]
    struck.step([v.start for v in struck.scenario.vehicles], contacts=hit)
    assert repr(struck).startswith("Mission('wall': step 2 of 10; remaining risk 0.0")
    assert repr(struck).endswith("; something was hit)")


def test_a_long_mission_is_shown_in_one_line() -> None:
    scenario = far()
    mission = LongMission(
        scenario, window=8, overlap=3, guide=straight(scenario), planner=steering, warm=False
    )
    assert repr(mission) == (
        "LongMission('paper-1-1': step 0 of 24; remaining risk 0.05 of Δ = 0.05; no collision)"
    )
    fly(mission, Model(scenario, 2))
    assert repr(mission).startswith(
        "LongMission('paper-1-1': over after 24 steps; remaining risk 0.0"
    )


def test_a_mission_tells_why_it_has_no_next_window() -> None:
    scenario = far()

    def stranded(contacts: tuple[Contact, ...], is_measured: bool) -> str:
        mission = LongMission(
            scenario, window=8, overlap=1, guide=straight(scenario), planner=steering, warm=False
        )
        states, _ = (model := Model(scenario, 2)).reset()
        while not mission.is_over:
            told = contacts if len(mission.ticks) == 4 else ()
            is_told = is_measured or len(mission.ticks) < 7
            tick = mission.step(states if is_told else None, contacts=told)
            if tick.segments:
                states, _ = model.advance(tick.segments)
        return mission.ticks[-1].reason.partition("no next window: ")[2]

    name = scenario.vehicles[0].name
    assert stranded((), is_measured=False) == "not all vehicles were measured"
    hit = (Contact(4, "obstacle", name, "rock"),)
    assert stranded(hit, is_measured=True) == "something was hit"
