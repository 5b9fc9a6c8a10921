"""The door through which arrays enter values."""

from __future__ import annotations

import copy
import pickle
from dataclasses import dataclass

import numpy as np
import pytest

from radmpc.arrays import Frozen, Vector, as_array, as_axes, as_covariance, as_matrix, as_vector
from radmpc.errors import ScenarioError


def test_what_enters_is_a_copy_that_nobody_can_change() -> None:
    given = np.array([1.0, 2.0])
    kept = as_vector(given)
    given[0] = 9.0
    assert kept.tolist() == [1.0, 2.0]
    with pytest.raises(ValueError, match="read-only"):
        kept[0] = 9.0


def test_whole_numbers_become_floats() -> None:
    assert as_matrix([[1, 2], [3, 4]]).dtype == np.float64


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ([1.0, 2.0], "must have 3 numbers, got 2"),
        ([[1.0, 2.0, 3.0]], r"must have shape \(3\), got \(1, 3\)"),
        ([1.0, float("nan"), 2.0], "must be finite numbers"),
        ([1.0, float("inf"), 2.0], "must be finite numbers"),
        ([[1.0], [1.0, 2.0]], "numbers of equal row length"),
        (["1", "2", "3"], "must be numbers"),
        ([True, False, True], "must be numbers"),
    ],
)
def test_what_is_no_vector_of_three_is_refused_with_its_place(value: object, message: str) -> None:
    with pytest.raises(ScenarioError, match=message) as caught:
        as_array(value, (3,), ("vehicles", 0, "start"))  # type: ignore[arg-type] # what a caller may try
    assert "vehicles[0].start" in str(caught.value)


def test_a_free_axis_takes_any_length_and_the_others_do_not() -> None:
    assert as_matrix(np.zeros((5, 2)), (None, 2)).shape == (5, 2)
    with pytest.raises(ScenarioError, match=r"shape \(any, 2\), got \(5, 3\)"):
        as_matrix(np.zeros((5, 3)), (None, 2))


def test_one_number_is_that_of_every_axis() -> None:
    assert as_axes(2.0, 3, ()).tolist() == [2.0, 2.0, 2.0]
    assert as_axes([1.0, 2.0], 2, ()).tolist() == [1.0, 2.0]


@pytest.mark.parametrize("value", [0.5, [0.5, 0.5], [[0.5, 0.0], [0.0, 0.5]]])
def test_a_covariance_is_a_number_a_diagonal_or_a_matrix(value: object) -> None:
    assert as_covariance(value, 2, ()).tolist() == [[0.5, 0.0], [0.0, 0.5]]


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ([[1.0, 0.5], [0.4, 1.0]], r"symmetric, got 0\.5 at \[0\]\[1\] and 0\.4 at \[1\]\[0\]$"),
        ([[1.0, 2.0], [2.0, 1.0]], "positive semi-definite, got an eigenvalue of -1"),
        (-1.0, "positive semi-definite"),
    ],
)
def test_what_is_no_covariance_is_refused(value: object, message: str) -> None:
    with pytest.raises(ScenarioError, match=message):
        as_covariance(value, 2, ())


def test_a_covariance_that_rounding_made_lopsided_is_made_symmetric() -> None:
    matrix = as_covariance([[1.0, 0.1 + 1e-12], [0.1, 1.0]], 2, ())
    assert np.array_equal(matrix, matrix.T)


@dataclass(frozen=True, slots=True, eq=False)
class Held(Frozen):
    vector: Vector
    parts: tuple[Vector, ...]


@pytest.mark.parametrize("again", [lambda x: pickle.loads(pickle.dumps(x)), copy.deepcopy])
def test_pickles_and_copies_of_a_value_stay_read_only(again) -> None:
    made = again(Held(as_vector([1.0]), (as_vector([2.0]),)))
    assert (made.vector.tolist(), made.parts[0].tolist()) == ([1.0], [2.0])
    assert not made.vector.flags.writeable
    assert not made.parts[0].flags.writeable
