r"""Process and measurement noise told apart by how residuals follow each other.

With states measured as :math:`x_k + m_k`, what the dynamics leave unexplained is
:math:`w_k + m_{k+1} - A m_k`: white disturbances have the same power at all frequencies,
measurement noise has most of it where the state changes its direction every step. The spectrum is
linear in both covariances, and Fisher scoring maximizes Whittle's likelihood over them.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Matrix
from radmpc.identification.intervals import Interval, normal_interval
from radmpc.identification.sharing import nearest_covariance

__all__ = ["by_another_sensor", "by_spectrum"]

_TAPER = 0.2
"""Share of a run [-] that is faded in and out: without it power leaks to low frequencies, where
measurement noise has none, and counts as disturbance."""

_LEAST_RUN = 16
"""Steps of the shortest run whose spectrum is looked at."""

_ROUNDS = 30
"""Most rounds of scoring; five to ten suffice."""

_DONE = 1e-8
"""Relative change [-] of the covariances that ends the scoring."""

Spectra = npt.NDArray[np.complex128]


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
    angles, waves, loss = _spectra([piece / scale for piece in pieces])
    basis = _basis(angles, relative)
    start = _by_moments([piece / scale for piece in pieces], relative)
    entries, deviations = _scored(start, basis, waves)
    half = len(entries) // 2
    both = []
    for part in (slice(0, half), slice(half, None)):
        value = _matrix(entries[part], len(scale)) * np.outer(scale, scale)
        width = _matrix(deviations[part], len(scale)) * np.outer(scale, scale)
        both.append(normal_interval(value, np.sqrt(loss) * width))
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


def _spectra(pieces: Sequence[Matrix]) -> tuple[Matrix, Spectra, float]:
    """Return frequencies, waves of unit mean power there, and what the taper costs."""
    angles, waves, losses = [], [], []
    for piece in pieces:
        n = len(piece)
        edge = 0.5 * _TAPER * n
        place = np.minimum(np.arange(n) + 0.5, n - np.arange(n) - 0.5) / edge
        taper = np.where(place < 1.0, 0.5 - 0.5 * np.cos(np.pi * place), 1.0)
        wave = np.fft.fft(piece * taper[:, None], axis=0) / np.sqrt(np.sum(taper**2))
        half = np.arange(1, (n - 1) // 2 + 1)
        angles.append(2.0 * np.pi * half / n)
        waves.append(wave[half])
        losses.append(n * float(np.sum(taper**4)) / float(np.sum(taper**2)) ** 2)
    weights = [len(piece) for piece in pieces]
    return np.concatenate(angles), np.concatenate(waves), float(np.average(losses, weights=weights))


def _basis(angles: Matrix, A: Matrix) -> Spectra:
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


def _scored(start: Matrix, basis: Spectra, waves: Spectra) -> tuple[Matrix, Matrix]:
    """Return the likeliest entries and their standard deviations."""
    entries = start
    badness = _badness(entries, basis, waves)
    information = np.eye(len(entries))
    for _ in range(_ROUNDS):
        inverse = np.linalg.inv(np.einsum("a,akij->kij", entries, basis))
        scaled = np.einsum("kij,akjl->akil", inverse, basis, optimize=True)
        seen = np.einsum("kij,kj->ki", inverse, waves)
        score = np.einsum("ki,akij,kj->a", seen.conj(), basis, seen, optimize=True).real
        score -= np.einsum("akii->a", scaled).real
        information = np.einsum("akij,bkji->ab", scaled, scaled, optimize=True).real
        step = np.linalg.lstsq(information, score, rcond=None)[0]
        share = 1.0
        while share > 1e-4:
            tried = entries + share * step
            found = _badness(tried, basis, waves)
            if found <= badness:
                break
            share *= 0.5
        else:
            break
        change = float(np.abs(tried - entries).max())
        entries, badness = tried, found
        if change < _DONE * float(np.abs(entries).max()):
            break
    deviations = np.sqrt(np.maximum(np.diag(np.linalg.pinv(information, hermitian=True)), 0.0))
    return entries, deviations


def _badness(entries: Matrix, basis: Spectra, waves: Spectra) -> float:
    """Return minus Whittle's log-likelihood; inf where a spectrum is not positive definite."""
    spectra = np.einsum("a,akij->kij", entries, basis)
    values, vectors = np.linalg.eigh(spectra)
    if values.min() <= 0.0:
        return np.inf
    turned = np.einsum("kij,ki->kj", vectors.conj(), waves)
    return float(np.sum(np.log(values)) + np.sum(np.abs(turned) ** 2 / values))


def _matrix(upper: Matrix, n: int) -> Matrix:
    """Return a symmetric matrix of its upper triangle."""
    full = np.zeros((n, n))
    full[np.triu_indices(n)] = upper
    return full + np.triu(full, 1).T
