"""Which vehicles a plan comes too close to, by their temporal obstacles."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.planners.paper.fleet_model import FleetModel
from radmpc.planners.paper.temporal import TemporalObstacle

__all__ = ["blocking_vehicles", "encounter_risks"]

_NO_ENCOUNTER = 1e-9
"""Collision probability below which a vehicle does not stand in another's way [-]."""


def encounter_risks(
    fleet: FleetModel,
    k: int,
    i: int,
    plan: Matrix,
    controls: Matrix,
    obstacles: Sequence[TemporalObstacle],
    windows: range,
) -> Vector:
    """Return the largest risk of vehicle i with every other one in any of some windows.

    Parameters
    ----------
    fleet : FleetModel
        The fleet.
    k, i : int
        Step and vehicle.
    plan : (T+1−k, n) array
        Its mean states from step k on.
    controls : (T, m) array
        Its controls over the whole horizon.
    obstacles : sequence of TemporalObstacle
        One per vehicle.
    windows : range
        Windows, counted from step k.

    Returns
    -------
    (N,) array
        Probabilities [-]; 0 for the vehicle itself.
    """
    risks = np.zeros(len(obstacles))
    for j, obstacle in enumerate(obstacles):
        if j != i:
            risks[j] = max(fleet.window_risk(k, i, plan, controls, obstacle, w) for w in windows)
    return risks


def blocking_vehicles(
    fleet: FleetModel,
    k: int,
    i: int,
    plan: Matrix,
    controls: Matrix,
    obstacles: Sequence[TemporalObstacle],
    share: float,
) -> list[int]:
    """Return the vehicles whose temporal obstacles a plan comes too close to.

    Parameters
    ----------
    fleet, k, i, plan, controls, obstacles
        As in `encounter_risks`.
    share : float
        Risk that the vehicle may take from step k on [-].

    Returns
    -------
    list of int
        Their numbers, ascending.
    """
    risks = encounter_risks(fleet, k, i, plan, controls, obstacles, range(len(plan) - 1))
    # A uniform share is at least this much; a vehicle that exceeds it blocks.
    least = share / max(len(plan) * len(obstacles), 1)
    found = np.flatnonzero(risks > max(least, _NO_ENCOUNTER))
    return [int(j) for j in found if j != i]
