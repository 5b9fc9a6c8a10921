"""Vehicles that were placed clear of everything, and the controls that keep them there."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from grid_worlds import cells

from radmpc.experiments.families import fleet
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.turned.narrow.at_pace import keep_places
from radmpc.planners.certified.turned.narrow.clear import Clear
from radmpc.planners.certified.turned.narrow.pacing import Pacing
from radmpc.planners.certified.turned.narrow.routes import shortest_routes
from radmpc.planners.certified.turned.paths import timed
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.certified.turned.turning import Task, Turning
from radmpc.planners.verdict import Verdict
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.solvers import solution
from radmpc.solvers.solution import Limits

CLEARANCE = 3.0


def never() -> bool:
    return False


def stair(path: Path) -> Scenario:
    """One robot up a stair of cells, one cell wide: steps are longer than the cells."""
    free = {(x, x) for x in range(6)} | {(x + 1, x) for x in range(5)}
    return cells(path, (6, 6), free, [((0, 0), (5, 5))])


def placed(hazards: Hazards) -> SuccessiveLp:
    """Paths that refer to places at a pace, each move between them clear of the corners."""
    clear = Clear.of(hazards)
    assert clear is not None
    pacing = Pacing(hazards, clear, CLEARANCE)
    pacing.offer(shortest_routes(hazards, clear, CLEARANCE))
    successive = SuccessiveLp(hazards, Limits())
    assert successive.begin_alone()
    for i, path in pacing.run(range(hazards.count), never).items():
        successive.refer(i, path)
    return successive


def test_a_robot_placed_clear_of_corners_stays_clear_of_them(tmp_path: Path) -> None:
    scenario = stair(tmp_path)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    # Planned on for less effort, it cuts the corners it was placed around, and cannot come back.
    lost = placed(hazards)
    assert not lost.keep_apart(CLEARANCE, TUNING.max_sweeps, None, TUNING.paced_penalty)
    kept = placed(hazards)
    assert keep_places(kept, CLEARANCE, TUNING.paced_sweeps, TUNING.paced_penalty, Limits())
    assert kept.missed.max() <= 1e-7


@pytest.mark.parametrize("late", [0.5, 0.6])
def test_who_waits_far_from_a_box_does_not_drift_through_it(late: float, tmp_path: Path) -> None:
    # An open hall with one box in its middle; the robot is to wait and to pass it in the end.
    free = {(x, y) for x in range(13) for y in range(5)} - {(6, 2)}
    scenario = cells(tmp_path, (13, 5), free, [((0, 2), (12, 2))])
    hazards = Hazards.of(scenario, condensed_models(scenario))
    clear = Clear.of(hazards)
    assert clear is not None
    route = shortest_routes(hazards, clear, CLEARANCE)[0][0]
    successive = SuccessiveLp(hazards, Limits())
    assert successive.begin_alone()
    successive.refer(0, timed(route, hazards.horizon, late, 1.0))
    assert keep_places(successive, CLEARANCE, 16, TUNING.paced_penalty, Limits())
    path = successive.paths.means[0]
    assert clear.along(path[:-1], path[1:]).min() > hazards.radii[0]


def test_places_are_not_kept_once_time_is_up(tmp_path: Path) -> None:
    scenario = stair(tmp_path)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    stopped = Limits(np.inf, lambda: True)
    assert not keep_places(placed(hazards), CLEARANCE, 16, TUNING.paced_penalty, stopped)


def test_turning_goes_on_until_there_is_a_plan_whatever_it_took_before(tmp_path: Path) -> None:
    scenario = stair(tmp_path)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    asked: list[float] = []

    def judge(controls: object) -> Verdict:
        del controls
        asked.append(0.2 / 2.0 ** len(asked))
        return Verdict(asked[-1], ())

    task = Task(hazards, judge, Limits(np.inf, never), 1e-3, 0.02)
    turning = Turning(task, FleetIncumbent(), ((0,),), 1.0)
    turning.successive.restore(placed(hazards).paths.state())
    turning.num_solves = 10 * TUNING.most_solves
    assert turning.run(TUNING.first_rounds).controls
    assert asked[-1] <= 0.02


def test_turning_goes_on_while_most_of_the_risk_bound_is_unspent(tmp_path: Path) -> None:
    scenario = stair(tmp_path)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    rounds = []
    for certified in (0.004, 0.016):
        asked: list[object] = []

        def judge(controls: object, asked=asked, certified=certified) -> Verdict:
            asked.append(controls)
            return Verdict(certified, ())

        task = Task(hazards, judge, Limits(np.inf, never), 1e-6, 0.02)
        turning = Turning(task, FleetIncumbent(), ((0,),), 1.0)
        turning.successive.restore(placed(hazards).paths.state())
        turning.num_solves = 10 * TUNING.most_solves
        turning.run(TUNING.first_rounds)
        rounds.append(len(asked) - 1)
    # At 20 % of Δ the price may still fall; at 80 % what was spent on turning ends it.
    assert rounds[0] > rounds[1] == TUNING.least_rounds


def test_a_large_fleet_waits_for_a_first_plan_only_for_so_long(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rounds = []
    for seconds in (0.0, 5.0):
        now, asked = [0.0], [1e6]
        clock = SimpleNamespace(monotonic=lambda now=now: now[0])
        monkeypatch.setattr(solution, "time", clock)
        scenario = fleet(TUNING.few + 1, 0)
        hazards = Hazards.of(scenario, condensed_models(scenario))

        def judge(controls: object, now=now, asked=asked, seconds=seconds) -> Verdict:
            # The certificate falls for as long as anybody asks, and stays above Δ.
            now[0] += seconds
            asked.append(0.5 * asked[-1])
            return Verdict(asked[-1], ())

        task = Task(hazards, judge, Limits(60.0, never), 1e-3, 0.02)
        alone = tuple((i,) for i in range(hazards.count))
        turning = Turning(task, FleetIncumbent(), alone, 1.0)
        assert turning.successive.begin_alone()
        assert not turning.run(TUNING.first_rounds).controls
        rounds.append(len(asked) - 2)
    # Two rounds of 5 s each are all the time that it may wait; a few are made in any case.
    assert rounds[1] == TUNING.waited_rounds < rounds[0]
