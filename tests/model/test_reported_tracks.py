"""Position, speed and course as a start and its covariance, against what they truly stand for."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc import track_from_course
from radmpc.errors import ScenarioError

SAMPLES = 400_000


@pytest.mark.parametrize(
    ("course", "east", "north"),
    [
        (0.0, 0.0, 1.0),
        (90.0, 1.0, 0.0),
        (180.0, 0.0, -1.0),
        (270.0, -1.0, 0.0),
        (-90.0, -1.0, 0.0),
        (-180.0, 0.0, -1.0),
    ],
)
def test_a_course_runs_clockwise_from_north(course, east, north):
    start, covariance = track_from_course([7.0, -3.0], 4.0, course)
    assert start == pytest.approx([7.0, -3.0, 4.0 * east, 4.0 * north])
    assert not covariance.any()


@pytest.mark.parametrize("sigma", [1.5, 5.0, 10.0])
def test_what_is_linear_is_near_what_is_true_by_what_the_docs_say(sigma):
    """Drawn as they are reported: normal speeds and courses, turned into velocities."""
    rng = np.random.default_rng(0)
    speed, course, of_speed = 6.0, 55.0, 0.3
    start, covariance = track_from_course(
        [0.0, 0.0], speed, course, speed_deviation=of_speed, course_deviation=sigma
    )
    speeds = rng.normal(speed, of_speed, SAMPLES)
    angles = np.radians(rng.normal(course, sigma, SAMPLES))
    true = speeds[:, None] * np.column_stack([np.sin(angles), np.cos(angles)])
    ahead = np.array([np.sin(np.radians(course)), np.cos(np.radians(course))])
    across = np.array([ahead[1], -ahead[0]])
    spread = np.radians(sigma)
    # The mean: too long by the share that is stated.
    shortened = float(true.mean(axis=0) @ ahead) / speed
    assert 1.0 - shortened == pytest.approx(1.0 - np.exp(-(spread**2) / 2.0), abs=4e-4)
    assert start[2:] == pytest.approx(speed * ahead)
    # Across the deviation is that of the course, along it is the speed's and the bend of the arc.
    linear = covariance[2:, 2:]
    assert np.std(true @ across) == pytest.approx(np.sqrt(across @ linear @ across), rel=0.03)
    bend = speed * spread**2 / np.sqrt(2.0)
    along = np.sqrt(ahead @ linear @ ahead + bend**2)
    assert np.std(true @ ahead) == pytest.approx(along, rel=0.02)
    assert np.sqrt(ahead @ linear @ ahead) == pytest.approx(of_speed)


def test_deviations_of_the_position_stand_along_its_axes():
    _, covariance = track_from_course([0, 0], 1.0, 30.0, position_deviation=[5.0, 3.0])
    assert covariance[:2, :2].tolist() == [[25.0, 0.0], [0.0, 9.0]]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"speed": -1.0}, "speed: must be >= 0 m/s, got -1.0"),
        ({"course": float("nan")}, "course: must be a finite number of degrees, got nan"),
        ({"course": 465.0}, "course: must be from -180 to below 360 degrees, got 465$"),
        ({"course": -181.5}, "course: must be from -180 to below 360 degrees, got -181.5$"),
        ({"course": 360.0}, "got 360, which AIS sends where it has no course$"),
        ({"position": [1.0]}, "position: must have 2 numbers, got 1"),
        ({"position_deviation": [1.0, -1.0]}, "position_deviation: must be >= 0 m"),
        ({"course_deviation": 21.0}, "course_deviation: must be at most 20 degrees, got 21"),
    ],
)
def test_what_no_track_has_is_refused(change, message):
    given = {"position": [0.0, 0.0], "speed": 1.0, "course": 0.0} | change
    with pytest.raises(ScenarioError, match=message):
        track_from_course(**given)
