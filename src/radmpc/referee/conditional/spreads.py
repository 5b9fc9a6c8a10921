"""How uncertain rows are, given what was measured, and how rows in sequence correlate."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.referee.conditional.loops import Since
from radmpc.referee.conditional.rows import HalfspaceRows, Parties

__all__ = ["correlations", "deviations_of"]


def deviations_of(rows: HalfspaceRows, parties: Parties, noise: Since) -> Vector:
    """Return the standard deviation of every row, (E,) [m]; 0 for rows of the past.

    Parameters
    ----------
    rows : HalfspaceRows
        E of them.
    parties : Parties
        The encounters.
    noise : Since
        What has come in since the step at which states were measured.
    """
    variances = _products(rows, parties, noise, rows.first, rows.other, rows.fresh)
    return np.asarray(np.sqrt(variances.clip(min=0.0)))


def correlations(rows: HalfspaceRows, parties: Parties, noise: Since, spread: Vector) -> Vector:
    """Return the correlation of every row with the one before it, (E,); 0 where there is none.

    Parameters
    ----------
    rows : HalfspaceRows
        E of them.
    parties : Parties
        The encounters.
    noise : Since
        What has come in since the step at which states were measured.
    spread : (E,) array
        Their standard deviations [m].
    """
    crossed = _products(rows, parties, noise, rows.link_first, rows.link_other, rows.link_fresh)
    scale = np.where(rows.before >= 0, spread * spread[rows.before], 0.0)
    found = np.clip(crossed / np.where(scale > 0.0, scale, 1.0), -1.0, 1.0)
    return np.asarray(np.where(scale > 0.0, np.where(rows.nested, 1.0, found), 0.0))


def _products(
    rows: HalfspaceRows,
    parties: Parties,
    noise: Since,
    first: Matrix,
    other: Matrix,
    fresh: Vector,
) -> Vector:
    """Return covariances of rows with others on the same deviations, (E,) [m²]."""
    result = np.zeros(len(rows.windows))
    coming = np.flatnonzero(rows.windows >= noise.step)
    steps = rows.windows[coming] - noise.step
    encounters = rows.encounters[coming]
    total = fresh[coming] + _squares(
        noise, steps, parties.first[encounters], rows.first[coming], first[coming]
    )
    pairs = np.flatnonzero(parties.are_pairs[encounters])
    at = coming[pairs]
    total[pairs] += _squares(
        noise, steps[pairs], parties.other[encounters[pairs]], rows.other[at], other[at]
    )
    result[coming] = total
    return result


def _squares(
    noise: Since, steps: Indices, vehicles: Indices, left: Matrix, right: Matrix
) -> Vector:
    """Return ``left Σ right`` of rows, each at its step and vehicle."""
    turned = np.matmul(left[:, None, :], noise.covariances[steps, vehicles])[:, 0]
    return np.asarray((turned * right).sum(axis=1))
