"""Disturbances with memory beside measurement noise, with one sensor and with two."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.console.reports.noise import noise_report
from radmpc.identification import identify
from radmpc.importing.logs.block import noise_block
from simulator import Truth, fly

SEEN = (0.05, 0.05, 0.01, 0.01)


def is_in(interval, truth) -> np.ndarray:
    return (interval.low <= truth) & (truth <= interval.high)


@pytest.mark.parametrize("seen", [SEEN, (0.005, 0.005, 0.001, 0.001)])
def test_memory_and_measurement_noise_are_found_together(seen: tuple[float, ...]) -> None:
    truth = Truth(steps=3000, color=0.78, seen=seen)
    pooled = identify(fly(truth, 1)).pooled
    assert float(pooled.time_constant.value) == pytest.approx(truth.time_constant, rel=0.25)
    assert np.diag(pooled.covariance.value) == pytest.approx(np.diag(truth.spread), rel=0.4)
    assert np.diag(pooled.measurement.value) == pytest.approx(truth.seen, rel=0.35)


@pytest.mark.slow
@pytest.mark.nightly
@pytest.mark.parametrize(
    "truth",
    [
        Truth(steps=1000, color=0.78, seen=SEEN),
        Truth(steps=1000, color=0.78, seen=(0.005, 0.005, 0.001, 0.001)),
    ],
    ids=["large", "small"],
)
def test_both_are_as_sure_as_they_say(truth: Truth) -> None:
    hits: dict[str, list[bool]] = {"W": [], "R": [], "time constant": []}
    for seed in range(60):
        pooled = identify(fly(truth, seed)).pooled
        hits["W"].extend(is_in(pooled.covariance, truth.spread).ravel())
        hits["R"].extend(is_in(pooled.measurement, truth.measurement).ravel())
        constant = pooled.time_constant
        hits["time constant"].append(
            constant is not None and bool(is_in(constant, truth.time_constant))
        )
    shares = {name: float(np.mean(found)) for name, found in hits.items()}
    assert {name: share for name, share in shares.items() if share < 0.93} == {}


@pytest.mark.parametrize("color", [0.0, 0.78])
def test_a_second_sensor_of_positions_does_not_hide_noise_of_velocities(color: float) -> None:
    truth = Truth(steps=1500, color=color, seen=SEEN)
    [track] = fly(truth, 2)
    [true] = fly(replace(truth, seen=()), 2)
    rng = np.random.default_rng(3)
    other = true.positions + 0.3 * rng.standard_normal(track.positions.shape)
    alone = identify([track]).pooled
    both = identify([track.changed({"second_positions": other})]).pooled
    for pooled in (alone, both):
        assert np.diag(pooled.measurement.value) == pytest.approx(truth.seen, rel=0.4)
        assert np.all(np.diag(is_in(pooled.covariance, truth.spread)))
        assert (pooled.time_constant is not None) == bool(color)
    if color:
        assert is_in(both.time_constant, truth.time_constant)


def test_a_time_constant_that_is_hardly_known_is_written_as_its_upper_end() -> None:
    truth = Truth(steps=200, color=0.9, seen=SEEN)
    found = identify(fly(truth, 5))
    constant = found.pooled.time_constant
    assert float(constant.high) > 2.0 * float(constant.value)
    disturbance = noise_block(found).content["defaults"]["disturbance"]
    assert disturbance["time_constant"] == pytest.approx(float(constant.high), rel=1e-4)
    assert any("upper end" in s for s in found.unknown if s.startswith("time constant: "))


@pytest.mark.parametrize("seed", range(4))
def test_measurement_noise_in_a_loop_leaves_no_more_than_an_upper_bound(seed: int) -> None:
    truth = Truth(steps=1000, seen=(0.05, 0.05, 0.005, 0.005))
    found = identify(fly(truth, seed, "references"))
    pooled = found.pooled
    assert pooled.is_bound
    assert np.all(is_in(pooled.covariance, truth.spread))
    assert not np.diag(pooled.covariance.low).any()
    assert any("the covariance holds both" in sentence for sentence in found.unknown)
    assert any("at most" in cell for cell in noise_report(found)[3].columns[0].cells)
    assert not identify(fly(Truth(steps=1000), seed, "references")).pooled.is_bound


def test_memory_as_long_as_can_be_told_is_called_so() -> None:
    found = identify(fly(Truth(steps=400, color=0.997, seen=SEEN), 6))
    assert any(sentence.startswith("time constant above 99.5 s") for sentence in found.unknown)


def claims_sensors(truth: Truth, seed: int) -> bool:
    """Whether any measurement noise counts as sure."""
    pooled = identify(fly(truth, seed)).pooled
    return pooled.measurement is not None and bool(np.any(np.diag(pooled.measurement.low) > 0.0))


def test_sensors_without_noise_get_none_for_what_memory_makes_look_alike() -> None:
    truth = Truth(steps=1000, dimension=3, color=0.7)
    for seed in (15, 17):
        found = identify(fly(truth, seed))
        assert np.all(np.diag(found.pooled.measurement.low) == 0.0)
        assert np.all(np.diag(is_in(found.pooled.measurement, np.zeros((6, 6)))))
        assert "measurement" not in noise_block(found).content["defaults"]
        assert any(sentence.startswith("measurement noise: it may") for sentence in found.unknown)


@pytest.mark.slow
@pytest.mark.nightly
@pytest.mark.parametrize(
    "truth",
    [Truth(steps=1000, dimension=3, color=0.7), Truth(color=0.7), Truth(steps=1000, color=0.9)],
    ids=["solid", "flat", "long"],
)
def test_sensors_without_noise_are_called_noisy_as_seldom_as_the_level_says(truth: Truth) -> None:
    assert sum(claims_sensors(truth, seed) for seed in range(100)) <= 5


def test_small_noise_of_sensors_beside_memory_counts_as_sure() -> None:
    assert claims_sensors(Truth(steps=1000, color=0.78, seen=(0.005, 0.005, 0.001, 0.001)), 7)
