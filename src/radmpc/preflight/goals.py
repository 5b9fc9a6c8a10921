"""The assumed assignment of shared goals before planning: arrivals in time, then distances."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import linear_sum_assignment

from radmpc.arrays import Matrix
from radmpc.model.relations.goals import places_of
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.preflight.pace import Pace

__all__ = ["assigned_text", "with_near_goals"]

_MOST_TOLD = 8
"""Vehicles up to which each one's goal is told [-]."""


def with_near_goals(scenario: Scenario) -> Scenario:
    """Return a fleet whose shared goals are assigned so that as many as possible arrive in time.

    Among those the sum of distances to the goals' centers is the least. If someone is late even so,
    some vehicle is late in every assignment.

    Parameters
    ----------
    scenario : Scenario
        With `goals`.
    """
    far = np.array(
        [
            [np.linalg.norm(vehicle.start_position - goal.center) for goal in scenario.goals]
            for vehicle in scenario.vehicles
        ]
    )
    # One who is late counts more than all distances together.
    late = 1.0 + len(far) * float(far.max())
    _, places = linear_sum_assignment(np.where(_in_time(scenario), far, far + late))
    pairs = zip(scenario.vehicles, places.tolist(), strict=True)
    vehicles = tuple(replace(vehicle, goal=scenario.goals[k]) for vehicle, k in pairs)
    return replace(scenario, vehicles=vehicles)


def _in_time(scenario: Scenario) -> Matrix:
    """Return which vehicles can be at which goals in time, in empty space, (N, G) bool."""
    return np.array(
        [
            [_arrives(scenario, replace(vehicle, goal=goal), bounds) for goal in scenario.goals]
            for vehicle, bounds in (
                (one, np.maximum(one.control_bounds(one.covariances(scenario.horizon)), 0.0))
                for one in scenario.vehicles
            )
        ]
    )


def _arrives(scenario: Scenario, vehicle: Vehicle, bounds: Matrix) -> bool:
    """Whether a vehicle arrives in time with what feedback leaves of its control."""
    pace = Pace.of(vehicle)
    if pace is None:
        from radmpc.preflight import general  # noqa: PLC0415 - a solver; integrators do without

        return general.arrives(scenario, vehicle, scenario.horizon)
    if vehicle.via:
        from radmpc.preflight.visits import earliest_visits  # noqa: PLC0415 - few visit anything

        return earliest_visits(vehicle, pace, bounds)[-1] is not None
    return pace.arrives(bounds)


def assigned_text(scenario: Scenario) -> str:
    """Return the assignment in one line; empty without shared goals.

    Parameters
    ----------
    scenario : Scenario
        As `with_near_goals` leaves it.
    """
    if not scenario.goals:
        return ""
    places = places_of(scenario.goals, [vehicle.goal for vehicle in scenario.vehicles])
    told = [
        f"{vehicle.name} to {k + 1}"
        for vehicle, k in zip(scenario.vehicles, places, strict=True)
        if k is not None
    ]
    more = f" and {len(told) - _MOST_TOLD} more" if len(told) > _MOST_TOLD else ""
    return (
        f"goals, until planning assigns them, in time and by the least sum of distances: "
        f"{', '.join(told[:_MOST_TOLD])}{more}"
    )
