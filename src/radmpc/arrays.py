"""Conversion of arrays on entry: checked, copied, made read-only."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import fields
from functools import cache
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from radmpc.arguments import value_text
from radmpc.errors import ScenarioError
from radmpc.ranges import LARGEST, sized

__all__ = [
    "Frozen",
    "Indices",
    "Integers",
    "Matrix",
    "Tensor",
    "Vector",
    "as_array",
    "as_axes",
    "as_covariance",
    "as_matrix",
    "as_vector",
    "distinct",
    "field_names",
    "frozen",
    "unchecked",
]

Vector = npt.NDArray[np.float64]
Matrix = npt.NDArray[np.float64]
Tensor = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

Integers = npt.NDArray[np.signedinteger]
"""Of 64 or 32 bits, which take half the memory where there are very many."""

_Value = TypeVar("_Value")


_NUMBERS = "iufO"
"""Kinds of numpy's types that hold numbers; objects may."""


def frozen(array: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the array itself, made read-only."""
    array.setflags(write=False)
    return array


def as_array(
    value: npt.ArrayLike, shape: tuple[int | None, ...], path: tuple[str | int, ...] = ()
) -> npt.NDArray[np.float64]:
    """Return a frozen float64 copy with the given shape and finite entries.

    Parameters
    ----------
    value : array_like
        Anything numpy turns into numbers.
    shape : tuple of int or None
        Required lengths; None leaves an axis free.
    path : tuple of str or int
        Where the value stands, for the error.

    Returns
    -------
    array
        A read-only copy.

    Raises
    ------
    ScenarioError
        If the value has no such shape or is not finite everywhere.
    """
    array = _numbers(value, path)
    if array.shape != shape and not _fits(array.shape, shape):
        if len(shape) == array.ndim == 1:
            raise ScenarioError(f"must have {shape[0]} numbers, got {array.size}", path)
        expected = "(" + ", ".join("any" if n is None else str(n) for n in shape) + ")"
        raise ScenarioError(f"must have shape {expected}, got {array.shape}", path)
    if not np.isfinite(array).all():
        raise ScenarioError("must be finite numbers, got nan or inf", path)
    return frozen(array)


def _fits(found: tuple[int, ...], wanted: tuple[int | None, ...]) -> bool:
    """Return whether an array has the lengths that are wanted."""
    if len(found) != len(wanted):
        return False
    return all(n is None or n == m for n, m in zip(wanted, found, strict=True))


def as_vector(
    value: npt.ArrayLike, size: int | None = None, path: tuple[str | int, ...] = ()
) -> Vector:
    """Return a frozen vector; see `as_array`.

    Parameters
    ----------
    value : array_like
        What was given.
    size : int or None
        Its length; None is any.
    path : tuple of str or int
        Where it stands, for the message.

    Raises
    ------
    ScenarioError
        If the value has no such shape or is not finite everywhere.
    """
    return as_array(value, (size,), path)


def as_matrix(
    value: npt.ArrayLike,
    shape: tuple[int | None, int | None] = (None, None),
    path: tuple[str | int, ...] = (),
) -> Matrix:
    """Return a frozen matrix; see `as_array`.

    Parameters
    ----------
    value : array_like
        What was given.
    shape : tuple of (int or None)
        Rows and columns; None is any number.
    path : tuple of str or int
        Where it stands, for the message.

    Raises
    ------
    ScenarioError
        If the value has no such shape or is not finite everywhere.
    """
    return as_array(value, shape, path)


def _numbers(value: npt.ArrayLike, path: tuple[str | int, ...]) -> npt.NDArray[np.float64]:
    """Return a copy as float64; texts, which numpy would read, are no numbers."""
    try:
        raw = np.asarray(value)
        if raw.dtype.kind in _NUMBERS:
            # Row by row whatever came: products of other layouts round otherwise.
            return np.array(raw, dtype=np.float64, order="C")
    except (TypeError, ValueError, OverflowError) as error:
        raise ScenarioError(
            f"must be numbers of equal row length, got {value_text(value)}", path
        ) from error
    raise ScenarioError(f"must be numbers, got {value_text(value)}", path)


def as_axes(value: npt.ArrayLike, size: int, path: tuple[str | int, ...]) -> Vector:
    """Return a vector from one, or from a number for all axes.

    Parameters
    ----------
    value : array_like
        A number, or a vector.
    size : int
        Number of axes d.
    path : tuple of str or int
        Where it stands, for the message.

    Raises
    ------
    ScenarioError
        If it has another size.
    """
    if np.asarray(value, dtype=object).ndim == 0:
        return frozen(np.full(size, as_array(value, (), path)))
    return as_vector(value, size, path)


def as_covariance(
    value: object, size: int, path: tuple[str | int, ...], most: float = LARGEST
) -> Matrix:
    """Return a covariance matrix from a scalar, a diagonal or a matrix.

    Parameters
    ----------
    value : array_like
        A number, n numbers or n by n.
    size : int
        Number of states n.
    path : tuple of str or int
        Where it stands, for the message.
    most : float
        Largest magnitude of its entries.

    Raises
    ------
    ScenarioError
        If it is not symmetric positive semi-definite, or too large.
    """
    num_axes = min(np.asarray(value, dtype=object).ndim, 2)
    given = as_array(value, (size,) * num_axes, path)  # type: ignore[arg-type] # checked there
    given = sized(given, path, most)
    matrix = given if num_axes == 2 else np.diag(np.broadcast_to(given, size))
    scale = max(float(np.abs(matrix).max()), 1e-300)
    if not np.allclose(matrix, matrix.T, rtol=0.0, atol=1e-9 * scale):
        i, j = np.unravel_index(int(np.abs(matrix - matrix.T).argmax()), matrix.shape)
        raise ScenarioError(
            f"must be symmetric, got {matrix[i, j]:.10g} at [{i}][{j}] and {matrix[j, i]:.10g} at "
            f"[{j}][{i}]",
            path,
        )
    matrix = 0.5 * matrix + 0.5 * matrix.T
    lowest = float(np.linalg.eigvalsh(matrix)[0])
    if lowest < -1e-9 * scale:
        raise ScenarioError(
            f"must be positive semi-definite, got an eigenvalue of {lowest:.6g}", path
        )
    return frozen(matrix)


class Frozen:
    """A dataclass whose arrays stay read-only through pickles and copies, which forget that."""

    __slots__ = ()

    def __reduce__(self) -> tuple[object, ...]:
        """Return what makes an equal value, without checking it again."""
        return unchecked, (type(self), *(getattr(self, name) for name in field_names(type(self))))


def distinct(values: Indices) -> Indices:
    """Return the distinct ones of some integers, ascending.

    `numpy.unique` loads numpy's masked arrays to ask whether these are any.

    Parameters
    ----------
    values : array of int
        Of any shape.

    Returns
    -------
    (n,) array of int
        Each once.
    """
    ordered = np.sort(values, axis=None)
    is_first = np.ones(ordered.size, dtype=bool)
    is_first[1:] = ordered[1:] != ordered[:-1]
    return np.asarray(ordered[is_first])


def field_names(kind: type) -> tuple[str, ...]:
    """Return the names of a dataclass's fields.

    Parameters
    ----------
    kind : type
        The dataclass.
    """
    return _field_names(kind)


@cache
def _field_names(kind: Hashable) -> tuple[str, ...]:
    """Return them; asked for often, they take as long as all else of a small copy."""
    return tuple(field.name for field in fields(kind))  # type: ignore[arg-type] # a dataclass


def unchecked(kind: type[_Value], *values: object) -> _Value:
    """Return a dataclass's value of all its fields, arrays frozen; what it checks was checked.

    Parameters
    ----------
    kind : type
        The dataclass.
    *values
        Of its fields, in order and of the right kinds.
    """
    put = object.__setattr__
    made = object.__new__(kind)
    for name, value in zip(field_names(kind), values, strict=True):
        for entry in value if isinstance(value, tuple) else (value,):
            if isinstance(entry, np.ndarray):
                frozen(entry)
        put(made, name, value)
    return made
