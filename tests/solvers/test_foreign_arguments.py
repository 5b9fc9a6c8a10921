"""Compiled code refuses arguments that do not fit: it never reads or writes beside an array."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from radmpc.solvers.compiled_code import is_compiled

if is_compiled():
    from radmpc.solvers import _compiled

pytestmark = pytest.mark.skipif(not is_compiled(), reason="no compiled code here")

SHAPE, COUNT = (3, 4, 5), 180
EVERYWHERE = (0, 4, 0, 5)
LARGEST, LEAST = 2**31 - 1, -(2**31)


def ints(*numbers: int) -> np.ndarray:
    return np.array(numbers, dtype=np.int32)


def singles(count: int) -> np.ndarray:
    return np.zeros(count, dtype=np.float32)


def ratings(**counts: int) -> Any:
    """Two avoidances of three alternatives with a row each, over two outputs of four columns."""
    outputs = ints(0, 2, 4), ints(0, 1, 2, 3), np.ones(4)
    normals = ints(0, 1, 2, 4), ints(0, 1, 0, 1), np.array([1.0, -1.0, 0.5, 0.5])
    rows = np.zeros(2), np.full(3, 0.2), np.array([0.1, 0.0, 0.2])
    alternatives = ints(0, 1, 2, -1), ints(0, 1, 2, 3), ints(0, 1, 2), ints(0, 1, 2)
    sizes = {"columns": 4, "width": 2, "events": 3, "samples": 0} | counts
    return _compiled.Ratings(*outputs, *normals, *rows, *alternatives, *sizes.values(), 1.0)


def to_fill() -> dict[str, np.ndarray]:
    return {
        "clearances": np.zeros(3),
        "cheapest": np.zeros(2),
        "selection": np.zeros(2, np.int64),
        "shortfall": np.zeros((2, 2)),
    }


def chance_rows() -> Any:
    program = _compiled.Program(np.zeros(6), -np.ones(6), np.ones(6), 1e-9)
    program.add_rows(ints(0, 1), ints(5), np.ones(1), np.zeros(1), np.ones(1))
    blocks = ints(0, 0, 1, 1), ints(), np.zeros((0, 2), dtype=bool)
    tangents = np.arange(3.0), np.full(3, 0.1), np.full(3, 0.3)
    numbers = 0, 0.2, 0.3, 1.0, 0.5, 0.0, 5.0
    return _compiled.RiskRows(
        program, ratings(), np.array([0.1, 0.0, 0.2]), *blocks, *tangents, *numbers
    )


def test_a_point_of_fewer_columns_than_are_rated_is_refused() -> None:
    rated = ratings()
    rated.rate(4, np.zeros(4), *to_fill().values())
    with pytest.raises(ValueError, match="lengths"):
        rated.rate(0, np.zeros(0), *to_fill().values())
    with pytest.raises(ValueError, match="lengths"):
        rated.rate(4, np.zeros(3), *to_fill().values())


@pytest.mark.parametrize("count", ["columns", "events", "samples"])
def test_fewer_than_none_are_refused(count: str) -> None:
    with pytest.raises(ValueError, match="counts >= 0"):
        ratings(**{count: -1})


@pytest.mark.parametrize("name", to_fill())
def test_ratings_are_not_written_where_nothing_may_be_written(name: str) -> None:
    arrays = to_fill()
    arrays[name].setflags(write=False)
    with pytest.raises(ValueError, match="an array to be written"):
        ratings().rate(4, np.ones(4), *arrays.values())
    assert not arrays[name].any()


def add_tails(into: np.ndarray) -> None:
    _compiled.lattice_add_tails(into, np.arange(5, dtype=np.uint32), singles(5), into[:5] + 1, 3.0)


def change(into: np.ndarray) -> None:
    _compiled.lattice_change(SHAPE, 1.0, EVERYWHERE, singles(COUNT), singles(9), 0, into)


def move(into: np.ndarray, source: Any = EVERYWHERE, target: Any = EVERYWHERE) -> None:
    values, risks, blocked = singles(COUNT), singles(COUNT), np.zeros(23, np.uint8)
    costs = (1.0, 1.0, 1.0)
    _compiled.lattice_move(
        SHAPE, 1.0, source, target, values, risks, blocked, costs, EVERYWHERE, into
    )


@pytest.mark.parametrize("fill", [add_tails, change, move])
def test_lattices_are_not_written_where_nothing_may_be_written(
    fill: Callable[[np.ndarray], None],
) -> None:
    into = singles(COUNT)
    fill(into.copy())
    into.setflags(write=False)
    with pytest.raises(ValueError, match="an array to be written"):
        fill(into)
    assert not into.any()


@pytest.mark.parametrize(
    "box",
    [
        (0, LEAST, 0, 5),
        (LARGEST, 4, 0, 5),
        (0, 4, 0, LEAST),
        (0, 4, LARGEST, 5),
        (-1, 4, 0, 5),
        (0, 5, 0, 5),
    ],
)
def test_boxes_that_end_before_they_begin_or_beyond_the_lattice_are_refused(box: Any) -> None:
    with pytest.raises(ValueError, match="lengths"):
        _compiled.lattice_change(SHAPE, 1.0, box, singles(COUNT), singles(9), 0, singles(COUNT))
    with pytest.raises(ValueError, match="lengths"):
        move(singles(COUNT), source=box)
    with pytest.raises(ValueError, match="lengths"):
        move(singles(COUNT), target=box)


def test_alternatives_come_as_a_tuple() -> None:
    with pytest.raises(TypeError, match="a tuple of alternatives"):
        chance_rows().activate([0, 1], 1000, 10)  # as a list


def test_the_number_of_rows_that_are_too_many_may_be_any() -> None:
    rows = chance_rows()
    assert rows.activate((0, 1, 2), LARGEST, LARGEST)
    assert not rows.activate((0, 1), LEAST, LEAST)
