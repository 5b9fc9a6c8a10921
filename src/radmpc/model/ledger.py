"""The risk of a plan: its ledger, summed by vehicle and by hazard."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Literal

from radmpc.arguments import field_number, field_parts, one, value_text
from radmpc.errors import ScenarioError
from radmpc.records import dataclass
from radmpc.rounding import rounded_up

__all__ = [
    "CAUSES",
    "Cause",
    "Hazard",
    "LedgerRow",
    "Risk",
    "bound_text",
    "bound_texts",
    "hazards",
    "put_numbers",
    "put_parts",
    "risk_by_vehicle",
]

Cause = Literal["obstacle", "pair", "workspace", "range"]

CAUSES: tuple[Cause, ...] = ("pair", "obstacle", "workspace", "range")

_DIGITS = 4
"""Significant digits of a certificate for people, at least."""


@dataclass(frozen=True, slots=True)
class LedgerRow:
    """A share of the risk and its cause.

    Attributes
    ----------
    cause : {'obstacle', 'pair', 'workspace', 'range'}
        What may be hit, left or lost.
    vehicle : str
        The vehicle.
    other : str or None
        The obstacle or the other vehicle; None for the workspace.
    step : int
        When, 0..T.
    risk : float
        Upper bound on the probability [-].

    Examples
    --------
    >>> import radmpc
    >>> from radmpc.experiments.families import paper
    >>> plan = radmpc.plan(paper(2, seed=1), "distance", rng=0).require()
    >>> most = max(plan.risk.ledger, key=lambda row: row.risk)
    >>> most.cause in {"obstacle", "pair"}, 0.0 < most.risk <= plan.risk.certified
    (True, True)
    """

    cause: Cause
    vehicle: str
    other: str | None
    step: int
    risk: float


def put_numbers(value: object, names: Sequence[str], *path: str) -> None:
    """Make numbers of a frozen value Python's, or leave them None; nan is one, judged later.

    Parameters
    ----------
    value : object
        Of a dataclass.
    names : sequence of str
        Its fields.
    *path : str
        Where it stands, for the message.

    Raises
    ------
    ScenarioError
        If one is no number.
    """
    for name in names:
        number = getattr(value, name)
        if number is not None and type(number) is not float:
            object.__setattr__(value, name, field_number(number, (*path, name)))


def put_parts(value: object, name: str, kind: type, *path: str) -> None:
    """Make parts of a frozen value a tuple, all of one kind.

    Parameters
    ----------
    value : object
        Of a dataclass.
    name : str
        Its field.
    kind : type
        What they are.
    *path : str
        Where it stands, for the message.

    Raises
    ------
    ScenarioError
        If one is of another kind.
    """
    given = getattr(value, name)
    parts = field_parts(given, f"a sequence of {kind.__name__}s", (*path, name))
    if parts and set(map(type, parts)) != {kind}:
        k, part = next((k, part) for k, part in enumerate(parts) if type(part) is not kind)
        raise ScenarioError(f"must be {one(kind)}, got {value_text(part)}", (*path, name, k))
    object.__setattr__(value, name, parts)


@dataclass(frozen=True, slots=True, eq=False)
class Risk:
    """The risk bound, and the risk that the certificate charges against it.

    Attributes
    ----------
    bound : float
        The scenario's Δ.
    certified : float or None
        Upper bound on the joint collision probability; None without a plan.
    ledger : tuple of LedgerRow
        Where it goes; sums to ``certified``.
    price : float or None
        Shadow price of risk: what a little more Δ would save, cost per unit of probability; None
        if unknown.
    saturation : float or None
        Upper bound on the probability that feedback ever asks for more control than there is,
        beside ``certified``: that one speaks of missions in which it does not. None if
        unknown.

    Examples
    --------
    >>> import radmpc
    >>> from radmpc.experiments.families import paper
    >>> plan = radmpc.plan(paper(2, seed=1), "distance", rng=0).require()
    >>> plan.risk.certified <= plan.risk.bound
    True
    >>> round(sum(row.risk for row in plan.risk.ledger) / plan.risk.certified, 9)
    1.0
    """

    bound: float
    certified: float | None = None
    ledger: tuple[LedgerRow, ...] = ()
    price: float | None = None
    saturation: float | None = None

    def __post_init__(self) -> None:
        """Refuse parts of another kind."""
        if type(self.bound) is not float:
            object.__setattr__(self, "bound", field_number(self.bound, ("risk", "bound")))
        put_numbers(self, ("certified", "price", "saturation"), "risk")
        put_parts(self, "ledger", LedgerRow, "risk")


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
    return _bound_text(certified, _DIGITS)


def bound_texts(certified: float, bound: float) -> tuple[str, str]:
    """Return a certificate and the risk bound with digits that tell which of the two is larger.

    Parameters
    ----------
    certified : float
        Upper bound on a probability, a sum.
    bound : float
        Risk bound Δ that it is compared with.

    Returns
    -------
    tuple of str
        As of `bound_text`, and the risk bound.
    """
    digits, limit = _DIGITS, f"{bound:g}"
    while (rounded_up(certified, digits) <= float(limit)) != (certified <= bound):
        digits += 1
        limit = f"{bound:.{max(digits, 6)}g}"
    return _bound_text(certified, digits), limit


def _bound_text(certified: float, digits: int) -> str:
    """Return a certificate with so many digits, never less than it is."""
    if float(f"{certified:.{_DIGITS}g}") > 1.0:
        return f"1 (the bounds sum to {rounded_up(certified, _DIGITS):.{_DIGITS}g})"
    return f"{rounded_up(min(certified, 1.0), digits):.{digits}g}"
