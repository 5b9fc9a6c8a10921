"""Numbers as exact as a screen shows them, and no longer."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Matrix
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass

__all__ = ["Rounding", "extent_of", "significant"]

_SHARE = 5
"""Decimal places of the map's size that places are told with: a hundredth of a pixel when a screen
shows a tenth of the map [-]."""

_DIGITS = 6
"""Digits of costs and the like [-]."""


def significant(value: float | None) -> float | None:
    """Return a number in six digits; None of what is none or not finite."""
    if value is None or not math.isfinite(value):
        return None
    return float(f"{value:.{_DIGITS}g}")


@dataclass(frozen=True, slots=True)
class Rounding:
    """How many decimal places lengths on a map have.

    Attributes
    ----------
    decimals : int
        Of meters.
    """

    decimals: int

    @classmethod
    def of(cls, lower: Matrix, upper: Matrix) -> Rounding:
        """Return what fits a map.

        Parameters
        ----------
        lower, upper : (d,) array
            Its corners [m].
        """
        size = float(np.max(upper - lower, initial=0.0))
        return cls(_SHARE - (math.ceil(math.log10(size)) if size > 0.0 else 0))

    def point(self, values: npt.ArrayLike) -> list[float]:
        """Return a place, or anything in meters, as a list."""
        rounded: list[float] = np.round(
            np.asarray(values, dtype=np.float64), self.decimals
        ).tolist()
        return rounded

    def points(self, values: npt.ArrayLike) -> list[list[float]]:
        """Return places row by row."""
        rounded: list[list[float]] = np.round(
            np.asarray(values, dtype=np.float64), self.decimals
        ).tolist()
        return rounded

    def length(self, value: float) -> float:
        """Return one length."""
        return round(float(value), self.decimals + 2)


def extent_of(scenario: Scenario) -> tuple[Matrix, Matrix]:
    """Return the corners of a box around all of a scenario, hulls included [m].

    Parameters
    ----------
    scenario : Scenario
        Any.
    """
    places = []
    for vehicle in scenario.vehicles:
        start, radius = vehicle.start_position, vehicle.radius
        boxes = [(vehicle.goal.lower, vehicle.goal.upper)]
        boxes += [(visit.lower, visit.upper) for visit in vehicle.via]
        places += [start - radius, start + radius]
        places += [corner for lower, upper in boxes for corner in (lower - radius, upper + radius)]
    if scenario.workspace is not None:
        places += [scenario.workspace.lower, scenario.workspace.upper]
    for obstacle in scenario.obstacles:
        pieces = [piece for step in (obstacle.steps[0], obstacle.steps[-1]) for piece in step]
        places += [corner for piece in pieces for corner in piece.vertices]
    every = np.array(places)
    return every.min(axis=0), every.max(axis=0)
