"""Equality of values bit for bit: -0.0 is not 0.0."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass

import numpy as np
from scipy.sparse import csr_array

_OF_SPARSE = "indptr", "indices", "data"


def differences(first: object, second: object, path: str = "") -> list[str]:
    """Return the paths at which two values differ."""
    if type(first) is not type(second):
        return [f"{path}: {type(first).__name__} and {type(second).__name__}"]
    if isinstance(first, np.ndarray) and isinstance(second, np.ndarray):
        same = first.shape == second.shape and first.tobytes() == second.tobytes()
        return [] if same else [f"{path}: {first.tolist()} and {second.tolist()}"]
    if isinstance(first, csr_array) and isinstance(second, csr_array):
        parts = [(name, getattr(first, name), getattr(second, name)) for name in _OF_SPARSE]
    elif is_dataclass(first):
        parts = [(f.name, getattr(first, f.name), getattr(second, f.name)) for f in fields(first)]
    elif isinstance(first, tuple | list) and isinstance(second, tuple | list):
        if len(first) != len(second):
            return [f"{path}: lengths {len(first)} and {len(second)}"]
        parts = [(str(i), a, b) for i, (a, b) in enumerate(zip(first, second, strict=True))]
    elif isinstance(first, Mapping) and isinstance(second, Mapping):
        if list(first) != list(second):
            return [f"{path}: keys {list(first)} and {list(second)}"]
        parts = [(str(key), first[key], second[key]) for key in first]
    else:
        return [] if repr(first) == repr(second) else [f"{path}: {first!r} and {second!r}"]
    return [line for name, a, b in parts for line in differences(a, b, f"{path}.{name}")]
