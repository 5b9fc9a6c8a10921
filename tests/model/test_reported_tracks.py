"""Position, speed and course as a start and its covariance, against what they truly stand for."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import norm

import radmpc
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


def drawn(rng, speed, of_speed, sigma):
    """Return velocities along and across the course as they are reported, (SAMPLES, 2) [m/s]."""
    speeds = rng.normal(speed, of_speed, SAMPLES)
    angles = np.radians(rng.normal(0.0, sigma, SAMPLES))
    return speeds[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])


def reported(speed, of_speed, sigma, course=55.0):
    """Return the mean [m/s] and the covariance [m²/s²] along and across the course."""
    start, covariance = track_from_course(
        [0.0, 0.0], speed, course, speed_deviation=of_speed, course_deviation=sigma
    )
    ahead = np.array([np.sin(np.radians(course)), np.cos(np.radians(course))])
    axes = np.array([ahead, [ahead[1], -ahead[0]]])
    return axes @ start[2:], axes @ covariance[2:, 2:] @ axes.T


@pytest.mark.parametrize("sigma", [1.5, 5.0, 10.0, 20.0])
def test_the_mean_velocity_is_that_of_speeds_and_courses_as_reported(sigma):
    true = drawn(np.random.default_rng(0), 6.0, 0.3, sigma)
    mean, covariance = reported(6.0, 0.3, sigma)
    # Five deviations of a mean of so many draws.
    assert mean == pytest.approx(true.mean(axis=0), abs=5.0 * 2.2 / np.sqrt(SAMPLES))
    assert np.diag(covariance) == pytest.approx(np.maximum(np.diag(covariance), true.var(axis=0)))
    assert covariance[0, 1] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.sampled(6)
@pytest.mark.parametrize("of_speed", [0.0, 0.3, 1.2])
@pytest.mark.parametrize("sigma", [1.0, 2.0, 5.0, 10.0, 15.0, 20.0])
def test_no_side_sees_a_reported_velocity_more_often_than_its_gaussian(sigma, of_speed):
    """Certificates read tails along normals: of arcs, too, they are not above the Gaussian's."""
    true = drawn(np.random.default_rng(1), 6.0, of_speed, sigma)
    mean, covariance = reported(6.0, of_speed, sigma)
    for angle in np.radians(np.arange(0.0, 181.0, 10.0)):
        normal = np.array([np.cos(angle), np.sin(angle)])
        far = (true - mean) @ normal / np.sqrt(normal @ covariance @ normal)
        for clearance in (0.5, 1.0, 1.5, 2.0, 2.5, 3.0):
            allowed = norm.sf(clearance)
            chance = 4.0 * np.sqrt(allowed / SAMPLES)
            assert np.mean(far > clearance) <= allowed + chance, (angle, clearance)


def test_a_certificate_beside_a_ship_of_uncertain_course_is_not_below_what_is_drawn():
    """The ship crosses ahead; its own speed and course are drawn, nothing is made linear."""
    speed, sigma, steps = 2.0, 10.0, 14
    start, covariance = track_from_course([10.0, -8.0], speed, 0.0, course_deviation=sigma)
    hull = [[-2.0, -2.0], [2.0, -2.0], [2.0, 2.0], [-2.0, 2.0]]
    ship = radmpc.Obstacle.tracked("ship", hull, start, covariance)
    boat = radmpc.Vehicle(
        "boat", radmpc.double_integrator(1.0, dimension=2), [0.0, 3.0, 0.0, 0.0],
        radmpc.Goal([17.0, 2.0], [19.0, 4.0], [0.3, 0.3]), radius=0.5, control_limit=1.5,
        speed_limit=3.0, initial_covariance=0.0, disturbance_covariance=0.0,
    )  # fmt: skip
    scenario = radmpc.Scenario("crossing", 1.0, steps, 0.05, [boat], [ship], avoidance="steps")
    plan = radmpc.plan(scenario, "certified(0)", rng=0).require()
    certified = radmpc.certify(plan).certified
    assert certified <= 0.05
    velocities = drawn(np.random.default_rng(2), speed, 0.0, sigma)[:, ::-1]
    touched = np.zeros(SAMPLES, bool)
    for k, place in enumerate(plan.trajectories[0].means[:, :2]):
        beside = np.abs(place - np.array([10.0, -8.0]) - k * velocities)
        gap = np.maximum(beside - 2.0, 0.0)
        touched |= np.hypot(gap[:, 0], gap[:, 1]) < 0.5
    assert touched.mean() <= certified + 4.0 * np.sqrt(certified / SAMPLES)


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
