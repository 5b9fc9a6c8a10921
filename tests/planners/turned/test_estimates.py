"""Certificates that are only estimated: those of paths that cannot become the plan."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import circle, clutter, paper
from radmpc.experiments.swarms import swarm
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.task import Task
from radmpc.planners.certified.state.timed_judge import TimedJudge, estimate
from radmpc.planners.certified.turned.turning import Turning
from radmpc.planners.outcome.record import Certifying
from radmpc.planners.presets import parse_planner
from radmpc.planners.verdict import RoughJudge, Verdict
from radmpc.planning import plan
from radmpc.program.build import condensed_models
from radmpc.solvers.solution import Limits

Controls = tuple[np.ndarray, ...]


def along_intervals(scenario: Scenario) -> Scenario:
    return replace(scenario, avoidance="intervals")


def referee_of(scenario: Scenario) -> Certifying:
    return Certifying(scenario, parse_planner("certified"))


def plans_of(scenario: Scenario, count: int = 6) -> list[Controls]:
    """Return a plan and others near it, some of them so risky that they hit for sure."""
    found = plan(scenario, "certified", rng=0, time_limit=10.0)
    assert found.plan is not None
    own = tuple(each.controls for each in found.plan.trajectories)
    rng = np.random.default_rng(3)
    sizes = np.geomspace(1e-3, 0.1, count)
    return [own, *(tuple(u + s * rng.normal(size=u.shape) for u in own) for s in sizes)]


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "scenario",
    [
        along_intervals(paper(4, 1)),
        along_intervals(circle(4)),
        along_intervals(clutter(2, 20, 0)),
        along_intervals(swarm(4, 0)),
        paper(3, 0),
    ],
    ids=lambda scenario: f"{scenario.name}, {scenario.avoidance}",
)
def test_what_is_told_roughly_is_not_below_the_certificate(scenario: Scenario) -> None:
    referee = referee_of(scenario)
    for controls in plans_of(scenario):
        certified, rough = referee.verdict(controls).certified, referee.rough(controls)
        assert rough >= certified * (1.0 - 1e-9)
        if scenario.avoidance == "steps":
            assert rough == certified


def test_the_referee_tells_roughly_only_where_that_is_quicker() -> None:
    assert isinstance(referee_of(along_intervals(paper(2, 0))).judge, RoughJudge)
    assert not isinstance(referee_of(paper(2, 0)).judge, RoughJudge)


@pytest.mark.parametrize("scenario", [along_intervals(paper(4, 1)), along_intervals(circle(4))])
def test_plans_like_one_that_was_judged_are_estimated_within_a_third(scenario: Scenario) -> None:
    referee = referee_of(scenario)
    judge = TimedJudge(referee.judge, scenario.risk_bound)
    own, *others = plans_of(scenario, 12)
    assert estimate(judge, own) is None  # Nothing was judged yet.
    judge(own)
    assert estimate(judge, own) == pytest.approx(referee.verdict(own).certified)
    alike = [c for c in others if 0.1 < referee.verdict(c).certified / scenario.risk_bound < 4.0]
    assert alike
    for controls in alike:
        assert estimate(judge, controls) == pytest.approx(
            referee.verdict(controls).certified, rel=0.35
        )


def test_a_certificate_far_from_the_bound_tells_nothing_of_others() -> None:
    certificates = iter([1e-9, 0.9, 0.04])
    judge = TimedJudge(
        RoughJudge(lambda controls: Verdict(next(certificates), ()), lambda controls: 0.2), 0.05
    )
    told = []
    for _ in range(3):
        judge(())
        told.append(estimate(judge, ()))
    assert told == [None, None, pytest.approx(0.04)]


def test_who_only_judges_estimates_nothing() -> None:
    judge = TimedJudge(lambda controls: Verdict(0.04, ()), 0.05)
    judge(())
    assert estimate(judge, ()) is None
    assert estimate(lambda controls: Verdict(0.04, ()), ()) is None


def test_no_plan_is_kept_by_an_estimate() -> None:
    """Estimates say that nothing risks anything, the referee that all risk twice Δ."""
    scenario = along_intervals(circle(3))
    fleet = Fleet.of(scenario, 1e-3, Limits())
    asked: list[str] = []

    def verdict(controls: Controls) -> Verdict:
        asked.append("verdict")
        return Verdict(2.0 * scenario.risk_bound, ())

    def rough(controls: Controls) -> float:
        asked.append("rough")
        return 1e-9

    judge = TimedJudge(RoughJudge(verdict, rough), scenario.risk_bound)
    judge(())
    task = Task(fleet.programs.hazards, judge, Limits(), 1e-3, scenario.risk_bound)
    turning = Turning(task, FleetIncumbent(), ((0, 1, 2),), 1.0)
    assert turning.successive.begin_alone()
    assert not turning.run(4).controls
    # Whoever risked far too much is estimated first, and judged where that speaks for it.
    assert "rough" in asked
    assert asked.count("verdict") > 2


def test_paths_dearer_than_the_plan_are_not_judged() -> None:
    scenario = along_intervals(circle(3))
    hazards = Fleet.of(scenario, 1e-3, Limits()).programs.hazards
    asked: list[Controls] = []

    def verdict(controls: Controls) -> Verdict:
        asked.append(controls)
        return Verdict(0.04, ())

    judge = TimedJudge(RoughJudge(verdict, lambda controls: 0.2), scenario.risk_bound)
    judge(())
    task = Task(hazards, judge, Limits(), 1e-3, scenario.risk_bound)
    controls = tuple(np.zeros((scenario.horizon, 2)) for _ in condensed_models(scenario))
    cheaper = FleetIncumbent(controls, 1e-3, ((0, 1, 2),), 0.04)
    turning = Turning(task, cheaper, cheaper.sets, 1.0)
    assert turning.successive.begin_alone()
    found = turning.run(3)
    assert found is cheaper
    assert len(asked) == 1
