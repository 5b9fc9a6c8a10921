"""What the relaxation knows of hazards in space."""

from __future__ import annotations

import numpy as np
import pytest
from cones_drawn import Array, chains, clearances_of, directions

from radmpc.geometry import box, hull
from radmpc.program.relaxed.cones import cones_around
from radmpc.program.relaxed.cones_in_space import cones_in_space
from radmpc.program.relaxed.level_curves import Outline
from radmpc.program.relaxed.patches import around_point, around_polytope
from radmpc.program.relaxed.tails import HalfSpaceTails


def best_in_space(mean: Array, covariance: Array, corners: Array, radius: float) -> float:
    """Clearance of the best half-space, by a fine sample of directions and a local search."""
    rng = np.random.default_rng(0)
    tried = rng.normal(size=(4000, 3))
    best = -np.inf
    for spread in (1.0, 0.2, 0.05, 0.01):
        tried /= np.linalg.norm(tried, axis=1)[:, None]
        slack = tried @ mean - (tried @ corners.T).max(axis=1) - radius
        found = slack / np.sqrt(np.einsum("ka,ab,kb->k", tried, covariance, tried))
        best = max(best, float(found.max()))
        tried = tried[found.argmax()] + spread * 0.3 * rng.normal(size=(2000, 3))
    return best


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("shape", ["pair", "box", "body"])
def test_in_space_no_mean_is_clearer_than_its_best_cone_says(shape: str, seed: int) -> None:
    rng = np.random.default_rng([seed, len(shape)])
    root = 0.2 * np.eye(3) + 0.05 * rng.normal(size=(3, 3))
    covariance, radius = root @ root.T, 0.6
    if shape == "pair":
        corners, patches = np.zeros((1, 3)), around_point(2)
    else:
        made = box([-1.0, -2.0, 0.0], [1.5, 0.5, 1.0])
        if shape == "body":
            made = hull(rng.normal(size=(9, 3)))
        corners, whole = made.vertices, around_polytope(made)
        assert whole is not None
        patches = whole
    cones = cones_in_space(patches, radius, covariance[None], HalfSpaceTails.of(0.1))
    assert not cones.is_void[0]
    for _ in range(25):
        away = rng.normal(size=3)
        mean = corners.mean(axis=0) + away * rng.uniform(1.0, 4.0) / np.linalg.norm(away)
        truth = best_in_space(mean, covariance, corners, radius)
        if truth < 0.0:
            continue
        clearances = clearances_of(cones, mean)
        enough = clearances >= truth - 1e-6
        assert any(all(enough[chain]) for chain in chains(cones))


def test_what_is_flat_in_space_is_left_out() -> None:
    assert around_polytope(box([0.0, 0.0, 0.0], [1.0, 1.0, 0.0])) is None


@pytest.mark.parametrize("turn", np.linspace(0.0, np.pi, 9))
def test_nothing_is_asked_where_all_the_noise_is_along_one_line(turn: float) -> None:
    along = np.array([np.cos(turn), np.sin(turn)])
    line = 0.04 * np.outer(along, along)
    tails = HalfSpaceTails.of(0.05)
    point = Outline(np.zeros((1, 1, 2)), np.zeros((1, 0, 2)), 0.5)
    both = np.stack([line, line + 0.01 * np.eye(2)])
    cones = cones_around(point, both, tails, np.repeat(directions(16), 2, axis=0))
    assert cones.is_void.tolist() == [True, False]
