"""Noise that starts and goals next to each other leave clearance for."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from radmpc.arrays import Matrix
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


def fit_ends(
    vehicles: Sequence[ForeignVehicle],
    noises: Sequence[Noise],
    goal_half_width: float,
    steps: tuple[float, int],
    options: ImportOptions,
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
        _reduce(shares, starts, np.zeros_like(starts), radii, stds[:, 0])
        _reduce(shares, goals, np.array(half), radii, stds[:, 1])
    found, names = list(noises), []
    for i in np.flatnonzero(shares < 1.0).tolist():
        std = rounded_down(noises[i].std * float(shares[i]), 3)
        found[i] = choose_noise(vehicles[i], *steps, replace(options, noise=std))
        names.append(vehicles[i].name)
    return found, names


def _reduce(shares: Matrix, places: Matrix, half: Matrix, radii: Matrix, stds: Matrix) -> None:
    """Lower the shares of the noise of all who are too close to each other at places."""
    reach = 2.0 * (radii.max() + math.sqrt(2.0) * stds.max() + np.linalg.norm(half, axis=1).max())
    for i, j in near_pairs(places, float(reach)).tolist():
        # Boxes around goals let the means keep as far from each other as their far sides.
        apart = float(np.linalg.norm(np.abs(places[i] - places[j]) + half[i] + half[j]))
        room, spread = apart - radii[i] - radii[j], math.hypot(stds[i], stds[j])
        if 0.0 < room < _TOO_NEAR * spread:
            shares[[i, j]] = np.minimum(shares[[i, j]], room / (_SIGMAS * spread))
