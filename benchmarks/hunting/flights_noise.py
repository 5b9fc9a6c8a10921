"""What may move a vehicle besides what is new at every step, and what it may know of its state."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from radmpc.arrays import Vector
from radmpc.model.noise.measurement import Measurement
from radmpc.model.noise.shared import SharedDisturbance
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle

__all__ = ["noisy_vehicles"]

Rng = np.random.Generator


def noisy_vehicles(rng: Rng, base: Scenario) -> tuple[Vehicle, ...]:
    """Return a scene's vehicles in currents, gusts and winds, with sensors.

    Parameters
    ----------
    rng : Generator
        Decides everything.
    base : Scenario
        With their ways.
    """
    vehicles = base.vehicles
    if rng.random() < 0.25:
        vehicles = tuple(_in_current(rng, v, base) for v in vehicles)
    if rng.random() < 0.3:
        vehicles = tuple(_in_gusts(rng, v) if rng.random() < 0.7 else v for v in vehicles)
    if rng.random() < 0.3:
        vehicles = tuple(_with_sensor(rng, v) if rng.random() < 0.7 else v for v in vehicles)
    if rng.random() < 0.3:
        vehicles = _in_one_wind(rng, vehicles)
    return vehicles


def _in_current(rng: Rng, vehicle: Vehicle, base: Scenario) -> Vehicle:
    """Return a vehicle in a current, or with a drift of all states."""
    n, place = vehicle.start.size, list(vehicle.system.position)
    drift: Vector = np.zeros(n)
    drift[place] = base.dt * rng.normal(0.0, 0.05, len(place))
    if rng.random() < 0.3:
        drift = drift + rng.normal(0.0, 0.01, n)
    return replace(vehicle, drift=drift)


def _in_gusts(rng: Rng, vehicle: Vehicle) -> Vehicle:
    """Return a vehicle whose own disturbances last."""
    return replace(vehicle, disturbance_correlation=float(rng.choice([0.1, 0.5, 0.9, 0.99])))


def _with_sensor(rng: Rng, vehicle: Vehicle) -> Vehicle:
    """Return a vehicle that estimates its state: of positions, of all states, or of sums."""
    n, kind = vehicle.start.size, rng.random()
    rows = np.eye(n)
    if kind < 0.4:
        rows = rows[list(vehicle.system.position)]
    elif kind < 0.6:
        rows = rng.normal(0.0, 1.0, (int(rng.integers(1, n + 1)), n))
    deviation = float(rng.choice([0.0, 1e-4, 0.01, 0.1]))
    spread = (deviation * rng.uniform(0.5, 1.5, len(rows))) ** 2
    return replace(vehicle, measurement=Measurement(rows, np.diag(spread)))


def _in_one_wind(rng: Rng, vehicles: tuple[Vehicle, ...]) -> tuple[Vehicle, ...]:
    """Return vehicles that one or two winds blow, each in its own way."""
    made = list(vehicles)
    for k in range(int(rng.choice([1, 1, 2]))):
        size = int(rng.integers(1, 3))
        spread = np.diag(rng.uniform(0.0, 0.05, size) ** 2)
        lasts = float(rng.choice([0.0, 0.0, 0.5, 0.95]))
        for i, vehicle in enumerate(made):
            if rng.random() < 0.8:
                matrix = rng.normal(0.0, 0.7, (vehicle.start.size, size))
                part = SharedDisturbance(f"wind{k}", matrix, spread, lasts)
                made[i] = replace(vehicle, shared=(*vehicle.shared, part))
    return tuple(made)
