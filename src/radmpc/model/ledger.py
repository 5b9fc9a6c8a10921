"""A risk ledger summed by vehicle, and by hazard."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from radmpc.model.plan import Cause, LedgerRow
from radmpc.records import dataclass

__all__ = ["CAUSES", "Hazard", "bound_text", "hazards", "risk_by_vehicle"]

CAUSES: tuple[Cause, ...] = ("pair", "obstacle", "workspace", "range")


@dataclass(frozen=True, slots=True)
class Hazard:
    """One thing that may go wrong, over all steps.

    Attributes
    ----------
    cause : {'obstacle', 'pair', 'workspace', 'range'}
        What may be hit, left or lost.
    vehicle : str
        The vehicle.
    other : str or None
        The obstacle or the other vehicle; None for the workspace and for all that is far away.
    risks : dict
        Risk per step, steps without any left out.
    """

    cause: Cause
    vehicle: str
    other: str | None
    risks: dict[int, float]

    @property
    def total(self) -> float:
        """Risk over all steps."""
        return math.fsum(self.risks.values())


def hazards(ledger: Iterable[LedgerRow]) -> tuple[Hazard, ...]:
    """Return the ledger by what may go wrong, the largest first.

    Parameters
    ----------
    ledger : iterable of LedgerRow
        In any order.

    Returns
    -------
    tuple of Hazard
        Their totals sum to that of the ledger.
    """
    found: dict[tuple[Cause, str, str | None], dict[int, float]] = {}
    for row in ledger:
        risks = found.setdefault((row.cause, row.vehicle, row.other), {})
        risks[row.step] = risks.get(row.step, 0.0) + row.risk
    rows = [Hazard(*key, risks) for key, risks in found.items()]
    return tuple(sorted(rows, key=lambda hazard: hazard.total, reverse=True))


def risk_by_vehicle(
    ledger: Iterable[LedgerRow], names: Sequence[str]
) -> dict[str, dict[Cause, float]]:
    """Return what each vehicle's risk is made of; the two of a pair bear half of its risk each.

    Parameters
    ----------
    ledger : iterable of LedgerRow
        In any order.
    names : sequence of str
        All vehicles; those without risk are in the answer too.

    Returns
    -------
    dict
        Risk per cause, per vehicle, in the order of the names. It sums to that of the ledger.
    """
    parts: dict[str, dict[Cause, list[float]]] = {
        name: {cause: [] for cause in CAUSES} for name in names
    }
    for row in ledger:
        bearers = [row.vehicle]
        # A pair's partner may be missing: all that is far away is charged to one vehicle.
        if row.cause in {"pair", "range"} and row.other is not None:
            bearers.append(row.other)
        for name in bearers:
            parts[name][row.cause].append(row.risk / len(bearers))
    return {
        name: {cause: math.fsum(risks) for cause, risks in causes.items()}
        for name, causes in parts.items()
    }


def bound_text(certified: float) -> str:
    """Return a certificate for people: a sum of bounds may exceed 1, a probability does not.

    Parameters
    ----------
    certified : float
        Upper bound on a probability, a sum.

    Returns
    -------
    str
        To be read after "at most".
    """
    return f"{certified:.4g}" if certified <= 1.0 else f"1 (the bounds sum to {certified:.4g})"
