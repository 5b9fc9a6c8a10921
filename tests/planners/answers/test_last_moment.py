"""Plans that come with the end of time are handed on like all others."""

from __future__ import annotations

from dataclasses import replace

import pytest

from radmpc.experiments.families import paper
from radmpc.planners.certified import certified
from radmpc.planning import plan
from radmpc.solvers.solution import Limits


def test_a_plan_of_the_last_resort_is_told_though_time_is_up(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It is returned in any case; who listens for plans was to see none."""
    ended: list[bool] = []
    searched, was_reached = certified.searched, Limits.__dict__["reached"].__get__

    def at_the_last_moment(scenario, hazards, planner, run, *rest, **flags):
        found = searched(scenario, hazards, planner, run.in_silence(), *rest, **flags)
        ended.append(True)
        return found

    monkeypatch.setattr(certified, "searched", at_the_last_moment)
    monkeypatch.setattr(Limits, "reached", property(lambda one: bool(ended) or was_reached(one)))
    told: list[float] = []
    scenario = replace(paper(2, 0), avoidance="intervals")
    result = plan(scenario, "certified", found=lambda cost, bound: told.append(cost))
    assert result.is_certified
    assert told == [result.cost]
