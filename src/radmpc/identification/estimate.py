"""What a group of vehicles with the same noise is found to have."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Indices, Matrix
from radmpc.identification.commands import feedback
from radmpc.identification.drift import SURE, current, mean_of_steps
from radmpc.identification.intervals import (
    Interval,
    bound_alone,
    covariance_interval,
    placed,
    spanning,
    widened,
    worth_of,
)
from radmpc.identification.least_squares.lookalikes import of_either, on_safe_side
from radmpc.identification.least_squares.regression import (
    LEAST_CHANCE,
    Fit,
    feedback_chance,
    fit,
    time_constant,
)
from radmpc.identification.least_squares.small_sample import without_bias
from radmpc.identification.model import StepModel
from radmpc.identification.segments import Evidence, Segment, Transitions, moving_axes, stacked
from radmpc.identification.spectral.fleet import repetition
from radmpc.identification.spectral.measurement import Measured, measured_noise, with_memory
from radmpc.identification.tails import Tails, scatter, tails
from radmpc.identification.whiteness import (
    LEAST_CHANGE,
    Autocorrelation,
    autocorrelation,
    moving_states,
    whitened,
)
from radmpc.records import dataclass, replace

__all__ = ["Estimate", "estimate"]

_LEAST_COLOR = 0.05
"""Autocorrelation [-] from step to step below which noise counts as white, however sure it is:
variances after many steps change by a tenth."""


@dataclass(frozen=True, slots=True, eq=False)
class Estimate:
    """What a group of vehicles is found to have.

    Attributes
    ----------
    vehicles : tuple of str
        The group.
    num_steps : int
        Steps that were used.
    worth : float
        Number of independent Gaussian steps that tell the covariance as well.
    covariance : Interval
        W of every step, (n, n) [m², m²/s²].
    drift : Interval
        What every step adds besides, (n,) [m, m/s]; NaN where the log does not tell.
    has_drift : bool
        Whether chance hardly makes it.
    gain : Interval or None
        Feedback K, (d, n), without ends along axes that never move; None where it cannot be told.
    gain_share : float
        Share of the corrections that commands hold [-] which feedback explains; NaN where these are
        not known.
    unexplained : float
        Mean square of the corrections [m²/s⁴, m²/s²] that K does not explain, over all axes; NaN
        where these are not known.
    gain_chance : float
        Probability of such residuals if the closed loop is that of a double integrator with
        feedback [-]; NaN where that was not tried.
    color : float
        Autocorrelation of the noise from step to step [-], 0 if it is white.
    time_constant : Interval or None
        Of the noise [s]; None if it is white or that cannot be told.
    measurement : Interval or None
        Covariance of the measurement noise, (n, n) [m², m²/s²]; None if there is no sign of it.
    tails : Tails or None
        Of the noise; None where that cannot be told.
    autocorrelation : Autocorrelation
        Of what remains when feedback and drift are taken away.
    residuals : (N, p) array
        What remains when color is, too, whitened.
    residual_states : tuple of int
        The states that these columns belong to; empty where they are fewer than states that change.
    noise : tuple
        Per segment of the group, in the order given: first step and residuals with mean zero.
    is_bound : bool
        Whether W holds more than disturbances, which maneuvers or measurement noise hide.
    """

    vehicles: tuple[str, ...]
    num_steps: int
    worth: float
    covariance: Interval
    drift: Interval
    has_drift: bool
    gain: Interval | None
    gain_share: float
    unexplained: float
    gain_chance: float
    color: float
    time_constant: Interval | None
    measurement: Interval | None
    tails: Tails | None
    autocorrelation: Autocorrelation
    residuals: Matrix
    residual_states: tuple[int, ...]
    noise: tuple[tuple[str, int, Matrix], ...]
    is_bound: bool = False


def estimate(
    group: Sequence[Transitions], model: StepModel, evidence: Evidence, *, share: float = 0.0
) -> Estimate:
    """Return what a group of vehicles has in common.

    Parameters
    ----------
    group : sequence of Transitions
        Of vehicles with the same noise and feedback.
    model : StepModel
        Their dynamics.
    evidence : {'commands', 'references', 'states'}
        What explains their transitions.
    share : float
        Correlation of the noise between vehicles at equal times [-]: steps that they share tell
        less.
    """
    y, _, _ = stacked([segment for one in group for segment in one.segments])
    axes = moving_axes(y, model)
    if len(axes) == model.dimension:
        return _of_moving(group, model, evidence, share)
    bare = [one.along(axes, model) for one in group]
    found = _of_moving(bare, replace(model, dimension=len(axes)), evidence, share)
    return _beside_still(found, y, axes, model, evidence)


def _beside_still(
    found: Estimate, y: Matrix, axes: Indices, model: StepModel, evidence: Evidence
) -> Estimate:
    """Return what was found of some axes with those that never move beside them."""
    n, means = model.num_states, y.mean(axis=0)
    states = model.states_along(axes)
    square, nothing = np.ix_(states, states), Interval(*np.zeros((3, n, n)))
    unknown = np.full((model.dimension, n), np.inf)
    drift, has_drift = current(y, model), False
    if evidence != "states":
        drift = placed(found.drift, Interval(means, means, means), (states,))
        still = np.delete(means, states)
        has_drift = bool(np.any(np.abs(still) > LEAST_CHANGE * y.std(axis=0).max()))
    gain, measurement = found.gain, found.measurement
    if gain is not None:
        around = Interval(np.zeros(unknown.shape), -unknown, unknown)
        gain = placed(gain, around, np.ix_(axes, states))
    noise = []
    for name, first, rows in found.noise:
        wide = np.zeros((len(rows), n))
        wide[:, states] = rows
        noise.append((name, first, wide))
    return replace(
        found,
        covariance=placed(found.covariance, nothing, square),
        drift=drift,
        has_drift=found.has_drift or has_drift,
        gain=gain,
        measurement=None if measurement is None else placed(measurement, nothing, square),
        residual_states=tuple(int(states[i]) for i in found.residual_states),
        noise=tuple(noise),
    )


def _of_moving(
    group: Sequence[Transitions], model: StepModel, evidence: Evidence, share: float
) -> Estimate:
    """Return what a group has in common, all axes of which move."""
    y, h, follows = stacked([segment for one in group for segment in one.segments])
    found, measured, first, either = _explained(group, model, evidence)
    white, moving = whitened(found.innovations), moving_states(found.innovations)
    kind = None if evidence == "states" else tails([white])
    more = (len(group) - 1) * max(share, 0.0)
    alike = 1.0 + more * max(share, 0.0)
    found, *ends = (_widened(one, np.sqrt(1.0 + more), np.sqrt(alike)) for one in (found, *either))
    covariance, worth, constant = _disturbance(found, measured, kind, model, alike)
    chance = feedback_chance(found, y, h, follows) if h.shape[1] else float("nan")
    is_bound = evidence == "references" and (first.first_score < -SURE or chance < LEAST_CHANCE)
    gain, gain_share, unexplained = feedback(found, group, evidence)
    if ends and gain is not None:
        gain, constant = of_either(ends, gain, constant, model.dt)
        covariance = spanning([covariance, _spread(ends[-1], kind, model, alike)[0]])
        is_bound = True
    drift, has_drift = mean_of_steps(found, y, model, evidence)
    return Estimate(
        vehicles=tuple(one.name for one in group),
        num_steps=len(y),
        worth=worth,
        covariance=bound_alone(covariance) if is_bound else covariance,
        drift=drift,
        has_drift=has_drift,
        gain=gain,
        gain_share=gain_share,
        unexplained=unexplained,
        gain_chance=chance,
        color=found.color,
        time_constant=constant,
        measurement=None if measured is None else measured.measurement,
        tails=kind,
        autocorrelation=first,
        residuals=white,
        residual_states=tuple(moving.tolist()) if len(moving) == white.shape[1] else (),
        noise=_noise(found.noise, group),
        is_bound=is_bound or evidence == "states",
    )


def _explained(
    group: Sequence[Transitions], model: StepModel, evidence: Evidence
) -> tuple[Fit, Measured | None, Autocorrelation, tuple[Fit, ...]]:
    """Return the fit that goes with what residuals look like, and how these follow each other.

    Where feedback and memory look alike, the fits of the shortest and the longest memory come with
    it.
    """
    all_segments = [segment for one in group for segment in one.segments]
    y, h, follows = stacked(all_segments)
    found = fit(y, h, follows, model.B, has_color=False)
    pieces = _pieces(whitened(found.innovations), all_segments)
    first = autocorrelation(pieces)
    if evidence == "commands":
        offsets = [segment.offset for segment in all_segments]
        noise, repeated = _pieces(found.noise, all_segments), repetition(group, pieces)
        measured = measured_noise(noise, offsets, model, repeated)
        if measured is not None:
            return with_memory(found, measured), measured, first, ()
    if evidence != "states" and first.first_score > SURE and first.first > _LEAST_COLOR:
        if not model.has_velocity and h.shape[1]:
            found, ends = on_safe_side(y, h, follows, model)
            return found, None, first, ends
        found = fit(y, h, follows, model.B, has_color=True)
    elif evidence == "references":
        found = without_bias(found, h, follows, model)
    return found, None, first, ()


def _pieces(rows: Matrix, all_segments: Sequence[Segment]) -> list[Matrix]:
    """Return rows by segment."""
    ends = np.cumsum([len(segment.y) for segment in all_segments])[:-1]
    return list(np.split(rows, ends))


def _noise(rows: Matrix, group: Sequence[Transitions]) -> tuple[tuple[str, int, Matrix], ...]:
    """Return residuals with vehicle and first step of their segments."""
    owners = [(one.name, segment) for one in group for segment in one.segments]
    pieces = _pieces(rows, [segment for _, segment in owners])
    return tuple(
        (name, segment.first, piece) for (name, segment), piece in zip(owners, pieces, strict=True)
    )


def _widened(found: Fit, by_mean: float, by_product: float) -> Fit:
    """Return a fit whose means and products are less sure by some factors."""
    return replace(
        found,
        gain_deviation=by_product * found.gain_deviation,
        drift_deviation=by_mean * found.drift_deviation,
        color_deviation=by_product * found.color_deviation,
    )


def _disturbance(
    found: Fit, measured: Measured | None, kind: Tails | None, model: StepModel, alike: float
) -> tuple[Interval, float, Interval | None]:
    """Return W, how many independent steps it is worth, and the time constant."""
    covariance, worth = _spread(found, kind, model, alike)
    if measured is None:
        return covariance, worth, time_constant(found, model.dt)
    worth = min(worth, worth_of(measured.disturbance))
    return measured.disturbance, worth, measured.time_constant(model.dt)


def _spread(
    found: Fit, kind: Tails | None, model: StepModel, alike: float
) -> tuple[Interval, float]:
    """Return W with its interval, and how many independent steps it is worth."""
    steps, color = len(found.noise), found.color
    spent = (1.0 + color) / (1.0 - color) + found.gain.size / model.num_states
    free = max(steps - spent, 1.0)
    covariance = found.noise.T @ found.noise / free
    independent = max(free * (1.0 - color**2) / (1.0 + color**2) / alike, 1.0)
    worth, least, most = scatter(kind, independent)
    return widened(covariance_interval(covariance, worth), least, most), worth
