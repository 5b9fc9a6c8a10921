"""Cheap controls between two states: a few reweighted least-norm solves for many pairs at once."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Tensor

__all__ = ["ROUNDS", "connect"]

ROUNDS = 5
"""Reweighted solves [-]: more concentrate the effort in fewer controls, and take time in
proportion."""

_RIDGE = 1e-11
"""Ridge added to the Gram matrix, as a share of its trace [-]: with larger ones point goals are
missed by more, with smaller ones dependent rows make it singular."""

_SPARSE = 1e-3
"""Weight that a control of size 0 keeps [-]; without any it would stay 0."""

_FREE = 100.0
"""Weight of columns that cost nothing [-]; controls weigh at most their limits."""


def connect(
    rows: Tensor, needs: Matrix, limits: Matrix, rounds: int = ROUNDS, free: int = 0
) -> Matrix:
    """Return controls of little cost with ``rows @ u = needs``, as far as limits allow.

    The least-norm controls, then reweighted by their own size: small ones shrink, as in the
    cheapest controls, of which few are not 0. The caller checks whether limits and rows hold.

    Parameters
    ----------
    rows : (s or 1, q, c) array
        Coefficients.
    needs : (s, q) array
        Right sides.
    limits : (s, c) array
        Largest |u|; 0 where there is none.
    rounds : int
        How often to solve.
    free : int
        How many of the last columns cost nothing.

    Returns
    -------
    (s, c) array
        Controls within their limits.
    """
    is_free = np.arange(limits.shape[1]) >= limits.shape[1] - free
    largest = np.maximum(limits, 1e-12)
    weights = np.where(is_free, _FREE, limits)
    held = np.zeros(limits.shape)
    controls = _least_norm(rows, needs, weights)
    for last in range(1, rounds + 1):
        over = np.abs(controls) > limits
        controls = np.clip(controls, -limits, limits)
        if last == rounds:
            break
        # What would exceed its limit stays there; the others make up for it.
        held = np.where(over, controls, held)
        shares = np.abs(controls) / largest
        # The power of the least sum is 1; a higher one gets to few controls in fewer rounds.
        weights = np.where(is_free, _FREE, limits * (shares * np.sqrt(shares) + _SPARSE))
        weights = np.where(held == 0.0, weights, 0.0)
        controls = held + _least_norm(rows, needs - _product(rows, held), weights)
    # Once more for what the ridge left over, or goals that are points would be missed.
    rest = _least_norm(rows, needs - _product(rows, controls), weights)
    return np.clip(controls + rest, -limits, limits)


def _least_norm(rows: Tensor, needs: Matrix, weights: Matrix) -> Matrix:
    """Return the controls of least weighted norm that satisfy the rows, (s, c)."""
    transposed = np.swapaxes(rows, 1, 2)
    gram = (rows * weights[:, None, :]) @ transposed
    ridge = _RIDGE * (np.trace(gram, axis1=1, axis2=2) + 1e-12)
    forces = np.linalg.solve(gram + ridge[:, None, None] * np.eye(gram.shape[1]), needs[:, :, None])
    controls: Matrix = weights * (transposed @ forces)[:, :, 0]
    return controls


def _product(rows: Tensor, controls: Matrix) -> Matrix:
    """Return ``rows @ u`` of each course, (s, q)."""
    return np.asarray((rows @ controls[:, :, None])[:, :, 0])
