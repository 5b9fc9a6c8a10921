"""Outlines of many corners: searched by angles, certified as if all corners were compared."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import radmpc
from radmpc import Goal, Obstacle, Plan, Scenario, Vehicle, double_integrator
from radmpc.geometry import hull
from radmpc.referee import sites, supports
from radmpc.referee.supports import planar_supports


def outlines(rng: np.random.Generator, most: int) -> np.ndarray:
    """Return convex outlines of all kinds that begin anywhere, the first corner repeated."""
    turn = np.sort(rng.uniform(0.0, 2.0 * np.pi, most))
    circle = np.column_stack([np.cos(turn), np.sin(turn)])
    clouds = [
        circle * 3.0 + 1e5,
        circle * [20.0, 1e-3],
        rng.normal(size=(300, 2)),
        np.round(rng.normal(size=(300, 2)), 1),
        rng.normal(size=(2, 2)),
        np.array([[3.0, -2.0]]),
        np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1e-9], [0.0, 1e-9]]),
    ]
    found = []
    for cloud in clouds:
        corners = hull(cloud).vertices
        corners = np.roll(corners, rng.integers(len(corners)), axis=0)
        rest = np.repeat(corners[:1], most - len(corners), axis=0)
        found.append(np.concatenate([corners, rest]))
    return np.array(found)


def compared(vertices: np.ndarray, directions: np.ndarray) -> np.ndarray:
    products = vertices[:, None] * directions[:, :, None]
    return np.asarray((products[..., 0] + products[..., 1]).max(axis=2))


@pytest.mark.parametrize("seed", range(5))
def test_the_farthest_corner_is_found_as_if_all_were_compared(seed: int) -> None:
    rng = np.random.default_rng(seed)
    every = outlines(rng, 80)
    edges = np.roll(every, -1, axis=1) - every
    lengths = np.linalg.norm(edges, axis=2, keepdims=True)
    # Along normals of edges two corners are equally far.
    normals = np.stack([edges[..., 1], -edges[..., 0]], axis=2)
    normals = np.where(lengths > 0.0, normals / np.where(lengths > 0.0, lengths, 1.0), [1.0, 0.0])
    drawn = rng.normal(size=(len(every), 100, 2))
    axes = np.broadcast_to(np.vstack([np.eye(2), -np.eye(2)]), (len(every), 4, 2))
    directions = np.concatenate([normals, -normals, drawn, axes], axis=1)
    found = planar_supports(every, directions)
    assert found is not None
    assert np.array_equal(found, compared(every, directions))


def test_corners_the_other_way_round_are_left_to_who_compares_all() -> None:
    every = outlines(np.random.default_rng(1), 80)[:1]
    directions = np.ones((1, 3, 2))
    assert planar_supports(every[:, ::-1], directions) is None


def rock(corners: int) -> Obstacle:
    turn = 2.0 * np.pi * np.arange(corners) / corners
    return Obstacle.polygon("rock", np.column_stack([5.0 + np.cos(turn), np.sin(turn)]))


def past(corners: int) -> Plan:
    """Return a plan past a round rock that was made past a square one within."""
    system, goal = double_integrator(1.0, 2), Goal.at([10.0, 0.5], 0.5)
    boat = Vehicle("boat", system, [0.0, 0.5], goal, 0.3, 2.0, 1e-3, 1e-3)
    scenario, found = Scenario("rock", 1.0, 8, 0.1, (boat,), (rock(4),)), list[Plan]()
    radmpc.plan(scenario, rng=0, improved=found.append, stop=lambda: bool(found))
    return replace(found[0], scenario=replace(scenario, obstacles=(rock(corners),)))


def test_certificates_are_the_same_whether_corners_are_searched_or_compared(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    plan = past(150)
    searched: list[int] = []

    def counting(vertices: np.ndarray, directions: np.ndarray) -> np.ndarray | None:
        searched.append(vertices.shape[1])
        return planar_supports(vertices, directions)

    monkeypatch.setattr(sites, "planar_supports", counting)
    by_angles = radmpc.certify(plan)
    assert searched
    assert set(searched) == {150}
    monkeypatch.setattr(sites, "is_searched", lambda *_: False)
    by_all = radmpc.certify(plan)
    assert by_angles.certified > 1e-6
    assert by_angles.certified == pytest.approx(by_all.certified, rel=1e-9)


def test_few_corners_are_compared() -> None:
    assert supports.is_searched(500, 100, 2)
    assert not supports.is_searched(20, 5000, 2)
    assert not supports.is_searched(500, 1, 2)
    assert not supports.is_searched(500, 100, 3)
