"""What a control and the feedback's reserve come to in all directions, against brute force."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.referee.claims.norms import _with_reserve


def all_around(dimension: int, count: int) -> np.ndarray:
    """Unit vectors of any direction."""
    found = np.random.default_rng(0).normal(size=(count, dimension))
    return found / np.linalg.norm(found, axis=1)[:, None]


def spread_of(rng: np.random.Generator, dimension: int, kind: str) -> np.ndarray:
    """A covariance: of any shape, the same in all directions, along a line, or none."""
    if kind == "none":
        return np.zeros((dimension, dimension))
    if kind == "round":
        return 0.3 * np.eye(dimension)
    root = rng.normal(size=(dimension, 1 if kind == "line" else dimension))
    return root @ root.T


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("kind", ["any", "round", "line", "none"])
@pytest.mark.parametrize("length", [0.0, 1e-3, 1.0])
def test_the_reserve_is_asked_for_in_all_directions(
    dimension: int, kind: str, length: float
) -> None:
    rng = np.random.default_rng(dimension)
    normals = all_around(dimension, 40_000)
    controls = length * rng.normal(size=(12, dimension))
    spreads = np.array([spread_of(rng, dimension, kind) for _ in controls])
    # Where a control is square to the widest direction, both ends of that count alike.
    controls[0], spreads[0] = 0.0, np.diag([0.1] * (dimension - 1) + [2.0])
    controls[0, 0] = length
    deviations = np.sqrt(np.einsum("fi,kij,fj->kf", normals, spreads, normals).clip(min=0.0))
    seen = (controls @ normals.T + deviations).max(axis=1)
    found = _with_reserve(controls, spreads)
    assert np.all(found >= seen - 1e-12)
    assert found == pytest.approx(seen, rel=2e-3, abs=1e-9)
