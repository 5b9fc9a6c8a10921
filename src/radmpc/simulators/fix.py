"""Where a vehicle said it was, and when."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Vector
from radmpc.records import dataclass

__all__ = ["Fix"]

_AROUND = 2**32
"""Numbers that a stamp has [ms]."""

_REORDERED = 10_000
"""Datagrams overtake each other by less; a stamp that is earlier by more is of a vehicle that was
started again [ms]."""


@dataclass(frozen=True, slots=True, eq=False)
class Fix:
    """Where a vehicle said it was.

    Attributes
    ----------
    time : float
        When it was heard, by the clock [s].
    position, velocity : (3,) array
        East, north, up of its local origin [m], [m/s].
    stamp : int
        When it was there, by its own clock, which begins again after 2³² [ms].
    """

    time: float
    position: Vector
    velocity: Vector
    stamp: int

    def at(self, moment: float) -> Vector:
        """Return the position at another moment, carried on by the velocity, (3,) [m].

        Parameters
        ----------
        moment : float
            By the same clock [s].
        """
        return np.asarray(self.position + (moment - self.time) * self.velocity)

    def is_before(self, stamp: int) -> bool:
        """Whether a message of another stamp is later, or its clock has begun again.

        Parameters
        ----------
        stamp : int
            By the vehicle's clock [ms].
        """
        return (self.stamp - stamp) % _AROUND >= _REORDERED
