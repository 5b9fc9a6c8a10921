"""What follows from controls: trajectories, and what they cost."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix
from radmpc.model.dynamics import rollout
from radmpc.model.plan import Trajectory
from radmpc.model.relations.alike import covariances_of_all
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle

__all__ = ["cost_of", "trajectories_of"]

_REACHED = 1e-6
"""What a mean may miss a goal or its speed by and count as arrived [m, m/s]."""

_OF_RADIUS = 1e-3
"""Share of the radius that this is at most [-], where lengths are in kilometers."""


def trajectories_of(
    scenario: Scenario, controls_of_all: tuple[Matrix, ...]
) -> tuple[Trajectory, ...]:
    """Return what follows from the controls.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    controls_of_all : tuple of (T, m) array
        In the scenario's order; empty of no plan.
    """
    if not controls_of_all:
        return ()
    spreads = covariances_of_all(scenario.vehicles, scenario.horizon)
    return tuple(
        Trajectory(
            name=vehicle.name,
            controls=controls,
            means=rollout(
                vehicle.system, vehicle.start, controls, vehicle.pushes(scenario.horizon)
            ),
            covariances=spread,
            gain=vehicle.gain,
        )
        for vehicle, spread, controls in zip(
            scenario.vehicles, spreads, controls_of_all, strict=True
        )
    )


def cost_of(scenario: Scenario, trajectories: tuple[Trajectory, ...]) -> float:
    """Return ``Σ weight · ‖u‖₁``, and what the times until arrival cost where these are free.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    trajectories : tuple of Trajectory
        Of every vehicle, in the scenario's order.
    """
    pairs = list(zip(scenario.vehicles, trajectories, strict=True))
    efforts = [
        vehicle.cost_weight * float(np.abs(trajectory.controls).sum())
        for vehicle, trajectory in pairs
    ]
    cost = float(np.sum(efforts))
    if scenario.time_weight > 0.0:
        steps = [_arrival(v, t.means) for v, t in pairs if v.goal.within is not None]
        cost += scenario.time_weight * scenario.dt * sum(steps)
    return cost


def _arrival(vehicle: Vehicle, means: Matrix) -> int:
    """Return the step at which a vehicle arrives, the last of its window where it is late."""
    velocity = vehicle.system.velocity
    speeds = None if velocity is None else means[:, list(velocity)]
    places = means[:, list(vehicle.system.position)]
    step = vehicle.goal.arrival(places, speeds, min(_REACHED, _OF_RADIUS * vehicle.radius))
    return vehicle.goal.window(len(means) - 1)[1] if step is None else step
