"""Which sampled paths collide, against the least distance of a parabola by its polynomial."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.geometry import box
from radmpc.referee.simulation.collisions import meets_origin, meets_solid
from radmpc.referee.simulation.sweep import resting

SURE = 2e-6
"""How far from its reach a path must stay for the answer to be one [m]."""


def least_distance(begin: np.ndarray, end: np.ndarray, sagitta: np.ndarray) -> float:
    """Return how close a parabola comes to the origin: where the slope of a quartic vanishes."""
    squared = np.polynomial.Polynomial([0.0])
    for p, q, b in zip(begin, end, sagitta, strict=True):
        squared += np.polynomial.Polynomial([p, q - p - 4.0 * b, 4.0 * b]) ** 2
    roots = squared.deriv().roots()
    times = [0.0, 1.0, *(float(r.real) for r in roots if abs(r.imag) < 1e-9 and 0 < r.real < 1)]
    return float(np.sqrt(max(min(squared(t) for t in times), 0.0)))


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("scale", [1e-3, 0.1, 3.0])
def test_paths_that_graze_are_told_apart_by_micrometers(dimension: int, scale: float) -> None:
    rng = np.random.default_rng(3)
    begin = rng.normal(size=(400, dimension))
    begin /= np.linalg.norm(begin, axis=1, keepdims=True)
    end = begin + scale * rng.normal(size=begin.shape)
    sagittas = scale * rng.normal(size=begin.shape)
    exact = np.array([least_distance(*path) for path in zip(begin, end, sagittas, strict=True)])
    # Just too close, or just not: by the thickness of a hair, and less.
    reaches = exact + rng.choice([-1.0, 1.0], 400) * 10.0 ** rng.uniform(-5.5, -2.0, 400)
    assert np.abs(reaches - exact).min() > SURE
    hits = meets_origin(begin, end, sagittas, np.maximum(reaches, 0.0))
    assert np.array_equal(hits, exact < reaches)


def test_a_path_that_turns_away_from_a_wall_touches_it_by_less_than_a_millimeter() -> None:
    wall = resting(box([1.0, -5.0], [2.0, 5.0]))
    begin, end = np.array([[0.0, 0.0]]), np.array([[0.0, 1.0]])
    sagittas = np.array([[-0.5, 0.0]])
    for distance, is_hit in ((0.5 - 1e-5, False), (0.5 + 1e-5, True)):
        assert meets_solid(begin, end, sagittas, np.array([distance]), wall).tolist() == [is_hit]
