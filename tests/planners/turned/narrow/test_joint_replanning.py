"""Those that miss room are planned with those in their way, and it is told whether that helps."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from grid_worlds import cells

from radmpc.experiments.families import circle
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.turned.narrow.joint_replanning import replan_jointly
from radmpc.planners.certified.turned.narrow.tuning import TUNING
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.outcome.record import Certifying
from radmpc.planners.presets import parse_planner
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.solvers.solution import Limits

CLEARANCE, PRICE = 3.0, 1e4


def alone(scenario: Scenario) -> SuccessiveLp:
    """Everyone on the path that is best alone, through whatever is in the way."""
    hazards = Hazards.of(scenario, condensed_models(scenario))
    successive = SuccessiveLp(hazards, Limits())
    assert successive.begin_alone()
    successive.missed[:] = 0.0
    return successive


def certified(scenario: Scenario, successive: SuccessiveLp) -> float:
    """What the referee certifies of the latest paths."""
    judge = Certifying(scenario, parse_planner("certified"))
    return judge(tuple(successive.paths.controls)).certified


def test_two_that_meet_head_on_give_way_together() -> None:
    scenario = circle(2)
    successive = alone(scenario)
    begun = successive.paths.means.copy()
    assert certified(scenario, successive) > 0.5
    successive.missed[0] = 0.3
    assert replan_jointly(successive, CLEARANCE, PRICE, scenario.risk_bound, Limits())
    assert certified(scenario, successive) < scenario.risk_bound
    moved = np.abs(successive.paths.means - begun).max(axis=(1, 2))
    # Who gives way how much costs the same: they do by what they need between them.
    assert moved.sum() > successive.hazards.radii.sum()


def test_who_misses_nothing_and_is_in_nobodys_way_stays(tmp_path: Path) -> None:
    free = {(x, y) for x in range(9) for y in (0, 1, 2, 8)}
    robots = [((0, 1), (8, 1)), ((8, 1), (0, 1)), ((0, 8), (8, 8))]
    successive = alone(cells(tmp_path, (9, 9), free, robots))
    begun = successive.paths.means.copy()
    successive.missed[1] = 0.3
    replan_jointly(successive, CLEARANCE, PRICE, 0.05, Limits())
    assert np.array_equal(successive.paths.means[2], begun[2])
    assert not np.array_equal(successive.paths.means[1], begun[1])


def test_of_many_in_the_way_the_nearest_are_planned_together(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    successive, groups = alone(circle(12)), []
    # Everyone beside vehicle 3 all the way, ever farther from it.
    beside = [5, 0, 11, 2, 7, 1, 10, 4, 9, 6, 8]
    aside = np.array([0.0, 0.05])
    for distance, i in enumerate(beside, start=1):
        successive.refer(i, successive.paths.means[3] + distance * aside)
    successive.missed[3] = 0.3
    monkeypatch.setattr(
        SuccessiveLp, "share_risk", lambda self, group, *_: groups.append(group) or 0.0
    )
    assert replan_jointly(successive, CLEARANCE, PRICE, 0.05, Limits())
    assert groups == [tuple(sorted([3, *beside[: TUNING.joint_count - 1]]))]


def test_a_path_that_leads_through_a_wall_is_found_to_be_stuck(tmp_path: Path) -> None:
    # The way around is a bend of three sides; straight ahead is the wall.
    free = {(x, y) for x in (0, 6) for y in range(4)} | {(x, 3) for x in range(7)}
    successive = alone(cells(tmp_path, (7, 4), free, [((0, 0), (6, 0))]))
    successive.missed[0] = 0.3
    assert not replan_jointly(successive, CLEARANCE, PRICE, 0.05, Limits())
