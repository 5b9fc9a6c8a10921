"""Visits at given steps, and the steps at which controls make them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.program.condensed import CondensedModel
from radmpc.program.visits.columns import timed_visits, windows_of

__all__ = [
    "arrival_step",
    "at_steps",
    "at_steps_of",
    "steps_on",
    "times_of",
    "visiting_steps",
]

_MISSED = 1e6
"""What a meter beside a box counts, in meters from its middle [-]: of the steps in the box the one
nearest to its middle is taken."""

_ROUNDING = 1e-7
"""Distance from a box up to which a position counts as in it [m]: above the solver's tolerance."""


def visiting_steps(model: CondensedModel, controls: Matrix) -> tuple[int, ...]:
    """Return the steps at which a vehicle makes its visits; where it misses any, the nearest.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    controls : (T, m) array
        Its nominal controls.

    Returns
    -------
    tuple of int
        One per visit, rising, each within its window.
    """
    means, speeds = _flown(model, controls)
    return _visited(model, means, speeds)


def _visited(model: CondensedModel, means: Matrix, speeds: Matrix | None) -> tuple[int, ...]:
    """Return the steps at which a path makes visits, or is nearest to that."""
    horizon, via = model.horizon, model.vehicle.via
    totals, before = np.zeros(horizon + 1), []
    for visit, (first, last) in zip(via, windows_of(model), strict=True):
        beside = np.maximum(np.maximum(visit.lower - means, means - visit.upper), 0.0).sum(axis=1)
        if visit.speed is not None and speeds is not None:
            beside += np.maximum(np.abs(speeds) - visit.speed, 0.0).sum(axis=1)
        beside[beside <= _ROUNDING] = 0.0
        costs = _MISSED * beside + np.linalg.norm(means - visit.center, axis=1)
        costs[:first] = costs[last + 1 :] = np.inf
        # The best way to have made all earlier visits before each step.
        order = np.minimum.accumulate(totals)
        is_new = np.append(True, totals[1:] < order[:-1])
        best = np.maximum.accumulate(np.where(is_new, np.arange(horizon + 1), 0))
        before.append(np.append(0, best[:-1]))
        totals = costs + np.append(np.inf if len(before) > 1 else 0.0, order[:-1])
    steps = [int(totals.argmin())] if via else []
    for earlier in before[:0:-1]:
        steps.append(int(earlier[steps[-1]]))
    return tuple(reversed(steps))


def arrival_step(model: CondensedModel, controls: Matrix) -> int:
    """Return the step at which a vehicle arrives; the last of its window where it is late.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    controls : (T, m) array
        Its nominal controls.
    """
    return _arrived(model, *_flown(model, controls))


def steps_on(model: CondensedModel, places: Matrix) -> tuple[tuple[int, ...], int | None]:
    """Return the steps at which places make visits, and arrive where time costs, or nearly.

    Parameters
    ----------
    model : CondensedModel
        The vehicle; its speeds are told from one place to the next.
    places : (T+1, d) array
        Where it is at each step [m].

    Returns
    -------
    tuple of int
        One per visit, rising, each within its window.
    int or None
        That of the arrival; None where time costs nothing.
    """
    rates = model.vehicle.system.rates
    speeds = None if rates is None else np.gradient(places, float(rates[1]), axis=0)
    arrival = _arrived(model, places, speeds) if model.time_cost > 0.0 else None
    return _visited(model, places, speeds), arrival


def _flown(model: CondensedModel, controls: Matrix) -> tuple[Matrix, Matrix | None]:
    """Return mean positions, and velocities if there are any, for given controls."""
    means = model.path(controls)
    velocity, drift = model.velocity, model.drift_velocity
    if velocity is None or drift is None:
        return means, None
    return means, drift + velocity @ controls.ravel()


def _arrived(model: CondensedModel, means: Matrix, speeds: Matrix | None) -> int:
    """Return the step at which a path arrives; the last of the window where it is late."""
    step = model.vehicle.goal.arrival(means, speeds, _ROUNDING)
    return model.vehicle.goal.window(model.horizon)[1] if step is None else step


def at_steps(
    model: CondensedModel, steps: Sequence[int], arrival: int | None = None
) -> CondensedModel:
    """Return a vehicle whose visits, and arrival, take place at given steps.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    steps : sequence of int
        One per visit, rising.
    arrival : int or None
        Of its arrival; None leaves that as it is.
    """
    pairs = zip(model.vehicle.via, steps, strict=True)
    via = tuple(replace(visit, between=(k, k)) for visit, k in pairs)
    goal = model.vehicle.goal
    if arrival is not None:
        goal = replace(goal, within=(arrival, arrival))
    return replace(model, vehicle=replace(model.vehicle, via=via, goal=goal))


def at_steps_of(model: CondensedModel, controls: Matrix) -> CondensedModel:
    """Return a vehicle whose visits, and arrival where time costs, are at the steps of controls.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    controls : (T, m) array
        Its nominal controls.
    """
    arrival = arrival_step(model, controls) if model.time_cost > 0.0 else None
    return at_steps(model, visiting_steps(model, controls), arrival)


def times_of(models: Sequence[CondensedModel], controls: Sequence[Matrix]) -> Vector:
    """Return the columns of times for given controls, of visits and arrivals.

    Parameters
    ----------
    models : sequence of CondensedModel
        The vehicles of a program.
    controls : sequence of (T, m) array
        Nominal controls of each.

    Returns
    -------
    (t,) array
        Shares of the horizon.
    """
    steps = []
    for model, each in zip(models, controls, strict=True):
        visiting = visiting_steps(model, each)
        steps += [visiting[j] for j in timed_visits(model)[0]]
        if model.time_cost > 0.0:
            steps.append(arrival_step(model, each))
    return np.array(steps, dtype=np.float64) / models[0].horizon
