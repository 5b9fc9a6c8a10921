"""Obstacles on tracks known up to noise; the second simulator draws them in loops."""

from __future__ import annotations

from dataclasses import asdict, replace

import numpy as np
import pytest
from fleets import permuted
from physical_scenes import DI, KINDS, craft, pd, pushed, still
from scipy.stats import norm
from second_opinion import check_certificate, check_counts

from radmpc.flying.mission import Mission
from radmpc.flying.remainder import left_of
from radmpc.model.dynamics import double_integrator
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.referee import certify, simulate

MISSIONS = 10_000
DECK = np.array([[-1.0, -0.4], [1.0, -0.4], [1.0, 0.4], [-1.0, 0.4]])


def passing_by(**more: object) -> Plan:
    """Two that hover, and a freighter of which the course is known within some degrees."""
    freighter = Obstacle.tracked(
        "freighter", DECK, [-2.5, 1.7, 0.8, 0.0], [0.04, 0.04, 0.002, 0.01], [0, 0, 0.001, 0.001]
    )
    a = craft("a", DI, [0, 0], gain=pd(1.0, 1.5))
    b = craft("b", permuted(1.0, 2, np.random.default_rng(3)), [1.1, 0.1], noise=0.05)
    return still(a, b, obstacles=(freighter,), horizon=5, **more)


def passing_by_at_steps() -> Plan:
    return passing_by(avoidance="steps")


def meeting_on_the_way() -> Plan:
    """A vehicle on its way among one that strays, one that is known and one that stands."""
    full = np.array(
        [[0.05, 0.01, 0, 0.005], [0.01, 0.03, 0, 0], [0, 0, 0.01, 0.002], [0.005, 0, 0.002, 0.01]]
    )
    strays = Obstacle.tracked("strays", 0.5 * DECK, [3.0, 1.1, -0.2, -0.05], full)
    known = Obstacle.tracked("known", 0.3 * DECK, [4.0, -1.5, 0.0, 0.05])
    post = Obstacle.box("post", [2.0, -2.0], [2.3, -0.9])
    vehicle = craft("a", DI, [0, 0], gain=pd(0.3, 0.9), speed=[0.6, 0.0], noise=0.05)
    push = np.tile([0.05, 0.0], (4, 1))
    return pushed((vehicle,), [push], obstacles=(post, known, strays))


def adrift_in_space() -> Plan:
    cube = np.stack(np.meshgrid(*[[-0.5, 0.5]] * 3), axis=-1).reshape(-1, 3)
    start = [0.2, 1.6, 0.1, 0.0, -0.1, 0.0]
    balloon = Obstacle.tracked("balloon", cube, start, np.diag([0.05] * 3 + [0.01] * 3), 0.002)
    a = craft("a", double_integrator(1.0, 3), [0, 0, 0], gain=pd(1.0, 1.5, 3))
    return still(a, obstacles=(balloon,), horizon=4)


SCENES = [passing_by, passing_by_at_steps, meeting_on_the_way, adrift_in_space]
FALSE_ALARM = 1e-4 / (len(SCENES) * len(KINDS))


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.__name__)
def test_simulation_counts_what_the_second_simulator_counts(scene):
    check_counts(scene(), MISSIONS, FALSE_ALARM, "obstacle_collisions")


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.__name__)
def test_the_certificate_is_just_above_the_second_simulator(scene):
    check_certificate(scene(), MISSIONS)


def test_at_steps_the_certificate_is_the_exact_probability_of_the_sum_of_both_noises():
    """One step matters, one long face: the tail of the distance, whose variances add up."""
    wall = np.array([[0.0, -50.0], [2.0, -50.0], [2.0, 50.0], [0.0, 50.0]])
    track = Obstacle.tracked("wall", wall, [1.0, 0.0, 0.0, 0.0], [0, 0, 0.01, 0], [0.02, 0, 0, 0])
    vehicle = craft("a", DI, [0, 0], noise=0.1, radius=0.3)
    plan = still(vehicle, obstacles=(track,), horizon=2, avoidance="steps")
    # At k = 1 speed and jolt, at k = 2 twice the speed and two jolts; the vehicle's likewise.
    first = norm.sf(0.7 / np.sqrt(0.01 + 0.02 + 0.01))
    second = norm.sf(0.7 / np.sqrt(0.04 + 0.04 + 0.04 + 0.01))
    assert certify(plan).certified == pytest.approx(first + second, rel=1e-6)


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_a_track_known_exactly_is_what_outlines_step_by_step_are(avoidance):
    plan = meeting_on_the_way()
    scenario = replace(plan.scenario, avoidance=avoidance)
    velocity, place = np.array([-0.2, -0.05]), np.array([3.0, 1.1])
    tracked = Obstacle.tracked("strays", 0.5 * DECK, [*place, *velocity], 0.0, 0.0)
    outlines = [0.5 * DECK + (place + k * velocity) for k in range(scenario.horizon + 1)]
    moving = Obstacle.moving("strays", outlines)
    judged, flown = [], []
    for obstacle in (tracked, moving):
        one = replace(plan, scenario=replace(scenario, obstacles=(obstacle,)))
        judged.append(certify(one))
        flown.append(asdict(simulate(one, 2_000, rng=0)))
    assert judged[0].certified == judged[1].certified > 0.0
    assert judged[0].ledger == judged[1].ledger
    assert flown[0] == flown[1]


def test_what_strays_is_drawn_once_for_the_whole_fleet():
    """Vehicles side by side without noise hit the same wall in the same missions, or none does."""
    wall = np.array([[0.0, -50.0], [2.0, -50.0], [2.0, 50.0], [0.0, 50.0]])
    track = Obstacle.tracked("wall", wall, [1.0, 0.0, 0.0, 0.0], [0.25, 0.0, 0.0, 0.0])
    fleet = [craft(f"v{i}", DI, [0.0, 2.0 * i], noise=0.0) for i in range(4)]
    one = simulate(still(fleet[0], obstacles=(track,)), MISSIONS, rng=1)
    four = simulate(still(*fleet, obstacles=(track,)), MISSIONS, rng=1)
    expected = norm.sf(0.7 / 0.5)
    error = np.sqrt(expected * (1.0 - expected) / MISSIONS)
    assert one.rate == pytest.approx(expected, abs=4.0 * error)
    assert four.rate == pytest.approx(expected, abs=4.0 * error)


@pytest.mark.slow
def test_obstacles_that_nobody_comes_near_are_charged_unseen():
    far = Obstacle.tracked("far", DECK, [400.0, 0.0, 0.0, 0.0], [1.0, 1.0, 0.0, 0.0])
    fleet = [craft(f"v{i}", DI, [0.0, 3.0 * i], noise=0.01) for i in range(3)]
    crowd = tuple(replace(far, name=f"far{i}") for i in range(700))
    plan = still(*fleet, obstacles=crowd, horizon=2)
    assert 0.0 < certify(plan).certified < 1e-12


def test_a_box_around_a_straying_obstacle_is_not_far_until_nine_deviations():
    """Among many obstacles those far away are found by boxes, which must grow by what strays."""
    near = Obstacle.tracked("near", DECK, [30.0, 0.0, 0.0, 0.0], [100.0, 0.0, 0.0, 0.0])
    post = Obstacle.box("post", [500.0, 0.0], [501.0, 1.0])
    crowd = tuple(replace(post, name=f"post{i}") for i in range(2_100))
    plan = still(craft("a", DI, [0, 0], noise=0.0), obstacles=(near, *crowd), horizon=1)
    alone = still(craft("a", DI, [0, 0], noise=0.0), obstacles=(near,), horizon=1)
    assert certify(plan).certified == pytest.approx(certify(alone).certified, rel=1e-9)
    assert certify(alone).certified > 1e-3


def test_a_scenario_lays_a_track_out_anew_when_its_steps_change():
    scenario: Scenario = passing_by().scenario
    longer = replace(scenario, horizon=9)
    [before], [after] = scenario.obstacles, longer.obstacles
    assert (len(before.steps), len(after.steps)) == (6, 10)
    assert after.spread.positions.shape == (10, 2, 2)
    np.testing.assert_allclose(after.spread.positions[:6], before.spread.positions, rtol=1e-12)


def test_under_way_a_track_goes_on_from_where_it_is():
    plan = meeting_on_the_way()
    left = left_of(plan.scenario, 1, [plan.scenario.vehicles[0].start], 0.05)
    for before, after in zip(plan.scenario.obstacles, left.obstacles, strict=True):
        for k in range(left.horizon + 1):
            np.testing.assert_array_equal(after.at(k)[0].vertices, before.at(k + 1)[0].vertices)
    strays, later = plan.scenario.obstacles[2], left.obstacles[2]
    np.testing.assert_array_equal(later.spread.positions, strays.spread.positions[1:])
    # Laid out anew it is where it was, and known as well.
    anew = replace(left, obstacles=(replace(later, dt=None),)).obstacles[0]
    np.testing.assert_allclose(anew.spread.positions, later.spread.positions, rtol=1e-12)
    np.testing.assert_allclose(anew.at(2)[0].vertices, later.at(2)[0].vertices, rtol=1e-12)


def test_a_track_known_exactly_is_no_obstacle_to_a_mission():
    plan = meeting_on_the_way()
    track = Obstacle.tracked("known", 0.5 * DECK, [3.0, 0.75, -0.2, -0.05])
    known = replace(plan.scenario, obstacles=(track,), risk_bound=0.4)
    mission = Mission(replace(plan, scenario=known), planner=None)
    certified = certify(replace(plan, scenario=known)).certified
    assert certified > 1e-4
    assert mission.balance.tail == pytest.approx(certified, rel=1e-3)
