"""What is in a value, to be compared: values themselves are equal only if they are one."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import is_dataclass
from typing import Any

import numpy as np

from radmpc.arrays import field_names
from radmpc.records import Kept, dataclass, field

__all__ = ["Keyed", "contents"]


def contents(value: object) -> Hashable:
    """Return what is equal for two values only if all their fields are, to the last bit.

    Parameters
    ----------
    value : object
        An array, a dataclass, a sequence of such, or something that can be hashed.

    Raises
    ------
    TypeError
        If it holds something else, such as a dictionary, that cannot be hashed.
    """
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, Kept):
        return None  # what was computed of the other fields
    if is_dataclass(value):
        kind = type(value)
        return kind, *(contents(getattr(value, name)) for name in field_names(kind))
    if isinstance(value, tuple | list):
        return type(value), *map(contents, value)
    hash(value)
    return value


@dataclass(frozen=True, slots=True)
class Keyed:
    """A value that equals another if their keys do: what is computed of one holds for the other.

    Attributes
    ----------
    value : object
        The value.
    key : hashable
        The contents of all that counts of it.
    """

    value: Any = field(compare=False)
    key: Hashable
