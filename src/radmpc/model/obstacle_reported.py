"""Tracks as AIS or a tracker reports them: position, speed and course, each with its deviation."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from radmpc.arguments import field_number
from radmpc.arrays import Matrix, Vector, as_axes, as_vector, frozen
from radmpc.errors import ScenarioError
from radmpc.ranges import check_size, sized

__all__ = ["track_from_course"]

_WIDEST = 20.0
"""Largest standard deviation of a course that is taken as a Gaussian velocity [degrees]: four of
them turn it by nearly a right angle."""

_FARTHEST = 4.0
"""Deviations of speed and course to which a Gaussian velocity covers them [-]: beyond is 3e-5."""

_LEAST_COURSE, _FULL_TURN = -180.0, 360.0
"""Least course, and what courses stay below [degrees]: counted from 0, or from -180 to 180."""


_STRAIGHT = 1e-12
"""Deviation of a course below which its arc is a line, to rounding [rad]."""


def track_from_course(
    position: npt.ArrayLike,
    speed: float,
    course: float,
    *,
    position_deviation: npt.ArrayLike = 0.0,
    speed_deviation: float = 0.0,
    course_deviation: float = 0.0,
) -> tuple[Vector, Matrix]:
    r"""Return the start of an obstacle's track and its covariance, for `Obstacle.tracked`.

    With a speed :math:`s \sim N(\bar s, \sigma_s^2)` and a course :math:`\theta \sim N(0,
    \sigma^2)` from the reported one, both independent, the velocity is :math:`s \cos\theta` along
    the reported course and :math:`s \sin\theta` across. Its mean is exact: :math:`\bar s
    \exp(-\sigma^2/2)` along. Its covariance is not below the exact one: velocities lie on an arc,
    whose ends lag behind far more often than a Gaussian of the arc's own deviation does, and a
    certificate reads the tails. So the variances are

    .. math:: \sigma_s^2 + \hat s^2 a^2 \quad \text{along}, \qquad
              \hat s^2 \sigma^2 (1 + \sigma/2) \quad \text{across}, \qquad
              \hat s = \bar s + 4 \sigma_s,

    :math:`\sigma` in radians, and *a* the least for which the ellipse of z deviations around the
    mean holds both ends of the arc of z deviations of the course, for all z from 1 to 4. It is
    0.6 % at 1 degree, 1.5 % at 2, 5 % at 5, 12 % at 10, 19 % at 15 and 25 % at 20, beyond which a
    course is refused. So along every direction, with noise of the position or without, velocities
    are beyond a clearance no more often than this Gaussian, up to four deviations (at 4.2 up to
    1.15 times as often), if deviations are as given.

    Parameters
    ----------
    position : (2,) array_like
        Where it is: east and north, or x and y of the scenario [m].
    speed : float
        Over ground [m/s], >= 0; a knot is 0.5144 m/s.
    course : float
        Over ground, clockwise from north (+y) [degrees], from -180 to below 360: 360 is what AIS
        sends where it has no course.
    position_deviation : float or (2,) array_like
        Standard deviation of the position along each axis [m].
    speed_deviation : float
        That of the speed [m/s].
    course_deviation : float
        That of the course [degrees], at most 20.

    Returns
    -------
    start : (4,) array
        Mean position [m] and velocity [m/s]: of an uncertain course slower than the speed.
    covariance : (4, 4) array
        Of both; position, speed and course are independent.

    Raises
    ------
    ScenarioError
        If an argument is no finite number of its range.

    Examples
    --------
    >>> import radmpc
    >>> start, covariance = radmpc.track_from_course([0.0, 100.0], 5.0, 90.0, course_deviation=2.0)
    >>> start.round(9).tolist()
    [0.0, 100.0, 4.996954754, 0.0]
    >>> (covariance[[2, 3], [2, 3]] ** 0.5).round(4).tolist()  # along, and across
    [0.0744, 0.176]
    """
    place = sized(as_vector(position, 2, ("position",)), ("position",))
    along = _at_least_zero(speed, "speed", "m/s")
    angle = math.radians(_course(course))
    path = ("position_deviation",)
    spread = sized(as_axes(position_deviation, 2, path), path)
    if np.any(spread < 0.0):
        text = f"must be >= 0 m, got {spread.tolist()}"
        raise ScenarioError(text, path)
    of_speed = _at_least_zero(speed_deviation, "speed_deviation", "m/s")
    of_course = _at_least_zero(course_deviation, "course_deviation", "degrees")
    if of_course > _WIDEST:
        text = f"must be at most {_WIDEST:g} degrees, got {of_course:g}: take a covariance"
        raise ScenarioError(text, ("course_deviation",))
    ahead = np.array([math.sin(angle), math.cos(angle)])
    across = np.array([ahead[1], -ahead[0]])
    kept, lag, turn = _arc(math.radians(of_course))
    fast = along + _FARTHEST * of_speed
    covariance = np.zeros((4, 4))
    covariance[:2, :2] = np.diag(spread**2)
    covariance[2:, 2:] = (of_speed**2 + (fast * lag) ** 2) * np.outer(ahead, ahead)
    covariance[2:, 2:] += (fast * turn) ** 2 * np.outer(across, across)
    return frozen(np.concatenate([place, along * kept * ahead])), frozen(covariance)


def _arc(deviation: float) -> tuple[float, float, float]:
    """Return a Gaussian that covers the arc of a unit vector whose angle is uncertain.

    Parameters
    ----------
    deviation : float
        Standard deviation of the angle [rad], > 0 or 0.

    Returns
    -------
    mean : float
        Along the mean angle [-]; across it is 0.
    along, across : float
        Standard deviations [-], see `track_from_course`.
    """
    mean = math.exp(-0.5 * deviation**2)
    # Exactly as wide as the arc is long, only a circle would hold it: a little more across saves
    # most of what the ends ask for along.
    across = deviation * math.sqrt(1.0 + 0.5 * deviation)
    if deviation < _STRAIGHT:
        return mean, deviation, across
    many = np.linspace(1.0, _FARTHEST, 401)
    aside = np.sin(many * deviation) / (many * across)
    behind = mean - np.cos(many * deviation)
    return mean, float(np.max(behind / (many * np.sqrt(1.0 - aside**2)))), across


def _finite(value: float, name: str, unit: str) -> float:
    """Return a finite number."""
    number = field_number(value, (name,))
    if not math.isfinite(number):
        raise ScenarioError(f"must be a finite number of {unit}, got {number}", (name,))
    check_size(number, (name,))
    return number


def _course(value: float) -> float:
    """Return a course within a turn."""
    number = _finite(value, "course", "degrees")
    if not _LEAST_COURSE <= number < _FULL_TURN:
        reason = ", which AIS sends where it has no course" if number == _FULL_TURN else ""
        allowed = f"from {_LEAST_COURSE:g} to below {_FULL_TURN:g} degrees"
        raise ScenarioError(f"must be {allowed}, got {number:.9g}{reason}", ("course",))
    return number


def _at_least_zero(value: float, name: str, unit: str) -> float:
    """Return a finite number that is not below 0."""
    number = _finite(value, name, unit)
    if number < 0.0:
        raise ScenarioError(f"must be >= 0 {unit}, got {number}", (name,))
    return number
