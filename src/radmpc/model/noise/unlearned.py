"""What measurements leave open of a covariance, without what only rounding leaves of it."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix

__all__ = ["surprised", "unlearned"]

_ROUNDING = 1e-14
"""Share of a variance that may be left of it by rounding alone [-]: some 2e-16 for each of a dozen
sums. The deviation is a ten-millionth of what it was."""


def surprised(matrix: Matrix, ahead: Matrix, error: Matrix) -> Matrix:
    """Return the covariance of what is measured, (p, p); 0 of what was known but for rounding.

    Parameters
    ----------
    matrix : (p, n) array
        What is seen of the state.
    ahead : (n, n) array
        Covariance of what is not known of the state.
    error : (p, p) array
        Covariance of the sensor's noise.
    """
    found = matrix @ ahead @ matrix.T + error
    most = np.square(np.abs(matrix) @ np.sqrt(np.diag(ahead).clip(min=0.0)))
    still = np.diag(found) <= _ROUNDING * most
    found[still] = found[:, still] = 0.0
    return np.asarray(0.5 * (found + found.T))


def unlearned(ahead: Matrix, learned: Matrix) -> Matrix:
    """Return the covariance of what is not known after a measurement, (q, q).

    Directions of which nothing is left but rounding have none: what was seen without error would
    otherwise seem to be noise of 1e-12 m, or of a negative variance.

    Parameters
    ----------
    ahead : (q, q) array
        Before it.
    learned : (q, q) array
        What it takes off.
    """
    left = np.asarray(0.5 * (ahead - learned + (ahead - learned).T))
    variances = np.diag(ahead)
    noisy = np.flatnonzero(variances > 0.0)
    # In units of its own each coordinate counts alike, be it a place or a speed.
    units = np.sqrt(variances[noisy])
    values, vectors = np.linalg.eigh(left[np.ix_(noisy, noisy)] / np.outer(units, units))
    if not np.any(values <= _ROUNDING):
        return left
    kept = values > _ROUNDING
    root = units[:, None] * vectors[:, kept] * np.sqrt(values[kept])
    root[np.square(root).sum(axis=1) <= _ROUNDING * np.square(units)] = 0.0
    found = np.zeros_like(left)
    found[np.ix_(noisy, noisy)] = root @ root.T
    return found
