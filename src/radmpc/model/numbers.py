"""Ranges of the numbers of scenarios and vehicles, all checked together."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.arguments import field_integer, field_number, field_parts, value_text
from radmpc.arrays import Matrix, Vector, as_axes, as_matrix
from radmpc.errors import ScenarioError, all_checked, raise_together
from radmpc.ranges import LARGEST, LEAST, check_range, check_size, check_steps

__all__ = [
    "check_correlation",
    "check_not_negative",
    "check_positive",
    "check_scenario_numbers",
    "check_speedless",
    "check_vehicle_numbers",
    "consistent_limits",
    "positive_definite",
    "step_window",
]


_FEWEST_SAMPLES = 3
"""Independent steps from which a covariance is estimated at least [-]: of fewer no tail has a
variance."""


def check_scenario_numbers(
    dt: float, horizon: int, risk_bound: float, covariance_samples: int | None = None
) -> None:
    """Refuse numbers that no scenario has.

    Parameters
    ----------
    dt : float
        Step [s].
    horizon : int
        Number of steps T.
    risk_bound : float
        Risk bound Δ.
    covariance_samples : int or None
        Steps ν that covariances were estimated from.

    Raises
    ------
    ScenarioError
        With all that are.
    """
    found = []
    try:
        check_range(dt, "s", ("dt",))
    except ScenarioError as error:
        found.append(error)
    try:
        check_steps(horizon)
    except ScenarioError as error:
        found.append(error)
    if not 0.0 < risk_bound < 0.5:
        text = f"must lie between 0 and 0.5, both excluded, got {risk_bound}"
        found.append(ScenarioError(text, ("risk_bound",)))
    if covariance_samples is not None and covariance_samples < _FEWEST_SAMPLES:
        text = f"must be at least {_FEWEST_SAMPLES} independent steps, got {covariance_samples}"
        found.append(ScenarioError(text, ("covariance_samples",)))
    raise_together(found)


def check_vehicle_numbers(radius: float, control_sigmas: float, cost_weight: float) -> None:
    """Refuse numbers that no vehicle has.

    Parameters
    ----------
    radius : float
        Hull radius [m].
    control_sigmas : float
        Standard deviations of the feedback held in reserve.
    cost_weight : float
        Factor in the cost.

    Raises
    ------
    ScenarioError
        With all that are.
    """
    all_checked(
        lambda: check_positive(np.array([radius]), "radius", "m"),
        lambda: check_not_negative(control_sigmas, "control_sigmas"),
        lambda: check_not_negative(cost_weight, "cost_weight"),
    )


def check_correlation(
    correlation: float, path: tuple[str, ...] = ("disturbance", "correlation")
) -> None:
    """Refuse what no stationary disturbance has as the correlation of consecutive steps.

    Parameters
    ----------
    correlation : float
        ρ.
    path : tuple of str
        Where it stands, for the message.

    Raises
    ------
    ScenarioError
        If it is below 0, or 1 or more.
    """
    if not 0.0 <= correlation < 1.0:
        text = f"must be from 0 to below 1, got {correlation}"
        raise ScenarioError(text, path)


def check_not_negative(value: float, name: str) -> None:
    """Refuse a value below zero, or too large.

    Parameters
    ----------
    value : float
        The value.
    name : str
        Its field.

    Raises
    ------
    ScenarioError
        With the value.
    """
    if not (np.isfinite(value) and value >= 0.0):
        raise ScenarioError(f"must be >= 0, got {value}", (name,))
    check_size(value, (name,))


def check_positive(values: Vector, name: str, unit: str) -> None:
    """Refuse values that are not above zero, or so small or large that their squares are none.

    Parameters
    ----------
    values : (d,) array
        What must be above zero.
    name : str
        Its field.
    unit : str
        Its unit, for the message.

    Raises
    ------
    ScenarioError
        With the unit.
    """
    if not np.all(np.isfinite(values) & (values > 0.0)):
        raise ScenarioError(f"must be > 0 {unit}, got {_shown(values)}", (name,))
    if np.any(values > LARGEST):
        raise ScenarioError(f"must be at most {LARGEST:.10g}, got {_shown(values)}", (name,))
    if np.any(values < LEAST):
        raise ScenarioError(f"must be at least {LEAST:g} {unit}, got {_shown(values)}", (name,))


def _shown(values: Vector) -> float | list[float]:
    """Return values as messages tell them."""
    return values.tolist() if values.size > 1 else values.item()


def step_window(given: object, name: str) -> tuple[int, int]:
    """Return a window of two steps.

    Parameters
    ----------
    given : sequence of two int
        The first and the last.
    name : str
        Its field.

    Raises
    ------
    ScenarioError
        If it is none, or if it begins before step 1 or after its end.
    """
    parts = field_parts(given, "two steps, the first and the last", (name,))
    if len(parts) != 2:
        raise ScenarioError(
            f"must be two steps, the first and the last, got {value_text(given)}", (name,)
        )
    first, last = (field_integer(part, (name, i)) for i, part in enumerate(parts))
    if not 1 <= first <= last:
        raise ScenarioError(f"must be two steps, 1 <= first <= last, got {[first, last]}", (name,))
    return first, last


def axes_under(norm: object, axes: Vector, name: str) -> tuple[float, Vector]:
    """Return a limit of a Euclidean norm, and limits per axis none of which exceeds it.

    Parameters
    ----------
    norm : object
        As a caller gives it.
    axes : (n,) array
        Limits per axis.
    name : str
        The field.

    Returns
    -------
    float and (n,) array
        Both.

    Raises
    ------
    ScenarioError
        If the norm is no positive number, or has no two or three axes.
    """
    number = field_number(norm, (name, "norm"))
    if not 0.0 < number < float("inf"):
        raise ScenarioError(f"must be > 0, got {number:g}", (name, "norm"))
    check_size(number, (name, "norm"))
    if axes.size not in (2, 3):
        raise ScenarioError(f"a norm needs two or three axes, got {axes.size}", (name,))
    least: Vector = np.minimum(axes, number)
    least.flags.writeable = False
    return number, least


def consistent_limits(
    norm: object, axes: npt.ArrayLike | None, size: int, name: str
) -> tuple[float | None, Vector | None]:
    """Return a limit's norm and its values per axis, none of these larger than the norm.

    Parameters
    ----------
    norm : number or None
        Largest Euclidean norm; None is free.
    axes : number, (size,) array, or None
        Largest values per axis; None is free.
    size : int
        Number of axes.
    name : str
        Of the limit.

    Raises
    ------
    ScenarioError
        If one of them is none.
    """
    limits = None if axes is None else as_axes(axes, size, (name,))
    if norm is None:
        if limits is None and name == "control_limit":
            text = "needs a number per axis or a control_norm, got neither"
            raise ScenarioError(text, (name,))
        return None, limits
    return axes_under(norm, np.full(size, np.inf) if limits is None else limits, name)


def check_speedless(**limits: object) -> None:
    """Refuse limits of speeds where dynamics do not tell which states are velocities.

    Parameters
    ----------
    **limits
        By key; None is no limit.

    Raises
    ------
    ScenarioError
        If there is one.
    """
    for name, limit in limits.items():
        if limit is not None:
            raise ScenarioError("a speed needs dynamics whose velocity indices are given", (name,))


def positive_definite(value: npt.ArrayLike, size: int, path: tuple[str | int, ...]) -> Matrix:
    """Return the weight of what must cost something in every direction.

    Parameters
    ----------
    value : (size, size) array_like
        What was given.
    size : int
        Number of rows.
    path : tuple of str or int
        Where it stands, for the message.

    Raises
    ------
    ScenarioError
        If it has another shape, or is not positive definite.
    """
    matrix = as_matrix(value, (size, size), path)
    lowest = float(np.linalg.eigvalsh(0.5 * (matrix + matrix.T))[0])
    if lowest <= 0.0:
        text = f"must be positive definite, got an eigenvalue of {lowest + 0.0:.6g}"
        raise ScenarioError(text, path)
    return matrix
