"""The benchmark families are what their description says."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from scipy.spatial.distance import pdist

from radmpc.errors import ArgumentError, ScenarioError
from radmpc.experiments.families import circle, clutter, fleet, paper
from radmpc.experiments.scatter import Arena
from radmpc.experiments.swarms import swarm


def _places(scenario):
    starts = np.array([v.start_position for v in scenario.vehicles])
    goals = np.array([v.goal.center for v in scenario.vehicles])
    return starts, goals


def _clearance(scenario, points):
    outlines = [shapely.Polygon(o.at(0)[0].vertices) for o in scenario.obstacles]
    return min(o.distance(shapely.Point(p)) for o in outlines for p in points)


@pytest.mark.parametrize("seed", range(3))
def test_the_paper_family_keeps_its_distances(seed):
    scenario = paper(8, seed)
    starts, goals = _places(scenario)
    for points in (starts, goals):
        assert np.all((points >= 1.0) & (points <= 19.0))
        assert pdist(points).min() >= 3.0
        assert _clearance(scenario, points) >= 1.2
    assert np.abs(goals - starts).max() <= 16.0
    assert (scenario.avoidance, scenario.horizon, scenario.risk_bound) == ("steps", 10, 0.05)


def test_the_fleet_family_keeps_the_paper_density():
    scenario = fleet(64, 1)
    starts, goals = _places(scenario)
    side = 20.0 * np.sqrt(8.0)
    assert len(scenario.obstacles) == 24
    centers = np.array([o.at(0)[0].vertices.mean(axis=0) for o in scenario.obstacles])
    assert pdist(centers).min() >= 6.0 - 1e-9
    for points in (starts, goals):
        assert np.all((points >= 1.0) & (points <= side - 1.0))
        assert pdist(points).min() >= 3.0
        assert _clearance(scenario, points) >= 1.2
    assert np.abs(goals - starts).max() <= 14.0


def test_the_clutter_family_is_small_vehicles_among_unit_boxes():
    scenario = clutter(4, 40, 2)
    starts, goals = _places(scenario)
    assert len(scenario.obstacles) == 40
    assert pdist(starts).min() >= 2.0
    assert pdist(goals).min() >= 2.0
    away = np.abs(goals - starts).max(axis=1)
    assert np.all((away >= 12.0) & (away <= 22.0))
    assert (scenario.avoidance, scenario.horizon) == ("intervals", 30)
    assert all(v.radius == 0.18 and v.gain is not None for v in scenario.vehicles)


def test_the_circle_sends_everyone_through_the_middle():
    starts, goals = _places(circle(6))
    assert 0.5 * (starts + goals) == pytest.approx(np.full((6, 2), 10.0))


def test_the_same_seed_draws_the_same_problem_and_another_does_not():
    first, again, other = (_places(fleet(16, seed))[0] for seed in (3, 3, 4))
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)


@pytest.mark.parametrize("family", [paper, fleet, swarm], ids=lambda family: family.__name__)
@pytest.mark.parametrize("count", [0, 10_001, 10**400], ids=["none", "too-many", "no-float"])
def test_a_family_has_as_many_vehicles_as_a_file_may(family, count):
    with pytest.raises(ArgumentError, match=r"^num_vehicles must be an integer from 1 to 10000"):
        family(count, 0)


def test_a_room_that_is_too_small_is_refused():
    room = Arena(np.zeros(2), np.ones(2), apart=3.0)
    with pytest.raises(ScenarioError, match="no room for 2 points 3 m apart"):
        room.scatter(np.random.default_rng(0), 2)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("num_vehicles", range(1, 9))
def test_a_swarm_of_few_drones_finds_room(num_vehicles):
    for seed in range(4):
        starts, goals = _places(swarm(num_vehicles, seed))
        assert len(starts) == len(goals) == num_vehicles


def test_the_swarm_family_is_as_dense_as_twenty_drones_in_a_small_room():
    scenario = swarm(40, 3)
    starts, goals = _places(scenario)
    assert scenario.dimension == 3
    size = scenario.workspace.upper - scenario.workspace.lower
    assert np.prod(size) / 40 == pytest.approx(18.0 / 20.0)
    for points in (starts, goals):
        assert pdist(points).min() >= 0.5
        assert np.all((points >= 0.5) & (points <= size - 0.5))
    longest = np.abs(goals - starts).max()
    assert scenario.horizon * scenario.dt >= longest + 1.0
    assert swarm(40, 3).vehicles[7].start.tolist() == scenario.vehicles[7].start.tolist()
    assert swarm(40, 4).vehicles[7].start.tolist() != scenario.vehicles[7].start.tolist()
