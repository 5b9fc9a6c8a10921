"""Covariances that were propagated before: planners ask for those of a vehicle time and again."""

from __future__ import annotations

from functools import lru_cache
from typing import Protocol

from radmpc.arrays import Matrix, frozen
from radmpc.model.noise.contents import Keyed, contents
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
    """Return a vehicle's covariances, the same again for it and for all that are shaken alike.

    Vehicles never change; the arrays are read-only.

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
    alike = contents((vehicle.system, vehicle.noise, vehicle.gain))
    return _kept_of_alike(Keyed(vehicle, alike), horizon)


@lru_cache(maxsize=64)
def _kept_of_alike(one: Keyed, horizon: int) -> Spread:
    """Return the covariances of any of the vehicles that are shaken and steered alike."""
    vehicle: Steered = one.value
    found = spread_of(vehicle.system, vehicle.noise, vehicle.gain, horizon)
    unknown = None if found.unknown is None else frozen(found.unknown)
    return Spread(frozen(found.mixing), frozen(found.known), unknown)
