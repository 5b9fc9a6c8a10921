"""How much of the reserve for the bow each end of an interval keeps."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.special import ndtr

from radmpc.arrays import Matrix, Tensor, Vector

__all__ = ["CONTACT_TOL", "held", "in_deviations", "reserves"]

# Touching is no collision. Without noise that must not hang on the last bit of a sum.
CONTACT_TOL = 1e-9

_SHARES = (0.5, 0.0, 1.0, 0.25, 0.75)
"""Shares of the reserve that are tried for the near end besides the balanced one; any is valid."""


def in_deviations(margins: Tensor, spread: Tensor) -> Tensor:
    """Return margins in standard deviations; ±inf without noise."""
    noisy = spread > 0.0
    certain = np.where(margins < -CONTACT_TOL, -np.inf, np.inf)
    with np.errstate(over="ignore"):  # a margin of meters over a deviation of 1e-160
        scaled: Tensor = np.where(noisy, margins / np.where(noisy, spread, 1.0), certain)
    return scaled


def reserves(is_near: tuple[bool, ...], sag: Matrix, shares: Tensor | float) -> Tensor:
    """Return what each end keeps in reserve for a sag, (S, C, E) [m]."""
    near, far = 4.0 * sag * np.square(shares), 4.0 * sag * np.square(1.0 - np.asarray(shares))
    return np.stack([near if one else far for one in is_near], axis=2)


def held(
    is_near: tuple[bool, ...], margins: Matrix, spread: Matrix, sag: Vector
) -> tuple[Matrix, Vector]:
    """Return the clearances of half-spaces whose ends share the reserve as costs least.

    Parameters
    ----------
    is_near : tuple of bool
        Which of the E ends stand at the beginning of the interval.
    margins, spread : (N, E) array
        Margins without any reserve, and standard deviations along the normals [m].
    sag : (N,) array
        How far the mean curves hang toward the sets in mid-interval, > 0 [m].

    Returns
    -------
    clearances : (N, E) array
        In standard deviations, ±inf without noise.
    shares : (N,) array
        The near ends' shares θ.
    """
    balanced = _balanced(np.array(is_near), margins, spread, sag)
    shares = np.column_stack([np.tile(_SHARES, (len(sag), 1)), balanced])
    found = in_deviations(
        margins[:, None] - reserves(is_near, sag[:, None], shares), spread[:, None]
    )
    best = ndtr(-found).sum(axis=2).argmin(axis=1)
    rows = np.arange(len(sag))
    return found[rows, best], shares[rows, best]


def _balanced(
    is_near: npt.NDArray[np.bool_], margins: Matrix, spread: Matrix, sag: Vector
) -> Vector:
    """Return the shares at which near and far ends are as many deviations clear, (N,).

    With margins m and deviations σ, ``(m₀ − 4bθ²) / σ₀ = (m₁ − 4b(1 − θ)²) / σ₁`` is quadratic in
    θ. Without noise at one end this leaves there exactly what is not needed: where vehicles start
    at contact, no fixed share does.
    """
    near, far = margins[:, is_near].min(axis=1), margins[:, ~is_near].min(axis=1)
    near_spread, far_spread = spread[:, is_near].max(axis=1), spread[:, ~is_near].max(axis=1)
    scale = np.maximum(near_spread, far_spread)
    is_certain = scale <= 0.0
    scale = np.where(is_certain, 1.0, scale)
    near_spread = np.where(is_certain, 1.0, near_spread / scale)
    far_spread = np.where(is_certain, 1.0, far_spread / scale)
    most = 4.0 * sag
    slope = most * near_spread
    rest = far_spread * near - near_spread * (far - most)
    root = np.sqrt((slope**2 - most * (near_spread - far_spread) * rest).clip(min=0.0))
    total = slope + root
    return np.asarray((rest / np.where(total > 0.0, total, 1.0)).clip(0.0, 1.0))
