"""What is tried where a search ends without a plan."""

from __future__ import annotations

import pytest

from radmpc.experiments.families import paper
from radmpc.planners.certified import fallbacks
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.search import PriceSearch
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.verdict import Verdict
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
