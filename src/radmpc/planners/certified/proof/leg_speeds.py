"""A quick bound on the effort between visits: velocities that each leg must have at some moment.

In empty space a double integrator that is in one box at one step, and in the next at another, has
the velocity of the straight leg between them at some moment of it, per axis. From moment to moment
its effort is at least the change of velocity. Boxes leave an interval of velocities to each leg,
and the least change through intervals follows from one after the other: it stays in the last as
long as it can.
"""

from __future__ import annotations

from itertools import pairwise
from math import prod

import numpy as np
import numpy.typing as npt

from radmpc.model.visits import steps_of_visits
from radmpc.program.condensed import CondensedModel

__all__ = ["Table", "beyond", "leg_efforts"]

Table = npt.NDArray[np.float64]

_MOST_ENTRIES = 2_000_000
"""Choices of steps up to which all are tabulated [-]: about 0.3 s."""


def leg_efforts(model: CondensedModel) -> Table | None:
    """Return a lower bound on the effort for every choice of steps of a vehicle's visits.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.

    Returns
    -------
    (w, ..., w) array or None
        An axis per visit, an entry per step of its window; infinite where they are out of order.
        None for dynamics other than double integrators, and where there are too many.
    """
    system, via = model.vehicle.system, model.vehicle.via
    windows = steps_of_visits(via, model.horizon)
    is_small = prod(last - first + 1 for first, last in windows) <= _MOST_ENTRIES
    if not (system.is_double_integrator and via and is_small):
        return None
    steps = [_along(np.arange(a, b + 1), j, len(via)) for j, (a, b) in enumerate(windows)]
    steps.append(np.full((1,) * len(via), model.horizon))
    total: Table = np.zeros((1,) * len(via))
    for axis in range(system.dimension):
        gain = float(np.abs(system.B[list(system.velocity or ())][axis]).max())
        total = total + _changes(model, steps, axis) / gain
    for before, after in pairwise(steps[:-1]):
        total = np.where(after > before, total, np.inf)
    return model.vehicle.cost_weight * total


def _along(values: npt.NDArray[np.int64], axis: int, count: int) -> npt.NDArray[np.int64]:
    """Return values along one of several axes."""
    shape = [1] * count
    shape[axis] = values.size
    return values.reshape(shape)


def _changes(model: CondensedModel, steps: list[npt.NDArray[np.int64]], axis: int) -> Table:
    """Return the least sum of changes of velocity along an axis for every choice of steps [m/s].

    Positions and velocities are those beyond what happens without any control: both begin at 0.
    """
    dt = model.vehicle.system.B[list(model.vehicle.system.velocity or ())].max()
    goal = model.vehicle.goal
    drift = model.drift_position[:, axis]
    boxes = [(v.lower[axis], v.upper[axis]) for v in model.vehicle.via]
    boxes.append((goal.lower[axis], goal.upper[axis]))
    lows = [low - drift[k] for (low, _), k in zip(boxes, steps, strict=True)]
    highs = [high - drift[k] for (_, high), k in zip(boxes, steps, strict=True)]
    ends = (-np.inf, np.inf)
    if goal.speed is not None and model.drift_velocity is not None:
        coasting = model.drift_velocity[-1, axis]
        ends = (-goal.speed[axis] - coasting, goal.speed[axis] - coasting)
    zero = np.zeros((1,) * (len(boxes) - 1))
    total, low, high = zero, zero, zero
    before: tuple[npt.NDArray[np.int64], Table, Table] = (np.zeros_like(steps[0]), zero, zero)
    for j, at in enumerate(zip(steps, lows, highs, strict=True)):
        count = np.maximum(at[0] - before[0], 1)
        least, most = (at[1] - before[2]) / (count * dt), (at[2] - before[1]) / (count * dt)
        if j == 0:
            least, most = beyond(least, most, count, (0.0, 0.0))
        elif j == len(boxes) - 1:
            least, most = beyond(least, most, count, ends)
        total, low, high = _moved(total, low, high, least, most)
        before = at
    return _moved(total, low, high, np.full_like(zero, ends[0]), np.full_like(zero, ends[1]))[0]


def beyond(
    least: Table, most: Table, count: npt.NDArray[np.int64], ends: tuple[float, float]
) -> tuple[Table, Table]:
    """Return the velocities that a leg must have if it begins or ends with one of an interval.

    Velocities change at even rates over a step: half of it is lost.

    Parameters
    ----------
    least, most : array
        Of the leg as a whole [m/s].
    count : int array
        Its steps [-].
    ends : tuple of float
        The interval [m/s].

    Returns
    -------
    tuple of array
        Least and largest velocity [m/s].
    """
    low, high = ends
    goes_up, goes_down = least > high, most < low
    with np.errstate(invalid="ignore"):  # an end may be free
        up = (least * count - 0.5 * high) / (count - 0.5)
        down = (most * count - 0.5 * low) / (count - 0.5)
    # What must go up must reach that, and may go farther.
    begin = np.where(goes_up, up, np.where(goes_down, -np.inf, least))
    return begin, np.where(goes_down, down, np.where(goes_up, np.inf, most))


def _moved(
    total: Table, low: Table, high: Table, least: Table, most: Table
) -> tuple[Table, Table, Table]:
    """Return the least sum until a velocity of the next interval, and the velocities it may be."""
    up, down = np.maximum(least - high, 0.0), np.maximum(low - most, 0.0)
    begin, end = np.maximum(low, least), np.minimum(high, most)
    begin, end = np.where(up > 0.0, least, begin), np.where(up > 0.0, least, end)
    begin, end = np.where(down > 0.0, most, begin), np.where(down > 0.0, most, end)
    return total + up + down, begin, end
