"""Covariances that were propagated before: planners ask for those of a vehicle time and again."""

from __future__ import annotations

from functools import lru_cache
from typing import Protocol

from radmpc.arrays import Matrix, frozen
from radmpc.model.noise.fleet_chain import Shaken
from radmpc.model.noise.spread import Spread, spread_of

__all__ = ["Steered", "kept_spread"]


class Steered(Shaken, Protocol):
    """A vehicle, as far as its noise and its feedback go."""

    @property
    def gain(self) -> Matrix | None:
        """Feedback; None is open loop."""


@lru_cache(maxsize=64)
def kept_spread(vehicle: Steered, horizon: int) -> Spread:
    """Return a vehicle's covariances, the same again for the same value.

    Vehicles never change, and two of them are the same only if they are one; the arrays are
    read-only.

    Parameters
    ----------
    vehicle : Steered
        The vehicle.
    horizon : int
        Number of steps T.

    Returns
    -------
    Spread
        At k = 0..T.
    """
    found = spread_of(vehicle.system, vehicle.noise, vehicle.gain, horizon)
    unknown = None if found.unknown is None else frozen(found.unknown)
    return Spread(frozen(found.mixing), frozen(found.known), unknown)
