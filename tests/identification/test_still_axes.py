"""Axes of logs that never move: what is told of the others is what it is without them."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.identification import Identification, Track, identify
from simulator import Truth, fly

ALONG_X = [0, 2]
"""Where the states of x stand."""


def still(track: Track, place: float = 7.0) -> Track:
    """The same flight where y was never seen to move."""
    parts = {name: np.array(getattr(track, name)) for name in track.parts()}
    for name, part in parts.items():
        part[:, 1::2] = place if name == "positions" else 0.0
    return track.changed(parts)


def flown(truth: Truth, seed: int, log: str) -> tuple[Identification, Identification]:
    """What is found of a flight, and of the same one without its y."""
    [track] = fly(truth, seed, log)
    return identify([track]), identify([still(track)])


def assert_same(one, other, rel: float) -> None:
    for part in ("value", "low", "high"):
        assert getattr(one, part) == pytest.approx(getattr(other, part), rel=rel, abs=1e-12)


class Picked:
    """Some entries of an interval."""

    def __init__(self, interval, *places) -> None:
        for part in ("value", "low", "high"):
            setattr(self, part, getattr(interval, part)[np.ix_(*places)])


def test_drift_of_an_axis_is_as_sure_as_beside_one_that_moves() -> None:
    whole, bare = flown(Truth(steps=300, drift=(0.05, 0.0, 0.0, 0.0)), 1, "commands")
    assert_same(Picked(bare.pooled.drift, ALONG_X), Picked(whole.pooled.drift, ALONG_X), 1e-9)
    assert bare.pooled.has_drift
    covariances = (one.pooled.covariance for one in (bare, whole))
    assert_same(*(Picked(one, ALONG_X, ALONG_X) for one in covariances), 1e-9)
    assert not np.any(bare.pooled.covariance.value[[1, 3]])
    assert not np.any(bare.pooled.drift.value[[1, 3]])


def test_states_without_noise_of_their_own_leave_a_push_as_unsure_as_it_is() -> None:
    [track] = fly(Truth(steps=300), 2)
    u, dt = track.controls[:-1], 0.5
    before = track.velocities[:-1]
    moved = np.cumsum(dt * before + 0.5 * dt**2 * u, axis=0)
    exact = track.changed({"positions": np.vstack([np.zeros(2), moved])})
    seen, known = identify([track]).pooled.drift, identify([exact]).pooled.drift
    assert known.high[2:] - known.low[2:] == pytest.approx(seen.high[2:] - seen.low[2:], rel=0.01)


def test_memory_and_feedback_of_an_axis_are_found_beside_one_that_never_moves() -> None:
    whole, bare = flown(Truth(steps=1500, color=0.8), 3, "references")
    constant = bare.pooled.time_constant
    assert float(constant.low) < Truth(color=0.8).time_constant < float(constant.high)
    assert_same(
        Picked(bare.pooled.gain, [0], ALONG_X), Picked(whole.pooled.gain, [0], ALONG_X), 0.2
    )


def test_feedback_in_short_logs_is_corrected_beside_an_axis_that_never_moves() -> None:
    whole, bare = flown(Truth(steps=120), 4, "references")
    gains = (Picked(one.pooled.gain, [0], ALONG_X) for one in (bare, whole))
    assert_same(*gains, 0.3)
    assert bare.pooled.gain_chance > 0.01
    # Of an axis that never leaves its reference feedback is not known.
    assert np.isinf(bare.pooled.gain.high[1]).all()


def test_measurement_noise_is_found_beside_an_axis_that_never_moves() -> None:
    truth = Truth(steps=2000, seen=(0.05, 0.08, 0.01, 0.01))
    _, bare = flown(truth, 7, "commands")
    seen = np.diag(bare.pooled.measurement.value)
    assert seen[ALONG_X] == pytest.approx([0.05, 0.01], rel=0.25)
    assert not seen[[1, 3]].any()
    assert not any(sentence.startswith("disturbance of ") for sentence in bare.unknown)


def test_states_alone_tell_a_current_beside_an_axis_that_never_moves() -> None:
    whole, bare = flown(Truth(steps=1000, drift=(0.05, 0.0, 0.0, 0.0)), 8, "states")
    assert_same(Picked(bare.pooled.drift, [0]), Picked(whole.pooled.drift, [0]), 1e-9)
    assert np.isnan(bare.pooled.drift.value[2:]).all()


def test_a_vehicle_that_rests_for_a_part_of_its_log_is_told_of() -> None:
    [track] = fly(Truth(steps=300), 1)
    parts = {name: np.array(getattr(track, name)) for name in track.parts()}
    for part in parts.values():
        part[:101] = part[100]
    [told] = [text for text in identify([track.changed(parts)]).warnings if "nothing" in text]
    assert "nothing changes from 33 % of its samples to the next: at rest, or repeated?" in told
    assert not any("nothing changes" in text for text in identify([track]).warnings)
