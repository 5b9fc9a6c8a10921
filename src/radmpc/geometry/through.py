"""Which straight ways lead through a convex piece, however thin it is."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Matrix
from radmpc.geometry.polytope import Polytope

__all__ = ["leads_through"]

_TOUCHED = 1e-9
"""Distance up to which a piece is touched [m]."""


def leads_through(piece: Polytope, begins: Matrix, ends: Matrix) -> npt.NDArray[np.bool_]:
    """Whether straight ways meet a piece.

    Parameters
    ----------
    piece : Polytope
        The piece.
    begins, ends : (k, d) array
        Ends of the ways [m].

    Returns
    -------
    (k,) bool array
        True, too, where a way only touches it.
    """
    first = begins @ piece.normals.T - piece.offsets - _TOUCHED
    last = ends @ piece.normals.T - piece.offsets - _TOUCHED
    fall = first - last
    shares = first / np.where(fall == 0.0, 1.0, fall)
    # Below a face all the way, or above it: then it is nowhere within.
    enters = np.where(fall > 0.0, shares, np.where((fall == 0.0) & (first > 0.0), np.inf, 0.0))
    leaves = np.where(fall < 0.0, shares, 1.0)
    found = np.maximum(enters.max(axis=1), 0.0) <= np.minimum(leaves.min(axis=1), 1.0)
    return np.asarray(found)
