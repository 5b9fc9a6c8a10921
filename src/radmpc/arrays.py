"""The one door through which arrays enter values: checked, copied, frozen."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import numpy.typing as npt

from radmpc.errors import ScenarioError

__all__ = [
    "Frozen",
    "Indices",
    "Matrix",
    "Tensor",
    "Vector",
    "as_array",
    "as_matrix",
    "as_vector",
    "frozen",
]

Vector = npt.NDArray[np.float64]
Matrix = npt.NDArray[np.float64]
Tensor = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]


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
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ScenarioError(f"must be numbers of equal row length, got {value!r}", path) from error
    wanted = "(" + ", ".join("any" if n is None else str(n) for n in shape) + ")"
    fits = array.ndim == len(shape) and all(
        n is None or n == m for n, m in zip(shape, array.shape, strict=True)
    )
    if not fits and len(shape) == array.ndim == 1:
        raise ScenarioError(f"must have {shape[0]} numbers, got {array.size}", path)
    if not fits:
        raise ScenarioError(f"must have shape {wanted}, got {array.shape}", path)
    if not np.all(np.isfinite(array)):
        raise ScenarioError("must be finite numbers, got nan or inf", path)
    return frozen(array)


def as_vector(
    value: npt.ArrayLike, size: int | None = None, path: tuple[str | int, ...] = ()
) -> Vector:
    """Return a frozen vector; see `as_array`.

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

    Raises
    ------
    ScenarioError
        If the value has no such shape or is not finite everywhere.
    """
    return as_array(value, shape, path)


class Frozen:
    """A dataclass whose arrays stay read-only through pickles and copies, which forget that."""

    __slots__ = ()

    def __reduce__(self) -> tuple[object, ...]:
        """Return what makes an equal value, without checking it again."""
        return _made_again, (type(self), *(getattr(self, name) for name in _fields(type(self))))


def _fields(kind: type[Frozen]) -> tuple[str, ...]:
    """Return the names of a dataclass's fields."""
    return tuple(field.name for field in fields(kind))  # type: ignore[arg-type] # its subclasses


def _made_again(kind: type[Frozen], *values: object) -> Frozen:
    """Return the value of its fields, arrays frozen."""
    for value in values:
        for entry in value if isinstance(value, tuple) else (value,):
            if isinstance(entry, np.ndarray):
                frozen(entry)
    made = object.__new__(kind)
    for name, value in zip(_fields(kind), values, strict=True):
        object.__setattr__(made, name, value)
    return made
