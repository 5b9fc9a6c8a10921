"""What a limit ends: nothing that takes long begins once one is reached."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import circle, paper
from radmpc.model.plan import Status
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.phases.time_shares import but_for_certificates
from radmpc.planners.certified.problem import SetProblem
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.task import Task
from radmpc.planners.certified.state.timed_judge import TimedJudge
from radmpc.planners.certified.turned.turning import Turning
from radmpc.planners.presets import parse_planner
from radmpc.planners.verdict import Verdict
from radmpc.planning import plan, unjudged_plan
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.referee import certify
from radmpc.solvers.solution import Limits


@pytest.fixture
def built(monkeypatch: pytest.MonkeyPatch) -> list[tuple[int, ...]]:
    """Return a list of the sets whose programs are built from now on."""
    sets, plain = list[tuple[int, ...]](), SetProblem.of.__func__

    def of(cls, scenario, members, *rest, **options):
        sets.append(members)
        return plain(cls, scenario, members, *rest, **options)

    monkeypatch.setattr(SetProblem, "of", classmethod(of))
    return sets


def test_once_stopped_no_program_is_built(built) -> None:
    result = plan(paper(5, 0), "certified", stop=lambda: True)
    assert result.status is Status.LIMIT
    assert "it was stopped on request" in result.explanation
    assert built == []


def test_a_first_plan_is_the_answer_where_no_time_is_left_for_a_search(built) -> None:
    told = []
    result = plan(
        circle(4),
        "certified",
        found=lambda cost, bound: told.append((cost, bound)),
        stop=lambda: bool(told),
    )
    assert built == []
    assert result.status is Status.FEASIBLE
    assert result.is_certified
    assert result.plan.stopped_by == "it was stopped on request (Ctrl-C)"
    assert result.cost == pytest.approx(told[-1][0])
    # What vehicles cost in empty space is known without any program of theirs.
    assert 0.0 < result.plan.lower_bound == result.plan.certified_lower_bound < result.cost
    assert certify(result.plan).holds


def test_programs_are_built_one_by_one_until_a_limit(built) -> None:
    fleet = Fleet.of(paper(4, 0), 1e-3, Limits())
    assert built == []
    assert not fleet.programs.build_alone(Limits(is_stopped=lambda: len(built) == 2))
    assert built == [(0,), (1,)]
    assert fleet.programs.build_alone(Limits())
    assert built == [(0,), (1,), (2,), (3,)]


def test_a_vehicle_costs_the_same_in_empty_space_with_its_program_or_without(built) -> None:
    without, fleet = (Fleet.of(paper(4, 0), 1e-3, Limits()) for _ in range(2))
    costs = without.programs.least_costs()
    assert built == []
    assert fleet.programs.build_alone(Limits())
    assert fleet.programs.least_costs() == pytest.approx(costs, rel=1e-12)


def test_a_fleet_that_is_proven_around_its_first_plan_needs_no_program_by_faces(built) -> None:
    assert plan(paper(4, 0), "certified", rng=0).status is Status.OPTIMAL
    assert built == []


def test_a_vehicle_costs_what_it_does_alone_or_with_its_visits_whichever_is_more() -> None:
    fleet = Fleet.of(paper(2, 0), 1e-3, Limits())
    alone = fleet.base
    assert min(alone) > 0.0
    assert replace(fleet, least_costs=(0.0, 99.0)).base == (alone[0], 99.0)


def test_a_plan_that_others_judge_is_the_same_without_its_certificate() -> None:
    scenario, planner = paper(3, 0), parse_planner("certified(0)")
    judged = plan(scenario, planner, rng=0).require()
    unjudged = unjudged_plan(scenario, planner, seed=0, time_limit=None)
    assert judged.risk.certified is not None
    assert unjudged.risk.certified is None
    for one, other in zip(judged.trajectories, unjudged.trajectories, strict=True):
        np.testing.assert_array_equal(one.controls, other.controls)


def test_a_plan_that_others_judge_is_none_once_its_time_is_up() -> None:
    found = unjudged_plan(paper(3, 0), parse_planner("certified(0)"), seed=0, time_limit=0.0)
    assert found.status is Status.LIMIT
    assert found.trajectories == ()


@pytest.mark.parametrize(("certificate", "kept"), [(0.5, 1.0), (1e-6, 2e-6), (50.0, 7.5)])
def test_time_is_kept_for_the_last_certificates(certificate: float, kept: float) -> None:
    limits = but_for_certificates(Limits(time_limit=30.0).within(10.0), certificate)
    assert limits.seconds_left == pytest.approx(10.0 - kept, abs=0.2)
    assert limits.time_limit == 30.0
    assert but_for_certificates(Limits(), certificate) == Limits()


def test_a_judge_knows_what_its_longest_certificate_took() -> None:
    naps = iter([0.0, 0.05, 0.0])

    def judge(controls: object) -> Verdict:
        time.sleep(next(naps))
        return Verdict(0.1, ())

    timed = TimedJudge(judge, 0.05)
    assert timed.seconds == 0.0
    for _ in range(3):
        assert timed(()).certified == 0.1
    assert 0.05 <= timed.seconds < 0.5


@pytest.mark.parametrize(("seconds", "is_turned"), [(0.25, False), (60.0, True)])
def test_no_round_of_turning_begins_without_time_for_its_certificate(
    seconds: float, *, is_turned: bool
) -> None:
    scenario = circle(3)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    asked = []

    def judge(controls: object) -> Verdict:
        asked.append(controls)
        time.sleep(0.15)
        return Verdict(0.01, ())

    task = Task(hazards, judge, Limits().within(seconds), 1e-3, scenario.risk_bound)
    turning = Turning(task, FleetIncumbent(), ((0, 1, 2),), 1.0)
    turning.run(2)
    assert (len(asked) > 1) == is_turned
