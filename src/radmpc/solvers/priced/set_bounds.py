"""Proven lower bounds of some blocks of a program, and the rows that they make of larger ones."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from radmpc.arrays import Vector
from radmpc.program.program import DisjunctiveProgram
from radmpc.records import dataclass
from radmpc.solvers.lp.outcome import NO_NUMBERS, NO_VALUES, Numbers

__all__ = ["BoundRows", "SetBound"]


@dataclass(frozen=True, slots=True)
class SetBound:
    """A proven lower bound on some blocks: ``cost + price · risk / unit >= value``.

    Attributes
    ----------
    blocks : frozenset of int
        The blocks.
    value : float
        Lower bound in any solution, risks between these blocks and within each included.
    """

    blocks: frozenset[int]
    value: float


@dataclass(frozen=True, slots=True, eq=False)
class BoundRows:
    """The rows of proven bounds, laid out once for all times that a program is loaded.

    Their columns are the program's, and after these one for what is risked beyond the chosen rows
    by each block and each pair, at the price of a unit: it is charged once.

    Attributes
    ----------
    blocks : tuple of frozenset of int
        Those of each row.
    num_columns : int
        Columns beyond the program's.
    starts, columns, values : (b+1,) int, (e,) int and (e,) array
        Entries, see `BoundedLp.add_packed_rows`.
    lower : (b,) array
        Lower bounds.
    """

    blocks: tuple[frozenset[int], ...]
    num_columns: int
    starts: Numbers
    columns: Numbers
    values: Vector
    lower: Vector

    @classmethod
    def of(
        cls, program: DisjunctiveProgram, bounds: Sequence[SetBound], price: float, scale: float
    ) -> BoundRows:
        """Lay out the rows, those of few blocks first.

        Parameters
        ----------
        program : DisjunctiveProgram
            The program.
        bounds : sequence of SetBound
            Proven at this price.
        price : float
            Cost of one unit of risk.
        scale : float
            Factor of all coefficients and bounds [-].
        """
        if not bounds:
            return _NONE
        ordered = sorted(bounds, key=lambda bound: (len(bound.blocks), sorted(bound.blocks)))
        remainders: dict[tuple[int, ...], int] = {}
        starts, columns, values = [0], [], []
        for bound in ordered:
            members = sorted(bound.blocks)
            parts = [part for size in (1, 2) for part in combinations(members, size)]
            inner = [remainders.setdefault(part, len(remainders)) for part in parts]
            is_member = np.zeros(int(program.blocks.max(initial=0)) + 1, dtype=bool)
            is_member[members] = True
            mine = is_member[program.blocks].nonzero()[0]
            columns += [mine, program.num_columns + np.array(inner)]
            values += [program.cost[mine], np.full(len(inner), price)]
            starts.append(starts[-1] + mine.size + len(inner))
        return cls(
            tuple(bound.blocks for bound in ordered),
            len(remainders),
            np.array(starts, dtype=np.int32),
            np.concatenate(columns).astype(np.int32),
            scale * np.concatenate(values),
            scale * np.array([bound.value for bound in ordered]),
        )


_NONE = BoundRows((), 0, NO_NUMBERS, NO_NUMBERS, NO_VALUES, NO_VALUES)
