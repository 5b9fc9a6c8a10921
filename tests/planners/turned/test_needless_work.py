"""What a first plan does without: programs of who would stay, certificates of what is too risky."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import fleet, paper
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.task import Task
from radmpc.planners.certified.turned import first_plan as first
from radmpc.planners.certified.turned.linear.warm_programs import WarmPrograms
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.turning import Turning
from radmpc.planners.verdict import Verdict
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.solvers.solution import Limits


def refuse(*_: object, **__: object) -> None:
    """Stand for work that is not to be done."""
    raise AssertionError("that is not needed")


def hazards_of(count: int, *, has_obstacles: bool = True) -> Hazards:
    """Return what some vehicles keep clear of."""
    scenario = paper(count, 0)
    if not has_obstacles:
        scenario = replace(scenario, obstacles=())
    return Hazards.of(scenario, condensed_models(scenario))


def begun_alone(hazards: Hazards) -> SuccessiveLp:
    """Begin with everyone on the path of least effort."""
    successive = SuccessiveLp(hazards, Limits())
    assert successive.begin_alone()
    successive.least.update(enumerate(successive.paths.controls))
    return successive


def test_who_keeps_clear_on_the_path_of_least_effort_is_not_planned(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    successive = begun_alone(hazards_of(1, has_obstacles=False))
    before = successive.paths.means.copy()
    monkeypatch.setattr(WarmPrograms, "plan_alone", refuse)
    assert successive.keep_apart(3.0, 4)
    assert np.array_equal(successive.paths.means, before)


def test_who_left_that_path_is_planned_even_where_it_keeps_clear(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    successive = begun_alone(hazards_of(1, has_obstacles=False))
    successive.paths.fly(0, successive.paths.controls[0].copy())
    monkeypatch.setattr(WarmPrograms, "plan_alone", refuse)
    with pytest.raises(AssertionError, match="not needed"):
        successive.keep_apart(3.0, 4)


def test_a_large_fleet_of_which_few_meet_is_searched_without_planning_anybody_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scenario = fleet(40, 0)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    task = Task(hazards, refuse, Limits(), 1e-3, scenario.risk_bound)  # type: ignore[arg-type] # never asked
    monkeypatch.setattr(first, "_paths_alone", refuse)
    assert not first.first_plan(task, 1.0, np.random.default_rng(0)).controls
    with pytest.raises(AssertionError, match="not needed"):
        first.first_plan(task, 1.0, np.random.default_rng(0), is_needed=True)


@pytest.mark.parametrize("is_above", [False, True])
def test_the_referee_is_not_asked_of_paths_that_risk_too_much(is_above: bool) -> None:
    asked: list[int] = []

    def judge(controls: tuple[np.ndarray, ...]) -> Verdict:
        asked.append(len(controls))
        return Verdict(1.0, ())

    hazards = hazards_of(2)
    task = Task(hazards, judge, Limits(), 1e-3, 0.05)
    turning = Turning(task, FleetIncumbent(), ((0,), (1,)), 1.0, is_above=is_above)
    assert turning.successive.begin_alone()
    turning.run(0)
    assert len(asked) == (0 if is_above else 1)
