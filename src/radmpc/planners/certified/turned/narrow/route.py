"""A route around obstacles, and when a vehicle is where on it to begin with."""

from __future__ import annotations

from radmpc.arrays import Matrix
from radmpc.planners.certified.turned.paths import timed_by_visits
from radmpc.program.condensed import CondensedModel
from radmpc.records import dataclass

__all__ = ["Route"]


@dataclass(frozen=True, slots=True, eq=False)
class Route:
    """A route from start to goal.

    Attributes
    ----------
    corners : (p, d) array
        Its corners [m].
    places : (T+1, d) array
        Where the vehicle is at each step to begin with [m].
    """

    corners: Matrix
    places: Matrix

    @classmethod
    def evenly(cls, model: CondensedModel, corners: Matrix) -> Route:
        """Return a route at even speed from visit to visit.

        Parameters
        ----------
        model : CondensedModel
            The vehicle.
        corners : (p, d) array
            Corners of the route [m].
        """
        return cls(corners, timed_by_visits(model, corners))
