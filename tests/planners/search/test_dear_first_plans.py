"""First plans that cost much: turned before they are reported, and in parts while there is none."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest

from radmpc import Goal, Obstacle, Scenario, Vehicle, Workspace, certify, double_integrator, plan
from radmpc.experiments.families import circle, clutter
from radmpc.planners.certified.phases import searching
from radmpc.planners.certified.phases.turned_first import FirstReports
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.task import Task
from radmpc.planners.certified.turned.large.groups import parts_of
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.certified.turned.turning import Turning
from radmpc.planners.verdict import Verdict
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.solvers.solution import Limits
from running import silent_run


def alcove() -> Scenario:
    """One that has to pass another in a lane, which can make way into an alcove only."""
    lane = (
        Obstacle.box("west", [0.0, 0.0], [2.5, 1.0]),
        Obstacle.box("east", [4.0, 0.0], [6.5, 1.0]),
        Obstacle.box("north", [0.0, 2.5], [6.5, 3.5]),
    )
    one, other = (
        Vehicle(
            name=name,
            radius=0.4,
            system=double_integrator(1.7, 2),
            start=[*start, 0.0, 0.0],
            goal=Goal.at(goal, 0.1, speed=0.05),
            control_limit=2.0,
            speed_limit=0.5,
            initial_covariance=np.diag([1.3e-4, 1.3e-4, 4.5e-6, 4.5e-6]),
            disturbance_covariance=np.diag([1.3e-4, 1.3e-4, 4.5e-6, 4.5e-6]),
        )
        for name, start, goal in (("a", [0.5, 1.75], [6.0, 1.75]), ("b", [2.0, 1.75], [4.5, 1.75]))
    )
    room = Workspace(np.zeros(2), np.array([6.5, 3.5]))
    return Scenario("alcove", 1.7, 10, 0.05, (one, other), obstacles=lane, workspace=room)


def test_a_first_plan_of_the_search_that_costs_much_is_turned_before_it_is_reported(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(searching, "first_plan", lambda *_, **__: FleetIncumbent())
    reported, made = [], []
    result = plan(
        alcove(),
        "certified",
        time_limit=60.0,
        found=lambda cost, _: reported.append(cost),
        improved=made.append,
    )
    assert result.plan is not None
    assert certify(result.plan).holds
    assert result.plan.cost <= min(reported)
    # By faces it costs half as much again; that plan was handed on, so that an interrupt keeps it.
    assert reported[0] < 1.2 * result.plan.cost
    assert made[0].cost > 1.4 * result.plan.cost


class Told:
    """What was reported of plans, and what was handed on."""

    def __init__(self) -> None:
        self.costs: list[float] = []
        self.plans: list[object] = []
        self.run = replace(
            silent_run(), found=lambda cost, _: self.costs.append(cost), improved=self.plans.append
        )


def costing(times: float) -> FleetIncumbent:
    """Return a plan of `circle(2)` that costs so many times what its vehicles cost alone."""
    alone = SuccessiveLp(FACING, Limits())
    assert alone.begin_alone()
    return FleetIncumbent((), times * alone.paths.cost(), certified=0.04)


FACING = Hazards.of(circle(2), condensed_models(circle(2)))


def test_a_dear_first_plan_of_few_waits_for_the_next() -> None:
    told = Told()
    with closing(FirstReports(told.run, FACING, 0.05)) as report:
        report(costing(3.0))
        assert (len(told.costs), len(told.plans)) == (0, 1)
        report(costing(2.5))
        assert (len(told.costs), len(told.plans)) == (1, 2)
    assert told.costs == [costing(2.5).cost]


def test_other_first_plans_are_reported_at_once() -> None:
    told = Told()
    FirstReports(told.run, FACING, 0.05)(costing(1.5))
    assert told.costs == [costing(1.5).cost]


def test_among_many_obstacles_a_dear_first_plan_that_uses_the_risk_bound_does_not_wait() -> None:
    told, among = Told(), Hazards.of(clutter(2, 100, 0), condensed_models(clutter(2, 100, 0)))
    FirstReports(told.run, among, 0.05)(costing(100.0))
    assert told.costs == [costing(100.0).cost]


def test_dear_first_plans_of_more_vehicles_are_reported_at_once() -> None:
    told, crowd = Told(), Hazards.of(circle(5), condensed_models(circle(5)))
    FirstReports(told.run, crowd, 0.05)(costing(100.0))
    assert told.costs == [costing(100.0).cost]


def test_a_first_plan_that_waits_is_reported_in_the_end() -> None:
    told = Told()
    with closing(FirstReports(told.run, FACING, 0.05)) as report:
        report(costing(3.0))
    assert told.costs == [costing(3.0).cost]


def turning(is_routed: bool) -> Turning:
    """Return the turning of a large set that begins on straight lines, in the name of routes."""
    scenario = circle(16)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    judge = lambda _: Verdict(1.0, ())  # noqa: E731 - a referee that certifies nothing
    task = Task(hazards, judge, Limits(), 1e-3, scenario.risk_bound)
    made = Turning(task, FleetIncumbent(), (tuple(range(16)),), 5.0, is_routed=is_routed)
    assert made.successive.begin_alone()
    return made


@pytest.mark.parametrize(("is_routed", "most"), [(True, TUNING.each_before_plan), (False, 16)])
def test_a_large_set_between_obstacles_is_turned_in_parts_before_a_plan(
    is_routed: bool, most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    groups = []
    planned = SuccessiveLp.share_risk

    def share_risk(self: SuccessiveLp, group: tuple[int, ...], *costs: float) -> float:
        groups.append(group)
        return planned(self, group, *costs)

    monkeypatch.setattr(SuccessiveLp, "share_risk", share_risk)
    turning(is_routed).run(1)
    assert max(map(len, groups)) == most
    assert sorted(i for group in groups for i in group) == list(range(16))


def test_parts_hold_every_vehicle_once() -> None:
    parts = parts_of([tuple(range(13)), (13, 14)])
    assert sorted(i for part in parts for i in part) == list(range(15))
    assert max(map(len, parts)) <= TUNING.each_before_plan
