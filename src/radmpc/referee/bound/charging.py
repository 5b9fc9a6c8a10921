"""Where the risk goes: by cause, vehicle, partner and step."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from radmpc.arrays import Indices, Matrix
from radmpc.model.plan import Cause, LedgerRow
from radmpc.records import dataclass, field

__all__ = ["Account", "Ledger"]

_SMALL = 1e-12
"""Risk below which steps share one row per vehicle and partner [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class _Charges:
    """Risks of one cause: of each vehicle and partner at each step, (E, T+1) [-]."""

    cause: Cause
    first: Indices
    other: Indices | None
    risks: Matrix

    def small(self) -> Matrix:
        """Return the risks that share one row, 0 for all others, (E, T+1)."""
        return np.where(self.risks < _SMALL, self.risks, 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class Ledger:
    """What an account comes to; rows are made on request.

    Attributes
    ----------
    charges : tuple
        What was charged.
    vehicles, obstacles : tuple of str
        Names, by number.
    total : float
        The sum over all rows, rounded once [-].
    """

    charges: tuple[_Charges, ...]
    vehicles: tuple[str, ...]
    obstacles: tuple[str, ...]
    total: float

    def __iter__(self) -> Iterator[LedgerRow]:
        """Yield the rows: nothing is dropped, small steps are merged into the worst."""
        for one in self.charges:
            names = self.vehicles if one.cause in {"pair", "range"} else self.obstacles
            partners = [None] * len(one.first) if one.other is None else one.other.tolist()
            small, risks = one.small(), one.risks.tolist()
            rest, worst = small.sum(axis=1).tolist(), small.argmax(axis=1).tolist()
            for row, (vehicle, partner) in enumerate(
                zip(one.first.tolist(), partners, strict=True)
            ):
                steps = [(step, risk) for step, risk in enumerate(risks[row]) if risk >= _SMALL]
                if rest[row] > 0.0:
                    steps = sorted([*steps, (worst[row], rest[row])])
                name, other = self.vehicles[vehicle], None if partner is None else names[partner]
                for step, risk in steps:
                    yield LedgerRow(one.cause, name, other, step, risk)


@dataclass(slots=True, eq=False)
class Account:
    """Collects risks per step; several pieces of one obstacle end up in one entry.

    Attributes
    ----------
    charges : list
        What was charged so far.
    """

    charges: list[_Charges] = field(default_factory=list)

    def charge(self, cause: Cause, first: Indices, other: Indices | None, risks: Matrix) -> None:
        """Add the risks of many encounters, (B, T+1).

        Parameters
        ----------
        cause : {'obstacle', 'pair', 'workspace', 'range'}
            What may be hit, left or lost.
        first : (B,) int array
            The vehicles charged.
        other : (B,) int array or None
            Obstacles, or the other vehicles, none of them in two calls of a cause; None for the
            workspace, and for what is far.
        risks : (B, T+1) array
            Risk of each at each step [-].
        """
        some = np.flatnonzero(risks.any(axis=1))
        if not some.size:
            return
        first, risks = first[some], risks[some]
        if other is None:
            self.charges.append(_Charges(cause, first, None, risks))
            return
        other = other[some]
        keys = first * (int(other.max()) + 1) + other
        _, begins, places = np.unique(keys, return_index=True, return_inverse=True)
        if begins.size < keys.size:
            # Entries come in the order in which they are first charged.
            order = np.argsort(begins)
            ranks = np.argsort(order)
            summed = np.zeros((begins.size, risks.shape[1]))
            np.add.at(summed, ranks[places], risks)
            begins = begins[order]
            first, other, risks = first[begins], other[begins], summed
        self.charges.append(_Charges(cause, first, other, risks))

    def ledger(self, vehicles: tuple[str, ...], obstacles: tuple[str, ...]) -> Ledger:
        """Return what the account comes to.

        Parameters
        ----------
        vehicles : tuple of str
            Names, by number.
        obstacles : tuple of str
            Names, by number.
        """
        parts: list[float] = []
        for one in self.charges:
            parts += one.risks[one.risks >= _SMALL].tolist()
            parts += one.small().sum(axis=1).tolist()
        return Ledger(tuple(self.charges), vehicles, obstacles, math.fsum(parts))
