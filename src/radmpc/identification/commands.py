"""Commands: whether vehicles followed them, and by what feedback they were given."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix
from radmpc.identification.intervals import Interval, normal_interval
from radmpc.identification.least_squares.regression import Fit
from radmpc.identification.sampling import Samples
from radmpc.identification.segments import Evidence, Transitions

__all__ = ["LEAST_EXPLAINED", "command_warning", "feedback"]

_LEAST, _MOST = 0.25, 1.5
"""Responses [-] to commands beyond which it is told. Feedback that opposes a lasting disturbance
makes them look weak: 0.53 at a time constant of three steps; nothing makes them look strong."""

_CROSSED = 0.4
"""Response [-] of one axis to commands along another from which on axes are mixed up."""

_LEAST_SHARE = 0.2
"""Share of what an axis gains [-] that such commands must explain alone."""

_SURE = 3.0
"""Standard deviations [-] by which it must be beyond."""


LEAST_EXPLAINED = 0.9
"""Share of the corrections [-] that feedback must explain to be their law: lags and filters in a
controller leave less than a tenth."""

_ROUNDING, _LAST_DIGITS = 1e-6, 1e-12
"""Shares of the corrections along an axis, and of all corrections, [-] below which what an entry of
K does is rounding: 32 bits hold seven digits, 64 bits sixteen."""


def command_warning(samples: Samples, evidence: Evidence) -> tuple[str, ...]:
    """Return what is odd about a vehicle's response to its commands.

    Parameters
    ----------
    samples : Samples
        At steps.
    evidence : {'commands', 'references', 'states'}
        What the estimates go by.

    Returns
    -------
    tuple of str
        A sentence, or nothing.
    """
    if evidence != "commands" or samples.effects is None or len(samples.steps) < 10:
        return ()
    d = samples.track.dimension
    is_step = np.diff(samples.steps) == 1
    gained = np.diff(samples.states[:, d:], axis=0)[is_step]
    asked = samples.effects[:-1, d:][is_step]
    gained, asked = gained - gained.mean(axis=0), asked - asked.mean(axis=0)
    size = float(np.sum(asked**2))
    if size <= 0.0:
        return (f"{samples.track.where}: its commands never change: were they logged?",)
    response = float(np.sum(asked * gained)) / size
    odd = _odd_axis(asked, gained)
    if odd:
        return (f"{samples.track.where}: {odd}: are commands along the same axes?",)
    rest = gained - response * asked
    deviation = float(np.sqrt(np.sum(asked**2 * rest**2))) / size
    width = _SURE * deviation
    if _LEAST - width <= response <= _MOST + width:
        return ()
    return (
        f"{samples.track.where}: gains {100 * response:.0f} % of what commands ask for: are they "
        "accelerations in m/s², along the same axes, and not cut off by the vehicle?",
    )


def _odd_axis(asked: Matrix, gained: Matrix) -> str:
    """Return the axis that answers to another one's commands, or against its own."""
    if np.linalg.matrix_rank(asked) < asked.shape[1]:
        return ""
    answers = np.linalg.lstsq(asked, gained, rcond=None)[0].T
    rest = gained - asked @ answers.T
    inverse = np.linalg.inv(asked.T @ asked)
    widths = _SURE * np.sqrt(np.outer(np.mean(rest**2, axis=0), np.diag(inverse)))
    sizes = np.outer(np.sum(gained**2, axis=0), np.sum(asked**2, axis=0))
    shares = (gained.T @ asked) ** 2 / np.maximum(sizes, 1e-300)
    for i, axis in enumerate("xyz"[: len(answers)]):
        if answers[i, i] + widths[i, i] < 0.0 and shares[i, i] > _LEAST_SHARE:
            return f"v{axis} gains against what commands along {axis} ask for"
        sure = np.abs(answers[i]) - widths[i]
        other = int(np.argmax(sure))
        is_other = other != i and sure[other] > _CROSSED and shares[i, other] > _LEAST_SHARE
        if is_other and abs(answers[i, other]) < _MOST and answers[i, i] - widths[i, i] < _LEAST:
            return f"v{axis} gains what commands along {'xyz'[other]} ask for"
    return ""


def feedback(
    found: Fit, group: Sequence[Transitions], evidence: Evidence
) -> tuple[Interval | None, float, float]:
    """Return the feedback, by least squares on what is known of it.

    Parameters
    ----------
    found : Fit
        Of the group's steps.
    group : sequence of Transitions
        Of vehicles with the same feedback.
    evidence : {'commands', 'references', 'states'}
        What explains their transitions.

    Returns
    -------
    gain : Interval or None
        K, (d, n); None where it cannot be told.
    share : float
        Share of the corrections that commands hold [-] which K explains; NaN without these.
    rest : float
        Mean square of what it leaves of them, over all axes [m²/s⁴, m²/s²]; NaN as well.
    """
    unknown = float("nan")
    if evidence == "references":
        return normal_interval(found.gain, found.gain_deviation), unknown, unknown
    told = [(one.deviations, one.corrections) for one in group]
    pairs = [(h, y) for h, y in told if h is not None and y is not None]
    if evidence != "commands" or len(pairs) < len(group):
        return None, unknown, unknown
    h = np.concatenate([deviations for deviations, _ in pairs])
    y = np.concatenate([corrections for _, corrections in pairs])
    h, y = h - h.mean(axis=0), y - y.mean(axis=0)
    gain = np.linalg.lstsq(h, y, rcond=None)[0].T
    gain = _without_rounding(gain, h, y)
    rest = y - h @ gain.T
    left = float(np.sum(rest**2))
    share = 1.0 - left / max(float(np.sum(y**2)), 1e-300)
    if np.any(y) and share < LEAST_EXPLAINED:
        return None, share, left / len(y)
    variances = np.sum(rest**2, axis=0) / max(len(y) - h.shape[1] - 1, 1)
    inverse = np.diag(np.linalg.pinv(h.T @ h, hermitian=True))
    deviations = np.sqrt(np.outer(variances, np.maximum(inverse, 0.0)))
    return normal_interval(gain, deviations), share, left / len(y)


def _without_rounding(gain: Matrix, h: Matrix, y: Matrix) -> Matrix:
    """Return a gain with zeros where it makes of deviations no more than rounding."""
    size = y.std(axis=0)[:, None]
    least = np.maximum(_ROUNDING * size, _LAST_DIGITS * size.max())
    return np.where(np.abs(gain) * h.std(axis=0) <= least, 0.0, gain)
