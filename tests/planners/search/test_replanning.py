"""Vehicles replanned on a lattice keep out of each other's way, as they are timed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import circle
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.lattice.others import around_others
from radmpc.planners.certified.phases.replanning import Replanning
from radmpc.solvers.solution import Limits


def straight(fleet: Fleet) -> np.ndarray:
    """Return where vehicles are at even speed on straight lines to their goals, (N, T+1, 2)."""
    shares = np.linspace(0.0, 1.0, fleet.scenario.horizon + 1)[:, None]
    return np.array(
        [
            v.start[:2] + shares * (0.5 * (v.goal.lower + v.goal.upper) - v.start[:2])
            for v in fleet.scenario.vehicles
        ]
    )


def least_distance(one: np.ndarray, other: np.ndarray) -> float:
    """Return how near two come, also between steps [m]."""
    gaps = one - other
    between = np.concatenate([gaps[:-1] + s * np.diff(gaps, axis=0) for s in (0.0, 0.5)] + [gaps])
    return float(np.linalg.norm(between, axis=1).min())


@pytest.fixture(params=["steps", "intervals"])
def fleet(request: pytest.FixtureRequest) -> Fleet:
    """Four that meet in the middle of a circle."""
    return Fleet.of(replace(circle(4), avoidance=request.param), 1e-3, Limits())


@pytest.mark.parametrize("seed", range(3))
def test_who_is_replanned_keeps_clear_of_all_others(fleet: Fleet, seed: int) -> None:
    means = straight(fleet)
    replanning = Replanning(fleet, 1e3, np.random.default_rng(seed))
    found = replanning.places((1, 2), means)
    assert set(found) == {1, 2}
    paths = {0: means[0], 3: means[3], **found}
    for i, path in found.items():
        vehicle = fleet.scenario.vehicles[i]
        assert path[0] == pytest.approx(vehicle.start[:2])
        assert path.shape == means[i].shape
        # Within half a cell of the lattice.
        assert np.all(
            (path[-1] >= vehicle.goal.lower - 1.0) & (path[-1] <= vehicle.goal.upper + 1.0)
        )
        for j in paths.keys() - {i}:
            radii = vehicle.radius + fleet.scenario.vehicles[j].radius
            if fleet.scenario.avoidance == "intervals":
                assert least_distance(path, paths[j]) >= radii - 0.05
            else:
                assert np.linalg.norm(path - paths[j], axis=1).min() >= radii - 0.05


def test_who_is_alone_is_replanned_among_nobody() -> None:
    scenario = circle(3)
    lonely = replace(scenario, vehicles=scenario.vehicles[:1])
    fleet = Fleet.of(lonely, 1e-3, Limits())
    found = Replanning(fleet, 1.0, np.random.default_rng(0)).places((0,), straight(fleet))
    assert set(found) == {0}


def test_points_within_the_radii_of_another_are_in_none_of_its_half_planes(fleet: Fleet) -> None:
    rng, means = np.random.default_rng(1), straight(fleet)
    windows = around_others(fleet.programs.hazards, 0, np.array([2]), means)
    assert len(windows) == fleet.scenario.horizon
    reach = fleet.scenario.vehicles[0].radius + fleet.scenario.vehicles[2].radius
    for k, (avoidance,) in enumerate(windows):
        drawn = rng.normal(size=(200, 2))
        lengths = rng.uniform(0.0, 2.0 * reach, (200, 1))
        offsets = lengths * drawn / np.linalg.norm(drawn, axis=1, keepdims=True)
        points = means[2, k + 1] + offsets
        rooms = (avoidance.ahead[:, 2] - points @ avoidance.ahead[:, :2].T).max(axis=1)
        is_within = lengths[:, 0] < reach - 1e-9
        assert np.all(rooms[is_within] < 0.0)
        # Eight half-planes leave what is 1 / cos(22.5 degrees) times as far.
        assert np.all(rooms[lengths[:, 0] > 1.083 * reach] > 0.0)
