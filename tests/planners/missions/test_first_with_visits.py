"""Vehicles that nothing stops have their first plan before a search chooses steps of visits."""

from __future__ import annotations

import numpy as np

from radmpc import Goal, Obstacle, Scenario, Vehicle, Visit, double_integrator, plan


def test_where_visits_may_be_made_at_any_step_a_plan_comes_before_the_search() -> None:
    boxes = [(8.0, 1.0), (14.0, 6.0), (9.0, 11.0), (2.0, 9.0)]
    via = tuple(Visit(np.array([x, y]) - 1.0, np.array([x, y]) + 1.0) for x, y in boxes)
    vehicle = Vehicle(
        name="s",
        system=double_integrator(1.0, 2),
        start=[0.0, 0.0],
        goal=Goal.at([0.0, 4.0], 0.5),
        radius=0.3,
        control_limit=1.0,
        initial_covariance=1e-3,
        disturbance_covariance=1e-4,
        via=via,
    )
    rock = Obstacle.box("rock", [7.0, 5.0], [8.0, 6.0])
    scenario = Scenario("survey", 1.0, 24, 0.02, [vehicle], [rock], avoidance="steps")
    told: list[str] = []
    result = plan(
        scenario,
        rng=0,
        time_limit=5.0,
        progress=lambda stage, done, total: told.append(stage),
        found=lambda cost, bound: told.append("found"),
    )
    assert result.is_certified
    assert told.index("found") < told.index("sets")
