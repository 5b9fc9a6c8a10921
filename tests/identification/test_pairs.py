"""Fleets of which not all pairs of vehicles share the same noise."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.console.reports.noise import noise_report
from radmpc.identification import Identification, Track, identify
from radmpc.importing.logs.block import noise_block
from simulator import Truth


def fleet(mixing: np.ndarray, seed: int) -> Identification:
    """Vehicles of which each one's noise mixes those of independent ones."""
    rng = np.random.default_rng(seed)
    steps, truth = 1500, Truth()
    fresh = rng.standard_normal((mixing.shape[1], steps, 4)) @ np.linalg.cholesky(truth.spread).T
    A = np.eye(4) + 0.5 * np.eye(4, k=2)
    tracks = []
    for number, noise in enumerate(np.tensordot(mixing, fresh, 1)):
        states = np.zeros((steps + 1, 4))
        controls = np.zeros((steps + 1, 2))
        for k in range(steps):
            controls[k] = -0.3 * states[k, :2] - 0.8 * states[k, 2:]
            push = np.concatenate([0.125 * controls[k], 0.5 * controls[k]])
            states[k + 1] = A @ states[k] + push + noise[k]
        times = 0.5 * np.arange(steps + 1)
        name = "abcd"[number]
        tracks.append(Track(name, "log", "one", times, states[:, :2], states[:, 2:], controls))
    return identify(tracks)


def report(found: Identification) -> str:
    table = noise_report(found)[1]
    return " ".join(str(cell) for column in table.columns for cell in column.cells)


def test_two_groups_do_not_get_one_shared_part() -> None:
    both = np.sqrt(0.8)
    mixing = np.hstack([np.sqrt(0.2) * np.eye(4), both * np.repeat(np.eye(2), 2, axis=0)])
    found = fleet(mixing, 1)
    assert found.shared.is_mixed
    assert not found.shared.is_sure
    assert found.shared.alike == (("a", "b"), ("c", "d"))
    block = noise_block(found).content
    assert "shared_disturbances" not in block
    W = np.array(block["defaults"]["disturbance_covariance"])
    assert np.diag(W) == pytest.approx(np.diag(Truth().spread), rel=0.1)
    assert "alike are a and b, c and d" in report(found)


def test_a_part_that_all_pairs_share_is_written() -> None:
    mixing = np.hstack([np.sqrt(0.5) * np.eye(3), np.sqrt(0.5) * np.ones((3, 1))])
    found = fleet(mixing, 2)
    assert found.shared.is_sure
    assert not found.shared.is_mixed
    assert "shared_disturbances" in noise_block(found).content


def test_noise_that_is_opposite_is_told_and_written_larger() -> None:
    found = fleet(np.array([[1.0, 0.0], [-0.8, 0.6]]), 3)
    assert found.shared.opposed == (("a", "b"),)
    assert "less safe" in report(found)
    W = np.array(noise_block(found).content["defaults"]["disturbance_covariance"])
    # Independent noise of this size parts them no less than what was flown.
    apart = 2.0 * (1.0 + 0.8) * Truth().spread
    assert np.linalg.eigvalsh(2.0 * W - 0.9 * apart)[0] > 0.0
