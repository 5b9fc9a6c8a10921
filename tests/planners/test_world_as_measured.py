"""Every planner plans for drift and for noise as it is measured, in the plane and in space."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binomtest

import radmpc
from radmpc.model.dynamics import double_integrator, lqr_gain
from radmpc.model.noise.measurement import Measurement
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planners import PRESETS


def drifting(vehicle: Vehicle, number: int) -> Vehicle:
    """Carry one by a current, and blow the other off."""
    d = vehicle.system.dimension
    drift = np.zeros(2 * d)
    drift[:2] = ([0.3, -0.2], [0.05, -0.1])[number]
    drift[d] = 0.05 * number
    return replace(vehicle, drift=drift)


def gusty(vehicle: Vehicle, number: int) -> Vehicle:
    """Shake both by gusts of different lengths."""
    return replace(vehicle, disturbance_correlation=(0.7, 0.3)[number])


def measuring(vehicle: Vehicle, number: int) -> Vehicle:
    """Let one see positions alone, and the other all but a velocity, in gusts."""
    n = vehicle.system.num_states
    states = (range(n // 2), range(n - 1))[number]
    sensor = Measurement.of(list(states), n, 2e-3)
    return replace(vehicle, measurement=sensor, disturbance_correlation=(0.0, 0.5)[number])


def beside_a_freighter(vehicle: Vehicle, number: int) -> Vehicle:
    """Leave both as they are: what is not known is where the freighter goes."""
    del number
    return vehicle


WORLDS: dict[str, Callable[[Vehicle, int], Vehicle]] = {
    "drift": drifting,
    "gusts": gusty,
    "measured": measuring,
    "freighter": beside_a_freighter,
}


def craft(name: str, start: list[float], goal: list[float], **more: object) -> Vehicle:
    """Return a double integrator with feedback."""
    d = len(start)
    system = double_integrator(1.0, d)
    return Vehicle(
        name=name,
        system=system,
        start=start,
        goal=Goal(np.array(goal) - 0.2, np.array(goal) + 0.2, np.full(d, 0.05)),
        radius=0.4,
        control_limit=1.0,
        speed_limit=3.0,
        initial_covariance=[1e-3] * d + [1e-4] * d,
        disturbance_covariance=[1e-3] * d + [1e-4] * d,
        gain=lqr_gain(system, np.eye(2 * d), np.eye(d)),
        **more,
    )


def fleet(world: str, avoidance: str = "intervals", d: int = 2) -> Scenario:
    """Return two vehicles that pass each other at a pier."""
    high = [0.0] * (d - 2)
    a = craft("a", [0.0, 0.0, *high], [8.0, 0.0, *high])
    b = craft("b", [8.0, 0.5, *high], [0.0, 0.5, *high])
    a, b = (WORLDS[world](vehicle, number) for number, vehicle in enumerate((a, b)))
    low, top = [-9.0] * (d - 2), [9.0] * (d - 2)
    pier = Obstacle.box("pier", [3.0, -4.0, *low], [4.0, -1.0, *top])
    obstacles = [pier]
    if world == "freighter":
        hull = np.array([[-1.5, -0.4], [1.5, -0.4], [1.5, 0.4], [-1.5, 0.4]])
        solid = np.array([[*corner, h] for corner in hull for h in (-9.0, 9.0)])
        start, still = [8.0, 4.0, *high, -0.6, -0.2, *high], [0.0] * (d - 2)
        known = [0.04, 0.04, *still, 2e-3, 1e-3, *still]
        obstacles.append(
            Obstacle.tracked("freighter", hull if d == 2 else solid, start, known, 5e-4)
        )
    return Scenario("s", 1.0, 8, 0.05, (a, b), obstacles, avoidance=avoidance)


def check(scenario: Scenario, name: str) -> None:
    """Plan, and ask the referee, who has a propagation of its own."""
    plan = radmpc.plan(scenario, name, rng=0).require()
    certificate = radmpc.certify(plan)
    assert not certificate.problems
    if name not in {"milp", "dlp"}:
        assert certificate.holds
        count = radmpc.simulate(plan, 20_000, rng=0).collisions
        low = binomtest(count, 20_000).proportion_ci(1 - 1e-5, "exact").low
        assert low <= certificate.certified


@pytest.mark.slow
@pytest.mark.sampled(5)
@pytest.mark.parametrize("name", sorted(PRESETS))
@pytest.mark.parametrize("world", sorted(WORLDS))
@pytest.mark.parametrize("avoidance", ["intervals", "steps"])
def test_every_planner_plans_for_the_world_as_it_is(name, world, avoidance):
    check(fleet(world, avoidance), name)


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("world", sorted(WORLDS))
def test_the_world_as_it_is_has_three_dimensions(world):
    check(fleet(world, d=3), "certified")


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("world", sorted(WORLDS))
def test_a_proof_is_below_every_certified_plan(world):
    scenario = fleet(world)
    plan = radmpc.plan(scenario, rng=0).require()
    assert plan.certified_lower_bound is not None
    assert plan.certified_lower_bound <= plan.cost
    for name in ("ira", "uniform"):
        other = radmpc.plan(scenario, name, rng=0).require()
        assert radmpc.certify(other).holds
        assert plan.certified_lower_bound <= other.cost + 1e-6


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("world", sorted(WORLDS))
def test_files_keep_the_world_as_it_is(world, tmp_path):
    scenario = fleet(world)
    plan = radmpc.plan(scenario, "uniform", rng=0).require()
    radmpc.save_plan(plan, tmp_path / "fleet.plan.json")
    read = radmpc.load_plan(tmp_path / "fleet.plan.json")
    assert radmpc.to_dict(read) == radmpc.to_dict(plan)
    assert radmpc.certify(read).certified == radmpc.certify(plan).certified


@pytest.mark.parametrize("avoidance", ["intervals", "steps"])
def test_a_track_known_exactly_gives_the_plan_that_its_outlines_give(avoidance):
    base = fleet("freighter", avoidance)
    hull = np.array([[-1.5, -0.4], [1.5, -0.4], [1.5, 0.4], [-1.5, 0.4]])
    place, velocity = np.array([8.0, 4.0]), np.array([-0.6, -0.4])
    outlines = [hull + (place + k * velocity) for k in range(base.horizon + 1)]
    costs = []
    for freighter in (
        Obstacle.tracked("freighter", hull, [*place, *velocity]),
        Obstacle.moving("freighter", outlines),
    ):
        scenario = replace(base, obstacles=(base.obstacles[0], freighter))
        costs.append(radmpc.plan(scenario, "uniform", rng=0).require().cost)
    assert costs[0] == costs[1]


def test_the_less_is_known_of_a_track_the_more_a_plan_costs():
    base = fleet("freighter")
    [pier, freighter] = base.obstacles
    start = [4.0, 2.5, 0.0, -0.3]
    costs = []
    for variance in (0.0, 0.02, 0.08):
        known = [variance, variance, 0.0, 0.0]
        track = Obstacle.tracked("freighter", freighter.shape.outline, start, known)
        scenario = replace(base, obstacles=(pier, track))
        costs.append(radmpc.plan(scenario, "uniform", rng=0).require().cost)
    assert costs[0] < costs[1] < costs[2]
