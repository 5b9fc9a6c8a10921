"""How uncertain rows are, given what was measured, and how rows in sequence correlate."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.referee.conditional.loops import Since
from radmpc.referee.conditional.rows import HalfspaceRows, Parties

__all__ = ["correlations", "deviations_before", "deviations_of"]

_NOTHING = 1e-13
"""Share of the sum of two vehicles' variances below which what is left of it is rounding [-]."""


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
    states = rows.first, rows.other
    variances = _products(rows, parties, noise, states, states, rows.fresh)
    return np.asarray(np.sqrt(variances.clip(min=0.0)))


def deviations_before(rows: HalfspaceRows, parties: Parties, noise: Since) -> Vector:
    """Return the standard deviations of rows before, as they end the step before, (E,) [m].

    Parameters
    ----------
    rows : HalfspaceRows
        E of them.
    parties : Parties
        The encounters.
    noise : Since
        What has come in since the step at which states were measured.
    """
    links = rows.link_first, rows.link_other
    variances = _products(rows, parties, noise, links, links, rows.link_rest)
    return np.asarray(np.sqrt(variances.clip(min=0.0)))


def correlations(
    rows: HalfspaceRows, parties: Parties, noise: Since, spread: Vector, before: Vector
) -> Vector:
    """Return the correlation of every row with the one before it, (E,); 0 where there is none.

    Parameters
    ----------
    rows : HalfspaceRows
        E of them.
    parties : Parties
        The encounters.
    noise : Since
        What has come in since the step at which states were measured.
    spread, before : (E,) array
        Their standard deviations, and those of the rows before [m].
    """
    links = rows.link_first, rows.link_other
    crossed = _products(rows, parties, noise, (rows.first, rows.other), links, rows.link_fresh)
    scale = np.where(rows.before >= 0, spread * before, 0.0)
    found = np.clip(crossed / np.where(scale > 0.0, scale, 1.0), -1.0, 1.0)
    return np.asarray(np.where(scale > 0.0, np.where(rows.nested, 1.0, found), 0.0))


def _products(
    rows: HalfspaceRows,
    parties: Parties,
    noise: Since,
    left: tuple[Matrix, Matrix],
    right: tuple[Matrix, Matrix],
    fresh: Vector,
) -> Vector:
    """Return covariances of rows with others on the same deviations, (E,) [m²].

    ``left`` and ``right`` hold rows on the state of the vehicle and, the sign turned, of the other.
    """
    result = np.zeros(len(rows.windows))
    coming = np.flatnonzero(rows.windows >= noise.step)
    steps = rows.windows[coming] - noise.step
    encounters = rows.encounters[coming]
    total = fresh[coming] + _squares(
        noise.covariances[steps, parties.first[encounters]], left[0][coming], right[0][coming]
    )
    pairs = np.flatnonzero(parties.are_pairs[encounters])
    at, when = coming[pairs], steps[pairs]
    total[pairs] += _squares(
        noise.covariances[when, parties.other[encounters[pairs]]], left[1][at], right[1][at]
    )
    if noise.crossed is not None:
        met = noise.crossed[when, encounters[pairs]]
        both = _squares(met, left[0][at], right[1][at])
        both += _squares(met, right[0][at], left[1][at])
        apart = total[pairs] - both
        # Where all but rounding cancels, nothing is left.
        total[pairs] = np.where(np.abs(apart) <= _NOTHING * np.abs(total[pairs]), 0.0, apart)
    result[coming] = total
    return result


def _squares(covariances: Tensor, left: Matrix, right: Matrix) -> Vector:
    """Return ``left Σ right`` row by row."""
    turned = np.matmul(left[:, None, :], covariances)[:, 0]
    return np.asarray((turned * right).sum(axis=1))
