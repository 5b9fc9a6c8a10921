"""How much less than a half-plane a disc collects that touches it from within."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from scipy.special import ndtr, ndtri

from radmpc.arrays import Indices, Vector, frozen
from radmpc.gaussian import GAUSSIAN, Tail
from radmpc.records import dataclass

__all__ = ["DiscTails", "HalfSpaceTails", "Tails", "disc_probability", "tails_of"]

_RADII = np.geomspace(0.1, 1e3, 80)
"""Radii of discs that are told apart [standard deviations]: a radius in between counts as the next
smaller one, which collects less."""

_FARTHEST = 7.0
"""Distance up to which tails are compared [standard deviations]; beyond, discs and half-planes
differ less."""

_SAFETY = 1e-6
"""Added to every shift [standard deviations]: above the error of the quadrature, below anything
that costs effort."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(40)
_WIDEST = 9.0
"""How far to the side of the nearest point the disc is looked at [standard deviations]."""


def disc_probability(radii: Vector) -> Callable[[Vector], Vector]:
    r"""Return the probability that a standard normal point of the plane lies in a disc.

    By the distance; what only the radii decide is computed once.

    .. math:: \int_{-\rho}^{\rho} \varphi(s)
              \left[Q(q + \rho - c) - Q(q + \rho + c)\right] ds, \qquad c = \sqrt{\rho^2 - s^2}

    Parameters
    ----------
    radii : (r,) array
        Radii ρ [standard deviations].

    Returns
    -------
    callable
        Takes distances q from the mean to the discs' outlines [standard deviations], negative
        inside, an array that broadcasts against (r,). Returns no more than the truth, but for the
        error of the quadrature.
    """
    widest = np.arcsin(np.minimum(_WIDEST / radii, 1.0))[..., None]
    angles = widest * _NODES
    side = radii[..., None] * np.sin(angles)
    depth = radii[..., None] * np.cos(angles)
    # ρ − ρ cos, without cancellation: the disc is deep by as much at that side.
    behind = 2.0 * radii[..., None] * np.square(np.sin(0.5 * angles))
    density = np.exp(-0.5 * side**2) / np.sqrt(2.0 * np.pi)

    def probability(distances: Vector) -> Vector:
        near = distances[..., None] + behind
        far = near + 2.0 * depth
        within = density * (ndtr(-near) - ndtr(-far)) * depth
        found: Vector = widest[..., 0] * (within @ _WEIGHTS)
        return found

    return probability


@dataclass(frozen=True, slots=True, eq=False)
class HalfSpaceTails:
    """What certified plans keep where the referee charges half-spaces: in space, along intervals.

    Attributes
    ----------
    least : float
        Least distance at a risk bound Δ [standard deviations].
    """

    least: float

    @classmethod
    def of(cls, risk_bound: float, tail: Tail = GAUSSIAN) -> HalfSpaceTails:
        """Return the tails for a risk bound Δ.

        Parameters
        ----------
        risk_bound : float
            Δ [-].
        tail : Tail
            Of what deviations are.
        """
        return cls(float(tail.clearance_for(risk_bound)) - _SAFETY)

    def at(self, radii: Vector) -> tuple[Vector, Vector]:
        """Return the least distances and the shifts, as `DiscTails.at`: the same for all."""
        return np.full(radii.shape, self.least), np.zeros(radii.shape)


@dataclass(frozen=True, slots=True, eq=False)
class DiscTails:
    r"""What certified plans keep from discs of various sizes, at a risk bound Δ.

    With :math:`F_\rho(q)` the probability of a disc of radius ρ at distance q, a certified plan
    keeps :math:`F_\rho(q) \le \Delta`, so q is at least ``least``; and there
    :math:`F_\rho(q) \ge Q(q + \text{shift})`.

    Attributes
    ----------
    least : (r,) array
        Least distance [standard deviations]; nan where a disc is so small that a mean inside it
        may be certified.
    shifts : (r,) array
        What makes the half-plane's tail no more than the disc's [standard deviations].
    level : float
        Clearance from a half-plane that is hit with probability Δ [standard deviations].
    """

    least: Vector
    shifts: Vector
    level: float

    @classmethod
    @lru_cache(maxsize=64)
    def of(cls, risk_bound: float) -> DiscTails:
        """Tabulate the tails for a risk bound Δ; once for many plans.

        Parameters
        ----------
        risk_bound : float
            Δ [-].
        """
        low, high = np.zeros(_RADII.size), np.full(_RADII.size, _FARTHEST)
        probability = disc_probability(_RADII)
        reachable = probability(low) > risk_bound
        for _ in range(40):
            middle = 0.5 * (low + high)
            is_above = probability(middle) > risk_bound
            low, high = np.where(is_above, middle, low), np.where(is_above, high, middle)
        distances = low + np.linspace(0.0, 1.0, 30)[:, None] * (_FARTHEST - low)
        tails = np.maximum(probability(distances), 1e-300)
        shifts = (-ndtri(tails) - distances).max(axis=0) + _SAFETY
        least = np.where(reachable, low, np.nan)
        return cls(frozen(least), frozen(np.maximum(shifts, 0.0)), float(-ndtri(risk_bound)))

    def at(self, radii: Vector) -> tuple[Vector, Vector]:
        """Return the least distances and the shifts of discs.

        Parameters
        ----------
        radii : array
            Radii [standard deviations].

        Returns
        -------
        least, shifts : array
            As in `DiscTails`; nan for discs too small to tell.
        """
        places: Indices = np.searchsorted(_RADII, radii, side="right") - 1
        is_known = places >= 0
        places = np.maximum(places, 0)
        return (
            np.where(is_known, self.least[places], np.nan),
            np.where(is_known, self.shifts[places], np.nan),
        )


Tails = DiscTails | HalfSpaceTails
"""What a charge is at least, by the distance from a hazard."""


def tails_of(risk_bound: float, tail: Tail = GAUSSIAN, *, are_integrated: bool) -> Tails:
    """Return the tails for a risk bound Δ.

    Parameters
    ----------
    risk_bound : float
        Δ [-].
    tail : Tail
        Of what deviations are.
    are_integrated : bool
        Whether the referee integrates over hazards, at steps in the plane and under Gaussian tails,
        instead of bounding them by half-spaces.
    """
    return DiscTails.of(risk_bound) if are_integrated else HalfSpaceTails.of(risk_bound, tail)
