"""What is tried where a search ends without a plan."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import paper
from radmpc.model.goal import Goal
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Workspace
from radmpc.planners import Branch, Certified, Optimal, Planner
from radmpc.planners.certified import fallbacks
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.infeasible.answer import WhyNot
from radmpc.planners.certified.infeasible.least_risk import feasible_within
from radmpc.planners.certified.more_faces import faces_text, finer_scenarios
from radmpc.planners.certified.search import PriceSearch
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.verdict import Verdict
from radmpc.planning import plan
from radmpc.solvers.solution import Limits


@pytest.mark.slow
def test_the_safest_plan_is_tried_even_if_plans_without_noise_take_long(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scenario = paper(2, 0)
    tried = []

    def slow(fleet: Fleet, state: SearchState, judge: object) -> SearchState:
        while not fleet.limits.reached:
            pass
        return state

    def from_safest(search: PriceSearch, state: SearchState, answer: object) -> SearchState:
        tried.append(answer)
        return state

    monkeypatch.setattr(fallbacks, "turn_from_noiseless", slow)
    monkeypatch.setattr(fallbacks, "_from_safest", from_safest)
    monkeypatch.setattr(PriceSearch, "run", lambda self, state: state)
    fleet = Fleet.of(scenario, 1e-3, Limits().within(1.0))
    search = PriceSearch.of(fleet, lambda controls: Verdict(1.0, ()))
    fallbacks.last_resort(search, SearchState.of(fleet))
    assert len(tried) == 1
    assert tried[0].controls


def test_who_is_not_persistent_neither_seeks_reasons_nor_more_faces(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    vehicle = replace(paper(2, 1).vehicles[0], start=np.zeros(4), goal=Goal.at([24.0, 0.0], 0.5))
    # Wide enough for the hull, and not for its noise: what no hull fits through needs no search.
    half = vehicle.radius + 1e-3
    walls = (
        Obstacle.box("south", [10.0, -9.0], [11.0, -half]),
        Obstacle.box("north", [10.0, half], [11.0, 9.0]),
    )
    workspace = Workspace([-2.0, -9.0], [28.0, 9.0])
    drawn = replace(paper(2, 1), vehicles=(vehicle,), horizon=24, avoidance="intervals")
    scenario = replace(drawn, obstacles=walls, workspace=workspace)
    asked: list[str] = []
    monkeypatch.setattr(fallbacks, "why_not", lambda *args: asked.append("why"))
    monkeypatch.setattr(fallbacks, "_with_more_faces", lambda *args: asked.append("faces"))
    record = Planner(Optimal(), Branch(), Certified(is_persistent=False))
    result = plan(scenario, record, rng=0)
    assert result.plan is None
    assert not asked
    assert result.explanation.startswith("No plan was found, and none was ruled out")
    assert str(record.decomposition) == "certified"


@pytest.mark.parametrize(("is_feasible", "is_proven"), [(False, True), (None, False)])
def test_only_faces_that_were_searched_to_the_end_rule_out_a_plan(
    monkeypatch: pytest.MonkeyPatch, is_feasible: bool | None, is_proven: bool
) -> None:
    none_by_faces = WhyNot("No path.", is_proven=True, blocked=(0, 1))
    monkeypatch.setattr(fallbacks, "turn_from_noiseless", lambda fleet, state, judge: state)
    monkeypatch.setattr(fallbacks, "why_not", lambda scenario, limits: none_by_faces)
    monkeypatch.setattr(fallbacks, "feasible_within", lambda scenario, limits: is_feasible)
    fleet = Fleet.of(paper(2, 0), 1e-3, Limits().within(60.0))
    search = PriceSearch.of(fleet, lambda controls: Verdict(1.0, ()))
    answer = fallbacks.last_resort(search, SearchState.of(fleet)).answer
    assert answer.is_proven is is_proven
    assert ("More faces allowed no plan" in answer.explanation) is is_proven
    assert ("Whether a plan exists with 8, 16 or 32 faces" in answer.explanation) is not is_proven


def test_more_faces_that_a_first_look_does_not_tell_of_are_searched_longer(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    none_by_faces = WhyNot("No path.", is_proven=True, blocked=(0, 1))
    monkeypatch.setattr(fallbacks, "turn_from_noiseless", lambda fleet, state, judge: state)
    monkeypatch.setattr(fallbacks, "why_not", lambda scenario, limits: none_by_faces)
    asked: list[int] = []

    def feasible(scenario, limits: Limits) -> bool | None:
        asked.append(scenario.num_pair_faces)
        return False if limits.seconds_left > 10.0 or scenario.num_pair_faces == 16 else None

    monkeypatch.setattr(fallbacks, "feasible_within", feasible)
    fleet = Fleet.of(paper(2, 0), 1e-3, Limits().within(60.0))
    search = PriceSearch.of(fleet, lambda controls: Verdict(1.0, ()))
    answer = fallbacks.last_resort(search, SearchState.of(fleet)).answer
    assert asked == [8, 16, 32, 8, 32]
    assert answer.is_proven
    assert "not known" not in answer.explanation


@pytest.mark.parametrize(
    ("looks_long", "why"),
    [(False, "searches ended without an answer."), (True, "each was given up to 15 s.")],
)
def test_what_is_not_known_of_more_faces_says_whether_time_ran_out(
    monkeypatch: pytest.MonkeyPatch, looks_long: bool, why: str
) -> None:
    none_by_faces = WhyNot("No path.", is_proven=True, blocked=(0, 1))
    monkeypatch.setattr(fallbacks, "turn_from_noiseless", lambda fleet, state, judge: state)
    monkeypatch.setattr(fallbacks, "why_not", lambda scenario, limits: none_by_faces)

    def undecided(scenario, limits: Limits) -> None:
        if looks_long:
            monkeypatch.setattr(Limits, "reached", property(lambda limits: len(limits_seen) > 0))
            limits_seen.append(limits)

    limits_seen: list[Limits] = []
    monkeypatch.setattr(fallbacks, "feasible_within", undecided)
    fleet = Fleet.of(paper(2, 0), 1e-3, Limits().within(60.0))
    search = PriceSearch.of(fleet, lambda controls: Verdict(1.0, ()))
    answer = fallbacks.last_resort(search, SearchState.of(fleet)).answer
    assert answer.explanation.endswith(why)


def test_faces_that_were_tried_are_told_in_one_list() -> None:
    finer = list(finer_scenarios(paper(2, 0)))
    assert faces_text(finer) == (
        "8, 16 or 32 faces around pairs and obstacles' corners cut every 45, 22.5 or 11.25 degrees"
    )
    assert finer[0].text == "8 faces around pairs and obstacles' corners cut every 45 degrees"
    alone = list(finer_scenarios(paper(1, 0)))
    assert faces_text(alone) == "obstacles' corners cut every 45, 22.5 or 11.25 degrees"


def test_more_faces_that_leave_a_way_but_no_plan_of_all_rule_out_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    none_by_faces = WhyNot("No path.", is_proven=True, blocked=(0, 1))
    monkeypatch.setattr(fallbacks, "turn_from_noiseless", lambda fleet, state, judge: state)
    monkeypatch.setattr(fallbacks, "why_not", lambda scenario, limits: none_by_faces)
    monkeypatch.setattr(
        fallbacks, "feasible_within", lambda scenario, limits: scenario.num_pair_faces == 16
    )
    planned: list[str] = []
    monkeypatch.setattr(
        fallbacks, "_planned_with", lambda search, finer, answer: planned.append(finer.text)
    )
    fleet = Fleet.of(paper(2, 0), 1e-3, Limits().within(60.0))
    search = PriceSearch.of(fleet, lambda controls: Verdict(1.0, ()))
    answer = fallbacks.last_resort(search, SearchState.of(fleet)).answer
    assert len(planned) == 1
    assert not answer.is_proven
    assert "A plan of these vehicles exists with 16 faces" in answer.explanation
    assert "More faces allowed no plan: tried were 8 or 32 faces around pairs" in answer.explanation


def test_more_faces_rule_out_nothing_once_time_is_up() -> None:
    assert feasible_within(paper(2, 0), Limits().within(0.0)) is None
