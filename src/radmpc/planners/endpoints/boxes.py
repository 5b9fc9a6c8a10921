"""Boxes that hold a mean, and the convex pieces of obstacles near them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from itertools import product

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.geometry import Polytope
from radmpc.model.scenario import Scenario
from radmpc.model.visits import Visit
from radmpc.program.condensed import CondensedModel
from radmpc.records import dataclass

__all__ = ["Box", "Shapes"]

_TOL = 1e-6
"""What a plan may miss its goal, or the box of a visit, by [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Box:
    """Where a mean may be, and how it scatters.

    Attributes
    ----------
    lower, upper : (d,) array
        Corners of the box that holds the mean [m].
    covariance : (d, d) array
        Covariance of the position around it [m²].
    """

    lower: Vector
    upper: Vector
    covariance: Matrix

    @classmethod
    def at_endpoint(cls, model: CondensedModel, *, at_goal: bool) -> Box:
        """Return where a vehicle's mean is at the start, or may be at the end.

        Parameters
        ----------
        model : CondensedModel
            The vehicle over the whole horizon.
        at_goal : bool
            At the end rather than at the start.
        """
        covariance = model.position_covariances[-1 if at_goal else 0]
        if not at_goal:
            return cls(model.drift_position[0], model.drift_position[0], covariance)
        goal = model.vehicle.goal
        lower = np.maximum(goal.lower, model.reach_lower[-1]) - _TOL
        upper = np.minimum(goal.upper, model.reach_upper[-1]) + _TOL
        # Out of reach: which corner is nearer does not matter, as long as it is a box.
        return cls(np.minimum(lower, upper), np.maximum(lower, upper), covariance)

    @classmethod
    def at_visit(cls, model: CondensedModel, visit: Visit, step: int) -> Box | None:
        """Return where a vehicle's mean may be while it makes a visit.

        Parameters
        ----------
        model : CondensedModel
            The vehicle over the whole horizon.
        visit : Visit
            What it visits.
        step : int
            When.

        Returns
        -------
        Box or None
            None where it cannot be there by then.
        """
        lower = np.maximum(visit.lower, model.reach_lower[step]) - _TOL
        upper = np.minimum(visit.upper, model.reach_upper[step]) + _TOL
        if np.any(lower > upper):
            return None
        return cls(lower, upper, model.position_covariances[step])

    def corners(self, cells: int) -> Matrix:
        """Return the corners of its cells, ((cells+1)^d, d), the last axis fastest."""
        axes = [np.linspace(a, b, cells + 1) for a, b in zip(self.lower, self.upper, strict=True)]
        return np.array(list(product(*axes)))

    @property
    def spread(self) -> float:
        """The largest standard deviation along any direction [m]."""
        return _deviation(self.covariance)


def _deviation(covariance: Matrix) -> float:
    """Return the largest standard deviation along any direction [m]."""
    return float(np.sqrt(max(np.linalg.eigvalsh(covariance)[-1], 0.0)))


@dataclass(frozen=True, slots=True, eq=False)
class Shapes:
    """The convex pieces of all obstacles at a step, with the boxes around them.

    Attributes
    ----------
    owners : tuple of str
        The obstacle of each piece.
    pieces : tuple of Polytope
        The pieces.
    lower, upper : (p, d) array
        Corners of the box around each piece [m].
    covariances : dict of str to (d, d) array
        How far obstacles are from there [m²], of those that are not known exactly.
    """

    owners: tuple[str, ...]
    pieces: tuple[Polytope, ...]
    lower: Matrix
    upper: Matrix
    covariances: Mapping[str, Matrix]

    @classmethod
    def of(cls, scenario: Scenario, step: int) -> Shapes:
        """Collect the pieces of a scenario's obstacles.

        Parameters
        ----------
        scenario : Scenario
            The scenario.
        step : int
            The step, 0 to T.
        """
        found = [(o.name, piece) for o in scenario.obstacles for piece in o.at(step)]
        d = scenario.dimension
        lower = np.array([piece.vertices.min(axis=0) for _, piece in found]).reshape(-1, d)
        upper = np.array([piece.vertices.max(axis=0) for _, piece in found]).reshape(-1, d)
        spreads = {
            o.name: o.spread.positions[step] for o in scenario.obstacles if o.spread is not None
        }
        return cls(tuple(n for n, _ in found), tuple(p for _, p in found), lower, upper, spreads)

    def covariance(self, name: str, box: Box) -> Matrix:
        """Return the covariance of a vehicle's position relative to an obstacle, (d, d) [m²].

        Parameters
        ----------
        name : str
            The obstacle.
        box : Box
            Where the vehicle is.
        """
        known = self.covariances.get(name)
        return box.covariance if known is None else box.covariance + known

    def near(self, box: Box, radius: float, far: float) -> dict[str, list[Polytope]]:
        """Return the pieces that a vehicle in a box may hit, whether they concern it or not.

        Parameters
        ----------
        box : Box
            Where its mean may be.
        radius : float
            Of the vehicle [m].
        far : float
            Standard deviations beyond which nothing is to be feared [-].

        Returns
        -------
        dict of str to list of Polytope
            By obstacle.
        """
        reach = radius + far * self._spreads(box) + 1e-6
        gaps = np.maximum(np.maximum(self.lower - box.upper, box.lower - self.upper), 0.0)
        close = np.linalg.norm(gaps, axis=1) < reach
        if np.count_nonzero(close) == 1:
            # One piece alone can be kept away from if some corner is far; several may not be.
            corners = box.corners(1)[:, None]
            gaps = np.maximum(np.maximum(self.lower - corners, corners - self.upper), 0.0)
            close &= np.linalg.norm(gaps, axis=2).max(axis=0) < reach
        found: dict[str, list[Polytope]] = defaultdict(list)
        for k in np.flatnonzero(close).tolist():
            found[self.owners[k]].append(self.pieces[k])
        return found

    def _spreads(self, box: Box) -> Vector | float:
        """Return how far a vehicle in a box and each piece stray from each other, (p,) [m]."""
        if not self.covariances:
            return box.spread
        # Deviations of two add up to less than their sum.
        more = {name: _deviation(matrix) for name, matrix in self.covariances.items()}
        return box.spread + np.array([more.get(owner, 0.0) for owner in self.owners])
