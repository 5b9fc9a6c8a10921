"""Visits and arrivals of published problems, in seconds, as steps."""

from __future__ import annotations

import math

import numpy as np

from radmpc.errors import ScenarioError
from radmpc.importing.problem import ForeignVehicle, Window
from radmpc.importing.rounding import rounded
from radmpc.model.visits import Visit
from radmpc.wording import count_text

__all__ = ["arrival_steps", "chosen_visits"]

_EARLY = 1e-9
"""Share of a step by which a step may lie outside a window: times are rounded [-]."""


def chosen_visits(vehicle: ForeignVehicle, dt: float, horizon: int) -> tuple[Visit, ...]:
    """Return what a vehicle visits, at steps.

    Parameters
    ----------
    vehicle : ForeignVehicle
        As published.
    dt : float
        Step [s].
    horizon : int
        Number of steps.

    Raises
    ------
    ScenarioError
        If no step lies in a window.
    """
    visits = []
    for i, visit in enumerate(vehicle.via):
        what = f"visit {i + 1} of {vehicle.name!r}"
        between = None if visit.window is None else _steps(visit.window, dt, horizon, what)
        half = np.full(visit.center.size, visit.half_width)
        visits.append(
            Visit(
                rounded(visit.center - half),
                rounded(visit.center + half),
                between,
                _axes(visit.speed, half.size),
            )
        )
    return tuple(visits)


def arrival_steps(vehicle: ForeignVehicle, dt: float, horizon: int) -> tuple[int, int] | None:
    """Return the steps at which a vehicle may arrive; None is the horizon.

    Parameters
    ----------
    vehicle : ForeignVehicle
        As published.
    dt : float
        Step [s].
    horizon : int
        Number of steps.

    Raises
    ------
    ScenarioError
        If none lies in the window.
    """
    if vehicle.arrival is None:
        return None
    return _steps(vehicle.arrival, dt, horizon, f"the arrival of {vehicle.name!r}")


def _axes(speed: float | None, d: int) -> list[float] | None:
    """Return a speed per axis."""
    return None if speed is None else [speed] * d


def _steps(window: Window, dt: float, horizon: int, what: str) -> tuple[int, int]:
    """Return the first and the last step in a window of time, 1 to the horizon."""
    first = max(math.ceil(window[0] / dt - _EARLY), 1)
    last = horizon if math.isinf(window[1]) else min(math.floor(window[1] / dt + _EARLY), horizon)
    if first > last:
        raise ScenarioError(
            f"the window of {what}, from {window[0]:g} to {window[1]:g} s, holds none of "
            f"{count_text(horizon, 'step')} of {dt:g} s: widen it, or choose dt and horizon"
        )
    return first, last
