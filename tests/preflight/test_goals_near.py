"""What a check before planning makes of goals that are shared."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc import Goal, Obstacle, Scenario, Vehicle, double_integrator
from radmpc.console.commands.check import check_report, outlook_json
from radmpc.preflight import concerns_of, outlook_of
from radmpc.preflight.goals import with_near_goals

SYSTEM = double_integrator(1.0, 2)


def vehicle(name: str, start: list[float], goal: Goal, **more: float) -> Vehicle:
    return Vehicle(
        name=name, system=SYSTEM, start=start, goal=goal, radius=0.3, control_limit=1.0,
        initial_covariance=1e-4, disturbance_covariance=0.0, speed_limit=more.get("speed", 2.0),
    )  # fmt: skip


def berths(*xs: float) -> list[Goal]:
    return [Goal.at([x, 0.0], 0.5, 0.1) for x in xs]


def sharing(starts: list[float], xs: list[float], horizon: int = 12) -> Scenario:
    """Vehicles on a line whose goals, as given, are those of the list in its order."""
    goals = berths(*xs)
    fleet = [
        vehicle(f"v{i}", [x, 3.0], goal)
        for i, (x, goal) in enumerate(zip(starts, goals, strict=False))
    ]
    return Scenario("berths", 1.0, horizon, 0.01, fleet, goals=goals)


def kinds(scenario: Scenario) -> list[str]:
    return [one.kind for one in concerns_of(outlook_of(scenario)) if one.is_fatal]


def test_goals_given_crosswise_are_looked_at_as_they_are_near() -> None:
    crosswise = sharing([0.0, 40.0], [40.0, 0.0])
    assert kinds(replace(crosswise, goals=())) == ["time", "time"]
    assert kinds(crosswise) == []
    told = check_report(outlook_of(crosswise), ())
    assert str(told[1]).endswith("in time and by the least sum of distances: v0 to 2, v1 to 1")
    assert outlook_json(outlook_of(crosswise), ())["goals"] == [1, 0]
    assert outlook_json(outlook_of(replace(crosswise, goals=())), ())["goals"] == []


def test_goals_that_take_the_same_time_do_not_cross() -> None:
    # As long along x either way: only the distances tell the two assignments apart.
    goals = [Goal.at([30.0, y], 0.5) for y in (0.0, 12.0)]
    fleet = [vehicle("a", [0.0, 12.0], goals[0]), vehicle("b", [0.0, 0.0], goals[1])]
    found = with_near_goals(Scenario("two", 1.0, 24, 0.01, fleet, goals=goals))
    assert [v.goal.center[1] for v in found.vehicles] == [12.0, 0.0]


def test_arriving_in_time_goes_before_distance() -> None:
    # The slow one reaches the near goal alone, though the quick one is nearer to it.
    goals = berths(5.0, 13.0)
    slow, quick = (
        vehicle("slow", [0.0, 0.0], goals[1], speed=0.6),
        vehicle("quick", [4.0, 0.0], goals[0]),
    )
    found = with_near_goals(Scenario("two", 1.0, 12, 0.01, [slow, quick], goals=goals))
    assert [v.goal.center[0] for v in found.vehicles] == [5.0, 13.0]


def test_who_is_late_wherever_he_goes_is_told() -> None:
    assert kinds(sharing([0.0, 100.0], [1.0, 2.0, 3.0])) == ["time"]


def test_of_many_goals_the_nearest_are_taken() -> None:
    rng = np.random.default_rng(4)
    starts, xs = rng.uniform(0.0, 30.0, 6).tolist(), rng.uniform(0.0, 30.0, 9).tolist()
    found = with_near_goals(sharing(starts, xs, horizon=60))
    far = sum(abs(v.start_position[0] - v.goal.center[0]) for v in found.vehicles)
    # On a line starts and their goals come in the same order: a program over both, sorted.
    starts, xs = sorted(starts), sorted(xs)
    best = np.zeros(len(xs) + 1)
    for start in starts:
        taken = np.full(len(xs) + 1, np.inf)
        for j, x in enumerate(xs):
            taken[j + 1] = min(taken[j], best[j] + np.hypot(start - x, 3.0))
        best = taken
    total = sum(np.linalg.norm(v.start_position - v.goal.center) for v in found.vehicles)
    assert total == pytest.approx(best[-1])
    assert far <= total


def test_a_goal_in_an_obstacle_does_not_rule_out_the_others() -> None:
    given = sharing([0.0, 4.0], [0.0, 4.0, 6.0])
    rock = Obstacle.box("rock", [3.0, -2.0], [4.9, 1.0])
    assert "endpoint" in kinds(replace(given, goals=(), obstacles=(rock,)))
    assert kinds(replace(given, obstacles=(rock,))) == []
