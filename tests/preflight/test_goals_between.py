"""What a check before planning says of goals that are near several things at once."""

from __future__ import annotations

import re

from radmpc import Goal, Obstacle, Scenario, Vehicle, double_integrator
from radmpc.preflight import concerns_of, outlook_of


def between_walls(goal: tuple[float, float] = (4.0, 0.0)) -> Scenario:
    """A vehicle whose goal is in a passage that leaves it a tenth of a meter on either side."""
    vehicle = Vehicle(
        name="a",
        system=double_integrator(1.0, 2),
        start=[-4.0, 0.0],
        goal=Goal.at(list(goal), 0.3, None),
        radius=0.9,
        control_limit=2.0,
        speed_limit=2.0,
        initial_covariance=1e-4,
        disturbance_covariance=0.0,
    )
    walls = [
        Obstacle.box("north", [-20.0, 1.0], [20.0, 3.0]),
        Obstacle.box("south", [-20.0, -3.0], [20.0, -1.0]),
    ]
    return Scenario("passage", 1.0, 14, 0.05, [vehicle], walls)


def test_a_goal_between_two_walls_is_told_what_both_risk_at_its_best_point() -> None:
    outlook = outlook_of(between_walls())
    (concern,) = [one for one in concerns_of(outlook) if one.kind == "endpoint"]
    assert concern.text.startswith(
        "The goal of vehicle 'a' is too close to obstacle 'north' and obstacle 'south': even its "
        f"best point runs a risk of {outlook.least_risk:.2g}, above risk_bound 0.05."
    )


def test_a_goal_between_two_walls_is_moved_to_where_both_risk_little() -> None:
    (concern,) = [one for one in concerns_of(outlook_of(between_walls())) if one.kind == "endpoint"]
    told = re.search(r"move the goal of 'a' to \(([-0-9.]+), ([-0-9.]+)\)", concern.text)
    assert told is not None
    moved = outlook_of(between_walls((float(told[1]), float(told[2]))))
    assert moved.least_risk <= 0.1 * moved.scenario.risk_bound
