r"""What least squares make of weak feedback in short logs.

Deviations that come back slowly seem to come back faster than they do, and estimates scatter more
than their information says: a log holds few returns (Hurwicz 1950). Both are seen on logs that are
simulated with what was found (Kilian 1998).
"""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.identification.least_squares.regression import Fit
from radmpc.identification.model import StepModel
from radmpc.records import replace

__all__ = ["without_bias"]

_MOST_STEPS = 1000
"""Steps of the longest log that is always looked at: in longer ones intervals without all this hold
feedback of a tenth of the usual gains in 93 % already."""

_FEW_RETURNS = 60.0
"""Returns of deviations [-], steps over the time constant of the slowest, below which logs of more
steps are looked at, too: sampled fast, many steps hold few of them."""

_FARTHEST = 5000
"""Steps of the longest log that is looked at for that: about a second, and 250 MB."""

_LOGS = 200
"""Simulated logs, in pairs with opposite noise: the bias is known within 0.07 of a deviation,
deviations within a twentieth, after 15 ms for 100 steps and 120 ms for 1000."""

_ROUNDS = 2
"""Rounds in which weights and gain improve each other; a third changes less than the scatter."""

_MOST_GROWTH = 10.0
"""Growth of deviations along a log [-] beyond which a closed loop is not simulated."""

_SHRINK = 0.9
"""Factor of a correction [-] that would make a stable closed loop an unstable one."""

_FLOOR = 1e-9
"""Share of a variance [-] that is added where noise or deviations hang together exactly."""


def without_bias(found: Fit, h: Matrix, follows: Vector, model: StepModel) -> Fit:
    """Return white noise's feedback and drift as simulated logs correct them.

    Parameters
    ----------
    found : Fit
        What least squares found, without color.
    h : (N, n) array
        Deviations from the reference.
    follows : (N,) array
        1 where a step follows the one before it, else 0.
    model : StepModel
        Dynamics without feedback.
    """
    most = max(1.0, _MOST_GROWTH ** (1.0 / len(h)))
    covariance = found.noise.T @ found.noise / max(len(h) - 1, 1)
    variances = np.diag(covariance)
    radius = _radius(found.gain, model)
    is_long = len(h) > _MOST_STEPS and (
        len(h) > _FARTHEST or len(h) * (1.0 - radius) >= _FEW_RETURNS
    )
    if is_long or variances.min() <= 0.0 or radius > most:
        return found
    covariance += _FLOOR * np.diag(variances)
    root = np.asarray(np.linalg.cholesky(covariance), dtype=np.float64)
    gains, drifts = _estimates(found.gain, found.drift, root, h, follows, model)
    gain, share = 2.0 * found.gain - gains.mean(axis=0), 1.0
    while share > _FLOOR and _radius(gain, model) > max(1.0, _radius(found.gain, model)):
        share *= _SHRINK
        gain = found.gain - share * (gains.mean(axis=0) - found.gain)
    drift = found.drift - share * (drifts.mean(axis=0) - found.drift)
    gains, drifts = _estimates(gain, drift, root, h, follows, model)
    return replace(
        found,
        gain=gain,
        gain_deviation=np.maximum(gains.std(axis=0), found.gain_deviation),
        drift=drift,
        drift_deviation=np.maximum(drifts.std(axis=0), found.drift_deviation),
    )


def _radius(gain: Matrix, model: StepModel) -> float:
    """Return by what deviations grow from step to step."""
    return float(np.abs(np.linalg.eigvals(model.A + model.B @ gain)).max())


def _estimates(
    gain: Matrix, drift: Vector, root: Matrix, h: Matrix, follows: Vector, model: StepModel
) -> tuple[Matrix, Matrix]:
    """Return feedback and drift that least squares find in simulated logs, (logs, ...) each."""
    y, e = _simulated(gain, drift, root, h, follows, model)
    mean_y, mean_e = y.mean(axis=1, keepdims=True), e.mean(axis=1, keepdims=True)
    y, e = y - mean_y, e - mean_e
    turned = e.transpose(0, 2, 1)
    free = (_inverses(turned @ e) @ (turned @ y)).transpose(0, 2, 1)
    B, found = model.B, free
    for _ in range(_ROUNDS):
        rest = y - e @ found.transpose(0, 2, 1)
        weight = _inverses(rest.transpose(0, 2, 1) @ rest)
        gains = np.linalg.solve(B.T @ weight @ B, B.T @ weight @ free)
        found = B @ gains
    return gains, (mean_y - mean_e @ found.transpose(0, 2, 1))[:, 0]


def _inverses(products: Matrix) -> Matrix:
    """Return inverses of positive definite matrices whose axes may have very different scales."""
    scale = np.sqrt(np.diagonal(products, axis1=1, axis2=2))
    sizes = scale[:, :, None] * scale[:, None, :]
    return np.asarray(np.linalg.inv(products / sizes + _FLOOR * np.eye(scale.shape[1])) / sizes)


def _simulated(
    gain: Matrix, drift: Vector, root: Matrix, h: Matrix, follows: Vector, model: StepModel
) -> tuple[Matrix, Matrix]:
    """Return what is to be explained and deviations of simulated logs, (logs, N, n) each."""
    half = np.random.default_rng(0).standard_normal((len(h), _LOGS // 2, h.shape[1])) @ root.T
    y = np.concatenate([half, -half], axis=1) + drift
    e = np.empty_like(y)
    back, onward = (model.B @ gain).T, model.A.T
    for k, has_past in enumerate(follows):
        e[k] = e[k - 1] @ onward + y[k - 1] if has_past else h[k]
        y[k] += e[k] @ back
    return y.transpose(1, 0, 2), e.transpose(1, 0, 2)
