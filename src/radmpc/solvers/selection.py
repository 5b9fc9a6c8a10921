"""Rating alternatives at a point, by whatever margins are in force."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from radmpc.arrays import Indices, Vector
from radmpc.program.program import DisjunctiveProgram

__all__ = ["least_violated", "violations_of", "violations_of_outputs"]


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
