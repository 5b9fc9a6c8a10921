"""The part of a program that concerns some blocks alone."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array, vstack

from radmpc.arrays import Indices, Vector
from radmpc.program.layout import owners_of_runs
from radmpc.program.program import PRESOLVED_SHARE, ChanceRows, DisjunctiveProgram
from radmpc.records import dataclass, replace

__all__ = ["Restriction", "along", "avoidance_blocks", "restrict", "restrict_around"]

_PRESOLVED = 7.0
"""Clearance from which an avoidance is presolved [standard deviations], a risk of 1e-12; more where
Δ is tiny, see `PRESOLVED_SHARE`."""


@dataclass(frozen=True, slots=True, eq=False)
class Restriction:
    """A smaller program and where its parts are in the larger one.

    Attributes
    ----------
    program : DisjunctiveProgram
        The chosen blocks with the avoidances that touch nothing else.
    columns, rows, alternatives, avoidances : int array
        Their numbers in the larger program.
    """

    program: DisjunctiveProgram
    columns: Indices
    rows: Indices
    alternatives: Indices
    avoidances: Indices


def avoidance_blocks(program: DisjunctiveProgram) -> csr_array:
    """Return which blocks each avoidance touches, (v, b), nonzero where it does."""
    rows, num_blocks = program.rows, int(program.blocks.max(initial=-1)) + 1
    if num_blocks == 1 and not program.fixed_rows().any():
        return csr_array(np.ones((program.num_avoidances, 1)))
    n = program.num_columns
    block_of_column = csr_array((np.ones(n), (np.arange(n), program.blocks)), shape=(n, num_blocks))
    row_blocks = csr_array(abs(rows.normals) @ (abs(program.outputs) @ block_of_column))
    owners = program.layout.owners[program.entry_owners()]
    members = csr_array(
        (np.ones(owners.size), (owners, program.alternative_rows)),
        shape=(program.num_avoidances, rows.count),
    )
    return csr_array(members @ row_blocks)


def restrict(
    program: DisjunctiveProgram, blocks: Indices, touched: csr_array | None = None
) -> Restriction:
    """Return the program of some blocks alone.

    Its optimum is a lower bound on what these blocks cost in any solution of the whole.

    Parameters
    ----------
    program : DisjunctiveProgram
        The whole.
    blocks : int array
        The blocks to keep.
    touched : (v, b) sparse array or None
        From `avoidance_blocks`, if at hand.

    Returns
    -------
    Restriction
        Risk bound, outputs and risk items as in the whole.
    """
    touched = avoidance_blocks(program) if touched is None else touched
    if len(blocks) == touched.shape[1]:
        return Restriction(
            program,
            np.arange(program.num_columns),
            np.arange(program.rows.count),
            np.arange(program.num_alternatives),
            np.arange(program.num_avoidances),
        )
    others = np.setdiff1d(np.arange(touched.shape[1]), blocks)
    avoidances = _avoidances(touched, blocks, others)
    return _part(program, blocks, avoidances, program.constant)


def restrict_around(
    whole: DisjunctiveProgram, free: Indices, placed: Indices, z: Vector, touched: csr_array
) -> Restriction:
    """Return the program of some blocks around others whose columns are fixed.

    A placed block is a moving obstacle to the rest. Blocks that are neither free nor placed are
    left out, and so are avoidances that hold whatever the free blocks do.

    Parameters
    ----------
    whole : DisjunctiveProgram
        The program.
    free, placed : int array
        Blocks to plan, and blocks that are fixed.
    z : (n,) array
        A point; only its entries of placed blocks are used.
    touched : (v, b) sparse array
        From `avoidance_blocks`.

    Returns
    -------
    Restriction
        Over the columns of the free blocks.
    """
    absent = np.setdiff1d(np.arange(touched.shape[1]), np.concatenate([free, placed]))
    avoidances = _avoidances(touched, free, absent)
    fixed = np.where(np.isin(whole.blocks, placed), z, 0.0)
    part = _part(whole, free, avoidances, whole.constant + whole.outputs @ fixed)
    program = part.program
    if program.num_avoidances == 0:
        return part
    rows = program.rows
    most = (
        rows.normals.maximum(0.0) @ program.output_upper
        + rows.normals.minimum(0.0) @ program.output_lower
    )
    enough = max(
        _PRESOLVED, float(program.tail.clearance_for(PRESOLVED_SHARE * program.risk_bound))
    )
    is_kept = rows.offsets - most >= enough * rows.deviations
    # Counted, since `reduceat` lends an avoidance without alternatives those of its neighbor.
    left = _counts(program.alternative_starts, ~is_kept[program.alternative_rows])
    is_presolved = _counts(program.avoidance_starts, left == 0.0) > 0.0
    return _with_avoidances(whole, part, avoidances[~is_presolved])


def along(
    program: DisjunctiveProgram, outputs: slice, path: Vector, half_width: Vector
) -> DisjunctiveProgram:
    """Return a program whose solutions stay within a tube around a path.

    Parameters
    ----------
    program : DisjunctiveProgram
        The whole; its solutions within the tube are those of the answer.
    outputs : slice
        The outputs that are positions on the path.
    path : (q,) array
        Values of these outputs [m].
    half_width : (q,) array
        How far they may be off [m].

    Returns
    -------
    DisjunctiveProgram
        With one more hard row per output.
    """
    rows, constant = program.outputs[outputs], program.constant[outputs]
    return replace(
        program,
        hard=csr_array(vstack([program.hard, rows])),
        hard_lower=np.concatenate([program.hard_lower, path - half_width - constant]),
        hard_upper=np.concatenate([program.hard_upper, path + half_width - constant]),
    )


def _avoidances(touched: csr_array, inside: Indices, outside: Indices) -> Indices:
    """Return the avoidances that touch some blocks and none of others."""
    is_inside = np.asarray(touched[:, inside].sum(axis=1)).ravel() > 0.0
    is_outside = np.asarray(touched[:, outside].sum(axis=1)).ravel() > 0.0
    return np.flatnonzero(is_inside & ~is_outside)


def _part(
    program: DisjunctiveProgram, blocks: Indices, avoidances: Indices, constant: Vector
) -> Restriction:
    """Return the columns of some blocks with some avoidances."""
    columns = np.flatnonzero(np.isin(program.blocks, blocks))
    hard_rows = np.flatnonzero(abs(program.hard)[:, columns].sum(axis=1) > 0.0)
    outputs = csr_array(program.outputs[:, columns])
    is_moved = np.diff(outputs.indptr) > 0
    part = replace(
        program,
        cost=program.cost[columns],
        lower=program.lower[columns],
        upper=program.upper[columns],
        blocks=program.blocks[columns],
        hard=csr_array(program.hard[hard_rows][:, columns]),
        hard_lower=program.hard_lower[hard_rows],
        hard_upper=program.hard_upper[hard_rows],
        outputs=outputs,
        constant=constant,
        output_lower=np.where(is_moved, program.output_lower, constant),
        output_upper=np.where(is_moved, program.output_upper, constant),
    )
    whole = Restriction(part, columns, *(np.zeros(0, dtype=np.int64),) * 3)
    return _with_avoidances(program, whole, avoidances)


def _with_avoidances(
    program: DisjunctiveProgram, part: Restriction, avoidances: Indices
) -> Restriction:
    """Return a restriction with exactly some of the whole program's avoidances."""
    alternatives = _runs(program.avoidance_starts, avoidances)
    entries = _runs(program.alternative_starts, alternatives)
    rows, place = np.unique(program.alternative_rows[entries], return_inverse=True)
    avoidance_starts = _starts(np.diff(program.avoidance_starts)[avoidances])
    smaller = replace(
        part.program,
        rows=ChanceRows(
            normals=csr_array(program.rows.normals[rows]),
            offsets=program.rows.offsets[rows],
            deviations=program.rows.deviations[rows],
            events=program.rows.events[rows],
            risk_items=program.rows.risk_items,
        ),
        alternative_starts=_starts(np.diff(program.alternative_starts)[alternatives]),
        alternative_rows=place.astype(np.int32),
        avoidance_starts=avoidance_starts,
        avoidances=tuple(program.avoidances[int(i)] for i in avoidances),
        layout=replace(program.layout, owners=owners_of_runs(avoidance_starts)),
        num_visits=int(np.sum(avoidances >= program.num_avoidances - program.num_visits)),
    )
    return Restriction(smaller, part.columns, rows, alternatives, avoidances)


def _runs(starts: Indices, chosen: Indices) -> Indices:
    """Return the members of chosen runs, one run after the other."""
    if chosen.size == 0:
        return np.zeros(0, dtype=np.int64)
    return np.concatenate([np.arange(starts[i], starts[i + 1]) for i in chosen])


def _counts(starts: Indices, marked: np.ndarray) -> Vector:
    """Return how many members of each run are marked; 0 for an empty one."""
    counts: Vector = np.zeros(starts.size - 1)
    np.add.at(counts, owners_of_runs(starts), marked)
    return counts


def _starts(sizes: Indices) -> Indices:
    """Return where each run starts, and the end."""
    return np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
