r"""Process and measurement noise told apart by how residuals follow each other.

With states measured as :math:`x_k + m_k`, what the dynamics leave unexplained is
:math:`w_k + m_{k+1} - A m_k`: white disturbances have the same power at all frequencies,
measurement noise has most of it where the state changes its direction every step.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.identification.intervals import Interval, covariance_interval, normal_interval
from radmpc.identification.model import StepModel
from radmpc.identification.sharing import nearest_covariance
from radmpc.identification.spectra import LEAST_RUN, spectra
from radmpc.identification.whittle import Whittle

__all__ = ["by_another_sensor", "by_spectrum", "measured_noise", "not_negative"]


def measured_noise(
    pieces: Sequence[Matrix], offsets: Sequence[Matrix | None], model: StepModel, *, opposes: bool
) -> tuple[Interval, Interval] | None:
    """Return disturbance and measurement noise where there is a sign of the latter.

    Parameters
    ----------
    pieces : sequence of (k, n) array
        Residuals with mean zero, a piece per run without a gap.
    offsets : sequence of (k, d) array or None
        For each piece the first sensor less the second at the beginning of every step [m]; None
        where there was no second one.
    model : StepModel
        Dynamics.
    opposes : bool
        Whether residuals of successive steps oppose each other beyond chance.

    Returns
    -------
    tuple of Interval or None
        W and R.
    """
    known = [offset for offset in offsets if offset is not None]
    if len(known) == len(offsets):
        return _by_two(np.concatenate(pieces), np.concatenate(known), model)
    return by_spectrum(pieces, model.A) if opposes else None


def _by_two(noise: Matrix, offsets: Matrix, model: StepModel) -> tuple[Interval, Interval] | None:
    """Return the same where a second sensor was logged."""
    d, n = model.dimension, model.num_states
    seen = by_another_sensor(noise[:, :d], offsets)
    if not np.any(np.diag(seen.low) > 0.0):
        return None
    value, width = np.zeros((n, n)), np.zeros((n, n))
    value[:d, :d], width[:d, :d] = seen.value, seen.high - seen.value
    steps = len(noise)
    total = noise.T @ noise / max(steps - 1, 1)
    W = total - value - model.A @ value @ model.A.T
    own = covariance_interval(total, float(steps))
    # Both parts are uncertain; they hang together little where W is not small beside R.
    deviation = np.hypot(0.5 * (own.high - own.low), width + model.A @ width @ model.A.T)
    return not_negative(W, deviation), Interval(value, value - width, value + width)


def by_spectrum(pieces: Sequence[Matrix], A: Matrix) -> tuple[Interval, Interval] | None:
    """Return the covariances of disturbance and measurement noise.

    Both values are positive definite. Where one hides the other, a variance's interval begins at
    zero and ends where spectra would be too unlikely.

    Parameters
    ----------
    pieces : sequence of (k, n) array
        Residuals with mean zero, a piece per run without a gap.
    A : (n, n) array
        State matrix.

    Returns
    -------
    tuple of Interval or None
        W and R; None where runs are too short.
    """
    pieces = [piece for piece in pieces if len(piece) >= LEAST_RUN]
    if not pieces:
        return None
    scale = np.concatenate(pieces).std(axis=0)
    scale = np.maximum(scale, 1e-9 * max(float(scale.max()), 1e-150))
    scaled, relative = [piece / scale for piece in pieces], A * scale / scale[:, None]
    units = _units(len(scale))
    whittle = Whittle(spectra(scaled, relative, units), units)
    entries = whittle.likeliest(_by_moments(scaled, relative))
    middle, deviations = whittle.unbounded(entries)
    around, beside = normal_interval(entries, deviations), normal_interval(middle, deviations)
    low, high = np.array(around.low), np.array(around.high)
    rows, columns = np.triu_indices(len(scale))
    variances = np.flatnonzero(np.tile(rows == columns, 2))
    low[variances] = np.maximum(low[variances], 0.0)
    # That no covariance is indefinite pulls the other one down; its upper end must not follow.
    ends = whittle.upper_ends(entries, variances)
    high[variances] = np.maximum(ends, beside.high[variances])
    back = np.outer(scale, scale)
    half = len(units)
    W, R = (
        Interval(*(back * np.tensordot(one[part], units, 1) for one in (entries, low, high)))
        for part in (slice(0, half), slice(half, None))
    )
    return W, R


def by_another_sensor(y: Matrix, offsets: Matrix) -> Interval:
    """Return the covariance of the first sensor's noise, by what a second one says.

    The difference of both at the beginning of a step holds the noise that the step's residual has
    with the opposite sign, and nothing else that both share.

    Parameters
    ----------
    y : (N, d) array
        Residuals of the positions [m].
    offsets : (N, d) array
        First sensor less the second at the beginning of each step [m].
    """
    one, other = y - y.mean(axis=0), offsets - offsets.mean(axis=0)
    products = -one[:, :, None] * other[:, None, :]
    products = 0.5 * (products + products.transpose(0, 2, 1))
    # Neighbors share a sample of the noise: their products belong together over a step.
    centered = products - products.mean(axis=0)
    variance = np.mean(centered**2, axis=0) + 2.0 * np.mean(centered[1:] * centered[:-1], axis=0)
    floor = 0.5 * np.mean(centered**2, axis=0)
    return normal_interval(
        products.mean(axis=0), np.sqrt(np.maximum(variance, floor) / len(products))
    )


def not_negative(difference: Matrix, width: Matrix) -> Interval:
    """Return the interval of a covariance that is a difference of others: no variance is negative.

    Parameters
    ----------
    difference : (n, n) array
        Symmetric.
    width : (n, n) array
        Half the widths of its entries' intervals.
    """
    value = nearest_covariance(difference)
    low, high = np.array(difference - width), np.array(difference + width)
    np.fill_diagonal(low, np.maximum(np.diag(low), 0.0))
    return Interval(value, np.minimum(low, value), np.maximum(high, value))


def _units(n: int) -> Matrix:
    """Return the symmetric matrices of unit entries, (entries, n, n)."""
    units = [np.zeros((n, n)) for _ in range(n * (n + 1) // 2)]
    for unit, i, j in zip(units, *np.triu_indices(n), strict=True):
        unit[i, j] = unit[j, i] = 1.0
    return np.array(units)


def _by_moments(pieces: Sequence[Matrix], A: Matrix) -> Vector:
    """Return a first guess of W and R, both positive definite."""
    count = sum(len(piece) for piece in pieces)
    power = sum((piece.T @ piece for piece in pieces), np.zeros(A.shape)) / count
    next_one = sum((piece[1:].T @ piece[:-1] for piece in pieces), np.zeros(A.shape)) / count
    seen = -np.linalg.solve(A, next_one)
    floor = 0.02 * np.eye(len(A))
    R = nearest_covariance(0.5 * (seen + seen.T)) + floor
    W = nearest_covariance(power - R - A @ R @ A.T) + floor
    upper = np.triu_indices(len(A))
    return np.concatenate([W[upper], R[upper]])
