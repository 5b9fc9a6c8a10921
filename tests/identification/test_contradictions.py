"""Logs whose parts contradict each other: axes, signs, units, stuck sensors, times."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.errors import FileFormatError
from radmpc.identification import Track, identify
from radmpc.identification.axes import check_axes
from simulator import Truth, dynamics, fly


def flight(log: str = "commands") -> Track:
    """A flight that goes somewhere along both axes."""
    [track] = fly(Truth(steps=400, feedback=(-0.01, -0.03)), 1, log)
    return track


def times(array: np.ndarray, factors: list[float]) -> np.ndarray:
    return array * np.array(factors)


def test_an_axis_against_its_velocity_is_refused() -> None:
    track = flight()
    with pytest.raises(FileFormatError, match="y moves against vy: do they have the same sign"):
        identify([track.changed({"positions": times(track.positions, [1.0, -1.0])})])


def test_velocities_of_exchanged_axes_are_refused() -> None:
    track = flight()
    with pytest.raises(FileFormatError, match="x moves as vy says, and not as vx"):
        identify([track.changed({"velocities": track.velocities[:, ::-1]})])


def test_one_axis_in_other_units_is_refused() -> None:
    track = flight()
    with pytest.raises(FileFormatError, match=r"moves along y 0\.2\d* times as far"):
        identify([track.changed({"velocities": times(track.velocities, [1.0, 3.6])})])


def test_velocities_in_knots_are_refused() -> None:
    track = flight()
    with pytest.raises(FileFormatError, match=r"moves 0\.5\d* times as far"):
        identify([track.changed({"velocities": 1.944 * track.velocities})])


def test_velocities_that_are_a_little_off_are_told() -> None:
    track = flight()
    found = identify([track.changed({"velocities": 1.3 * track.velocities})])
    assert any("times as far along x as vx says" in line for line in found.warnings)
    assert not any("times as far" in line for line in identify([track]).warnings)


def test_short_logs_are_not_told_of_what_is_chance() -> None:
    for seed in range(100):
        [track] = fly(Truth(steps=80, feedback=(-0.01, -0.03)), seed, "commands")
        assert check_axes(track) == (), seed


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda u: u[:, ::-1], "vx gains what commands along y ask for"),
        (lambda u: u * [1.0, -1.0], "vy gains against what commands along y ask for"),
    ],
)
def test_commands_along_other_axes_are_told(change: object, told: str) -> None:
    [track] = fly(Truth(steps=600, scale=0.1), 2)
    rng = np.random.default_rng(3)
    pushes = 0.2 * rng.standard_normal((len(track.times), 2))
    moved = np.vstack([np.zeros(2), np.cumsum(0.5 * pushes[:-1], axis=0)])
    places = np.vstack([np.zeros(2), np.cumsum(0.5 * moved[:-1] + 0.125 * pushes[:-1], axis=0)])
    track = track.changed(
        {
            "positions": track.positions + places,
            "velocities": track.velocities + moved,
            "controls": track.controls + pushes,
        }
    )
    assert not any("commands along" in line for line in identify([track]).warnings)
    found = identify([track.changed({"controls": change(track.controls)})])
    assert any(told in line for line in found.warnings)


def test_a_stuck_position_is_refused() -> None:
    track = flight()
    stuck = np.array(track.positions)
    stuck[:, 0] = 1.0
    with pytest.raises(FileFormatError, match="x never changes, and vx says that it moves"):
        identify([track.changed({"positions": stuck})])


@pytest.mark.parametrize("factor", [1e3, 1e6, 1e9])
def test_times_since_1970_that_are_no_seconds_are_refused(factor: float) -> None:
    track = flight("states")
    bare = Track("v1", "log.csv", "one", factor * (1.7e9 + track.times), track.positions)
    with pytest.raises(FileFormatError, match=r"log.csv: vehicle 'v1': times go up to .*seconds"):
        identify([bare])


def test_steps_of_minutes_are_asked_about() -> None:
    track = flight("states")
    bare = Track("v1", "log.csv", "one", 1e3 * track.times, track.positions)
    assert any("are times in seconds?" in line for line in identify([bare]).warnings)


def test_positions_in_degrees_are_asked_about() -> None:
    track = flight("states")
    degrees = np.array([54.3, 10.1]) + track.positions / 111_000.0
    bare = Track("v1", "log.csv", "one", track.times, degrees)
    assert any("not degrees?" in line for line in identify([bare]).warnings)


def test_a_step_longer_than_the_log_is_one_line() -> None:
    with pytest.raises(FileFormatError, match="are too few"):
        identify([flight("both")], dt=1000.0)


def test_exact_motion_along_one_axis_contradicts_nothing() -> None:
    since = 0.5 * np.arange(301)
    positions = np.column_stack([7.0 * since, 0.5 * np.sin(since)])
    velocities = np.column_stack([7.0 + 1e-9 * since, 0.5 * np.cos(since)])
    found = identify([Track("v1", "log.csv", "one", since, positions, velocities)])
    assert not any("times as far" in line for line in found.warnings)


def test_a_log_whose_time_runs_backwards_throughout_is_not_two_logs() -> None:
    track = flight()
    with pytest.raises(FileFormatError, match="the whole log does"):
        identify([track.changed({}, -track.times)])


def test_what_happens_while_nothing_is_logged_contradicts_no_velocity() -> None:
    flown = 0.5 * np.arange(400)
    # After every 20 samples the vehicle waits for 15 s, without a log.
    times = flown + 15.0 * (np.arange(400) // 20)
    positions = np.column_stack([2.0 * flown, 1.5 * flown + np.sin(flown)])
    velocities = np.column_stack([2.0 + 1e-9 * flown, 1.5 + np.cos(flown)])
    assert check_axes(Track("v1", "log.csv", "one", times, positions, velocities)) == ()


def test_a_still_position_and_noise_of_its_velocity_at_a_gap_are_no_contradiction() -> None:
    track = flight("states")
    later = track.times + np.where(np.arange(len(track.times)) > 200, 3600.0, 0.0)
    positions, velocities = track.positions.copy(), track.velocities.copy()
    positions[:, 1] = 0.0
    velocities[:, 1] = 0.02 * np.sin(np.arange(len(later)))
    still = track.changed({"positions": positions, "velocities": velocities}, later)
    assert any("y never changes, though vy does" in line for line in identify([still]).warnings)


def test_a_vehicle_that_goes_along_both_axes_alike_has_no_axes_mixed_up() -> None:
    dt, rng = 0.5, np.random.default_rng(4)
    A, B = dynamics(dt, 2)
    states = np.zeros((401, 4))
    for k in range(400):
        # Feedback answers what pushes along x, so that vx explains x less well than vy does.
        pushed = -0.3 * states[k, :2] - 0.8 * states[k, 2:]
        noise = [0.035, 0.047, 0.025, 0.022] * rng.standard_normal(4)
        states[k + 1] = A @ states[k] + B @ (pushed + 0.5 * np.sin(0.1 * k)) + noise
        states[k + 1, 0] += 0.02
    track = Track("v", "log.csv", "one", dt * np.arange(401), states[:, :2], states[:, 2:])
    assert identify([track]).pooled.num_steps == 400
