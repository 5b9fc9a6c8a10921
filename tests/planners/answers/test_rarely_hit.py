"""Obstacles that are small beside the noise: the referee may certify means within them."""

from __future__ import annotations

from dataclasses import replace

import pytest

from radmpc.model.dynamics import double_integrator
from radmpc.model.goal import Goal
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.planners.certified.infeasible.rarely_hit import rarely_hit
from radmpc.planning import plan
from radmpc.program.build import condensed_models
from radmpc.referee import simulate


def beside_a_wall(*small: Obstacle, radius: float = 0.05) -> Scenario:
    """A vehicle known within 1 m that has to get around a box, to a goal on something small."""
    vehicle = Vehicle(
        name="v",
        system=double_integrator(1.0, 2),
        start=[0.0, 0.0],
        goal=Goal.at([10.0, 0.0], 0.0, speed=None),
        radius=radius,
        control_limit=30.0,
        initial_covariance=[1.0, 1.0, 0.0, 0.0],
        disturbance_covariance=0.0,
    )
    wall = Obstacle.box("wall", [4.0, -2.0], [6.0, 2.0])
    return Scenario("small", 1.0, 3, 0.02, [vehicle], [*small, wall], avoidance="steps")


@pytest.mark.parametrize(
    ("low", "high", "radius"),
    [([10.0, 0.0], [10.0, 0.0], 0.05), ([10.0, -0.5], [10.0, 0.5], 0.005)],
    ids=["post", "wall"],
)
def test_a_goal_on_what_is_rarely_hit_has_a_plan(
    low: list[float], high: list[float], radius: float
) -> None:
    scenario = beside_a_wall(Obstacle.box("small", low, high), radius=radius)
    result = plan(scenario, rng=0, time_limit=20.0)
    assert result.is_certified
    assert result.require().cost < 12.9  # a plan of the same sides certified at 0.0158 costs so
    assert "Planned through obstacle 'small'" in result.explanation
    assert simulate(result.require(), 20_000, rng=0).rate_low <= scenario.risk_bound


def test_a_goal_on_what_is_hit_more_often_has_none() -> None:
    scenario = beside_a_wall(Obstacle.box("small", [10.0, -0.5], [10.0, 0.5]), radius=0.1)
    assert plan(scenario, rng=0, time_limit=20.0).status is Status.INFEASIBLE


def test_only_what_fits_in_the_risk_bound_together_is_left_out() -> None:
    posts = [Obstacle.box(f"post {k}", [10.0 + k, 0.0], [10.0 + k, 0.0]) for k in range(20)]
    scenario = beside_a_wall(*posts)
    found = rarely_hit(scenario, condensed_models(scenario))
    assert found is not None
    # A disc of 5 cm is hit with 0.00125 at most: fifteen of them are within 0.02.
    assert len(found.names) == 15
    assert found.risk < scenario.risk_bound
    assert {one.name for one in found.scenario.obstacles}.isdisjoint(found.names)
    assert len(found.scenario.obstacles) == 6


@pytest.mark.parametrize(
    "change", [{"avoidance": "intervals"}, {"covariance_samples": 30}], ids=["intervals", "samples"]
)
def test_nothing_is_left_out_where_half_spaces_are_charged(change: dict[str, object]) -> None:
    scenario = beside_a_wall(Obstacle.box("small", [10.0, 0.0], [10.0, 0.0]))
    assert rarely_hit(scenario, condensed_models(scenario)) is not None
    changed = replace(scenario, **change)
    assert rarely_hit(changed, condensed_models(changed)) is None
