"""The reserve for the sagitta, and how the two ends of an interval share it."""

from __future__ import annotations

from functools import reduce

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.referee.tails import exceeding

__all__ = ["CONTACT_TOL", "held", "in_deviations", "reserves"]

CONTACT_TOL = 1e-9
"""Overlap that counts as touching [m], which is no collision: without noise the verdict must not
depend on the last bit of a sum."""

_SHARES = (0.5, 0.0, 1.0, 0.25, 0.75)
"""Shares of the reserve that are tried for the near end besides the balanced one; any is valid."""


def in_deviations(margins: Tensor, spread: Tensor) -> Tensor:
    """Return margins in standard deviations; ±inf without noise.

    Parameters
    ----------
    margins : array
        Any shape [m].
    spread : array
        Standard deviations [m], of the same shape.
    """
    noisy = spread > 0.0
    with np.errstate(over="ignore"):  # a margin of meters over a deviation of 1e-160
        if noisy.all():
            return np.asarray(margins / spread)
        certain = np.where(margins < -CONTACT_TOL, -np.inf, np.inf)
        scaled: Tensor = np.where(noisy, margins / np.where(noisy, spread, 1.0), certain)
    return scaled


def reserves(is_near: tuple[bool, ...], sagitta: Matrix, shares: Tensor | float) -> Tensor:
    """Return what each end keeps in reserve for the sagitta, (S, C, E), ends first in memory [m].

    Parameters
    ----------
    is_near : tuple of bool
        Of each of E ends, whether it is the near one of its interval.
    sagitta : (S, C) array
        Of the mean curve across each half-space [m].
    shares : (S, C) array or float
        Share θ of the reserve that near ends keep.
    """
    near, far = (
        4.0 * sagitta * np.square(shares),
        4.0 * sagitta * np.square(1.0 - np.asarray(shares)),
    )
    return np.array([near if one else far for one in is_near]).transpose(1, 2, 0)


def held(
    is_near: tuple[bool, ...],
    margins: Matrix,
    spread: Matrix,
    sagitta: Vector,
    samples: int | None = None,
) -> tuple[Matrix, Vector]:
    """Return the clearances of half-spaces whose ends share the reserve at the least risk.

    Parameters
    ----------
    is_near : tuple of bool
        Which of the E ends stand at the beginning of the interval.
    margins, spread : (N, E) array
        Margins without any reserve, and standard deviations along the normals [m].
    sagitta : (N,) array
        Deviation of the mean curves from their chords toward the sets in mid-interval, > 0 [m].
    samples : int or None
        Independent steps ν that covariances were estimated from; None is that they are known.

    Returns
    -------
    clearances : (N, E) array
        In standard deviations, ±inf without noise.
    shares : (N,) array
        The near ends' shares θ.
    """
    margins, spread = margins.T, spread.T
    shares = np.empty((len(_SHARES) + 1, len(sagitta)))
    shares[:-1] = np.array(_SHARES)[:, None]
    shares[-1] = _balanced(is_near, margins, spread, sagitta)
    kept = reserves(is_near, sagitta, shares).transpose(2, 0, 1)
    found = in_deviations(margins[:, None] - kept, spread[:, None])
    best = reduce(np.add, exceeding(found, samples)).argmin(axis=0)
    rows = np.arange(len(sagitta))
    return found[:, best, rows].T, shares[best, rows]


def _balanced(
    is_near: tuple[bool, ...], margins: Matrix, spread: Matrix, sagitta: Vector
) -> Vector:
    """Return the shares at which near and far ends are as many deviations clear, (N,); by ends.

    With margins m and deviations σ, ``(m₀ − 4bθ²) / σ₀ = (m₁ − 4b(1 − θ)²) / σ₁`` is quadratic in
    θ. Without noise at one end this leaves there exactly what is not needed: where vehicles start
    at contact, no fixed share does.
    """
    first, last = [e for e, one in enumerate(is_near) if one], is_near.index(False)
    near, near_spread = margins[first].min(axis=0), spread[first].max(axis=0)
    far, far_spread = margins[last], spread[last]
    scale = np.maximum(near_spread, far_spread)
    is_certain = scale <= 0.0
    scale = np.where(is_certain, 1.0, scale)
    near_spread = np.where(is_certain, 1.0, near_spread / scale)
    far_spread = np.where(is_certain, 1.0, far_spread / scale)
    most = 4.0 * sagitta
    slope = most * near_spread
    rest = far_spread * near - near_spread * (far - most)
    root = np.sqrt((slope**2 - most * (near_spread - far_spread) * rest).clip(min=0.0))
    total = slope + root
    return np.asarray((rest / np.where(total > 0.0, total, 1.0)).clip(0.0, 1.0))
