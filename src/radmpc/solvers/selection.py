"""Rating alternatives at a point, by whatever margins are in force."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from radmpc.arrays import Indices, Vector
from radmpc.program.program import DisjunctiveProgram

__all__ = [
    "least_violated",
    "possible_alternatives",
    "side_table",
    "violations_of",
    "violations_of_outputs",
]


def violations_of(program: DisjunctiveProgram, margins: Vector, z: Vector) -> Vector:
    """Return by how much each alternative is violated, (a,) [m]; negative is slack."""
    return violations_of_outputs(program, margins, program.outputs @ z + program.constant)


def violations_of_outputs(program: DisjunctiveProgram, margins: Vector, outputs: Vector) -> Vector:
    """Return the same for given outputs, whatever point they come from."""
    if program.num_alternatives == 0:
        return np.zeros(0)
    short: Vector = margins - program.rows.offsets + program.rows.normals @ outputs
    return np.maximum.reduceat(short[program.alternative_rows], program.alternative_starts[:-1])


def least_violated(program: DisjunctiveProgram, violations: Vector) -> Indices:
    """Return each avoidance's least violated alternative, (v,)."""
    starts = program.avoidance_starts
    chosen = [start + int(violations[start:stop].argmin()) for start, stop in pairwise(starts)]
    return np.array(chosen, dtype=np.int64)


def possible_alternatives(program: DisjunctiveProgram, margins: Vector) -> np.ndarray:
    """Return which alternatives some admissible control can satisfy, (a,) bool."""
    if program.num_alternatives == 0:
        return np.zeros(0, dtype=bool)
    normals = program.rows.normals
    least = (
        normals.maximum(0.0) @ program.output_lower + normals.minimum(0.0) @ program.output_upper
    )
    missed = least - program.rows.offsets + margins > 1e-6
    return ~np.logical_or.reduceat(
        missed[program.alternative_rows], program.alternative_starts[:-1]
    )


def side_table(program: DisjunctiveProgram, possible: np.ndarray) -> Indices:
    """Return the possible alternatives of every avoidance, (v, most), filled up with −1."""
    owner = program.layout.owners[possible]
    counts = np.bincount(owner, minlength=program.num_avoidances)
    table = np.full((program.num_avoidances, int(counts.max(initial=1))), -1, dtype=np.int64)
    place = np.arange(owner.size) - np.repeat(np.cumsum(counts) - counts, counts)
    table[owner, place] = np.flatnonzero(possible)
    return table
