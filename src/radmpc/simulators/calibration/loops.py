"""Feedback as it was flown: what the whole loop, simulator and all, did about deviations."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix
from radmpc.identification import Track, identify
from radmpc.identification.intervals import Interval
from radmpc.model.plan import Plan
from radmpc.records import dataclass

__all__ = ["Loop", "loops_of"]

_SURE = 3.3
"""Deviations [-] from which one of the gain's eight entries differs: 1 % by chance."""


@dataclass(frozen=True, slots=True, eq=False)
class Loop:
    """A vehicle's feedback, planned and flown, positions before velocities.

    Attributes
    ----------
    vehicle : str
        The vehicle.
    planned : (d, 2d) array
        K of the scenario, 0 where there is none [1/s², 1/s].
    flown : Interval
        The same as ``e⁺ = (A + B K) e + w`` has it, from deviations e alone.
    """

    vehicle: str
    planned: Matrix
    flown: Interval

    @property
    def score(self) -> float:
        """Largest difference of the two in standard deviations [-]."""
        deviations = np.maximum((self.flown.high - self.flown.low) / 3.92, 1e-300)
        return float(np.abs((self.flown.value - self.planned) / deviations).max())

    @property
    def differs(self) -> bool:
        """Whether they differ beyond chance."""
        return self.score > _SURE


def loops_of(
    plan: Plan, tracks: Sequence[Track], orders: Sequence[Sequence[int]]
) -> tuple[Loop, ...]:
    """Return vehicles' feedback as flown, of those that it can be told of.

    Parameters
    ----------
    plan : Plan
        That was flown.
    tracks : sequence of Track
        Of all vehicles and missions, sampled at the plan's steps.
    orders : sequence of sequence of int
        Where positions, then velocities, stand in each vehicle's state.
    """
    found = []
    whole = zip(plan.scenario.vehicles, plan.trajectories, orders, strict=True)
    for vehicle, trajectory, order in whole:
        means = trajectory.means[:, list(order)]
        own = [
            Track(t.name, t.source, t.clock, t.times, t.positions, t.velocities, references=means)
            for t in tracks
            if t.name == vehicle.name
        ]
        gain = identify(own, dt=plan.scenario.dt).pooled.gain
        if gain is None or not np.all(np.isfinite(gain.value)):
            continue
        none = np.zeros((vehicle.system.num_controls, vehicle.system.num_states))
        planned = none if vehicle.gain is None else vehicle.gain
        found.append(Loop(vehicle.name, planned[:, list(order)], gain))
    return tuple(found)
