"""What every step adds besides the noise."""

from __future__ import annotations

import numpy as np
from scipy.special import stdtrit

from radmpc.arrays import Matrix
from radmpc.identification.intervals import LEVEL, SIGMAS, Interval, normal_interval
from radmpc.identification.least_squares.regression import Fit
from radmpc.identification.model import StepModel
from radmpc.identification.segments import Evidence

__all__ = ["SURE", "current", "mean_of_steps"]

SURE = 2.58
"""Standard deviations [-] beyond which color, drift and the like are taken for real: 1 % by
chance."""


def mean_of_steps(
    found: Fit, y: Matrix, model: StepModel, evidence: Evidence
) -> tuple[Interval, bool]:
    """Return what every step adds, and whether that is beyond chance.

    Parameters
    ----------
    found : Fit
        Of the steps.
    y : (N, n) array
        As it was fitted to.
    model : StepModel
        Dynamics.
    evidence : {'commands', 'references', 'states'}
        What explains the steps.
    """
    if evidence != "states":
        # A mean is as sure as the deviation around it: noise with memory has few independent steps.
        free = max(len(found.noise) * (1.0 - found.color) / (1.0 + found.color), 1.0)
        sure = found.drift_deviation * float(stdtrit(free, 0.5 + 0.5 * LEVEL)) / SIGMAS
        drift = normal_interval(found.drift, sure)
        scores = np.abs(found.drift) / np.maximum(sure, 1e-300)
        # As many chances as states to look large.
        return drift, bool(np.any(scores > SURE + 0.25 * np.log2(model.num_states)))
    return current(y, model), False


def current(y: Matrix, model: StepModel) -> Interval:
    """Return the current that positions tell whatever was commanded.

    Parameters
    ----------
    y : (N, n) array
        What dynamics without feedback leave unexplained.
    model : StepModel
        Dynamics.
    """
    value = np.full(model.num_states, np.nan)
    deviation = np.full(model.num_states, np.nan)
    if model.has_velocity:
        d = model.dimension
        # Positions move by the mean of both velocities: the rest is a
        # current (exact for commands that are held over the step).
        rest = y[:, :d] - 0.5 * model.dt * y[:, d:]
        value[:d] = rest.mean(axis=0)
        deviation[:d] = rest.std(axis=0) / np.sqrt(len(rest))
    return normal_interval(value, deviation)
