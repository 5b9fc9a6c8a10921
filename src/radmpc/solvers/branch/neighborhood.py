"""Incumbents by planning one block (vehicle) at a time around the others.

A block whose columns are fixed is a moving obstacle to the rest: it needs no new rows, only column
bounds that allow one value.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from radmpc.arrays import Vector
from radmpc.program.program import DisjunctiveProgram
from radmpc.program.restrict import avoidance_blocks, restrict
from radmpc.solvers.branch.tree import Tree
from radmpc.solvers.solution import Limits

__all__ = ["improve", "prioritize"]

_NODES = 300
"""Nodes that one block may take [-]: it is a heuristic, not a proof."""

_ROUGH_GAP = 1e-2
"""Relative gap at which the search for one block stops while blocks are placed [-]: they are
planned anew afterwards."""

_MAX_ROUNDS = 3
"""Orders in which blocks are placed, and rounds in which they are planned anew [-]."""


def prioritize(
    program: DisjunctiveProgram, margins: Vector, alone: Vector, *, limits: Limits
) -> Vector | None:
    """Plan blocks one after the other, each around those before it.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    margins : (r,) array
        Back-off of each row [m].
    alone : (n,) array
        Every block's solution without the others.
    limits : Limits
        When to stop early.

    Returns
    -------
    (n,) array or None
        A solution of the whole. A block that finds no path is put first and all begins again, a
        few times; then None.
    """
    order = sorted(int(b) for b in np.unique(program.blocks))
    touched = avoidance_blocks(program)
    for _ in range(_MAX_ROUNDS):
        z = alone.copy()
        failed = None
        for place, block in enumerate(order):
            if limits.reached:
                return None
            part = restrict(program, np.array(sorted(order[: place + 1])), touched)
            free = part.program.blocks == block
            found = _with_others_fixed(
                part.program, margins[part.rows], z[part.columns], free, _ROUGH_GAP, limits
            )
            if found is None:
                failed = block
                break
            z[part.columns] = found
        if failed is None:
            return z
        order = [failed, *(b for b in order if b != failed)]
    return None


def improve(
    program: DisjunctiveProgram, margins: Vector, z: Vector, *, gap: float, limits: Limits
) -> Vector:
    """Free one block after the other and plan it anew, as long as the cost falls.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    margins : (r,) array
        Back-off of each row [m].
    z : (n,) array
        A solution.
    gap : float
        Relative gain below which to stop.
    limits : Limits
        When to stop early.

    Returns
    -------
    (n,) array
        A solution that costs no more.
    """
    blocks: Iterable[int] = [int(b) for b in np.unique(program.blocks)]
    for _ in range(_MAX_ROUNDS):
        before = float(program.cost @ z)
        for block in blocks:
            if limits.reached:
                return z
            free = program.blocks == block
            found = _with_others_fixed(program, margins, z, free, gap, limits, incumbent=z)
            if found is not None and float(program.cost @ found) < float(program.cost @ z):
                z = found
        if before - float(program.cost @ z) <= gap * abs(before):
            break
    return z


def _with_others_fixed(
    program: DisjunctiveProgram,
    margins: Vector,
    z: Vector,
    free: np.ndarray,
    gap: float,
    limits: Limits,
    incumbent: Vector | None = None,
) -> Vector | None:
    """Solve for the free columns, all others as they are."""
    fixed = replace(
        program,
        lower=np.where(free, program.lower, z),
        upper=np.where(free, program.upper, z),
    )
    tree = Tree(fixed, margins, gap=gap, limits=limits)
    if incumbent is not None:
        tree.try_point(incumbent)
    tree.run(_NODES)
    return tree.z
