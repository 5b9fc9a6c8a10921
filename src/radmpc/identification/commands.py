"""Whether vehicles did what they were commanded."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix
from radmpc.identification.sampling import Samples
from radmpc.identification.segments import Evidence

__all__ = ["command_warning"]

_LEAST, _MOST = 0.25, 1.5
"""Responses [-] to commands beyond which it is told. Feedback that opposes a lasting disturbance
makes them look weak: 0.53 at a time constant of three steps; nothing makes them look strong."""

_CROSSED = 0.4
"""Response [-] of one axis to commands along another from which on axes are mixed up."""

_LEAST_SHARE = 0.2
"""Share of what an axis gains [-] that such commands must explain alone."""

_SURE = 3.0
"""Standard deviations [-] by which it must be beyond."""


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
