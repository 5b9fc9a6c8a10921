"""The controls of vehicles until the next step, and where they are expected to lead."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from radmpc.arrays import Vector
from radmpc.flying.leg import Leg
from radmpc.flying.tick import Segment, segments
from radmpc.model.limits import within_limits
from radmpc.model.vehicle import Vehicle
from radmpc.records import dataclass

__all__ = ["Commands", "commanded", "let_pass"]

_SATURATED = 1e-6
"""By how much feedback asks for more control than there is where that is an alarm: a share of
limits below one [-], and so much of larger ones [m/s²]."""


@dataclass(frozen=True, slots=True, eq=False)
class Commands:
    """What is flown over a step.

    Attributes
    ----------
    segments : tuple of Segment
        What vehicles do; empty at the end of the leg.
    expected : tuple of (n,) array
        Where they are expected at the next step; where they are, at the end.
    """

    segments: tuple[Segment, ...]
    expected: tuple[Vector, ...]


def let_pass(vehicles: Iterable[Vehicle]) -> float:
    """Return by how much feedback may ask for more control than there is without an alarm.

    Parameters
    ----------
    vehicles : iterable of Vehicle
        Of the least of their limits.
    """
    return _SATURATED * min(1.0, *(float(v.control_limit.min()) for v in vehicles))


def commanded(leg: Leg, step: int, states: Sequence[Vector], alarms: list[str]) -> Commands:
    """Return what a leg has vehicles do, within their limits.

    Parameters
    ----------
    leg : Leg
        In the air.
    step : int
        Of the mission.
    states : sequence of (n,) array
        Where vehicles are, or are thought to be.
    alarms : list of str
        Gets a sentence for every control that saturates.
    """
    scenario = leg.plan.scenario
    if step - leg.began >= scenario.horizon:
        return Commands((), tuple(states))
    flown = []
    for vehicle, control in zip(scenario.vehicles, leg.controls(step, states), strict=True):
        held = within_limits(vehicle, control)
        excess = float(np.abs(control - held).max())
        if excess > let_pass([vehicle]):
            alarms.append(f"vehicle {vehicle.name!r}: its control saturates by {excess:.3g}")
        flown.append(held)
    expected = leg.expected(step, states, flown)
    return Commands(segments(scenario, states, flown), expected)
