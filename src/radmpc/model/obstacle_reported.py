"""Tracks as AIS or a tracker reports them: position, speed and course, each with its deviation."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from radmpc.arguments import field_number
from radmpc.arrays import Matrix, Vector, as_axes, as_vector, frozen
from radmpc.errors import ScenarioError

__all__ = ["track_from_course"]

_WIDEST = 20.0
"""Largest standard deviation of a course that is taken as straight [degrees]: the velocity's mean
is then 6 % too long, and grows worse with the square."""

_LEAST_COURSE, _FULL_TURN = -180.0, 360.0
"""Least course, and what courses stay below [degrees]: counted from 0, or from -180 to 180."""


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

    With the speed s and the course γ the velocity is :math:`s\,(\sin γ, \cos γ)`, taken as linear
    in both around what is reported: its deviation is that of the speed along the course, and
    :math:`s\,\sigma_γ` across. The reported velocity is longer than the mean of the true one by
    the share :math:`1 - \exp(-\sigma_γ^2/2)`: 0.03 % at 1.5 degrees, 0.4 % at 5, 1.5 % at 10 (and
    6 % at 20, beyond which it is refused). What is left out besides is the bend of an arc around
    the course, :math:`s\,\sigma_γ^2/\sqrt 2` of deviation along it.

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
        Position [m] and velocity [m/s].
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
    [0.0, 100.0, 5.0, 0.0]
    >>> float(covariance[3, 3] ** 0.5)  # across: 5 m/s times 2 degrees
    0.17453292519943295
    """
    place = as_vector(position, 2, ("position",))
    along = _at_least_zero(speed, "speed", "m/s")
    angle = math.radians(_course(course))
    spread = as_axes(position_deviation, 2, ("position_deviation",))
    if np.any(spread < 0.0):
        text = f"must be >= 0 m, got {spread.tolist()}"
        raise ScenarioError(text, ("position_deviation",))
    of_speed = _at_least_zero(speed_deviation, "speed_deviation", "m/s")
    of_course = _at_least_zero(course_deviation, "course_deviation", "degrees")
    if of_course > _WIDEST:
        text = f"must be at most {_WIDEST:g} degrees, got {of_course:g}: take a covariance"
        raise ScenarioError(text, ("course_deviation",))
    ahead = np.array([math.sin(angle), math.cos(angle)])
    across = np.array([ahead[1], -ahead[0]])
    covariance = np.zeros((4, 4))
    covariance[:2, :2] = np.diag(spread**2)
    covariance[2:, 2:] = of_speed**2 * np.outer(ahead, ahead)
    covariance[2:, 2:] += (along * math.radians(of_course)) ** 2 * np.outer(across, across)
    return frozen(np.concatenate([place, along * ahead])), frozen(covariance)


def _finite(value: float, name: str, unit: str) -> float:
    """Return a finite number."""
    number = field_number(value, (name,))
    if not math.isfinite(number):
        raise ScenarioError(f"must be a finite number of {unit}, got {number}", (name,))
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
