"""What a check warns of where vehicles keep a range."""

from __future__ import annotations

from dataclasses import replace

import pytest
from scenes_checked import of_scene, warned

import radmpc
from radmpc import Goal, Keep, Scenario, Vehicle, double_integrator
from radmpc.console.commands.check import outlook_json
from radmpc.planners.endpoints.floors import EndpointHazard
from radmpc.planners.wording import endpoints_text
from radmpc.preflight import concerns_of, outlook_of

SYSTEM = double_integrator(1.0, 2)


def vehicle(name: str, start: list[float], goal: list[float]) -> Vehicle:
    return Vehicle(
        name=name, system=SYSTEM, start=start, goal=Goal.at(goal, 0.5), radius=0.3,
        control_limit=1.0, initial_covariance=1e-3, disturbance_covariance=1e-4,
    )  # fmt: skip


def keeping(within: float, far: float = 6.0, end: float = 3.0, bound: float = 0.01) -> Scenario:
    """Two who start at a distance, and whose goals' centers end at another."""
    fleet = [vehicle("a", [0.0, 0.0], [8.0, 0.0]), vehicle("b", [0.0, far], [8.0, end])]
    return Scenario("escort", 1.0, 10, bound, fleet, keep=[Keep(["b", "a"], within)])


def test_check_warns_where_two_begin_out_of_range() -> None:
    given = keeping(5.0)
    (concern,) = warned(given, "endpoint")
    assert concern.is_fatal
    assert set(concern.vehicles) == {"a", "b"}
    found = radmpc.plan(given)
    assert found.status is radmpc.Status.INFEASIBLE
    assert found.explanation is not None
    assert concern.text in found.explanation
    assert "6 m apart" in concern.text


def test_check_warns_where_two_end_out_of_range() -> None:
    given = keeping(5.0, far=3.0, end=7.0)
    (concern,) = warned(given, "endpoint")
    assert concern.is_fatal
    assert concern.text.startswith("The goals of vehicles 'a' and 'b' are 6 m apart or more")


def test_a_range_below_contact_is_lost_where_two_begin() -> None:
    (concern,) = warned(keeping(0.5, far=6.0, end=1.0), "endpoint")
    assert concern.text.startswith("The starts of vehicles 'a' and 'b' are 6 m apart")


def test_a_range_that_holds_at_both_ends_is_no_concern() -> None:
    outlook = outlook_of(keeping(12.0))
    assert outlook.least_risk == 0.0
    assert outlook.ranges == ()
    assert [one.kind for one in concerns_of(outlook)] == []


def test_a_range_lost_at_both_ends_counts_once_in_the_least_risk() -> None:
    outlook = outlook_of(keeping(5.0, end=8.0))
    told = outlook_json(outlook, ())
    assert told["least_risk"] == pytest.approx(1.0)
    assert [(one["at"], one["cause"]) for one in told["endpoints"]] == [
        ("start", "range"), ("goal", "range"),
    ]  # fmt: skip
    assert told["endpoints"][0]["members"] == ["a", "b"]
    assert told["endpoints"][0]["distance"] == pytest.approx(6.0)
    for seen in outlook.vehicles:
        assert seen.start_risk == pytest.approx(1.0)
        assert seen.goal_risk == pytest.approx(told["endpoints"][1]["risk"])


def test_a_range_that_is_nearly_lost_is_told_as_a_part_of_the_bound() -> None:
    # 2.2 standard deviations of a distance, each of 0.045 m: 1.3 %.
    given = keeping(6.1, bound=0.05)
    (concern,) = warned(given, "endpoint")
    assert not concern.is_fatal
    assert "the starts of 'a' and 'b' at the end of their range" in concern.text
    assert "Starts and goals alone take 0.013 of risk_bound 0.05" in concern.text


def test_a_sum_over_starts_and_goals_that_leaves_out_ranges_says_so() -> None:
    hazards = [EndpointHazard("obstacle", (i,), "reef", True, 0.006, 0.4) for i in (0, 1)]
    told = endpoints_text(keeping(5.0), hazards, 0.012)
    assert told.startswith("Starts and goals alone, ranges aside, run a risk of 0.012, above")
    told = endpoints_text(replace(keeping(5.0), keep=()), hazards, 0.012)
    assert told.startswith("Starts and goals alone run a risk of 0.012, above")


def test_goals_to_choose_from_out_of_range_do_not_rule_out_a_plan() -> None:
    given = keeping(5.0, far=3.0, end=7.0)
    goals = [*(v.goal for v in given.vehicles), Goal.at([8.0, 3.0], 0.5)]
    shared = replace(given, goals=goals, keep=[Keep(["b", "a"], 2.0)])
    fatal = [one.is_fatal for one in warned(shared, "endpoint")]
    assert fatal == [True, False]


def test_ranges_stand_beside_goals_too_near_to_something() -> None:
    scene = of_scene("goal-too-near-fleet")
    names = [v.name for v in scene.vehicles]
    alone = warned(scene, "endpoint")
    both = warned(replace(scene, keep=[Keep([names[0], names[3]], 0.01)]), "endpoint")
    assert [one.text for one in both[: len(alone)]] == [one.text for one in alone]
    assert len(both) == len(alone) + 2
