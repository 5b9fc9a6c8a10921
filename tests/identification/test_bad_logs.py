"""Logs as they come: every flaw is one clear line, or a warning that says what was done."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from radmpc.errors import FileFormatError, ScenarioError
from radmpc.identification import Track, identify
from simulator import Truth, fly


def flight(**parts: object) -> Track:
    """Return a flight of 300 steps of 0.5 s with some parts replaced."""
    [track] = fly(Truth(steps=300), seed=1)
    times = parts.pop("times", None)
    return track.changed(parts, times)


def changed(array: np.ndarray, rows: object, value: object) -> np.ndarray:
    """Return a copy with other rows."""
    found = np.array(array)
    found[rows] = value
    return found


def test_a_gap_is_not_bridged() -> None:
    track = flight()
    kept = np.r_[0:100, 140:301]
    parts = {name: getattr(track, name)[kept] for name in track.parts()}
    found = identify([track.changed(parts, track.times[kept])])
    assert found.pooled.num_steps == 99 + 160
    assert any("a gap of 20.5 s" in line for line in found.warnings)


def test_a_clock_that_is_set_during_a_log_is_a_gap() -> None:
    track = flight()
    times = np.concatenate([track.times[:50], 1.76e9 + track.times[50:]])
    found = identify([track.changed({}, times)])
    assert found.pooled.num_steps == 49 + 250
    assert any("has a gap of 1.76e+09 s" in line for line in found.warnings)


def test_a_jump_is_left_out_and_told() -> None:
    track = flight()
    jumped = np.array(track.positions)
    jumped[150:] += [40.0, 0.0]
    found = identify([track.changed({"positions": jumped})])
    assert found.pooled.num_steps == 299
    assert found.pooled.covariance.value[0, 0] < 0.02
    assert any("a jump of 40 m" in line for line in found.warnings)


@pytest.mark.parametrize(
    ("part", "factor"), [("positions", 1000.0), ("velocities", 3.6), ("velocities", 0.01)]
)
def test_units_that_contradict_each_other_are_refused(part: str, factor: float) -> None:
    track = flight()
    with pytest.raises(
        FileFormatError, match=r"moves [\d.e+-]+ times as far as its velocities say"
    ):
        identify([track.changed({part: factor * getattr(track, part)})])


def test_times_in_milliseconds_are_refused() -> None:
    track = flight()
    with pytest.raises(FileFormatError, match="are times in s"):
        identify([track.changed({}, 1000.0 * track.times)])


def test_times_that_are_hardly_in_seconds_are_told_where_nothing_contradicts_them() -> None:
    track = flight()
    bare = Track("v1", "log.csv", "one", 1e6 * track.times, track.positions)
    assert any("are times in seconds?" in line for line in identify([bare]).warnings)


def test_a_time_that_runs_backwards_is_refused_with_its_place() -> None:
    track = flight()
    times = np.concatenate([track.times[:200], track.times[:101]])
    with pytest.raises(
        FileFormatError,
        match=r"log.csv: vehicle 'v1': time runs backwards at sample 201: 0 s after 99.5 s",
    ):
        identify([track.changed({}, times)])


def test_repeated_times_are_left_out_and_told() -> None:
    track = flight()
    rows = np.sort(np.r_[0:301, 50, 60])
    parts = {name: getattr(track, name)[rows] for name in track.parts()}
    found = identify([track.changed(parts, track.times[rows])])
    assert found.pooled.num_steps == 300
    assert any("2 samples repeat the time before them" in line for line in found.warnings)


def test_a_position_that_never_changes_is_refused() -> None:
    with pytest.raises(FileFormatError, match="its position never changes: nothing to learn"):
        identify([flight(positions=np.zeros((301, 2)))])


def test_an_axis_that_never_changes_is_told_and_does_no_harm() -> None:
    track = flight()
    still = {
        name: changed(getattr(track, name), np.s_[:, 1], 0.0)
        for name in ("positions", "velocities", "controls")
    }
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = identify([track.changed(still)])
    assert any("y never changes: its noise cannot be told" in line for line in found.warnings)
    covariance = found.pooled.covariance.value
    assert covariance[1, 1] == covariance[3, 3] == 0.0
    assert covariance[0, 0] == pytest.approx(0.012, rel=0.3)


def test_velocities_that_never_change_are_not_used() -> None:
    found = identify([flight(velocities=np.zeros((301, 2)))])
    assert not found.model.has_velocity
    assert any("velocities never change, and are not used" in line for line in found.warnings)


def test_five_samples_are_too_few() -> None:
    track = flight()
    parts = {name: getattr(track, name)[:5] for name in track.parts()}
    with pytest.raises(FileFormatError, match=r"4 steps of 0\.5 s are too few: at least 14"):
        identify([track.changed(parts, track.times[:5])])


def test_one_sample_is_too_few() -> None:
    track = flight()
    parts = {name: getattr(track, name)[:1] for name in track.parts()}
    with pytest.raises(FileFormatError, match="has a single sample"):
        identify([track.changed(parts, track.times[:1])])


def test_twenty_steps_are_called_rough() -> None:
    track = flight()
    parts = {name: getattr(track, name)[:21] for name in track.parts()}
    found = identify([track.changed(parts, track.times[:21])])
    assert any("about 19 independent steps: the numbers are rough" in w for w in found.warnings)


def test_samples_without_a_number_are_left_out() -> None:
    track = flight()
    found = identify([track.changed({"positions": changed(track.positions, [10, 20], np.nan)})])
    assert any("2 of 301 samples lack a number" in line for line in found.warnings)
    assert found.pooled.num_steps == 296


def test_a_vehicle_without_data_is_left_out() -> None:
    track = flight()
    nothing = Track("ghost", "log.csv", "one", track.times, np.full((301, 2), np.nan),
                    np.full((301, 2), np.nan), track.controls)  # fmt: skip
    found = identify([track, nothing])
    assert found.pooled.vehicles == ("v1",)
    assert any("'ghost': has no data, and is left out" in line for line in found.warnings)
    with pytest.raises(FileFormatError, match="no sample that can be used"):
        identify([nothing])


def test_an_axis_without_numbers_is_named_where_nothing_else_is_left() -> None:
    track = flight()
    lacking = track.changed({"positions": changed(track.positions, np.s_[:, 1], np.nan)})
    with pytest.raises(FileFormatError, match="'v1': has no position along y, and is left out"):
        identify([lacking])


def test_commands_of_a_part_of_the_flight_restrict_it_to_that() -> None:
    track = flight()
    found = identify([track.changed({"controls": changed(track.controls, np.s_[:100], np.nan)})])
    assert found.evidence == "commands"
    assert found.pooled.num_steps == 200
    few = identify([track.changed({"controls": changed(track.controls, np.s_[:290], np.nan)})])
    assert few.evidence == "states"
    assert any("controls stand in 11 of 301 samples only" in line for line in few.warnings)


def test_commands_that_are_not_followed_are_told() -> None:
    track = flight()
    found = identify([track.changed({"controls": 9.81 * track.controls})])
    assert any("of what commands ask for" in line for line in found.warnings)
    # Feedback against a gust that lasts looks like a weak response, and is none.
    for truth in (Truth(steps=300), Truth(steps=300, color=0.7)):
        followed = identify(fly(truth, 1))
        assert not any("of what commands ask for" in line for line in followed.warnings)


def test_commands_that_never_change_are_told() -> None:
    found = identify([flight(controls=np.zeros((301, 2)))])
    assert any("its commands never change" in line for line in found.warnings)


@pytest.mark.parametrize("dt", [0.0, -1.0, np.nan, np.inf])
def test_a_step_must_be_above_zero(dt: float) -> None:
    with pytest.raises(ScenarioError, match=r"dt: must (be > 0|lie between 1e-06 and 1e\+06) s"):
        identify([flight()], dt=dt)


def test_a_step_shorter_than_the_log_is_refused() -> None:
    with pytest.raises(
        FileFormatError, match=r"too few for steps of 0\.1 s: --dt must be at least"
    ):
        identify([flight()], dt=0.1)


def test_times_beside_the_steps_are_interpolated_and_told() -> None:
    track = flight()
    rng = np.random.default_rng(3)
    shaken = track.times + rng.uniform(-0.2, 0.2, 301)
    found = identify([track.changed({}, shaken)], dt=0.5)
    assert any("they are interpolated" in line for line in found.warnings)


def test_jitter_of_times_makes_no_noise() -> None:
    rng = np.random.default_rng(4)
    times = 0.5 * np.arange(301) + rng.uniform(-0.02, 0.02, 301)
    positions = np.column_stack([7.0 * times, 0.5 * np.sin(times)])
    velocities = np.column_stack([np.full(301, 7.0) + 1e-9 * times, 0.5 * np.cos(times)])
    track = Track("v1", "log.csv", "one", times, positions, velocities)
    found = identify([track], dt=0.5)
    # Read as if the times were even, 7 m/s and 0.02 s would be 0.08 m of noise.
    assert np.sqrt(found.pooled.covariance.value[0, 0]) < 1e-6


def test_a_fleet_of_mixed_logs_is_refused() -> None:
    track = flight()
    bare = Track("bare", "other.csv", "two", track.times, track.positions)
    with pytest.raises(FileFormatError, match=r"'bare': has no velocities, other vehicles have"):
        identify([track, bare])


def test_a_number_that_no_vehicle_has_is_refused_with_its_place() -> None:
    times, places = [0.0, 1.0], [[0.0, 0.0], [1.0, 1e10]]
    with pytest.raises(ScenarioError, match=r"positions\[1\]\[1\]: must be at most 1000000000"):
        Track("tug", "log.csv", "one", times, places)
    with pytest.raises(ScenarioError, match=r"controls\[0\]\[0\]: must be at least -1000000000"):
        Track("tug", "log.csv", "one", times, np.zeros((2, 2)), controls=[[-1e99, 0], [0, 0]])
    missing = Track("tug", "log.csv", "one", times, [[np.nan, np.inf], [0.0, 1e9]])
    assert missing.positions[1, 1] == 1e9


def test_too_few_axes_are_refused() -> None:
    with pytest.raises(FileFormatError, match="has 2 axes, and 3 are needed"):
        identify([flight()], dimension=3)


def test_no_vehicle_is_refused() -> None:
    with pytest.raises(FileFormatError, match="hold no vehicle"):
        identify([])


@pytest.mark.parametrize("log", ["both", "references"])
def test_references_that_are_where_vehicles_were_tell_nothing_and_that_is_said(log: str) -> None:
    [track] = fly(Truth(steps=400), 5, log)
    states = np.hstack([track.positions, track.velocities])
    found = identify([track.changed({"references": states})])
    assert found.evidence == ("commands" if log == "both" else "states")
    assert found.pooled.gain is None
    assert any(line.startswith("feedback: ") for line in found.unknown)
    assert [line for line in found.warnings if "where the vehicle was" in line]
    # A plan made anew at every step ends where the vehicle does not.
    states[-1] += 1.0
    assert identify([track.changed({"references": states})]).pooled.gain is None
    # Positions alone that were copied tell as little.
    found = identify([track.changed({"references": track.positions})])
    assert found.pooled.gain is None
