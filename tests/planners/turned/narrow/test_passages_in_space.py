"""Drones in passages of a meter and a half between blocks, in a canyon of two hundred."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from radmpc import (
    Goal,
    Obstacle,
    Scenario,
    Vehicle,
    Visit,
    Workspace,
    double_integrator,
)
from radmpc.arrays import Matrix
from radmpc.planners.certified.turned.detours import detours
from radmpc.planners.certified.turned.grid import Grid
from radmpc.planners.certified.turned.narrow.cheapest import _shortest as shortest_routes
from radmpc.planners.certified.turned.narrow.closeness import closeness, passing_by
from radmpc.planners.certified.turned.narrow.track import Track
from radmpc.planners.certified.turned.straight import StandingFaces, pulled
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from running import plan_before_any_search

CLEARANCE = 2.0

LENGTH, WIDTH, HEIGHT = 200.0, 60.0, 12.0

PASSAGES = {40.0: 12.0, 90.0: 37.3, 140.0: 20.9}
"""Where blocks begin, and where the middle of the passage between them is [m]."""

WINDING = {40.0: 5.0, 52.0: 45.0, 64.0: 10.0}
"""Others so near each other that even speeds lead to no plan: corners need braking [m]."""

DEPTH = 4.0
"""Length of each passage [m]: half of what points of the usual grid are apart."""


def canyon(count: int = 1, passages: Mapping[float, float] = PASSAGES) -> Scenario:
    """Drones fly through three passages of a meter and a half, one after the other."""
    blocks = []
    for x, y in passages.items():
        blocks += [
            Obstacle.box(f"right {x:g}", [x, 0.0, 0.0], [x + DEPTH, y - 0.75, HEIGHT]),
            Obstacle.box(f"left {x:g}", [x, y + 0.75, 0.0], [x + DEPTH, WIDTH, HEIGHT]),
        ]
    drones = [
        Vehicle(
            name=f"drone {i}",
            system=double_integrator(1.0, 3),
            start=[10.0, 20.0 + 10.0 * i, 4.0],
            goal=Goal.at([LENGTH - 10.0, 20.0 + 10.0 * i, 4.0], 0.3),
            radius=0.35,
            control_limit=2.0,
            speed_limit=4.0,
            initial_covariance=1e-4,
            disturbance_covariance=1e-5,
            gain=np.kron([[-0.3, -0.9]], np.eye(3)),
        )
        for i in range(count)
    ]
    room = Workspace([0.0, 0.0, 0.0], [LENGTH, WIDTH, HEIGHT])
    return Scenario("canyon", 1.0, 90, 0.05, drones, blocks, workspace=room)


def hazards_of(scenario: Scenario) -> Hazards:
    return Hazards.of(scenario, condensed_models(scenario))


def is_outside(route: Matrix) -> bool:
    """Whether a route keeps out of all blocks, by dense samples."""
    lengths = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(route, axis=0), axis=1)))
    along = np.arange(0.0, lengths[-1], 0.01)
    x, y = (np.interp(along, lengths, route[:, a]) for a in (0, 1))
    return all(
        np.all(np.abs(y - middle)[(x > begin) & (x < begin + DEPTH)] < 0.75)
        for begin, middle in PASSAGES.items()
    )


@pytest.mark.parametrize("passages", [PASSAGES, WINDING])
@pytest.mark.parametrize("count", [1, 2])
def test_drones_in_narrow_passages_have_a_plan_before_any_search(
    count: int, passages: Mapping[float, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    certified = plan_before_any_search(canyon(count, passages), monkeypatch).risk.certified
    assert certified is not None
    assert certified <= 0.05


def test_planes_beside_faces_tell_passages_that_points_far_apart_do_not() -> None:
    hazards = hazards_of(canyon())
    through = detours(hazards, [0], CLEARANCE)
    assert not through or not is_outside(through[0])
    grid = Grid.beside_faces(hazards, CLEARANCE)
    assert grid is not None
    assert len(grid.points) < 100_000
    route = detours(hazards, [0], CLEARANCE, grid)[0]
    assert is_outside(route)
    straight = pulled(StandingFaces.of(hazards), route, 0.5)
    assert is_outside(straight)
    assert len(straight) < len(route)
    lengths = [np.linalg.norm(np.diff(one, axis=0), axis=1).sum() for one in (route, straight)]
    assert lengths[1] < lengths[0]


def test_a_route_to_a_visit_is_not_pulled_past_it() -> None:
    scenario = canyon()
    visit = Visit.at([70.0, 50.0, 8.0], 1.0, between=(40, 50))
    scenario = replace(scenario, vehicles=(replace(scenario.vehicles[0], via=(visit,)),))
    hazards = hazards_of(scenario)
    routes = shortest_routes(hazards, [0], CLEARANCE, Grid.of(hazards))
    assert is_outside(routes[0])
    assert np.linalg.norm(routes[0] - [70.0, 50.0, 8.0], axis=1).min() < 1e-9


def test_straight_pieces_are_open_as_dense_samples_tell() -> None:
    hazards, rng = hazards_of(canyon()), np.random.default_rng(3)
    size = np.array([LENGTH, WIDTH, HEIGHT])
    begin = rng.uniform(0.0, 1.0, (400, 3)) * size
    end = begin + rng.uniform(-0.2, 0.2, (400, 3)) * size
    around, room = StandingFaces.of(hazards), 0.4
    shares = np.linspace(0.0, 1.0, 2001)[:, None]
    least = np.array(
        [around.at(a + shares * (b - a)).min() for a, b in zip(begin, end, strict=True)]
    )
    is_clear = np.abs(least - room) > 0.02
    told = StandingFaces.of(hazards).are_open(begin, end, room)
    assert np.array_equal(told[is_clear], least[is_clear] > room)
    assert 0.2 < told.mean() < 0.8
    near = least < around.far
    assert around.along(begin, end)[near] == pytest.approx(least[near], abs=0.4)


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_in_space_whoever_is_above_is_not_near(avoidance: str) -> None:
    hazards = hazards_of(replace(canyon(2), avoidance=avoidance))
    places = np.column_stack([np.arange(20.0), np.zeros(20), np.zeros(20)])
    nothing = np.zeros((3, 3, 20))
    each = Track(0, places, nothing.astype(int), nothing, 0, np.zeros(3), 7.0)
    path = np.column_stack([np.full(6, 9.5), np.linspace(-6.0, 6.0, 6), np.zeros(6)])
    for height, is_near in ((0.0, True), (3.0, False)):
        other = path + np.array([0.0, 0.0, height])
        lack = closeness(hazards, each, 1, other, CLEARANCE)[2]
        crosses = is_near and avoidance == "intervals"
        assert bool(np.isinf(lack).any()) == crosses
        assert passing_by(hazards, each, other[None], CLEARANCE).all()
