"""What is told of several assignments: costs that fall, bounds that hold for all, all the time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from test_goals_assigned import sharing

from radmpc import Plan, Scenario, Status, plan
from radmpc.model.relations.goals import places_of
from radmpc.planners import assignment
from radmpc.planners.assignment import least_costs
from radmpc.planners.certified.certified import Certified
from radmpc.planners.draft import Draft, Event, Step
from radmpc.planners.outcome.best_of_all import Cheaper
from radmpc.planners.planner import Planner, Run
from radmpc.result import Result

FIRST, SECOND = (1, 0), (0, 1)
"""The assignments of two vehicles to two goals, the one of the less sum first."""

LEASTS = (8.75, 11.5)
"""What they cost at least in empty space."""

Script = Callable[[Run], Draft]


def costing(scenario: Scenario, cost: float) -> tuple[np.ndarray, ...]:
    """Return controls that cost as much, wherever they lead."""
    found = [np.zeros((scenario.horizon, 2)) for _ in scenario.vehicles]
    found[0][0, 0] = cost / scenario.vehicles[0].cost_weight
    return tuple(found)


def drafted(status: Status, cost: float | None = None, **changes: object) -> Draft:
    controls = () if cost is None else costing(sharing(2, 2), cost)
    return replace(Draft(status, controls, ((0, 1),), (), (), {"sets": 1.0}), **changes)


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> Callable[..., Result]:
    """Plan two vehicles with two goals, each assignment by a script or to a draft."""

    def answered(first: Draft | Script, second: Draft | Script, **options: object) -> Result:
        scripts = {FIRST: first, SECOND: second}

        def scripted(self: Certified, scenario: Scenario, planner: Planner, run: Run) -> Draft:
            goals = places_of(scenario.goals, [v.goal for v in scenario.vehicles])
            script = scripts.pop(goals)  # type: ignore[arg-type] # all goals are shared ones
            return script if isinstance(script, Draft) else script(run)

        monkeypatch.setattr(Certified, "plan", scripted)
        result = plan(sharing(2, 2), **options)  # type: ignore[arg-type] # options by name
        assert not scripts
        return result

    return answered


def test_the_scripts_are_of_assignments_in_the_order_of_their_sums() -> None:
    costs = least_costs(sharing(2, 2))
    sums = [costs[0, i] + costs[1, j] for i, j in (FIRST, SECOND)]
    assert sums == pytest.approx(LEASTS)


def test_costs_told_never_rise_and_bounds_told_hold_for_every_assignment(asked) -> None:
    def first(run: Run) -> Draft:
        run.found(15.0, None)
        run.found(14.0, 13.0)
        run.found(14.0, 13.5)
        return drafted(Status.OPTIMAL, 14.0, lower_bound=13.99, certified_lower_bound=9.0)

    def second(run: Run) -> Draft:
        run.found(16.0, 11.6)
        run.found(12.5, 11.8)
        run.found(12.0, None)
        return drafted(Status.OPTIMAL, 12.0, lower_bound=11.99, certified_lower_bound=11.7)

    told: list[tuple[float, float | None]] = []
    result = asked(first, second, found=lambda cost, bound: told.append((cost, bound)))
    assert result.cost == pytest.approx(12.0)
    costs, bounds = zip(*told, strict=True)
    assert costs == pytest.approx([15.0, 14.0, 14.0, 14.0, 12.5, 12.0, 12.0])
    # While the first is planned the other one costs 11.5 at least, which is nearer than 13.
    assert bounds == pytest.approx([8.75, 11.5, 11.5, 11.5, 11.8, 11.8, 11.99])
    assert max(bounds) <= result.cost


def test_of_an_assignment_dearer_than_the_best_nobody_is_told(asked) -> None:
    def second(run: Run) -> Draft:
        run.found(16.0, 11.6)
        return drafted(Status.OPTIMAL, 16.0, lower_bound=15.9)

    def first(run: Run) -> Draft:
        run.found(14.0, 13.5)
        return drafted(Status.OPTIMAL, 14.0, lower_bound=13.9)

    told: list[tuple[float, float | None]] = []
    result = asked(first, second, found=lambda cost, bound: told.append((cost, bound)))
    assert {cost for cost, _ in told} == {14.0}
    assert told[-1] == (14.0, pytest.approx(13.9))
    assert result.lower_bound == pytest.approx(13.9)


def test_no_plan_by_faces_bounds_no_other_plan_that_the_referee_would_certify(asked) -> None:
    best = drafted(Status.OPTIMAL, 12.0, lower_bound=11.99, certified_lower_bound=11.99)
    by_faces = asked(drafted(Status.INFEASIBLE), best)
    assert by_faces.lower_bound == pytest.approx(11.99)
    assert by_faces.certified_lower_bound == pytest.approx(LEASTS[0])
    for_any = asked(drafted(Status.INFEASIBLE, rules_out_any=True), best)
    assert for_any.certified_lower_bound == pytest.approx(11.99)


@pytest.mark.parametrize(
    "ended", [(Status.INFEASIBLE, Status.LIMIT), (Status.LIMIT, Status.INFEASIBLE)]
)
def test_an_assignment_that_ran_out_of_time_leaves_open_whether_there_is_a_plan(
    asked, ended: tuple[Status, Status]
) -> None:
    drafts = [drafted(status, explanation=f"It is {status.value}.") for status in ended]
    result = asked(*drafts)
    assert result.status is Status.LIMIT
    assert "It is limit." in str(result.explanation)


def test_an_assignment_without_a_plan_says_why_even_where_its_planner_does_not(asked) -> None:
    ended = "the time limit of 5 s was reached"
    result = asked(drafted(Status.LIMIT, stopped_by=ended), drafted(Status.INFEASIBLE))
    assert str(result.explanation).endswith(
        f"No plan was found with these goals, and none was ruled out: {ended}."
    )


def test_without_a_plan_for_any_assignment_there_is_none(asked) -> None:
    result = asked(drafted(Status.INFEASIBLE), drafted(Status.INFEASIBLE))
    assert result.status is Status.INFEASIBLE


def test_seconds_steps_and_events_are_those_of_all_assignments(asked) -> None:
    steps = [Step("sets", ("a", "b"), 0, c, 0, 0, 0.0, 0.0, 0.0, 1, 0.1) for c in (14.0, 12.0)]
    events = [Event(step, "a", ("b",)) for step in (1, 2)]
    drafts = [
        drafted(
            Status.FEASIBLE, step.cost, steps=(step,), events=(event,), seconds={"sets": s, **more}
        )
        for step, event, s, more in zip(
            steps, events, (3.0, 4.0), ({"coarse": 0.5}, {}), strict=True
        )
    ]
    result = asked(*drafts)
    assert result.seconds["sets"] == 7.0
    assert result.seconds["coarse"] == 0.5
    assert result.steps == tuple(steps)
    assert result.events == tuple(events)


def test_every_better_plan_is_handed_on_with_the_goals_that_were_assigned() -> None:
    given, handed = sharing(2, 2), list[Plan]()
    result = plan(given, "certified(0)", improved=handed.append)
    assert handed
    assert handed[-1].cost == pytest.approx(result.cost)
    for one in handed:
        goals = [vehicle.goal for vehicle in one.scenario.vehicles]
        assert places_of(given.goals, goals) == FIRST
        assert one.risk.certified is not None
        assert one.risk.certified <= given.risk_bound


def test_plans_of_another_assignment_are_handed_on_only_if_they_are_cheaper() -> None:
    planned = plan(sharing(1, 1), "dlp").require()
    handed: list[Plan] = []
    cheaper = Cheaper(handed.append)
    assert cheaper.least == np.inf
    for cost in (9.0, 12.0, 8.0, 8.0):
        cheaper(replace(planned, cost=cost))
    assert [one.cost for one in handed] == [9.0, 8.0]
    assert cheaper.least == 8.0


@pytest.mark.parametrize("is_overdrawn", [False, True])
def test_what_is_out_of_reach_costs_without_end(*, is_overdrawn: bool) -> None:
    given = sharing(2, 2)
    slow = replace(given.vehicles[0], control_limit=1e-3)
    if is_overdrawn:
        # Feedback keeps more control back than there is.
        slow = replace(given.vehicles[0], control_limit=0.1, control_sigmas=1e3)
    costs = least_costs(replace(given, vehicles=(slow, given.vehicles[1])))
    assert np.all(np.isinf(costs[0]))
    assert np.all(np.isfinite(costs[1]))


def test_the_number_of_assignments_is_exact(monkeypatch: pytest.MonkeyPatch) -> None:
    # 3! of 3 goals, 4!/2! of 4.
    monkeypatch.setattr(assignment, "_ALL", 6)
    told = [assignment._are_few(np.zeros(shape)) for shape in ((3, 3), (2, 3), (2, 4))]
    assert told == [True, True, False]
