"""Where the risk goes: by cause, vehicle, partner and step."""

from __future__ import annotations

import math

import numpy as np

from radmpc.arrays import Indices, Vector
from radmpc.model.plan import Cause, LedgerRow
from radmpc.records import dataclass, field

__all__ = ["Account", "total_risk"]

_SMALL = 1e-12
"""Risk below which steps share one row per vehicle and partner [-]."""


@dataclass(slots=True, eq=False)
class Account:
    """Collects risks per step; several pieces of one obstacle end up in one entry.

    Attributes
    ----------
    entries : dict
        Risks at each step, (T+1,) [-], by cause, vehicle and partner.
    """

    entries: dict[tuple[Cause, int, int | None], Vector] = field(default_factory=dict)

    def charge(self, cause: Cause, first: Indices, other: Indices | None, risks: Vector) -> None:
        """Add the risks of many encounters, (B, T+1).

        Parameters
        ----------
        cause : {'obstacle', 'pair', 'workspace', 'range'}
            What may be hit, left or lost.
        first : (B,) int array
            The vehicles charged.
        other : (B,) int array or None
            Obstacles, or the other vehicles; None for the workspace.
        risks : (B, T+1) array
            Risk of each at each step [-].
        """
        for b in np.flatnonzero(risks.any(axis=1)):
            key = (cause, int(first[b]), None if other is None else int(other[b]))
            known = self.entries.get(key)
            self.entries[key] = risks[b].copy() if known is None else known + risks[b]

    def rows(self, vehicles: tuple[str, ...], obstacles: tuple[str, ...]) -> tuple[LedgerRow, ...]:
        """Return the ledger: nothing is dropped, small steps are merged into the worst.

        Parameters
        ----------
        vehicles : tuple of str
            Names, by number.
        obstacles : tuple of str
            Names, by number.
        """
        rows = []
        for (cause, vehicle, other), steps in zip(self.entries, self._merged(), strict=True):
            names = vehicles if cause in {"pair", "range"} else obstacles
            partner = None if other is None else names[other]
            rows += [
                LedgerRow(cause, vehicles[vehicle], partner, step, risk) for step, risk in steps
            ]
        return tuple(rows)

    def _merged(self) -> list[list[tuple[int, float]]]:
        """Return each entry's steps and risks, those below a limit added to their largest."""
        found: list[list[tuple[int, float]]] = [[]] * len(self.entries)
        alike: dict[int, list[int]] = {}
        for number, risks in enumerate(self.entries.values()):
            alike.setdefault(risks.size, []).append(number)
        every = list(self.entries.values())
        for numbers in alike.values():
            risks = np.array([every[number] for number in numbers])
            small = np.where(risks < _SMALL, risks, 0.0)
            rest, worst = small.sum(axis=1).tolist(), small.argmax(axis=1).tolist()
            has_large = risks.max(axis=1) >= _SMALL
            for row, number in enumerate(numbers):
                merged = [(worst[row], rest[row])] if rest[row] > 0.0 else []
                found[number] = [*_large(risks[row]), *merged] if has_large[row] else merged
                found[number].sort()
        return found


def _large(risks: Vector) -> list[tuple[int, float]]:
    """Return the steps that have a row of their own, with their risks."""
    return [(step, risk) for step, risk in enumerate(risks.tolist()) if risk >= _SMALL]


def total_risk(rows: tuple[LedgerRow, ...]) -> float:
    """Return the sum over the ledger, rounded once."""
    return math.fsum(row.risk for row in rows)
