"""Windows, visits and speeds that limits rule out with nothing in the way are told as that."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

import radmpc
from radmpc import Goal, Obstacle, Scenario, Vehicle, Visit
from radmpc.model.plan import Status
from radmpc.planners.explain import unable_alone
from radmpc.planners.least_effort import alone_in_space
from radmpc.planners.reaching.visiting import makes_visits
from radmpc.preflight import concerns_of, outlook_of
from radmpc.preflight.concerns import Concern
from radmpc.program.build import condensed_models
from radmpc.program.visits.steps import at_steps
from radmpc.solvers.lp.outcome import LpOutcome

NOISE = [1e-3, 1e-3, 1e-4, 1e-4]
WALL = Obstacle.box("wall", [9.9, -5.0], [10.1, 5.0])


def ship(within: list[int] | None = None, horizon: int = 12, **fields: object) -> Scenario:
    """A vehicle that reaches its goal 15 m away in 10 steps, and needs 11 around a wall."""
    vehicle = Vehicle(
        "a", radmpc.double_integrator(1.0, 2), [0.0, 0.0],
        Goal.at([15.0, 0.0], 0.5, within=within), radius=0.5, control_limit=1.0, speed_limit=2.0,
        initial_covariance=1e-3, disturbance_covariance=NOISE,
    )  # fmt: skip
    return Scenario("base", 1.0, horizon, 0.01, [replace(vehicle, **fields)], (WALL,))


def detour(*via: Visit, horizon: int = 6, **fields: object) -> Scenario:
    """A vehicle that turns back from a visit beside its way, and has a step too few for that."""
    vehicle = Vehicle(
        "a", radmpc.double_integrator(0.5, 2), [0.0, 0.0], Goal.at([2.4, 0.0], 0.5), radius=0.4,
        control_limit=2.0, initial_covariance=2e-3, disturbance_covariance=0.0,
        via=via or (Visit.at([1.2, 2.0], 0.7),),
    )  # fmt: skip
    return Scenario("mini", 0.5, horizon, 0.01, [replace(vehicle, **fields)])


def why(scenario: Scenario) -> str:
    """What planning says."""
    result = radmpc.plan(scenario, rng=0, time_limit=20.0)
    assert result.status is Status.INFEASIBLE
    return result.explanation


def fatal(scenario: Scenario) -> list[Concern]:
    """What a check says rules out any plan."""
    return [one for one in concerns_of(outlook_of(scenario)) if one.is_fatal]


def test_a_window_that_ends_too_early_is_told_with_the_least_steps() -> None:
    text = why(ship([3, 5]))
    assert text.startswith(
        "Vehicle 'a' cannot be at its goal by step 5, the end of its window (10 steps at best, "
        "10 s), under its control and speed limits, obstacles aside: widen `goal.within`."
    )
    assert "within 12 steps" not in text
    assert "horizon" not in text
    assert "feedback" not in text


def test_the_window_that_is_advised_has_a_plan_and_an_earlier_end_has_none() -> None:
    assert why(ship([3, 5])).endswith("let `goal.within` end at step 11 (11 s).")
    assert radmpc.plan(ship([3, 11]), rng=0, time_limit=20.0).is_certified
    assert "the end of its window (10 steps at best" in why(ship([3, 9]))


def test_a_check_says_of_such_a_window_what_planning_says() -> None:
    (told,) = fatal(ship([3, 5]))
    assert told.kind == "time"
    assert told.text.startswith("Vehicle 'a': cannot be at its goal by step 5, the end of its wind")
    assert told.horizon is None
    assert fatal(ship([3, 10])) == []
    (warning,) = [one for one in concerns_of(outlook_of(ship([3, 10]))) if one.kind == "time"]
    assert "due at step 10, the end of its window: none is left" in warning.text


def test_a_window_before_a_horizon_that_is_too_short_as_well_tells_of_both() -> None:
    text = why(ship([3, 5], horizon=9))
    assert "by step 5, the end of its window, nor within 9 steps (9 s)," in text
    assert "widen `goal.within` and lengthen the horizon" in text


def test_a_window_that_ends_with_a_horizon_tells_of_the_horizon() -> None:
    text = why(ship([3, 9], horizon=9))
    assert "cannot reach its goal within 9 steps (9 s)" in text
    assert "lengthen the horizon to 11 steps (11 s), and windows that end with it" in text


def test_a_goal_that_cannot_be_kept_from_the_end_of_its_window_on_is_late() -> None:
    goal = Goal.at([15.0, 0.0], 0.5, None, within=[3, 6])
    given = {"start": [0.0, 0.0, 2.5, 0.0], "speed_limit": None, "control_limit": 0.25}
    passing = replace(ship(goal=goal, **given), obstacles=())
    assert "by step 6, the end of its window (" in why(passing)
    assert len(fatal(passing)) == 1
    by_then = replace(ship(goal=replace(goal, within=None), horizon=6, **given), obstacles=())
    assert radmpc.plan(by_then, rng=0).is_certified
    assert fatal(by_then) == []


def test_a_single_step_is_singular() -> None:
    assert "cannot reach its goal within 1 step (1 s)" in why(ship(horizon=1))
    assert all("1 steps" not in one.text for one in fatal(ship(horizon=1)))


def test_a_visit_that_limits_rule_out_is_not_blamed_on_faces() -> None:
    text = why(detour())
    assert text == (
        "Vehicle 'a' cannot make its visit via[0] and be at its goal by step 6 (3 s) under its "
        "control limits, obstacles aside. What helps, as tried: lengthen the horizon to 7 steps "
        "(3.5 s)."
    )
    assert radmpc.plan(detour(horizon=7), rng=0).is_certified


def test_a_check_says_of_such_a_visit_what_planning_says() -> None:
    (told,) = fatal(detour())
    assert told.kind == "visit"
    assert told.text.startswith(
        "Vehicle 'a': cannot make its visit via[0] and be at its goal by step 6 (3 s) under its "
        "control limits, obstacles aside: lengthen the horizon to "
    )
    assert fatal(detour(horizon=8)) == []
    assert fatal(detour(control_limit=2.2)) == []


def test_a_visit_with_a_window_is_told_with_it() -> None:
    given = detour(Visit.at([1.2, 2.0], 0.7, between=[2, 4]))
    assert "its visit via[0] between steps 2 and 4 and be" in why(given)
    fixed = detour(Visit.at([1.2, 2.0], 0.7, between=[3, 3]))
    assert "its visit via[0] at step 3 and be" in why(fixed)


def test_visits_that_are_too_many_only_together_are_told_together() -> None:
    two = detour(Visit.at([0.6, 1.0], 0.4), Visit.at([0.6, -1.0], 0.4), horizon=7)
    assert "cannot make its 2 visits in order and be at its goal by step 7 (3.5 s)" in why(two)
    for visit in two.vehicles[0].via:
        assert radmpc.plan(detour(visit, horizon=7), rng=0).is_certified


def test_what_feedback_keeps_back_is_named_where_a_visit_lacks_it() -> None:
    noisy = detour(horizon=7, disturbance_covariance=[3e-3, 3e-3, 3e-2, 3e-2])
    system = noisy.vehicles[0].system
    gain = radmpc.lqr_gain(system, np.eye(4), np.eye(2))
    assert makes_visits(condensed_models(noisy)[0])
    steered = replace(noisy, vehicles=(replace(noisy.vehicles[0], gain=gain),))
    text = why(steered)
    assert "under what its feedback leaves of its control limits (the feedback keeps back" in text
    assert "without it there is a way), obstacles aside" in text
    assert "clearance" not in text
    assert "faces" not in text


def test_the_reason_of_planners_by_rows_is_the_same() -> None:
    result = radmpc.plan(detour(), "ira", rng=0)
    assert "cannot make its visit via[0] and be at its goal by step 6" in result.explanation


@pytest.mark.parametrize(("limit", "is_possible"), [(1.2, False), (1.6, False), (2.0, True)])
def test_visits_can_be_made_exactly_where_some_choice_of_steps_can(
    limit: float, is_possible: bool
) -> None:
    two = detour(
        Visit.at([0.6, 1.0], 0.4), Visit.at([1.5, -0.8], 0.4, speed=1.0), control_limit=limit
    )
    (model,) = condensed_models(two)
    solved = [alone_in_space(at_steps(model, c)).solve()[0] for c in combinations(range(1, 6), 2)]
    assert (LpOutcome.OPTIMAL in solved) is is_possible
    assert makes_visits(model) is is_possible
    assert (unable_alone(two, model) is None) is is_possible


def test_a_start_that_cannot_brake_in_time_is_told_as_that() -> None:
    fast = ship(start=[0.0, 0.0, 5.0, 0.0])
    text = (
        "starts at 5 m/s along x and cannot be below speed_limit 2 at step 1 (braking by 1 m/s "
        "in a step)"
    )
    assert why(fast) == f"Vehicle 'a' {text}."
    (told,) = fatal(fast)
    assert told.text == (f"Vehicle 'a': {text}: raise speed_limit to 4 or raise control_limit to 3")


@pytest.mark.parametrize("speed", [3.0, -3.0])
def test_a_start_that_just_brakes_in_time_is_planned(speed: float) -> None:
    fast = replace(ship(start=[0.0, 0.0, speed, 0.0], horizon=20), obstacles=())
    assert radmpc.plan(fast, rng=0).is_certified
    assert fatal(fast) == []


def test_three_vehicles_that_start_too_fast_are_told_in_one_sentence() -> None:
    one = ship(start=[0.0, 0.0, 0.0, -5.0]).vehicles[0]
    fleet = [replace(one, name=f"v{i}", start=[0.0, 9.0 * i, 0.0, -5.0]) for i in range(3)]
    text = why(replace(ship(), vehicles=tuple(fleet)))
    assert "Vehicles 'v0', 'v1' and 'v2' start at 5 m/s along y and cannot be below" in text
