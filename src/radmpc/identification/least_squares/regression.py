r"""Feedback, drift and autocorrelation of the noise by generalized least squares.

The model of all steps is :math:`y_k = B K h_k + c + s_k` with stationary noise
:math:`s_{k+1} = \rho s_k + \varepsilon_k`; K, c and ρ maximize the Gaussian likelihood given the
first step of every segment.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq, minimize_scalar
from scipy.special import chdtrc, chdtri

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.identification.intervals import LEVEL, Interval, normal_interval
from radmpc.records import dataclass

__all__ = ["LEAST_CHANCE", "Fit", "ends_of_memory", "feedback_chance", "fit", "time_constant"]

_MOST_COLOR = 0.995
"""Largest autocorrelation [-] from step to step that is looked for: beyond it noise and drift
cannot be told apart in logs of any length."""

_COLORS = np.linspace(-0.3, _MOST_COLOR, 24)
"""Autocorrelations [-] that are tried before the best is refined."""

_RIVAL = 0.001
"""Probability [-] below which one maximum of the likelihood rules out another: both may be true
descriptions, and which is the larger one is chance."""

LEAST_CHANCE = 0.01
"""Probability [-] below which a closed loop is not that of a double integrator with feedback."""

_ROUNDS = 3
"""Rounds in which weights and gain improve each other; a fourth changes less than 1e-6 of them."""


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """What least squares found.

    Attributes
    ----------
    gain : (d, q) array
        Feedback K; q may be 0.
    gain_deviation : (d, q) array
        Standard deviations.
    drift, drift_deviation : (n,) array
        What every step adds, and its standard deviation.
    color, color_deviation : float
        Autocorrelation ρ from step to step, and its standard deviation.
    noise : (N, n) array
        s of every step.
    innovations : (N', n) array
        ε, of the steps that follow another one if there is color.
    """

    gain: Matrix
    gain_deviation: Matrix
    drift: Vector
    drift_deviation: Vector
    color: float
    color_deviation: float
    noise: Matrix
    innovations: Matrix


def fit(y: Matrix, h: Matrix, follows: Vector, B: Matrix, *, has_color: bool) -> Fit:
    """Return K, c and ρ of all steps.

    Parameters
    ----------
    y : (N, n) array
        What is to be explained.
    h : (N, q) array
        By what feedback may explain it.
    follows : (N,) array
        1 where a step follows the one before it, else 0.
    B : (n, d) array
        Control matrix.
    has_color : bool
        Whether ρ is looked for; else it is 0.
    """
    if not has_color:
        return _finished(y, h, B, _solved(y, h, B, 0.0, np.arange(1, len(y))), 0.0, follows)
    badness = _badness(y, h, follows, B)
    color, _ = _refined(badness, int(np.argmin([badness(float(color)) for color in _COLORS])))
    pairs = np.flatnonzero(follows)
    return _finished(y, h, B, _solved(y, h, B, color, pairs), color, follows)


def ends_of_memory(y: Matrix, h: Matrix, follows: Vector, B: Matrix) -> tuple[Fit, Fit]:
    """Return K, c and ρ with the shortest and with the longest memory that the steps allow.

    Positions alone are explained as well if feedback and memory change places: the likelihood may
    have two maxima, and its 95 % region reaches from below the one to beyond the other.

    Parameters
    ----------
    y, h, follows, B
        As in `fit`.
    """
    badness, pairs = _badness(y, h, follows, B), np.flatnonzero(follows)
    values = np.array([badness(float(color)) for color in _COLORS])
    around = np.concatenate([[np.inf], values, [np.inf]])
    lows = np.flatnonzero((values <= around[:-2]) & (values <= around[2:]))
    maxima = [_refined(badness, int(at)) for at in lows]
    rival = min(value for _, value in maxima) + float(chdtri(1.0, _RIVAL)) / max(len(pairs), 1)
    likely = sorted(one for one in maxima if one[1] <= rival)
    fits = []
    for (color, value), side in ((likely[0], -1.0), (likely[-1], 1.0)):
        most = value + float(chdtri(1.0, 1.0 - LEVEL)) / max(len(pairs), 1)
        onward = np.sort(_COLORS[side * (_COLORS - color) > 0.0])[:: int(side)]
        end = _crossing(badness, most, color, onward)
        fits.append(_finished(y, h, B, _solved(y, h, B, end, pairs), end, follows))
    short, long = fits
    return short, long


def _badness(y: Matrix, h: Matrix, follows: Vector, B: Matrix) -> Callable[[float], float]:
    """Return the log-determinant of the innovations as a function of ρ."""
    pairs = np.flatnonzero(follows)

    def badness(color: float) -> float:
        """Return it at one autocorrelation."""
        _, _, innovations = _solved(y, h, B, color, pairs)
        return _log_determinant(innovations)

    return badness


def _refined(badness: Callable[[float], float], at: int) -> tuple[float, float]:
    """Return the ρ around one of those tried that is least bad, and how bad it is."""
    low, high = _COLORS[max(at - 1, 0)], _COLORS[min(at + 1, len(_COLORS) - 1)]
    best = minimize_scalar(badness, bounds=(low, high), method="bounded")
    return float(best.x), float(best.fun)


def _crossing(
    badness: Callable[[float], float], most: float, begin: float, onward: Vector
) -> float:
    """Return where it gets worse than what is likely on the way from a ρ, the last one if never."""

    def excess(color: float) -> float:
        """Return by how much it is worse at one autocorrelation."""
        return badness(color) - most

    for color in onward.tolist():
        if excess(color) > 0.0:
            return float(brentq(excess, begin, color, xtol=1e-4))
        begin = color
    return begin


Solved = tuple[Matrix, Vector, Matrix]


def _solved(y: Matrix, h: Matrix, B: Matrix, color: float, pairs: Indices) -> Solved:
    """Return gain, drift and innovations at one autocorrelation."""
    if color == 0.0:
        z, g = y, h
    else:
        z, g = y[pairs] - color * y[pairs - 1], h[pairs] - color * h[pairs - 1]
    mean_z, mean_g = z.mean(axis=0), g.mean(axis=0)
    z, g = z - mean_z, g - mean_g
    d, q = B.shape[1], h.shape[1]
    gain = np.zeros((d, q))
    if q:
        free = np.linalg.lstsq(g, z, rcond=None)[0].T
        weight = _inverse(z - g @ free.T)
        for _ in range(_ROUNDS):
            gain = np.linalg.solve(B.T @ weight @ B, B.T @ weight @ free)
            weight = _inverse(z - g @ (B @ gain).T)
    drift = (mean_z - B @ gain @ mean_g) / (1.0 - color)
    return gain, drift, z - g @ (B @ gain).T


def _finished(
    y: Matrix, h: Matrix, B: Matrix, solved: Solved, color: float, follows: Vector
) -> Fit:
    """Return the fit with the deviations of what it found."""
    gain, drift, innovations = solved
    noise = y - h @ (B @ gain).T - drift
    d, q = gain.shape
    n = y.shape[1]
    pairs = np.flatnonzero(follows) if color != 0.0 else np.arange(len(y))
    regressors = h[pairs] - color * h[pairs - 1] if color != 0.0 else h
    columns = [np.einsum("ij,kl->kijl", B, regressors).reshape(len(pairs), n, d * q)]
    columns.append(np.broadcast_to((1.0 - color) * np.eye(n), (len(pairs), n, n)))
    if color != 0.0:
        columns.append(noise[pairs - 1][:, :, None])
    J = np.concatenate(columns, axis=2)
    weight = _inverse(innovations)
    information = np.einsum("kij,il,klm->jm", J, weight, J, optimize=True)
    deviations = _deviations(information)
    color_deviation = deviations[-1] if color != 0.0 else float("nan")
    # Least squares and the mean that is taken away make it look smaller (Kendall 1954); what all
    # axes have in common counts once, the mean of each by itself.
    small = (1.0 + color + 2.0 * color / n) / max(len(pairs), 1)
    known = color + small if color != 0.0 else 0.0
    return Fit(
        gain=gain,
        gain_deviation=deviations[: d * q].reshape(d, q),
        drift=drift,
        drift_deviation=deviations[d * q : d * q + n],
        color=min(known, _MOST_COLOR),
        color_deviation=float(color_deviation),
        noise=noise,
        innovations=innovations,
    )


def _deviations(information: Matrix) -> Vector:
    """Return the deviations that an information matrix leaves, whatever the units of its entries.

    A state that hardly has noise is known so well that a plain pseudo-inverse takes what is known
    of the others for rounding.
    """
    sizes = np.sqrt(np.diag(information))
    scale = np.where(sizes > 0.0, sizes, 1.0)
    inverse = np.linalg.pinv(information / np.outer(scale, scale), hermitian=True)
    return np.asarray(np.sqrt(np.maximum(np.diag(inverse), 0.0)) / scale)


def _inverse(residuals: Matrix) -> Matrix:
    """Return the inverse covariance of residuals, large in directions without any."""
    covariance = residuals.T @ residuals / len(residuals)
    scale = np.sqrt(_variances(covariance))
    relative = covariance / np.outer(scale, scale)
    values, vectors = np.linalg.eigh(relative)
    root = vectors / np.sqrt(np.maximum(values, 1e-9))
    return np.asarray((root @ root.T) / np.outer(scale, scale))


def _log_determinant(residuals: Matrix) -> float:
    """Return the log-determinant of the residuals' covariance."""
    covariance = residuals.T @ residuals / len(residuals)
    scale = _variances(covariance)
    relative = covariance / np.sqrt(np.outer(scale, scale))
    values = np.maximum(np.linalg.eigvalsh(relative), 1e-9)
    return float(np.sum(np.log(values)) + np.sum(np.log(scale)))


def _variances(covariance: Matrix) -> Vector:
    """Return the diagonal, where it is zero a tiny share of the largest."""
    variances = np.diag(covariance)
    return np.maximum(variances, max(1e-20 * float(variances.max(initial=0.0)), 1e-200))


def feedback_chance(found: Fit, y: Matrix, h: Matrix, follows: Vector) -> float:
    """Return the chance of such residuals if position and velocity are driven by K alone.

    Parameters
    ----------
    found : Fit
        Of the steps.
    y, h, follows : (N, n), (N, q), (N,) array
        As it was fitted to.

    Returns
    -------
    float
        NaN without velocities.
    """
    color, d = found.color, found.gain.shape[0]
    n, q = y.shape[1], h.shape[1]
    if n == d:
        return float("nan")
    pairs = np.flatnonzero(follows) if color != 0.0 else np.arange(len(y))
    z = y[pairs] - color * y[pairs - 1] if color != 0.0 else y
    g = h[pairs] - color * h[pairs - 1] if color != 0.0 else h
    z, g = z - z.mean(axis=0), g - g.mean(axis=0)
    rest = z - g @ np.linalg.lstsq(g, z, rcond=None)[0]
    bound = found.innovations - found.innovations.mean(axis=0)
    gained = np.linalg.slogdet(bound.T @ bound)[1] - np.linalg.slogdet(rest.T @ rest)[1]
    statistic = max((len(z) - q - 1) * gained, 0.0) if np.isfinite(gained) else 0.0
    return float(chdtrc(q * (n - d), statistic))


def time_constant(found: Fit, dt: float) -> Interval | None:
    """Return τ of ρ = exp(−dt/τ) [s]; None without color.

    Parameters
    ----------
    found : Fit
        With its color.
    dt : float
        Step [s].
    """
    if found.color <= 0.0:
        return None
    # Of an autocorrelation's arcsine the deviation is nearly the same everywhere.
    angle = float(np.arcsin(found.color))
    turned = normal_interval(angle, found.color_deviation / np.sqrt(1.0 - found.color**2))
    parts = (turned.value, turned.low, turned.high)
    colors = np.clip(np.sin(np.clip(parts, 0.0, 0.5 * np.pi)), 1e-9, 1.0 - 1e-9)
    ends = [-dt / np.log(color) for color in colors]
    return Interval(*map(np.asarray, ends))
