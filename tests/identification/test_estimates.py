from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.identification import Track, identify
from radmpc.identification.intervals import covariance_interval
from simulator import Truth, fly


def holds(interval, truth) -> np.ndarray:
    """Whether intervals twice as wide contain the truth, entry by entry: but for 1 in 10,000."""
    half = 0.5 * (interval.high - interval.low)
    return (interval.low - half <= truth) & (truth <= interval.high + half)


def test_white_noise_is_found_with_its_covariance() -> None:
    truth = Truth(steps=4000)
    found = identify(fly(truth, seed=1))
    assert found.evidence == "commands"
    assert found.model.dt == truth.dt
    pooled = found.pooled
    assert pooled.covariance.value == pytest.approx(truth.spread, abs=0.1 * 0.022)
    assert np.all(holds(pooled.covariance, truth.spread))
    assert pooled.time_constant is None
    assert pooled.measurement is None
    assert not pooled.has_drift
    assert pooled.tails.is_gaussian
    assert pooled.worth == pytest.approx(4000, rel=0.01)


def test_a_current_and_a_push_are_found() -> None:
    truth = Truth(drift=(0.05, 0.0, 0.0, -0.03))
    pooled = identify(fly(truth, seed=2)).pooled
    assert pooled.has_drift
    assert np.all(holds(pooled.drift, truth.push))
    assert pooled.drift.low[0] > 0.0 > pooled.drift.high[3]


@pytest.mark.parametrize("log", ["commands", "references"])
def test_the_memory_of_noise_is_told_from_feedback(log: str) -> None:
    truth = Truth(steps=1500, color=0.8)
    pooled = identify(fly(truth, 3, log)).pooled
    assert pooled.time_constant.low < truth.time_constant < pooled.time_constant.high
    assert pooled.time_constant.value == pytest.approx(truth.time_constant, rel=0.2)
    assert pooled.covariance.value == pytest.approx(truth.spread, abs=0.35 * 0.022)
    assert pooled.worth < 500
    if log == "references":
        assert pooled.gain.value == pytest.approx(truth.gain, abs=0.15)


def test_feedback_is_found_by_references_alone() -> None:
    truth = Truth(steps=2000)
    found = identify(fly(truth, 4, "references"))
    assert found.evidence == "references"
    assert found.pooled.gain.value == pytest.approx(truth.gain, abs=0.1)
    assert found.pooled.gain_chance > 0.01
    assert found.pooled.covariance.value == pytest.approx(truth.spread, abs=0.1 * 0.022)


def test_feedback_that_commands_show_is_found_to_the_last_digit() -> None:
    truth = Truth(steps=200, vehicles=2)
    found = identify(fly(truth, 5, "both"))
    assert found.evidence == "commands"
    assert found.pooled.gain.value == pytest.approx(truth.gain, abs=1e-9)
    assert not found.differ


def test_a_loop_with_more_than_feedback_is_called_so() -> None:
    found = identify(fly(Truth(steps=1500, seen=(0.05, 0.05, 0.01, 0.01)), 6, "references"))
    assert found.pooled.gain_chance < 0.01
    assert any("K is the nearest" in sentence for sentence in found.unknown)


def test_measurement_noise_is_told_from_disturbance() -> None:
    truth = Truth(steps=2000, seen=(0.05, 0.08, 0.01, 0.01))
    pooled = identify(fly(truth, 7)).pooled
    assert np.diag(pooled.measurement.value) == pytest.approx(truth.seen, rel=0.25)
    assert np.all(holds(pooled.measurement, truth.measurement))
    assert np.diag(pooled.covariance.value) == pytest.approx(np.diag(truth.spread), rel=0.35)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("seed", range(6))
def test_a_disturbance_hidden_by_measurement_noise_has_an_upper_end_alone(seed: int) -> None:
    truth = Truth(steps=300, scale=0.005, seen=(0.02, 0.02, 0.01, 0.01))
    found = identify(fly(truth, seed))
    disturbance, measurement = found.pooled.covariance, found.pooled.measurement
    for covariance in (disturbance.value, measurement.value):
        assert np.linalg.eigvalsh(covariance)[0] > 0.0
    # Positions tell nothing of disturbances below what sensors add in a step.
    assert np.diag(disturbance.low)[:2] == pytest.approx(0.0, abs=1e-12)
    assert np.all(np.diag(disturbance.high) > np.diag(truth.spread))
    assert any(sentence.startswith("disturbance of x, y") for sentence in found.unknown)
    # 300 steps tell a variance within a sixth at best.
    width = np.diag(measurement.high - measurement.low) / np.diag(measurement.value)
    assert np.all(width > 0.25)
    assert found.pooled.worth < 30.0


def test_a_second_sensor_tells_the_noise_of_the_first() -> None:
    truth = Truth(steps=2000, color=0.6)
    [track] = fly(truth, 8)
    rng = np.random.default_rng(9)
    shape = track.positions.shape
    seen = track.positions + 0.2 * rng.standard_normal(shape)
    other = track.positions + 0.5 * rng.standard_normal(shape) + [3.0, -1.0]
    pooled = identify([track.changed({"positions": seen, "second_positions": other})]).pooled
    assert np.diag(pooled.measurement.value)[:2] == pytest.approx([0.04, 0.04], rel=0.2)
    assert np.all(holds(pooled.measurement, np.diag([0.04, 0.04, 0.0, 0.0]))[:2, :2])


@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", range(4))
def test_no_variance_is_negative_where_a_second_sensor_hides_the_disturbance(seed: int) -> None:
    truth = Truth(steps=300, scale=0.01)
    [track] = fly(truth, seed)
    rng = np.random.default_rng(seed)
    shape = track.positions.shape
    seen = track.positions + 0.2 * rng.standard_normal(shape)
    other = track.positions + 0.5 * rng.standard_normal(shape)
    found = identify([track.changed({"positions": seen, "second_positions": other})])
    disturbance = found.pooled.covariance
    assert np.linalg.eigvalsh(disturbance.value)[0] > -1e-15
    assert np.all(np.diag(disturbance.low) >= 0.0)
    assert np.all(disturbance.low <= disturbance.value)
    assert np.all(disturbance.value <= disturbance.high)
    assert np.all(holds(disturbance, truth.spread))
    assert any(sentence.startswith("disturbance of ") for sentence in found.unknown)


@pytest.mark.parametrize(("color", "most"), [(0.0, 0.08), (0.6, 0.12)])
def test_the_part_that_vehicles_share_is_found(color: float, most: float) -> None:
    truth = Truth(vehicles=3, share=0.4, color=color, steps=1200)
    found = identify(fly(truth, 10))
    assert found.shared.is_sure
    assert float(found.shared.share.value) == pytest.approx(0.4, abs=most)
    assert found.shared.covariance.value == pytest.approx(0.4 * truth.spread, abs=0.3 * 0.022)
    # What three vehicles share counts less than three times.
    alone = identify(fly(replace(truth, share=0.0), 10))
    assert not alone.shared.is_sure
    assert found.pooled.worth < 0.85 * alone.pooled.worth


def test_vehicles_of_different_clocks_are_not_compared() -> None:
    one, other = fly(Truth(vehicles=2, share=0.9), 11)
    other = Track("v2", "b", "another", other.times, other.positions, other.velocities,
                  other.controls)  # fmt: skip
    found = identify([one, other])
    assert found.shared is None
    assert any(sentence.startswith("shared noise") for sentence in found.unknown)


def test_vehicles_that_differ_get_numbers_of_their_own() -> None:
    [calm] = fly(Truth(), 12)
    [wild] = fly(Truth(scale=2.0), 13)
    found = identify([calm, renamed(wild, "wild")])
    assert found.differ
    assert [one.vehicles for one in found.groups] == [("v1",), ("wild",)]
    first, second = (np.trace(one.covariance.value) for one in found.groups)
    assert second == pytest.approx(2.0 * first, rel=0.25)
    assert not identify(fly(Truth(vehicles=2), 14)).differ


def renamed(track: Track, name: str) -> Track:
    """The same flight of another vehicle."""
    return Track(name, track.source, track.clock, track.times, track.positions, track.velocities,
                 track.controls)  # fmt: skip


def test_gaussian_vehicles_of_different_noise_are_gaussian_together() -> None:
    [calm], [other], [wild] = (fly(Truth(scale=scale), 30 + i) for i, scale in enumerate((1, 1, 9)))
    found = identify([calm, renamed(other, "other"), renamed(wild, "wild")])
    assert found.differ
    assert all(one.tails.is_gaussian for one in found.groups)
    assert found.pooled.tails.is_gaussian
    assert found.pooled.worth == pytest.approx(1800, rel=0.01)


def test_heavy_tails_of_vehicles_that_differ_are_told_by_their_own_freedom() -> None:
    truth = Truth(steps=2000, freedom=5.0)
    [calm], [wild] = fly(truth, 33), fly(replace(truth, scale=9.0), 34)
    found = identify([calm, renamed(wild, "wild")])
    assert found.differ
    assert found.pooled.tails.freedom == pytest.approx(5.0, rel=0.3)
    assert found.pooled.worth < 0.7 * 4000


def test_vehicles_that_differ_by_an_axis_that_never_moves_are_judged_together() -> None:
    [whole], [flat] = fly(Truth(), 35), fly(Truth(), 36)
    parts = {name: np.array(getattr(flat, name)) for name in flat.parts()}
    for part in parts.values():
        part[:, 1] = 0.0
    found = identify([whole, renamed(flat.changed(parts), "flat")])
    assert found.differ
    assert found.pooled.tails.is_gaussian
    assert found.pooled.worth == pytest.approx(1200, rel=0.01)


def test_logs_of_one_vehicle_count_together() -> None:
    truth = Truth(steps=300)
    [morning], [evening] = fly(truth, 15), fly(truth, 16)
    found = identify([morning, evening])
    assert found.pooled.vehicles == ("v1",)
    assert found.pooled.num_steps == 600


def test_heavy_tails_are_told_in_degrees_of_freedom() -> None:
    found = identify(fly(Truth(steps=3000, freedom=5.0), 17)).pooled
    assert found.tails.are_heavy
    assert not found.tails.is_gaussian
    assert found.tails.freedom == pytest.approx(5.0, rel=0.35)
    assert found.worth < 0.7 * found.num_steps


def test_states_alone_bound_the_noise_and_say_so() -> None:
    truth = Truth(steps=1000, drift=(0.05, 0.0, 0.0, 0.0))
    found = identify(fly(truth, 18, "states"))
    assert found.evidence == "states"
    assert np.all(np.diag(found.pooled.covariance.low) > 0.9 * np.diag(truth.spread))
    assert found.pooled.gain is None
    assert found.pooled.tails is None
    assert any("maneuver" in sentence for sentence in found.unknown)
    # A current shows whatever was commanded.
    assert holds(found.pooled.drift, truth.push)[0]
    assert found.pooled.drift.low[0] > 0.0
    assert np.isnan(found.pooled.drift.value[2:]).all()


def test_positions_alone_are_those_of_a_single_integrator() -> None:
    [track] = fly(Truth(steps=1000), 19, "references")
    bare = Track("v1", "log.csv", "one", track.times, track.positions,
                 references=track.references[:, :2])  # fmt: skip
    found = identify([bare])
    assert not found.model.has_velocity
    assert found.pooled.covariance.value.shape == (2, 2)
    assert found.pooled.gain.value.shape == (2, 2)
    assert np.all(np.diag(found.pooled.gain.high) < 0.0)


def test_noise_of_longer_steps_is_that_of_several_short_ones() -> None:
    truth = Truth(steps=4000, dt=0.25)
    short, long = (identify(fly(truth, 20), dt=dt).pooled for dt in (0.25, 1.0))
    A = np.eye(4)
    A[:2, 2:] = 0.25 * np.eye(2)
    expected = sum(
        np.linalg.matrix_power(A, k) @ short.covariance.value @ np.linalg.matrix_power(A, k).T
        for k in range(4)
    )
    assert long.covariance.value == pytest.approx(expected, abs=0.12 * expected.max())
    assert long.num_steps == 1000


def test_noise_in_space_has_six_states() -> None:
    truth = Truth(dimension=3, steps=1500)
    pooled = identify(fly(truth, 21)).pooled
    assert np.all(holds(pooled.covariance, truth.spread))
    flat = identify(fly(truth, 21), dimension=2)
    assert flat.pooled.covariance.value.shape == (4, 4)
    assert flat.pooled.covariance.value == pytest.approx(
        pooled.covariance.value[np.ix_([0, 1, 3, 4], [0, 1, 3, 4])], rel=1e-9
    )


def test_intervals_of_variances_are_those_of_chi_square() -> None:
    interval = covariance_interval(np.eye(2), 10.0)
    # Quantiles of chi-square with ten degrees of freedom, from a table.
    assert interval.low[0, 0] == pytest.approx(10.0 / 20.4832, rel=1e-5)
    assert interval.high[0, 0] == pytest.approx(10.0 / 3.24697, rel=1e-5)
    assert interval.high[0, 1] == pytest.approx(1.96 / np.sqrt(10.0), rel=1e-3)
