"""Sparse matrices laid out by hand, against SciPy's."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import block_diag, csr_array, eye_array, vstack

from radmpc.sparse_rows import (
    diagonal_rows,
    negated,
    rows_of_entries,
    side_by_side,
    sparse_block,
)


def blocks(rng: np.random.Generator) -> list[np.ndarray]:
    """Blocks of which half of the entries are zeros, some rows and one block altogether."""
    shapes = [(3, 4), (1, 2), (2, 3), (4, 1), (0, 2)]
    found = [rng.normal(size=shape) * rng.integers(0, 2, shape) for shape in shapes]
    found[2][:] = 0.0
    return found


def test_blocks_along_the_diagonal_are_those_of_scipy_without_its_zeros() -> None:
    for seed in range(20):
        some = blocks(np.random.default_rng(seed))
        ours, theirs = (
            diagonal_rows([sparse_block(one) for one in some]),
            csr_array(block_diag([csr_array(one) for one in some])),
        )
        theirs.eliminate_zeros()
        for name in ("data", "indices", "indptr"):
            np.testing.assert_array_equal(getattr(ours, name), getattr(theirs, name))
        assert ours.shape == theirs.shape
        assert ours.indices.dtype == ours.indptr.dtype == np.int32


def test_rows_of_a_unit_stand_below_the_blocks() -> None:
    some = blocks(np.random.default_rng(3))
    width = sum(block.shape[1] for block in some)
    diagonal = block_diag([csr_array(one) for one in (*some, np.zeros((0, 2)))])
    wider = vstack([diagonal, eye_array(width + 2)])
    ours = diagonal_rows([sparse_block(one) for one in some], width + 2, num_units=width + 2)
    np.testing.assert_array_equal(ours.toarray(), wider.toarray())


def test_entries_are_sorted_by_row_and_column_and_zeros_are_left_out() -> None:
    rows, columns = np.array([2, 0, 2, 0, 1]), np.array([1, 3, 0, 2, 0])
    values = np.array([1.0, 2.0, 3.0, 4.0, 0.0])
    made = rows_of_entries(rows, columns, values, (4, 4))
    np.testing.assert_array_equal(made.toarray()[rows, columns], values)
    assert made.nnz == 4
    assert made.has_sorted_indices


@pytest.mark.parametrize("height", [0, 1, 5])
def test_blocks_side_by_side_are_those_of_the_dense_rows(height: int) -> None:
    for seed in range(10):
        rng = np.random.default_rng(seed)
        some = [rng.normal(size=(height, w)) * rng.integers(0, 2, (height, w)) for w in (3, 1, 4)]
        one, two, three = map(sparse_block, some)
        ours = side_by_side([one, negated(two), three, negated(one)])
        theirs = sparse_block(np.hstack([some[0], -some[1], some[2], -some[0]]))
        for name in ("values", "columns", "ends"):
            np.testing.assert_array_equal(getattr(ours, name), getattr(theirs, name))
        assert ours.width == theirs.width == 11
