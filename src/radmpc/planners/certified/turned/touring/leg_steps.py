"""Steps of visits at which straight legs between boxes change velocity little, all at once.

A double integrator that flies straight from visit to visit pays for what its velocity changes by at
each. That depends on the steps of three visits in a row, so that dynamic programming over pairs of
steps finds the best of all. Turns take time, and are counted: with acceleration a, a change of
velocity w begun and ended w / 2a from the corner cuts it by w² / 8a. What a box does not allow of
that the legs beside it have to make up for.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.program.condensed import CondensedModel
from radmpc.records import dataclass

__all__ = ["steps_by_legs"]

_NEAR = 12
"""Steps from those at even speed that are looked at [-]: all 60 lead to nothing cheaper."""

_INSIDE = 0.5
"""Share of a box that legs may end beside its middle [-]: paths use most of it to turn less."""

_NEVER = 1e9
"""What legs too fast cost, and one that is late for the goal [m/s]: finite, so that there is a best
choice always. Legs from a visit to an earlier one cost more than any number of these."""


@dataclass(frozen=True, slots=True, eq=False)
class _Leg:
    """A leg by the steps at which it begins and ends, a and b of them.

    Attributes
    ----------
    velocities : (d, a, b) array
        Beyond what the vehicle does without controls [m/s].
    seconds : (a, b) array
        How long it takes [s].
    penalty : (a, b) array
        `_NEVER` where it cannot be, infinite where one visit would be before the one before it.
    """

    velocities: Tensor
    seconds: Matrix
    penalty: Matrix


@dataclass(frozen=True, slots=True, eq=False)
class _Corner:
    """What velocities change at: the start, a visit or the goal.

    Attributes
    ----------
    slack : (d,) array
        How far a turn may cut it [m].
    accelerations : (d,) array
        The largest [m/s²].
    extent : float
        Multiple of w² / a by which a turn cuts it [-].
    """

    slack: Vector
    accelerations: Vector
    extent: float

    def cost(self, changes: Tensor, seconds: Sequence[Matrix]) -> Matrix:
        """Return what changes of velocity, axes first, cost beside legs of so many seconds."""
        faster = sum(1.0 / each for each in seconds)
        total = 0.0
        for change, slack, most in zip(changes, self.slack, self.accelerations, strict=True):
            beyond = np.maximum(self.extent * change**2 / most - slack, 0.0)
            total = total + (change + beyond * faster)
        return np.asarray(total)


def steps_by_legs(
    model: CondensedModel, windows: Sequence[tuple[int, int]], even: Sequence[int]
) -> list[int] | None:
    """Return steps of visits for which straight legs cost least, obstacles and others aside.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    windows : sequence of tuple of int
        First and last step of each visit.
    even : sequence of int
        Their steps at even speed, rising: those nearby are looked at.

    Returns
    -------
    list of int or None
        One per visit, rising, each within its window; None for dynamics other than double
        integrators and where nothing is visited.
    """
    rates = model.vehicle.system.rates
    if rates is None or not windows:
        return None
    last = model.vehicle.goal.window(model.horizon)[1]
    steps = [np.zeros(1, dtype=np.int64)]
    for (first, end), k in zip(windows, even, strict=True):
        steps.append(np.arange(max(first, k - _NEAR), min(end, k + _NEAR) + 1))
    steps.append(np.full(1, last))
    found = _cheapest(model, _legs(model, steps), last)
    return [int(at[k]) for at, k in zip(steps[1:-1], found, strict=True)]


def _cheapest(model: CondensedModel, legs: Sequence[_Leg], last: int) -> list[int]:
    """Return which of the steps of each visit make the cheapest chain of legs."""
    corners, beginning, ending = _corners(model), legs[0], legs[-1]
    values = corners[0].cost(np.abs(beginning.velocities), [beginning.seconds]) + beginning.penalty
    choices = []
    for j, (one, two) in enumerate(pairwise(legs)):
        totals = values[:, :, None] + _turned(model, j, one, two, corners[j + 1])
        choices.append(totals.argmin(axis=0))
        values = totals.min(axis=0)
    goal = model.vehicle.goal
    if goal.speed is not None and model.drift_velocity is not None:
        speeds = np.abs(ending.velocities + _by_axes(model.drift_velocity[last]))
        slowed = np.maximum(speeds - _by_axes(goal.speed), 0.0)
        values = values + corners[-1].cost(slowed, [ending.seconds])
    found = [int(values[:, 0].argmin()), 0]
    for choice in choices[:0:-1]:
        found.insert(0, int(choice[found[0], found[1]]))
    return found[:-1]


def _legs(model: CondensedModel, steps: Sequence[Indices]) -> list[_Leg]:
    """Return the legs between steps: from middle to middle of boxes, or nearly."""
    vehicle, rates = model.vehicle, model.vehicle.system.rates
    dt = 1.0 if rates is None else float(rates[1])
    boxes = [(v.center, 0.5 * (v.upper - v.lower)) for v in vehicle.via]
    boxes.append((vehicle.goal.center, 0.5 * (vehicle.goal.upper - vehicle.goal.lower)))
    boxes.insert(0, (model.drift_position[0], np.zeros(vehicle.system.dimension)))
    most = np.inf if vehicle.speed_limit is None else vehicle.speed_limit
    coasting = model.drift_velocity
    legs: list[_Leg] = []
    for (here, wide), (there, wider), at in zip(boxes, boxes[1:], pairwise(steps), strict=False):
        begin, end = here - model.drift_position[at[0]], there - model.drift_position[at[1]]
        away = end - begin[:, None]
        away = np.sign(away) * np.maximum(np.abs(away) - _INSIDE * (wide + wider), 0.0)
        away = np.ascontiguousarray(np.moveaxis(away, -1, 0))
        count = at[1] - at[0][:, None]
        seconds = dt * np.maximum(count, 1)
        velocities = away / seconds
        there_is = 0.0 if coasting is None else coasting[at[1]].T[:, None]
        is_too_fast = (np.abs(velocities + there_is) > _by_axes(most)).any(axis=0)
        # A visit at the horizon has no time for a leg to the goal, and is in order.
        unordered = _NEVER if len(legs) == len(vehicle.via) else np.inf
        penalty = np.where(count < 1, unordered, _NEVER * is_too_fast)
        legs.append(_Leg(velocities, seconds, penalty))
    return legs


def _corners(model: CondensedModel) -> list[_Corner]:
    """Return where velocities change: at the start, at each visit, at the goal."""
    vehicle, rates = model.vehicle, model.vehicle.system.rates
    dt = 1.0 if rates is None else float(rates[1])
    pushes = np.abs(vehicle.system.B[list(vehicle.system.velocity or ())])
    accelerations = np.maximum(
        pushes @ np.maximum(model.control_bounds, 0.0).max(axis=0) / dt, 1e-9
    )
    half = 0.5 * (vehicle.goal.upper - vehicle.goal.lower)
    found = [_Corner(np.zeros(vehicle.system.dimension), accelerations, 0.5)]
    for visit in vehicle.via:
        found.append(_Corner(0.5 * (visit.upper - visit.lower), accelerations, 0.125))
    return [*found, _Corner(half, accelerations, 0.5)]


def _turned(model: CondensedModel, j: int, one: _Leg, two: _Leg, corner: _Corner) -> Tensor:
    """Return what a visit costs by the steps before, at and after it, (a, b, c)."""
    before, after = one.velocities[..., None], two.velocities[:, None]
    changes = np.abs(after - before)
    speed, coasting = model.vehicle.via[j].speed, model.drift_velocity
    if speed is not None and coasting is not None:
        # Slowed down, and sped up again.
        idle, limit = (_by_axes(each)[..., None] for each in (coasting[0], speed))
        slowed = [np.maximum(np.abs(v + idle) - limit, 0.0) for v in (before, after)]
        changes = np.maximum(changes, slowed[0] + slowed[1])
    seconds = one.seconds[:, :, None], two.seconds[None]
    return np.asarray(corner.cost(changes, seconds) + two.penalty[None])


def _by_axes(each: Vector | float) -> Tensor:
    """Return what there is by axes, to go with velocities of a leg, (1 or d, 1, 1)."""
    return np.reshape(each, (-1, 1, 1))
