"""What logs do not tell, and why, in sentences."""

from __future__ import annotations

import numpy as np

from radmpc.identification.estimate import Estimate
from radmpc.identification.intervals import Interval
from radmpc.identification.least_squares.regression import LEAST_CHANCE
from radmpc.identification.model import StepModel
from radmpc.identification.segments import Evidence
from radmpc.identification.sharing import Shared

__all__ = ["growth_of_loop", "misfit_of_color", "safe_constant", "unknowns"]

_ROUNDING = 1e-6
"""Growth of deviations from step to step [-] that is none: of axes without feedback it is 1."""

_LONGEST = 199.0
"""Time constants [steps] beyond which none is looked for."""

_VAGUE = 2.0
"""Ratio [-] of a time constant's upper end to its value beyond which it is hardly known."""


def unknowns(
    identified: Estimate,
    shared: Shared | None,
    model: StepModel,
    evidence: Evidence,
    num_vehicles: int,
) -> tuple[str, ...]:
    """Return what cannot be told from logs like these, a sentence each.

    Parameters
    ----------
    identified : Estimate
        What can.
    shared : Shared or None
        The part that vehicles have in common, if it could be looked for.
    model : StepModel
        Dynamics without feedback.
    evidence : {'commands', 'references', 'states'}
        What the logs hold beside states.
    num_vehicles : int
        How many vehicles they are of.
    """
    told = {"states": _of_states, "references": _of_references, "commands": _of_commands}
    sentences = told[evidence](identified, model)
    if identified.gain is not None and (growth := growth_of_loop(identified.gain, model)) > 1.0:
        sentences.append(
            f"feedback that holds: with K deviations grow {growth:.5g} times every step, so that "
            "the block has none"
        )
    constant = identified.time_constant
    if constant is not None and _is_vague(constant):
        sentences.append(
            "time constant: its interval is wide, and the block holds its upper end, "
            f"{float(constant.high):.3g} s"
        )
    if constant is not None and constant.high >= _LONGEST * model.dt:
        sentences.append(
            f"time constant above {_LONGEST * model.dt:.3g} s: what lasts so long looks like drift"
        )
    if num_vehicles < 2:
        sentences.append("shared noise: the logs are of one vehicle")
    elif shared is None:
        sentences.append("shared noise: too few steps of two vehicles at equal times by one clock")
    return tuple(sentences)


def growth_of_loop(gain: Interval, model: StepModel) -> float:
    """Return by what factor deviations grow every step in the closed loop, 1 if by rounding alone.

    Parameters
    ----------
    gain : Interval
        K, (d, n).
    model : StepModel
        Dynamics without feedback.
    """
    growth = float(np.abs(np.linalg.eigvals(model.A + model.B @ gain.value)).max())
    return growth if growth > 1.0 + _ROUNDING else min(growth, 1.0)


def safe_constant(constant: Interval) -> float:
    """Return a time constant on the safe side [s]: where it is hardly known, its upper end.

    Parameters
    ----------
    constant : Interval
        What was found.
    """
    return float(constant.high if _is_vague(constant) else constant.value)


def _is_vague(constant: Interval) -> bool:
    """Whether a time constant may be far longer than its value."""
    return bool(constant.high > _VAGUE * constant.value)


def _of_states(identified: Estimate, model: StepModel) -> list[str]:
    """Return what states alone do not tell."""
    del identified
    moved = "controls" if model.has_velocity else "motion"
    sentences = [
        f"noise apart from {moved}: without commands or references every maneuver counts as noise, "
        "so the covariance is too large where the vehicle maneuvered",
        "feedback: that needs references, or commands and references",
        "time constant, tails and measurement noise: they would be those of the maneuvers",
    ]
    if model.has_velocity:
        sentences.append("a constant push: it looks like a control")
    else:
        sentences.append("drift: it looks like motion; log velocities or references")
    return sentences


def _of_references(identified: Estimate, model: StepModel) -> list[str]:
    """Return what states with references do not tell."""
    sentences = []
    if identified.gain is not None and not identified.gain.excludes_zero:
        sentences.append("feedback: deviations come back no faster than by chance")
    if identified.gain_chance < LEAST_CHANCE:
        sentences.append(
            "feedback: the closed loop is not that of a double integrator with K alone (lags, "
            "integrators or measurement noise in the loop); K is the nearest"
        )
    if identified.color == 0.0 and identified.autocorrelation.first_score > 2.58:
        sentences.append("time constant: the residuals are nearly white")
    if identified.time_constant is not None and not model.has_velocity:
        gain = identified.gain
        what = "the longest memory that fits" if gain and gain.excludes_zero else "memory alone"
        sentences.append(
            "feedback apart from memory: without velocities slow feedback and a disturbance that "
            f"lasts look alike; {what} stands here, on the safe side"
        )
    elif identified.is_bound:
        sentences.append(
            "disturbance apart from measurement noise and lags of the loop: the covariance holds "
            "both, and is too large; log the commands"
        )
    sentences.append(
        "measurement noise: it enters through the feedback, too; log the commands"
        if identified.autocorrelation.first_score < -2.58
        else "measurement noise: no sign of it, nor would a small part show without commands"
    )
    return sentences


def _of_commands(identified: Estimate, model: StepModel) -> list[str]:
    """Return what states with commands do not tell."""
    sentences = []
    if identified.measurement is not None and (hidden := _hidden(identified, model)):
        sentences.append(
            f"disturbance of {hidden}: measurement noise hides it; no more than the upper end of "
            "its interval is known"
        )
    if identified.measurement is not None and not np.any(np.diag(identified.measurement.low) > 0.0):
        sentences.append(
            "measurement noise: it may be none; no more than the upper ends of its intervals are "
            "known"
        )
    if identified.gain is None and np.isfinite(identified.gain_share):
        sentences.append(
            f"feedback: deviations from references explain {100 * identified.gain_share:.0f} % of "
            "what commands correct: the controller goes by something else"
        )
    elif identified.gain is None:
        sentences.append("feedback: commands without references hide what they answer")
    if identified.measurement is None and identified.color > 0.0:
        sentences.append(
            "measurement noise: beside the disturbance's memory there is no sign of it"
        )
    elif identified.measurement is None:
        sentences.append(
            "measurement noise: residuals show no sign of it: it is small against the disturbance, "
            "or logged states are filtered"
        )
    if identified.measurement is not None and identified.color == 0.0:
        sentences.append("time constant: beside measurement noise there is no sign of memory")
    if (
        identified.tails is not None
        and identified.measurement is not None
        and not identified.tails.is_gaussian
    ):
        sentences.append("whose tails are heavy: those of the disturbance or of the measurement")
    return sentences


def _hidden(identified: Estimate, model: StepModel) -> str:
    """Return the states whose disturbance may be none."""
    axes = "xyz"[: model.dimension]
    names = [*axes, *(f"v{axis}" for axis in axes)]
    lows, highs = np.diag(identified.covariance.low), np.diag(identified.covariance.high)
    ends = zip(names, lows, highs, strict=True)
    return ", ".join(name for name, low, high in ends if low <= 0.0 < high)


def misfit_of_color(identified: Estimate) -> str | None:
    """Return how autocorrelations contradict a single time constant, None if they do not.

    Parameters
    ----------
    identified : Estimate
        Of noise with color.
    """
    seen = identified.autocorrelation
    if identified.color <= 0.0 or seen.values.size < 5 or identified.measurement is not None:
        return None
    expected = identified.color ** seen.lags[:5]
    width = 4.0 * seen.deviations[:5] / max(1.0 - identified.color, 0.05)
    worst = int(np.argmax(np.abs(seen.values[:5] - expected) - width))
    if abs(seen.values[worst] - expected[worst]) <= width[worst]:
        return None
    return (
        f"one time constant does not describe it: correlations fall to {seen.values[0]:.2f} after "
        f"a step and {seen.values[4]:.2f} after five"
    )
