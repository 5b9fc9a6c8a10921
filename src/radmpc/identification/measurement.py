r"""Process and measurement noise told apart by how residuals follow each other.

With states measured as :math:`x_k + m_k`, what the dynamics leave unexplained is
:math:`w_k + m_{k+1} - A m_k`: white disturbances have the same power at all frequencies,
measurement noise has most of it where the state changes its direction every step. The spectrum is
linear in both covariances, and Fisher scoring maximizes Whittle's likelihood over them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Matrix, Vector
from radmpc.identification.intervals import Interval, normal_interval
from radmpc.identification.sharing import nearest_covariance

__all__ = ["by_another_sensor", "by_spectrum"]

_TAPER = 0.2
"""Share of a run [-] that is faded in and out: without it power leaks to low frequencies, where
measurement noise has none, and counts as disturbance."""

_LEAST_RUN, _LONGEST_RUN = 16, 1024
"""Steps of the shortest and the longest run whose spectrum is looked at: longer ones tell nothing
more, and take memory."""

_ROUNDS = 30
"""Most rounds of scoring; five to ten suffice."""

_DONE = 1e-8
"""Relative change [-] of the covariances that ends the scoring."""

Complex = npt.NDArray[np.complex128]


class _Spectra(NamedTuple):
    """Frequencies [rad/step], mean power there, of how many runs, and what the taper costs."""

    angles: Vector
    powers: Complex
    weights: Vector
    loss: float


def by_spectrum(pieces: Sequence[Matrix], A: Matrix) -> tuple[Interval, Interval] | None:
    """Return the covariances of disturbance and measurement noise.

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
    pieces = [piece for piece in pieces if len(piece) >= _LEAST_RUN]
    if not pieces:
        return None
    scale = np.concatenate(pieces).std(axis=0)
    scale = np.maximum(scale, 1e-9 * max(float(scale.max()), 1e-150))
    relative = A * scale / scale[:, None]
    seen = _spectra([piece / scale for piece in pieces])
    start = _by_moments([piece / scale for piece in pieces], relative)
    entries, deviations = _scored(start, _basis(seen.angles, relative), seen)
    half = len(entries) // 2
    both = []
    for part in (slice(0, half), slice(half, None)):
        value = _matrix(entries[part], len(scale)) * np.outer(scale, scale)
        width = _matrix(deviations[part], len(scale)) * np.outer(scale, scale)
        both.append(normal_interval(value, np.sqrt(seen.loss) * width))
    return both[0], both[1]


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


def _spectra(pieces: Sequence[Matrix]) -> _Spectra:
    """Return the mean spectra of runs of equal lengths, and what the taper costs."""
    runs: dict[int, list[Matrix]] = {}
    for piece in pieces:
        length = _run_length(len(piece))
        blocks = [piece[k : k + length] for k in range(0, len(piece) - length + 1, length)]
        runs.setdefault(length, []).extend(blocks)
    angles, powers, weights, losses = [], [], [], []
    for length, blocks in runs.items():
        edge = 0.5 * _TAPER * length
        order = np.arange(length)
        place = np.minimum(order + 0.5, length - order - 0.5) / edge
        taper = np.where(place < 1.0, 0.5 - 0.5 * np.cos(np.pi * place), 1.0)
        half = np.arange(1, (length - 1) // 2 + 1)
        waves = np.fft.fft(np.array(blocks) * taper[:, None], axis=1)[:, half]
        waves /= np.sqrt(np.sum(taper**2))
        angles.append(2.0 * np.pi * half / length)
        powers.append(np.einsum("bki,bkj->kij", waves, waves.conj()) / len(blocks))
        weights.append(np.full(len(half), float(len(blocks))))
        losses.append(length * float(np.sum(taper**4)) / float(np.sum(taper**2)) ** 2)
    loss = float(np.average(losses, weights=[float(weight.sum()) for weight in weights]))
    return _Spectra(np.concatenate(angles), np.concatenate(powers), np.concatenate(weights), loss)


def _run_length(steps: int) -> int:
    """Return the length of the runs that a piece is cut into: few different ones in all."""
    round_to = _LEAST_RUN if steps <= 16 * _LEAST_RUN else 4 * _LEAST_RUN
    return min(steps // round_to * round_to, _LONGEST_RUN)


def _basis(angles: Vector, A: Matrix) -> Complex:
    """Return the spectra of unit entries of W and R, (entries, frequencies, n, n)."""
    n = len(A)
    turn = np.exp(1j * angles)[:, None, None] * np.eye(n) - A
    flat, seen = [], []
    for i, j in zip(*np.triu_indices(n), strict=True):
        unit = np.zeros((n, n))
        unit[i, j] = unit[j, i] = 1.0
        flat.append(np.broadcast_to(unit.astype(np.complex128), (len(angles), n, n)))
        seen.append(turn @ unit @ turn.conj().transpose(0, 2, 1))
    return np.array(flat + seen)


def _by_moments(pieces: Sequence[Matrix], A: Matrix) -> Matrix:
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


def _scored(start: Matrix, basis: Complex, seen: _Spectra) -> tuple[Matrix, Matrix]:
    """Return the likeliest entries and their standard deviations."""
    entries, badness = start, _badness(start, basis, seen)
    information = np.eye(len(entries))
    for _ in range(_ROUNDS):
        score, information = _slope(entries, basis, seen)
        step = np.linalg.lstsq(information, score, rcond=None)[0]
        share = 1.0
        while share > 1e-4 and _badness(entries + share * step, basis, seen) > badness:
            share *= 0.5
        if share <= 1e-4:
            break
        entries = entries + share * step
        badness = _badness(entries, basis, seen)
        if float(np.abs(share * step).max()) < _DONE * float(np.abs(entries).max()):
            break
    deviations = np.sqrt(np.maximum(np.diag(np.linalg.pinv(information, hermitian=True)), 0.0))
    return entries, deviations


def _slope(entries: Matrix, basis: Complex, seen: _Spectra) -> tuple[Matrix, Matrix]:
    """Return the gradient of Whittle's log-likelihood and its expected curvature."""
    inverse = np.linalg.inv(np.einsum("a,akij->kij", entries, basis))
    scaled = inverse @ basis
    rest = inverse @ seen.powers - np.eye(len(inverse[0]))
    weighed = seen.weights[:, None, None] * rest
    score = np.einsum("akij,kji->a", scaled, weighed, optimize=True).real
    flat = (np.sqrt(seen.weights)[:, None, None] * scaled).reshape(len(entries), -1)
    turned = (np.sqrt(seen.weights)[:, None, None] * scaled).transpose(0, 1, 3, 2)
    return score, (flat @ turned.reshape(len(entries), -1).T).real


def _badness(entries: Matrix, basis: Complex, seen: _Spectra) -> float:
    """Return minus Whittle's log-likelihood; inf where a spectrum is not positive definite."""
    values, vectors = np.linalg.eigh(np.einsum("a,akij->kij", entries, basis))
    if values.min() <= 0.0:
        return np.inf
    turned = np.einsum("kji,kjl,kli->ki", vectors.conj(), seen.powers, vectors, optimize=True)
    return float(np.sum(seen.weights[:, None] * (np.log(values) + turned.real / values)))


def _matrix(upper: Matrix, n: int) -> Matrix:
    """Return a symmetric matrix of its upper triangle."""
    full = np.zeros((n, n))
    full[np.triu_indices(n)] = upper
    return full + np.triu(full, 1).T
