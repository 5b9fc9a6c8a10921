"""Attempts that begin with vehicles placed apart, and those that are turned though they miss."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from grid_worlds import cells

from radmpc.experiments.families import circle
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.task import Task
from radmpc.planners.certified.turned import attempts as making
from radmpc.planners.certified.turned import first_plan as making_first
from radmpc.planners.certified.turned import placing
from radmpc.planners.certified.turned.attempt import Attempt, Begin
from radmpc.planners.certified.turned.narrow.prioritized import prioritized_ticks
from radmpc.planners.certified.turned.placing import placed_apart
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.verdict import Verdict
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.solvers.solution import Limits


def never() -> bool:
    return False


def begun(hazards: Hazards) -> Begin:
    """Begin with what vehicles do alone, all of them in conflict."""
    task = Task(hazards, lambda _: Verdict(1.0, ()), Limits(), 1e-3, 0.05, lambda _: None)
    alone = SuccessiveLp(hazards, Limits())
    assert alone.begin_alone()
    return Begin(task, alone, {}, (tuple(range(hazards.count)),), 1.0, 2.4)


def lane(path: Path, bays: list[int], robots: list) -> Hazards:
    """Seven cells in a row, and bays beside some of them."""
    free = {(x, 0) for x in range(7)} | {(x, 1) for x in bays}
    scenario = cells(path, (7, 2), free, robots)
    return Hazards.of(scenario, condensed_models(scenario))


def first_placed(hazards: Hazards) -> np.ndarray:
    """Places of the first attempt with any, (N, T+1, 2) [m]."""
    attempts = placed_apart(begun(hazards), np.random.default_rng(0), Limits())
    return next(one for one in attempts if one.is_placed).turning.successive.paths.means


def least_apart(hazards: Hazards, places: np.ndarray) -> float:
    """Least distance of two hulls at a step [m]."""
    pairs = [(i, j) for i in range(hazards.count) for j in range(i)]
    return min(
        float(np.linalg.norm(places[i] - places[j], axis=1).min())
        - float(hazards.radii[i] + hazards.radii[j])
        for i, j in pairs
    )


def test_where_no_order_of_paces_fits_all_go_as_they_were_planned_in_turn(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At the best pace, or in haste, who is first leaves the others none: one waits in the bay."""
    monkeypatch.setattr(placing, "joint_routes", lambda *_: {})
    robots = [((5, 0), (0, 0)), ((1, 0), (5, 0)), ((3, 0), (4, 1))]
    hazards = lane(tmp_path, [4], robots)
    places = first_placed(hazards)
    assert least_apart(hazards, places) > 0.0
    goals = [model.vehicle.goal.center for model in hazards.models]
    assert np.abs(places[:, -1] - goals).max() < 0.5 * float(hazards.radii.min())


def test_routes_planned_in_turn_lead_everyone_to_the_goal_at_full_speed_if_need_be(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(placing, "joint_routes", lambda *_: {})
    robots = [((5, 0), (5, 0)), ((0, 0), (2, 1)), ((6, 0), (2, 0))]
    hazards = lane(tmp_path, [3, 2], robots)
    placed, ticks = prioritized_ticks(hazards, never)
    assert placed == {}
    placed, faster = prioritized_ticks(hazards, never, ticks)
    assert sorted(placed) == [0, 1, 2]
    assert faster > ticks
    # As fast as that is as fast as can be.
    assert prioritized_ticks(hazards, never, faster)[0] == {}
    assert least_apart(hazards, first_placed(hazards)) > 0.0


@pytest.mark.parametrize(("missed", "is_turned"), [(0.5, True), (9.0, False)])
def test_what_attempts_miss_alike_is_turned_unless_it_is_far_too_much(
    missed: float, is_turned: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Pairs that meet head-on miss alike whatever else there is: to turn them takes seconds."""
    scenario = circle(3)
    begin, turned = begun(Hazards.of(scenario, condensed_models(scenario))), []
    assert 0.5 < begin.task.hazards.radii.sum() < 9.0
    begins = iter([Attempt(begin.referring({}), 0) for _ in range(2)])

    def run(attempt: Attempt) -> FleetIncumbent:
        turned.append(attempt)
        return FleetIncumbent()

    monkeypatch.setattr(making, "_attempts", lambda *_: begins)
    monkeypatch.setattr(making, "_turned", lambda *_: (missed, FleetIncumbent(), False))
    monkeypatch.setattr(Attempt, "run", run)
    making.tried(begin, np.random.default_rng(0), Limits())
    # What missed least is turned at the end in any case.
    assert len(turned) == (2 if is_turned else 1)


@pytest.mark.parametrize(("missed", "is_sooner"), [(0.5, True), (90.0, False)])
def test_what_misses_little_is_turned_before_times_are_drawn(
    missed: float, is_sooner: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    scenario = circle(3)
    begin, turned = begun(Hazards.of(scenario, condensed_models(scenario))), []
    first = Attempt(begin.referring({}), 0)
    begins = iter([first, Attempt(begin.referring({}), 0, is_drawn=True)])

    def kept_apart(_: Begin, attempt: Attempt, __: Limits) -> tuple[float, FleetIncumbent, bool]:
        if attempt.is_drawn:
            assert turned == ([first] if is_sooner else [])
        return (1.1 if attempt.is_drawn else 1.0) * missed, FleetIncumbent(), False

    def run(attempt: Attempt) -> FleetIncumbent:
        turned.append(attempt)
        return FleetIncumbent()

    monkeypatch.setattr(making, "_attempts", lambda *_: begins)
    monkeypatch.setattr(making, "_turned", kept_apart)
    monkeypatch.setattr(Attempt, "run", run)
    making.tried(begin, np.random.default_rng(0), Limits())
    assert turned == [first]


def test_who_keeps_apart_at_once_but_risks_too_much_is_planned_like_all_others(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    begun_with = []

    def tried(begin: Begin, *_: object) -> FleetIncumbent:
        begun_with.append(begin)
        return FleetIncumbent()

    monkeypatch.setattr(making, "tried", tried)
    scenario = circle(3)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    # The referee certifies nothing.
    task = Task(hazards, lambda _: Verdict(1.0, ()), Limits(), 1e-3, 0.05, lambda _: None)
    assert not making_first.first_plan(task, 1.0, np.random.default_rng(0)).controls
    assert len(begun_with) == 1
