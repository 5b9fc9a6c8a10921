"""What is known of the narrowest place that a vehicle must pass, and of the vehicle there."""

from __future__ import annotations

from enum import Enum
from math import log, sqrt

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.model.scenario import Scenario
from radmpc.planners.reaching.enclosed import Closed
from radmpc.preflight.distances import Surroundings
from radmpc.records import dataclass

__all__ = ["Narrowest", "Passage", "Traveler", "closed_place"]

_FEWEST, _MOST = 5.0, 8.5
"""Clearances that are looked for at least and at most, whatever Δ [standard deviations]."""

_LEAST_DEVIATION = 1e-3
"""Standard deviation that stands for less, where places are compared [hull radii]."""


class Passage(Enum):
    """Why there is no narrowest place to name."""

    WIDE = "wide"
    UNKNOWN = "unknown"
    TOO_LARGE = "too large"
    """What the vehicle can reach has too many cells as small as its hull, soon so in space."""

    CLOSED = "closed"
    """No path leads to the goal in time, but through what stands there."""


@dataclass(frozen=True, slots=True)
class Narrowest:
    """Where a vehicle has the least clearance, on the path that leaves it the most.

    Attributes
    ----------
    clearance : float
        Of the hull from what is nearest, negative where it does not fit [m].
    deviation : float
        Standard deviation of the position toward it, then [m].
    position : tuple of float
        Where [m].
    step : int
        The step at or before; 0 where a way is closed at all steps.
    beside : tuple of (str or None)
        What is there, the nearest first; None is the workspace's border.
    """

    clearance: float
    deviation: float
    position: tuple[float, ...]
    step: int
    beside: tuple[str | None, ...]

    @property
    def deviations(self) -> float | None:
        """The clearance in standard deviations; None without noise."""
        return self.clearance / self.deviation if self.deviation > 0.0 else None


@dataclass(frozen=True, slots=True, eq=False)
class Traveler:
    """A vehicle on its way through a scenario.

    Attributes
    ----------
    scenario : Scenario
        The scenario.
    radius : float
        Hull radius [m].
    start : (d,) array
        Mean position at the start [m].
    goal : pair of (d,) array
        Corners of the goal [m].
    covariances : (T+1, d, d) array
        Position covariances [m²].
    reach : pair of (T+1, d) array
        Corners of boxes that hold its mean [m].
    """

    scenario: Scenario
    radius: float
    start: Vector
    goal: tuple[Vector, Vector]
    covariances: Tensor
    reach: tuple[Matrix, Matrix]

    @property
    def enough(self) -> float:
        """Clearance beyond which no place is narrow [standard deviations]."""
        # Its tail is at most exp(−q²/2)/2: this one runs a ten-thousandth of Δ.
        return min(max(sqrt(-2.0 * log(2e-4 * self.scenario.risk_bound)), _FEWEST), _MOST)

    def surroundings(self, step: int) -> Surroundings:
        """Return what it has to keep clear of, see `Surroundings.of`."""
        return Surroundings.of(self.scenario, self.radius, step)

    @property
    def least(self) -> float:
        """Standard deviation that stands for less, where places are compared [m]."""
        return _LEAST_DEVIATION * self.radius

    @property
    def far(self) -> float:
        """Distance of the hull from anything, beyond which no clearance is too little [m]."""
        widest = np.linalg.eigvalsh(self.covariances)[:, -1].max()
        spreads = [o.spread for o in self.scenario.obstacles if o.spread is not None]
        steps = range(self.scenario.horizon + 1)
        # Deviations of two add up to less than their sum.
        more = max((spread.deviation(k) for spread in spreads for k in steps), default=0.0)
        return self.enough * max(float(np.sqrt(max(widest, 0.0))) + more, self.least)

    def covariance(self, name: str | None, step: int) -> Matrix:
        """Return the covariance of its position relative to an obstacle, (d, d) [m²].

        Parameters
        ----------
        name : str or None
            The obstacle; None for the workspace's border.
        step : int
            The step, 0 to T.
        """
        for obstacle in self.scenario.obstacles:
            if obstacle.name == name and obstacle.spread is not None:
                return np.asarray(self.covariances[step] + obstacle.spread.positions[step])
        return np.asarray(self.covariances[step])


def closed_place(closed: Closed, radius: float, covariance: Matrix) -> Narrowest:
    """Return the widest opening of a way that is closed for a vehicle.

    Parameters
    ----------
    closed : Closed
        The way.
    radius : float
        Hull radius [m].
    covariance : (d, d) array
        Position covariance at the horizon [m²]; when it would get there is not known.
    """
    # The border is kept by the center: what is lacking is shared by both of its sides.
    share = 0.5 if None in closed.beside else 1.0
    return Narrowest(
        clearance=share * (closed.radius - radius),
        deviation=float(np.sqrt(max(np.linalg.eigvalsh(covariance)[-1], 0.0))),
        position=closed.position,
        step=0,
        beside=tuple(dict.fromkeys(closed.beside)) if closed.is_shut else closed.beside,
    )
