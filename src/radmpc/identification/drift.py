"""What every step adds besides the noise."""

from __future__ import annotations

import numpy as np
from scipy.special import stdtrit

from radmpc.arrays import Matrix, Vector
from radmpc.identification.intervals import LEVEL, SIGMAS, Interval, normal_interval
from radmpc.identification.least_squares.regression import Fit
from radmpc.identification.model import StepModel
from radmpc.identification.segments import Evidence

__all__ = ["SURE", "current", "mean_of_steps"]

SURE = 2.58
"""Standard deviations [-] beyond which color, drift and the like are taken for real: 1 % by
chance."""

_STRETCHES = 20
"""Parts of a log whose means are compared."""

_MOST_COLOR = 0.995
"""Largest correlation from row to row [-] that is told from drift."""


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
        deviation[:d] = _deviation_of_mean(rest)
    return normal_interval(value, deviation)


def _deviation_of_mean(rows: Matrix) -> Vector:
    """Return how unsure means of rows are that may have memory, as if they were normal.

    By the correlation from row to row, or by means of stretches, whichever are less sure: noise of
    sensors hides the former, and short logs the latter.
    """
    count, centered = len(rows), rows - rows.mean(axis=0)
    power = np.maximum(np.mean(centered**2, axis=0), 1e-300)
    color = np.mean(centered[1:] * centered[:-1], axis=0) / power if count > 1 else 0.0 * power
    # The mean that is taken away makes it look smaller (Kendall 1954).
    color = np.clip(color + (1.0 + 3.0 * color) / count, 0.0, _MOST_COLOR)
    free = np.maximum(count * (1.0 - color) / (1.0 + color), 2.0)
    sure = np.sqrt(power / free) * stdtrit(np.maximum(free - 1.0, 1.0), 0.5 + 0.5 * LEVEL)
    if count >= 2 * _STRETCHES:
        means = np.array([part.mean(axis=0) for part in np.array_split(centered, _STRETCHES)])
        apart = means.std(axis=0, ddof=1) / np.sqrt(_STRETCHES)
        sure = np.maximum(sure, apart * float(stdtrit(_STRETCHES - 1.0, 0.5 + 0.5 * LEVEL)))
    return np.asarray(sure / SIGMAS)
