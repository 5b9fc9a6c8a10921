"""Sparse matrices from their entries or from dense blocks, without SciPy's detours.

What builds programs makes thousands of small ones, of which SciPy's own constructions take several
times as long: each goes by way of coordinates, and every step checks its input anew.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csr_array

from radmpc.arrays import Indices, Integers, Matrix, Vector
from radmpc.records import dataclass

__all__ = [
    "SparseBlock",
    "diagonal_rows",
    "negated",
    "rows_of_entries",
    "side_by_side",
    "sparse_block",
]


@dataclass(frozen=True, slots=True, eq=False)
class SparseBlock:
    """A block of a matrix, row by row without its zeros.

    Attributes
    ----------
    values : (e,) array
        The entries.
    columns : (e,) int array
        Their columns.
    ends : (h,) int array
        Where each row ends among them.
    width : int
        Columns of the block.
    """

    values: Vector
    columns: Indices
    ends: Indices
    width: int


def sparse_block(matrix: Matrix) -> SparseBlock:
    """Return a dense block without its zeros.

    Parameters
    ----------
    matrix : (h, w) array
        The block.
    """
    height, width = matrix.shape
    entries = matrix.ravel()
    places = np.flatnonzero(entries)
    ends = places.searchsorted(np.arange(1, height + 1) * width)
    return SparseBlock(entries[places], places % width, ends, width)


def negated(block: SparseBlock) -> SparseBlock:
    """Return a block of the opposite signs.

    Parameters
    ----------
    block : SparseBlock
        The block.
    """
    return SparseBlock(-block.values, block.columns, block.ends, block.width)


def side_by_side(blocks: Sequence[SparseBlock]) -> SparseBlock:
    """Return blocks of equally many rows from left to right, entry by entry.

    Dense rows, which are mostly zeros where a step depends on those before it, would grow with the
    square of the horizon once more for each block.

    Parameters
    ----------
    blocks : sequence of SparseBlock
        The blocks.
    """
    sizes = np.array([np.diff(block.ends, prepend=0) for block in blocks])
    # Row by row, and in it block by block.
    begins = (np.cumsum(sizes.T.ravel()) - sizes.T.ravel()).reshape(-1, len(blocks)).T
    total = int(sizes.sum())
    values, columns, width = np.empty(total), np.empty(total, dtype=np.int64), 0
    for block, size, begin in zip(blocks, sizes, begins, strict=True):
        where = np.repeat(begin - (block.ends - size), size) + np.arange(block.values.size)
        values[where], columns[where] = block.values, block.columns + width
        width += block.width
    return SparseBlock(values, columns, np.cumsum(sizes.sum(axis=0)), width)


def rows_of_entries(
    rows: Indices, columns: Indices, values: Vector, shape: tuple[int, int]
) -> csr_array:
    """Return a matrix of entries that stand in different places; zeros are left out.

    Parameters
    ----------
    rows, columns : (n,) int array
        Where the entries stand.
    values : (n,) array
        The entries.
    shape : (int, int)
        Numbers of rows and columns.

    Returns
    -------
    sparse array
        Row and column numbers have 32 bits.
    """
    kept = np.flatnonzero(values)
    # Sorting one number each is several times faster than scipy's way over columns.
    kept = kept[np.argsort(rows[kept] * shape[1] + columns[kept], kind="stable")]
    # SciPy keeps the integers it is given: small ones take half the memory, and are read sooner.
    starts = np.zeros(shape[0] + 1, dtype=np.int32)
    np.cumsum(np.bincount(rows[kept], minlength=shape[0]), out=starts[1:])
    return _made(values[kept], columns[kept].astype(np.int32), starts, shape)


def diagonal_rows(
    blocks: Sequence[SparseBlock], num_columns: int | None = None, num_units: int = 0
) -> csr_array:
    """Return blocks along the diagonal, and rows of a unit below them.

    Parameters
    ----------
    blocks : sequence of SparseBlock
        The blocks.
    num_columns : int or None
        Columns of the matrix; None for those of the blocks.
    num_units : int
        Rows below the blocks, of which row i has a one in column i.

    Returns
    -------
    (h + num_units, n) sparse array
        Row and column numbers have 32 bits.
    """
    values, columns, ends = [], [], [np.zeros(1, dtype=np.int64)]
    first = count = 0
    for block in blocks:
        values.append(block.values)
        columns.append(block.columns + first)
        ends.append(block.ends + count)
        first, count = first + block.width, count + block.values.size
    units = np.arange(num_units)
    values.append(np.ones(num_units))
    columns.append(units)
    ends.append(units + (count + 1))
    starts = np.concatenate(ends).astype(np.int32)
    where = np.concatenate(columns).astype(np.int32)
    shape = starts.size - 1, first if num_columns is None else num_columns
    return _made(np.concatenate(values), where, starts, shape)


_PLAIN = csr_array((0, 0))
"""What SciPy keeps of a matrix beside its entries."""


def _made(values: Vector, columns: Integers, starts: Integers, shape: tuple[int, int]) -> csr_array:
    """Return a matrix of parts that fit: SciPy's own look at them takes twice as long as the rest.

    Where a version of it keeps anything else of a matrix, it makes them itself.
    """
    if vars(_PLAIN).keys() != {"_shape", "maxprint", "indices", "indptr", "data"}:
        return csr_array((values, columns, starts), shape=shape)
    matrix = csr_array.__new__(csr_array)
    parts = {"_shape": shape, "data": values, "indices": columns, "indptr": starts}
    vars(matrix).update(vars(_PLAIN), **parts)
    return matrix
