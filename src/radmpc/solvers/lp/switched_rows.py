"""Rows of a linear program that are added when first needed, and free while unused."""

from __future__ import annotations

from collections.abc import Callable, Set

import numpy as np
from scipy.sparse import csr_array

from radmpc.arrays import Vector
from radmpc.solvers.lp.bounded_lp import BoundedLp

__all__ = ["Key", "SwitchedRows"]

Key = tuple[int, int]
"""What some rows stand for, as a visit at a step."""


class SwitchedRows:
    """Rows by what they stand for.

    Parameters
    ----------
    lp : BoundedLp
        The program.
    rows_of : callable
        Returns coefficients, (k, n), and lower and upper bounds, (k,), of what is asked for first.
    """

    def __init__(
        self, lp: BoundedLp, rows_of: Callable[[Key], tuple[csr_array, Vector, Vector]]
    ) -> None:
        self._lp = lp
        self._rows_of = rows_of
        self._known: dict[Key, tuple[list[int], Vector, Vector]] = {}
        self._active: Set[Key] = frozenset()

    def ask_for(self, keys: Set[Key]) -> None:
        """Let the rows of these hold, and all others be free.

        Parameters
        ----------
        keys : set of (int, int)
            What is asked for.
        """
        for key in self._active - keys:
            numbers, lower, _ = self._known[key]
            free = np.full(lower.size, np.inf)
            self._lp.bound_rows(numbers, -free, free)
        for key in sorted(keys - self._active):
            if key in self._known:
                self._lp.bound_rows(*self._known[key])
                continue
            matrix, lower, upper = self._rows_of(key)
            first = self._lp.add_rows(matrix, lower, upper)
            self._known[key] = list(range(first, first + lower.size)), lower, upper
        self._active = keys
