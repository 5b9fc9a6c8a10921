"""What some of a fleet's vehicles keep and meet that are among them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from radmpc.model.obstacle import Obstacle
from radmpc.model.relations.concerns import among

if TYPE_CHECKING:
    from radmpc.model.relations.keep import Keep
    from radmpc.model.vehicle import Vehicle

__all__ = ["kept_and_met"]


def kept_and_met(
    vehicles: Iterable[Vehicle], keep: Iterable[Keep], obstacles: Iterable[Obstacle]
) -> tuple[tuple[Keep, ...], tuple[Obstacle, ...]]:
    """Return the ranges and obstacles of a scenario of some vehicles.

    Parameters
    ----------
    vehicles : iterable of Vehicle
        Its vehicles.
    keep : iterable of Keep
        Ranges of these and others: kept are those that none of the others has a part in.
    obstacles : iterable of Obstacle
        Obstacles, which may name others.
    """
    names = {vehicle.name for vehicle in vehicles}
    kept = tuple(one for one in keep if names.issuperset(one.vehicles))
    return kept, tuple(among(obstacle, names) for obstacle in obstacles)
