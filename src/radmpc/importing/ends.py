"""Noise that starts and goals next to each other leave clearance for."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.gaussian import clearance, tail_probability
from radmpc.importing.noise import Noise, choose_noise
from radmpc.importing.options import ImportOptions
from radmpc.importing.problem import ForeignVehicle
from radmpc.nearby import near_pairs
from radmpc.rounding import rounded_down

__all__ = ["fit_ends"]

_TOO_NEAR = 2.0
"""Standard deviations between two hulls below which noise is reduced: a chance of 2 %."""

_SIGMAS = 4.0
"""Standard deviations that it then leaves between them: 3e-5."""

_MOST_RISK = 0.5
"""Share of the risk bound that starts and goals may use together, however far apart each two are.
Above it the noise of all who have less than `_SIGMAS` between them is reduced."""


def fit_ends(
    vehicles: Sequence[ForeignVehicle],
    noises: Sequence[Noise],
    goal_half_width: float,
    steps: tuple[float, int],
    options: ImportOptions,
    risk_bound: float,
) -> tuple[list[Noise], list[str]]:
    """Return less noise for those who start or end so close together that it alone rules out plans.

    Parameters
    ----------
    vehicles : sequence of ForeignVehicle
        At least one.
    noises : sequence of Noise
        Theirs, in the same order.
    goal_half_width : float
        Of goals around published points, per axis [radii].
    steps : tuple of float and int
        Step [s], and their number.
    options : ImportOptions
        Noise that is asked for stays as it is.
    risk_bound : float
        That of the scenario [-].

    Returns
    -------
    list of Noise
        The same but for those.
    list of str
        Their names.
    """
    shares = np.ones(len(vehicles))
    if options.noise is None:
        radii = np.array([v.radius for v in vehicles])
        half = [
            np.full(v.goal.size, goal_half_width * v.radius)
            if v.goal_half_width is None
            else v.goal_half_width
            for v in vehicles
        ]
        starts = np.array([v.start for v in vehicles])
        goals = np.array([v.goal for v in vehicles])
        stds = np.array([(noise.std, noise.final) for noise in noises])
        ends = (
            _Clearances(starts, np.zeros_like(starts), radii, stds[:, 0]),
            _Clearances(goals, np.array(half), radii, stds[:, 1]),
        )
        is_risky = sum(end.risk() for end in ends) > _MOST_RISK * risk_bound
        for end in ends:
            end.reduce(shares, _SIGMAS if is_risky else _TOO_NEAR)
    found, names = list(noises), []
    for i in np.flatnonzero(shares < 1.0).tolist():
        std = rounded_down(noises[i].std * float(shares[i]), 3)
        found[i] = choose_noise(vehicles[i], *steps, replace(options, noise=std))
        names.append(vehicles[i].name)
    return found, names


class _Clearances:
    """Those of hulls that are next to each other at their places: starts, or goals.

    Attributes
    ----------
    pairs : (P, 2) int array
        Who; pairs that overlap are left out.
    sigmas : (P,) array
        Clearance between the two [standard deviations].
    """

    def __init__(self, places: Matrix, half: Matrix, radii: Vector, stds: Vector) -> None:
        reach = 2.0 * (radii.max() + np.linalg.norm(half, axis=1).max())
        reach += _SIGMAS * math.sqrt(2.0) * stds.max()
        pairs = near_pairs(places, float(reach))
        i, j = pairs.T
        # Boxes around goals let the means keep as far from each other as their far sides.
        apart = np.linalg.norm(np.abs(places[i] - places[j]) + half[i] + half[j], axis=1)
        slacks = apart - radii[i] - radii[j]
        is_free = slacks > 0.0
        self.pairs: Indices = pairs[is_free]
        self.sigmas: Vector = clearance(slacks, np.hypot(stds[i], stds[j]))[is_free]

    def risk(self) -> float:
        """Return what pairs that are not too near risk in sum."""
        return float(tail_probability(self.sigmas[self.sigmas >= _TOO_NEAR]).sum())

    def reduce(self, shares: Vector, limit: float) -> None:
        """Lower the shares of the noise of all who have less between them than a limit."""
        for (i, j), sigmas in zip(self.pairs.tolist(), self.sigmas.tolist(), strict=True):
            if sigmas < limit:
                shares[[i, j]] = np.minimum(shares[[i, j]], sigmas / _SIGMAS)
