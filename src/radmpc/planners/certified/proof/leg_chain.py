"""A quick bound on the effort of many visits: changes of velocity from each leg to the next.

With all choices of steps in one table four visits are too many. Here only legs that follow each
other are compared: what velocities change by at least from one to the next adds up, and the least
sum over all choices of steps that are left open is found by dynamic programming, visit by visit.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from radmpc.model.visits import steps_of_visits
from radmpc.planners.certified.proof.leg_speeds import Table, beyond
from radmpc.program.condensed import CondensedModel
from radmpc.records import dataclass

__all__ = ["LegChain"]

_MOST_ENTRIES = 2_000_000
"""Choices of three steps in a row up to which all are tabulated [-]: 60 steps have 216 000."""

_Interval = tuple[Table, Table]
"""Least and largest velocity of a leg, by the steps at which it begins and ends [m/s]."""


@dataclass(frozen=True, slots=True, eq=False)
class LegChain:
    """What a vehicle's visits cost at least by the steps of three in a row.

    Attributes
    ----------
    begin : (w,) array
        Until the first leg, by the step of the first visit.
    changes : tuple of (w, w, w) array
        From each leg to the next, by the steps of the visits before, between and after; the start
        and the goal have one each. Infinite where they are out of order.
    end : (w,) array
        After the last leg, by the step of the last visit.
    """

    begin: Table
    changes: tuple[Table, ...]
    end: Table

    @classmethod
    def of(cls, model: CondensedModel) -> LegChain | None:
        """Compare the legs of a vehicle.

        Parameters
        ----------
        model : CondensedModel
            The vehicle.

        Returns
        -------
        LegChain or None
            None for dynamics other than double integrators, and where there are too many steps.
        """
        system, via = model.vehicle.system, model.vehicle.via
        windows = steps_of_visits(via, model.horizon)
        most = max((last - first + 1 for first, last in windows), default=0)
        if not (system.is_double_integrator and via and most**3 <= _MOST_ENTRIES):
            return None
        steps = [np.zeros(1, dtype=np.int64), *(np.arange(a, b + 1) for a, b in windows)]
        steps.append(np.full(1, model.horizon))
        begin, end = np.zeros(steps[1].size), np.zeros(steps[-2].size)
        changes = [_order(*steps[j : j + 3]) for j in range(len(via))]
        for axis in range(system.dimension):
            gain = float(np.abs(system.B[list(system.velocity or ())][axis]).max())
            weight = model.vehicle.cost_weight / gain
            legs, ends = _intervals(model, steps, axis)
            nothing = np.zeros(())
            begin = begin + weight * _apart((nothing, nothing), legs[0])[0]
            end = end + weight * _apart(legs[-1], ends)[:, 0]
            for j, (one, two) in enumerate(pairwise(legs)):
                before = one[0][:, :, None], one[1][:, :, None]
                after = two[0][None], two[1][None]
                changes[j] = changes[j] + weight * _apart(before, after)
        return cls(begin, tuple(changes), end)

    def least(self, places: Sequence[slice]) -> float:
        """Return the least sum over the steps that are left open.

        Parameters
        ----------
        places : sequence of slice
            Which steps of its window are left to each visit.
        """
        whole = slice(None)
        kept = [whole, *places, whole]
        value = self.begin[None, kept[1]]
        for j, change in enumerate(self.changes):
            value = (value[:, :, None] + change[kept[j], kept[j + 1], kept[j + 2]]).min(axis=0)
        return float((value[:, 0] + self.end[kept[-2]]).min())


def _order(
    before: npt.NDArray[np.int64], between: npt.NDArray[np.int64], after: npt.NDArray[np.int64]
) -> Table:
    """Return 0 where steps rise, else infinity."""
    rises = (before[:, None, None] < between[:, None]) & (between[:, None] < after)
    return np.where(rises, 0.0, np.inf)


def _apart(one: _Interval, two: _Interval) -> Table:
    """Return how far intervals are from each other, 0 where they meet."""
    return np.maximum(np.maximum(two[0] - one[1], one[0] - two[1]), 0.0)


def _intervals(
    model: CondensedModel, steps: Sequence[npt.NDArray[np.int64]], axis: int
) -> tuple[list[_Interval], _Interval]:
    """Return the velocities of each leg along an axis, and those allowed at the end.

    Positions and velocities are those beyond what happens without any control: both begin at 0.
    """
    vehicle, drift = model.vehicle, model.drift_position[:, axis]
    dt = vehicle.system.B[list(vehicle.system.velocity or ())].max()
    boxes = [(v.lower[axis], v.upper[axis]) for v in vehicle.via]
    boxes.append((vehicle.goal.lower[axis], vehicle.goal.upper[axis]))
    ends = (-np.inf, np.inf)
    if vehicle.goal.speed is not None and model.drift_velocity is not None:
        coasting = model.drift_velocity[-1, axis]
        ends = (-vehicle.goal.speed[axis] - coasting, vehicle.goal.speed[axis] - coasting)
    low, high = [np.zeros(1)], [np.zeros(1)]
    for (lower, upper), at in zip(boxes, steps[1:], strict=True):
        low.append(lower - drift[at])
        high.append(upper - drift[at])
    legs = []
    for j in range(len(boxes)):
        count = np.maximum(steps[j + 1] - steps[j][:, None], 1)
        least = (low[j + 1] - high[j][:, None]) / (count * dt)
        most = (high[j + 1] - low[j][:, None]) / (count * dt)
        if j == 0:
            least, most = beyond(least, most, count, (0.0, 0.0))
        if j == len(boxes) - 1:
            least, most = beyond(least, most, count, ends)
        legs.append((least, most))
    return legs, (np.full((1, 1), ends[0]), np.full((1, 1), ends[1]))
