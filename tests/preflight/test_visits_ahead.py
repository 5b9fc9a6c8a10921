from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from radmpc import Goal, Scenario, Vehicle, Visit, double_integrator, plan
from radmpc.model.visits import steps_visited
from radmpc.preflight import Concern, concerns_of, outlook_of
from radmpc.preflight.pace import Pace
from radmpc.preflight.visits import earliest_visits

HORIZON = 9


def vehicle(*via: Visit, speed: float | None = None, within: list[int] | None = None) -> Vehicle:
    return Vehicle(
        name="a",
        system=double_integrator(1.0, 2),
        start=[0.0, 0.0],
        goal=Goal.at([12.0, 0.0], 0.5, within=within),
        radius=0.3,
        control_limit=2.0,
        initial_covariance=1e-4,
        disturbance_covariance=0.0,
        speed_limit=speed,
        via=via,
    )


def alone(one: Vehicle) -> Scenario:
    return Scenario("ahead", 1.0, HORIZON, 0.01, [one])


def earliest(one: Vehicle) -> tuple[int | None, ...]:
    pace = Pace.of(one)
    assert pace is not None
    return earliest_visits(one, pace, np.tile(one.control_limit, (HORIZON, 1)))


@pytest.mark.parametrize("speed", [None, 1.5])
@pytest.mark.parametrize("place", [[4.0, 3.0], [-6.0, 0.0], [0.2, 7.0]])
def test_the_first_leg_is_as_short_as_a_goal_there_would_be(
    place: list[float], speed: float | None
) -> None:
    visit = Visit.at(place, 0.5, speed=0.5)
    there = replace(vehicle(speed=speed), goal=Goal.at(place, 0.5, 0.5))
    pace = Pace.of(there)
    assert pace is not None
    steps = [k for k in range(1, HORIZON) if pace.arrives(np.full((k, 2), 2.0))]
    assert earliest(vehicle(visit, speed=speed))[0] == min(steps, default=None)


def test_no_plan_is_earlier_and_one_is_not_much_later() -> None:
    one = vehicle(Visit.at([4.0, 3.0], 0.5), Visit.at([9.0, -2.0], 0.5), within=[1, HORIZON])
    soonest = earliest(one)
    planned = plan(replace(alone(one), time_weight=1e3), "dlp").require()
    means = planned.trajectories[0].means
    visited = steps_visited(one.via, means[:, :2], means[:, 2:])
    arrival = one.goal.arrival(means[:, :2], means[:, 2:])
    assert arrival is not None
    for bound, made in zip(soonest, (*visited, arrival), strict=True):
        assert bound is not None
        assert made - 3 <= bound <= made


def test_windows_and_what_comes_before_count() -> None:
    late = vehicle(Visit.at([0.0, 0.0], 1.0, between=[5, 8]), Visit.at([4.0, 3.0], 0.5))
    assert earliest(late)[:2] == (5, 6)
    far = Visit.at([0.0, 9.0], 0.5)
    assert earliest(vehicle(far))[1] is not None
    assert earliest(vehicle(far, Visit.at([0.0, -9.0], 0.5)))[2] is None


def test_a_check_names_the_first_visit_that_is_too_late() -> None:
    hasty = vehicle(Visit.at([1.0, 0.0], 0.5), Visit.at([9.0, 3.0], 0.5, between=[2, 2]))
    seen = outlook_of(alone(hasty))
    assert seen.vehicles[0].visits == (1, None, None)
    (concern,) = [c for c in concerns_of(seen) if c.kind == "visit"]
    assert concern.is_fatal
    assert "cannot be at via[1] by step 2 after via[0], at step 1 at best" in concern.text
    assert plan(alone(hasty), "dlp").plan is None


def test_a_check_warns_of_a_goal_that_is_hardly_reached_after_visits() -> None:
    seen = outlook_of(alone(vehicle(Visit.at([0.0, 9.0], 0.5))))
    assert [c.is_fatal for c in concerns_of(seen) if c.kind == "visit"] in ([], [False])
    beyond = outlook_of(alone(vehicle(Visit.at([0.0, 20.0], 0.5))))
    (concern,) = [c for c in concerns_of(beyond) if c.kind == "visit"]
    assert concern.is_fatal
    assert outlook_of(alone(vehicle())).vehicles[0].visits == ()


def told(text: str, words: str) -> float:
    found = re.search(re.escape(words) + r" ([0-9.]*[0-9])", text)
    assert found is not None, text
    return float(found[1])


def visit_concerns(scenario: Scenario) -> list[Concern]:
    return [c for c in concerns_of(outlook_of(scenario)) if c.kind == "visit"]


def test_every_cure_of_a_visit_that_is_too_late_cures_it() -> None:
    far = vehicle(Visit.at([0.0, 20.0], 0.5), speed=9.0)
    (concern,) = visit_concerns(alone(far))
    horizon = int(told(concern.text, "lengthen the horizon to"))
    assert visit_concerns(replace(alone(far), horizon=horizon)) == []
    limit = told(concern.text, "raise control_limit to")
    assert visit_concerns(alone(replace(far, control_limit=limit))) == []
    assert "speed_limit" not in concern.text  # it never gets that fast


def test_no_horizon_is_advised_where_a_window_ends_too_early() -> None:
    hasty = vehicle(Visit.at([1.0, 0.0], 0.5), Visit.at([9.0, 3.0], 0.5, between=[2, 2]))
    (concern,) = visit_concerns(alone(hasty))
    assert "horizon" not in concern.text
    limit = told(concern.text, "raise control_limit to")
    assert visit_concerns(alone(replace(hasty, control_limit=limit))) == []
