"""Violations of alternatives at a point, at given margins, and which alternatives are possible."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from radmpc.arrays import Indices, Integers, Vector
from radmpc.program.program import DisjunctiveProgram

__all__ = [
    "alternative_table",
    "least_violated",
    "possible_alternatives",
    "violations_of",
    "violations_of_outputs",
]

_REACH_TOL = 1e-6
"""Violation at the best of the reachable outputs from which an alternative is impossible [m]: the
bounds of outputs are exact only up to rounding."""

_BLOCK = 50_000
"""Rows that are looked at at a time [-]: a few arrays as long as their entries are made."""


def violations_of(program: DisjunctiveProgram, margins: Vector, z: Vector) -> Vector:
    """Return by how much each alternative is violated at a point.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    margins : (r,) array
        Back-off of each row [m].
    z : (n,) array
        The point.

    Returns
    -------
    (a,) array
        The worst of each alternative's rows [m]; negative is slack.
    """
    return violations_of_outputs(program, margins, program.outputs @ z + program.constant)


def violations_of_outputs(program: DisjunctiveProgram, margins: Vector, outputs: Vector) -> Vector:
    """Return by how much each alternative is violated at given outputs.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    margins : (r,) array
        Back-off of each row [m].
    outputs : (p,) array
        Positions and controls; no point of the program need have them.

    Returns
    -------
    (a,) array
        As in `violations_of` [m].
    """
    if program.num_alternatives == 0:
        return np.zeros(0)
    short: Vector = margins - program.rows.offsets + program.rows.normals @ outputs
    return np.maximum.reduceat(short[program.alternative_rows], program.alternative_starts[:-1])


def least_violated(program: DisjunctiveProgram, violations: Vector) -> Indices:
    """Return each avoidance's least violated alternative, (v,).

    Parameters
    ----------
    program : DisjunctiveProgram
        The program; no avoidance without alternatives.
    violations : (a,) array
        From `violations_of` [m].
    """
    starts = program.avoidance_starts
    chosen = [start + int(violations[start:stop].argmin()) for start, stop in pairwise(starts)]
    return np.array(chosen, dtype=np.int64)


def possible_alternatives(program: DisjunctiveProgram, margins: Vector) -> np.ndarray:
    """Return which alternatives some admissible control can satisfy, (a,) bool.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program, with bounds of its outputs.
    margins : (r,) array
        Back-off of each row [m].
    """
    if program.num_alternatives == 0:
        return np.zeros(0, dtype=bool)
    normals, lower, upper = program.rows.normals, program.output_lower, program.output_upper
    least = np.empty(program.rows.count)
    for begin in range(0, program.rows.count, _BLOCK):
        starts = normals.indptr[begin : begin + _BLOCK + 1]
        values = normals.data[starts[0] : starts[-1]]
        outputs = normals.indices[starts[0] : starts[-1]]
        ends = np.where(values > 0.0, lower[outputs], upper[outputs])
        owners = np.repeat(np.arange(starts.size - 1), np.diff(starts))
        least[begin : begin + _BLOCK] = np.bincount(owners, values * ends, starts.size - 1)
    missed = least - program.rows.offsets + margins > _REACH_TOL
    return ~np.logical_or.reduceat(
        missed[program.alternative_rows], program.alternative_starts[:-1]
    )


def alternative_table(program: DisjunctiveProgram, possible: np.ndarray) -> Integers:
    """Return the possible alternatives of every avoidance, (v, most), padded with −1.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    possible : (a,) bool array
        From `possible_alternatives`.
    """
    owner = program.layout.owners[possible]
    counts = np.bincount(owner, minlength=program.num_avoidances)
    table = np.full((program.num_avoidances, int(counts.max(initial=1))), -1, dtype=np.int32)
    place = np.arange(owner.size) - np.repeat(np.cumsum(counts) - counts, counts)
    table[owner, place] = np.flatnonzero(possible)
    return table
