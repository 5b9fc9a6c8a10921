"""Feedback and memory where velocities are not logged: either may be what positions show.

Positions that come back by feedback F, pushed by noise of autocorrelation ρ, are those of two
roots in a row, whichever of them is which. From a known start the slower one as memory makes them
deviate most, at all times: it adds to the covariance of the first push alone.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.identification.intervals import SIGMAS, Interval, normal_interval, spanning
from radmpc.identification.least_squares.regression import Fit, ends_of_memory, fit, time_constant
from radmpc.identification.model import StepModel
from radmpc.records import replace

__all__ = ["of_either", "on_safe_side"]

_UNIT_ROOT = 3.43
"""Standard deviations [-] by which deviations without any feedback seem to come back in one of a
hundred logs, with the mean unknown (Dickey and Fuller 1979)."""


def on_safe_side(
    y: Matrix, h: Matrix, follows: Vector, model: StepModel
) -> tuple[Fit, tuple[Fit, Fit]]:
    """Return of what explains positions alike what lets them deviate most, and what it is among.

    If there may be no feedback at all, none will be written, and all that lasts is memory.

    Parameters
    ----------
    y : (N, n) array
        What is to be explained.
    h : (N, n) array
        Deviations from the reference.
    follows : (N,) array
        1 where a step follows the one before it, else 0.
    model : StepModel
        Dynamics without velocities.

    Returns
    -------
    found : Fit
        Of memory as long as it may be.
    ends : tuple of Fit
        Of the shortest and of the longest memory.
    """
    ends = ends_of_memory(y, h, follows, model.B)
    shortest, longest = ends
    if spanning([_gain(end) for end in ends]).excludes_zero:
        return longest, ends
    alone = fit(y, np.empty((len(y), 0)), follows, model.B, has_color=True)
    found = replace(alone, gain=shortest.gain, gain_deviation=shortest.gain_deviation)
    return found, ends


def of_either(
    ends: Sequence[Fit], gain: Interval, constant: Interval | None, dt: float
) -> tuple[Interval, Interval | None]:
    """Return feedback and time constant with intervals that hold whatever root is which.

    Parameters
    ----------
    ends : sequence of Fit
        Of the shortest and of the longest memory.
    gain : Interval
        K on the safe side, (d, n), whose values stay.
    constant : Interval or None
        Time constant on the safe side [s]; without sure feedback it stays that of noise alone.
    dt : float
        Step [s].
    """
    gain = spanning([gain, *map(_gain, ends)])
    if constant is None or not gain.excludes_zero:
        return gain, constant
    briefest = time_constant(ends[0], dt)
    low = 0.0 if briefest is None else briefest.low
    return gain, Interval(constant.value, np.minimum(low, constant.value), constant.value)


def _gain(one: Fit) -> Interval:
    """Return the feedback of a fit, as sure as it is of deviations that may not come back."""
    return normal_interval(one.gain, _UNIT_ROOT / SIGMAS * one.gain_deviation)
