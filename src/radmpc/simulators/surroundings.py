r"""What sampled paths hit: vehicles, obstacles, walls, ranges' ends. Nothing of the referee's.

Positions count where they were sampled, and nothing between. On a path of speed v that is sampled
every h seconds, a contact of discs whose radii are r together shows in some sample if it is deeper
than about (v h)² / (8 r): 0.2 mm for 1.5 m/s, 0.05 s and 3 m.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.optimize import nnls

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.flying.tick import Contact
from radmpc.model.relations.concerns import is_for
from radmpc.model.scenario import Scenario
from radmpc.nearby import near_pairs_ever

__all__ = ["Surroundings", "hull_distance"]

_TOUCH = 1e-9
"""Depth up to which discs that touch do not collide [m]: rounding."""


class Surroundings:
    """A scenario's obstacles, workspace, discs and ranges, against which samples are held.

    Parameters
    ----------
    scenario : Scenario
        What is flown.
    margin : float
        What every disc is larger than the scenario says [m], for a body whose tracked point is not
        its center.
    """

    def __init__(self, scenario: Scenario, margin: float = 0.0) -> None:
        self._scenario = scenario
        self._radii = np.array([v.radius for v in scenario.vehicles]) + margin

    def at_start(self, positions: Matrix) -> tuple[Contact, ...]:
        """Return what is hit before anything moves.

        Parameters
        ----------
        positions : (N, d) array
            Of all vehicles [m].
        """
        return self.contacts(0, np.zeros(1), positions[None])

    def contacts(
        self, step: int, shares: Vector, positions: Tensor, tracked: Tensor | None = None
    ) -> tuple[Contact, ...]:
        """Return what is hit on the way to a step.

        Parameters
        ----------
        step : int
            The mission's step at the end, at which it is noticed.
        shares : (S,) array
            When samples were taken, from 0 at the step before to 1 [-]; at step 0 all 0.
        positions : (S, N, d) array
            Of the middles of all bodies [m].
        tracked : (S, N, d) array or None
            Of the points that must stay in the workspace and in range [m]; None is the same.
        """
        inside = positions if tracked is None else tracked
        vehicles, workspace = self._scenario.vehicles, self._scenario.workspace
        met = []
        farthest = np.full(len(positions), 2.0 * float(self._radii.max()))
        for i, j in near_pairs_ever(positions.transpose(1, 0, 2), farthest).tolist():
            apart = np.linalg.norm(positions[:, i] - positions[:, j], axis=1)
            if apart.min() < self._radii[i] + self._radii[j] - _TOUCH:
                met.append(Contact(step, "pair", vehicles[i].name, vehicles[j].name))
        for number, obstacle in enumerate(self._scenario.obstacles):
            met += [
                Contact(step, "obstacle", vehicle.name, obstacle.name)
                for i, vehicle in enumerate(vehicles)
                if is_for(obstacle, vehicle.name)
                and self._hits(number, step, shares, positions[:, i], self._radii[i])
            ]
        if workspace is not None:
            low = (inside < workspace.lower - _TOUCH).any(axis=(0, 2))
            high = (inside > workspace.upper + _TOUCH).any(axis=(0, 2))
            met += [
                Contact(step, "workspace", vehicles[i].name) for i in np.flatnonzero(low | high)
            ]
        numbers = {vehicle.name: i for i, vehicle in enumerate(vehicles)}
        for kept in self._scenario.keep:
            i, j = sorted(numbers[name] for name in kept.vehicles)
            if np.linalg.norm(inside[:, i] - inside[:, j], axis=1).max() > kept.within + _TOUCH:
                met.append(Contact(step, "range", vehicles[i].name, vehicles[j].name))
        return tuple(met)

    def _hits(self, number: int, step: int, shares: Vector, places: Matrix, radius: float) -> bool:
        """Whether one vehicle comes closer to an obstacle than its radius."""
        obstacle = self._scenario.obstacles[number]
        if not obstacle.is_moving or step == 0:
            pieces = obstacle.at(step)
            return any(_comes_near(piece.vertices, places, radius) for piece in pieces)
        ends = zip(obstacle.at(step - 1), obstacle.at(step), strict=True)
        for before, after in ends:
            both = np.vstack([before.vertices, after.vertices])
            close = np.flatnonzero(_is_near(both, places, radius))
            for share, place in zip(shares[close], places[close], strict=True):
                # Of two outlines every corner goes to every other: their Minkowski interpolation.
                here = (1.0 - share) * before.vertices[:, None] + share * after.vertices[None]
                if _comes_near(here.reshape(-1, places.shape[1]), place[None], radius):
                    return True
        return False


def _comes_near(corners: Matrix, places: Matrix, radius: float) -> bool:
    """Whether a place is closer to a hull than a radius; boxes leave out what is far."""
    near = places[_is_near(corners, places, radius)]
    return any(hull_distance(corners, place) < radius - _TOUCH for place in near)


def _is_near(corners: Matrix, places: Matrix, radius: float) -> npt.NDArray[np.bool_]:
    """Return which places are in a hull's box, grown by a radius, (S,) bool."""
    low, high = corners.min(axis=0) - radius, corners.max(axis=0) + radius
    return np.asarray(np.all((places > low) & (places < high), axis=1))


def hull_distance(corners: Matrix, place: Vector) -> float:
    r"""Return the distance of a point from the convex hull of others, 0 within [m].

    Of all :math:`\lambda \ge 0` the one of least
    :math:`\|\sum \lambda_i (c_i - p)\|^2 + s^2 (1 - \sum \lambda_i)^2`, scaled to the sum 1, gives
    the nearest point, whatever s: for :math:`\lambda = t \mu` with :math:`\sum \mu_i = 1` and a
    distance :math:`\delta(\mu)` the least over t is :math:`s^2 \delta^2 / (s^2 + \delta^2)`, which
    grows with the distance.

    Parameters
    ----------
    corners : (v, d) array
        The others [m].
    place : (d,) array
        The point [m].
    """
    apart = corners - place
    scale = float(np.abs(apart).max())
    if scale == 0.0:
        return 0.0
    columns = np.vstack([apart.T / scale, np.ones(len(apart))])
    target = np.zeros(len(columns))
    target[-1] = 1.0
    weights, _ = nnls(columns, target)
    return float(np.linalg.norm(weights @ apart) / weights.sum())
