"""Units in which a scenario's numbers are of order one."""

from __future__ import annotations

import math

import numpy as np

from radmpc.arrays import Vector
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.records import dataclass

__all__ = ["Units", "other_units"]

_LENGTHS = 1e-2, 1e6
"""Lengths of scenarios that are planned as they are [m]."""

_CONTROLS = 1e-4, 1e4
"""Control limits of scenarios that are planned as they are [m/s², m/s]: the referee lets a nominal
control exceed its limit by 1e-6 of it, and linear programs leave 1e-9 at most, mostly nothing."""

_LENGTH = 8.0
"""What lengths are about in other units [-]: radii are a tenth of that or so."""


@dataclass(frozen=True, slots=True)
class Units:
    """What numbers are multiplied by, all powers of two.

    Attributes
    ----------
    length, time : float
        Lengths [m] and times [s].
    cost : float
        Costs.
    controls : tuple of float
        Controls of each vehicle.
    """

    length: float
    time: float
    cost: float
    controls: tuple[float, ...]

    def states(self, vehicle: Vehicle) -> Vector:
        """Return what a vehicle's states are multiplied by, (n,).

        Parameters
        ----------
        vehicle : Vehicle
            The vehicle; states that are no position or velocity stay as they are.
        """
        system = vehicle.system
        factors = np.ones(system.num_states)
        factors[list(system.position)] = self.length
        velocity = system.velocity if system.rates is None else system.rates[0]
        if velocity is not None:
            factors[list(velocity)] = self.length / self.time
        return factors


def other_units(scenario: Scenario) -> Units | None:
    """Return the units to plan a scenario in; None is its own.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    """
    length = _typical_length(scenario)
    is_usual = _LENGTHS[0] <= length <= _LENGTHS[1] and all(
        _CONTROLS[0] <= v.control_limit.min() and v.control_limit.max() <= _CONTROLS[1]
        for v in scenario.vehicles
    )
    if is_usual:
        return None
    lengths = _power_of_two(_LENGTH / length)
    limits = np.array([_middle(v.control_limit) for v in scenario.vehicles])
    pushed = [v.system.is_double_integrator for v in scenario.vehicles]
    times = 1.0
    if any(pushed):
        times = _power_of_two(math.sqrt(lengths * _middle(limits[pushed])))
    controls = tuple(
        lengths / times**2 if is_pushed else _power_of_two(1.0 / limit)
        for is_pushed, limit in zip(pushed, limits.tolist(), strict=True)
    )
    weights = [v.cost_weight / c for v, c in zip(scenario.vehicles, controls, strict=True)]
    dearest = max(weights) or scenario.time_weight / times
    return Units(lengths, times, _power_of_two(1.0 / dearest) if dearest else 1.0, controls)


def _typical_length(scenario: Scenario) -> float:
    """Return how far vehicles have to go, or how large they are where that is more [m]."""
    ways = [
        float(np.abs(v.start_position - 0.5 * (v.goal.lower + v.goal.upper)).max())
        for v in scenario.vehicles
    ]
    return max(*ways, *(v.radius for v in scenario.vehicles))


def _middle(values: Vector) -> float:
    """Return the geometric mean of positive numbers."""
    return math.exp(float(np.log(values).mean()))


def _power_of_two(value: float) -> float:
    """Return the power of two nearest to a positive number."""
    return 2.0 ** round(math.log2(value))
