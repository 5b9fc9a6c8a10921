"""Where the risk goes: by cause, vehicle, partner and step."""

from __future__ import annotations

import math
from operator import itemgetter

import numpy as np

from radmpc.arrays import Indices, Vector
from radmpc.model.plan import Cause, LedgerRow
from radmpc.records import dataclass, field

__all__ = ["Account", "total_risk"]

_SMALL = 1e-12
"""Risk below which steps share one row per vehicle and partner [-]."""


_BY_RISK = itemgetter(1)


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
        for (cause, vehicle, other), risks in self.entries.items():
            names = vehicles if cause in {"pair", "range"} else obstacles
            partner = None if other is None else names[other]
            for step, risk in _merged(risks):
                rows.append(LedgerRow(cause, vehicles[vehicle], partner, step, risk))
        return tuple(rows)


def _merged(risks: Vector) -> list[tuple[int, float]]:
    """Return steps and risks, those below a limit added to the step of their largest."""
    steps = list(enumerate(risks.tolist()))
    large = [(step, risk) for step, risk in steps if risk >= _SMALL]
    small = [(step, risk) for step, risk in steps if risk < _SMALL]
    rest = math.fsum(risk for _, risk in small)
    if rest > 0.0:
        worst, _ = max(small, key=_BY_RISK)
        large = sorted([*large, (worst, rest)])
    return large


def total_risk(rows: tuple[LedgerRow, ...]) -> float:
    """Return the sum over the ledger, rounded once."""
    return math.fsum(row.risk for row in rows)
