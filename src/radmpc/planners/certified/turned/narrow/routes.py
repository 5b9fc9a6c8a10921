"""Routes for vehicles to be paced on: the shortest, and those that paths on coarser grids take."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np

from radmpc.arrays import Matrix
from radmpc.planners.certified.turned.detours import detours, routes_beside
from radmpc.planners.certified.turned.narrow.clear import Clear
from radmpc.planners.certified.turned.narrow.tuning import TUNING
from radmpc.program.hazards import Hazards

__all__ = ["distinct_corners", "pulled_routes", "shortest_routes"]

_LITTLE = 1e-6
"""Distance below which points of a route are the same [m]."""


def shortest_routes(
    hazards: Hazards, clear: Clear, clearance: float
) -> Mapping[int, Sequence[Matrix]]:
    """Return the corners of each vehicle's shortest route around obstacles.

    Parameters
    ----------
    hazards, clear, clearance
        As in `Pacing`.
    """
    found = detours(hazards, range(hazards.count), clearance, clear.grid)
    return {
        i: [distinct_corners(_pulled(hazards, clear, i, [route])[0])] for i, route in found.items()
    }


def pulled_routes(
    hazards: Hazards, clear: Clear, paths: Mapping[int, Matrix], clearance: float
) -> Mapping[int, Sequence[Matrix]]:
    """Return the corners of the routes of paths between places of rest, and of routes beside.

    Parameters
    ----------
    hazards, clear, clearance
        As in `Pacing`.
    paths : mapping of int to (K+1, 2) array
        Positions, tick by tick [m].
    """
    parts = {i: _parts(path) for i, path in paths.items()}
    far = TUNING.beside * float(hazards.radii.max())
    beside = routes_beside(hazards, clear.grid, parts, clearance, far)
    found = {}
    for i in paths:
        goal = hazards.models[i].vehicle.goal
        ends = hazards.models[i].drift_position[:1], 0.5 * (goal.lower + goal.upper)
        found[i] = [
            distinct_corners(np.vstack([ends[0], *_pulled(hazards, clear, i, route), ends[1]]))
            for route in (parts[i], beside[i])
        ]
    return found


def _parts(path: Matrix) -> list[Matrix]:
    """Return the pieces of a path between places of rest.

    Vehicles wait for a reason: pulled straight across, a route would lead through others.
    """
    is_rest = np.append(False, ~np.diff(path, axis=0).any(axis=1))
    moving = path[~is_rest]
    waits = np.cumsum(~is_rest)[is_rest] - 1
    marks = np.unique(np.concatenate([[0], waits, [len(moving) - 1]]))
    return [moving[a : b + 1] for a, b in pairwise(marks.tolist())]


def _pulled(hazards: Hazards, clear: Clear, i: int, pieces: Sequence[Matrix]) -> list[Matrix]:
    """Return the corners of the pieces of a vehicle's route, each pulled straight."""
    beside = clear.within_borders(float(hazards.radii[i]))
    return [beside.pulled(piece, _room(hazards, i)) for piece in pieces]


def _room(hazards: Hazards, i: int) -> float:
    """Return the distance from obstacles that is worth a corner [m]."""
    spread = float(np.sqrt(hazards.variances[i].max() / hazards.dimension))
    return float(hazards.radii[i]) + TUNING.corner_sigmas * spread


def distinct_corners(route: Matrix) -> Matrix:
    """Return a route without points that repeat the one before.

    Parameters
    ----------
    route : (p, d) array
        Points of the route [m].
    """
    moved = np.linalg.norm(np.diff(route, axis=0), axis=1) > _LITTLE
    if not moved.any():
        return np.asarray(np.vstack([route[0], route[0] + _LITTLE]))
    return np.asarray(route[np.append(True, moved)])
