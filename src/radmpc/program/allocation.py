"""From a risk budget to the risks of rows, and from risks to margins. Arithmetic only.

An allocation gives a risk to every risk item; all events of the item (the faces of one set at
one step) get it, and each distinct event that is chosen pays it.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from radmpc.arrays import Indices, Vector
from radmpc.program.program import DisjunctiveProgram
from radmpc.records import dataclass

__all__ = [
    "Reallocation",
    "Spread",
    "allocated",
    "allocation_from",
    "margins_of",
    "reallocate",
    "uniform_allocation",
]

Spread = Literal["reached", "all"]
"""Over which constraints Δ is spread evenly: those that the presolve leaves, or all there are."""


def uniform_allocation(
    program: DisjunctiveProgram, budget: float, spread: Spread = "reached"
) -> Vector:
    """Spread a budget evenly, so that no selection can use more.

    Risk items whose rows no control moves get the least risk they carry in any case on top.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    budget : float
        Risk to spread, > 0.
    spread : {'reached', 'all'}
        Whether presolved avoidances get a share, too.

    Returns
    -------
    (x,) array
        Risk of each event of every risk item.
    """
    counts = _largest_counts(program)
    unavoidable = _unavoidable(program)
    left = budget - float((counts * unavoidable).sum())
    if counts.sum() == 0 or left <= 0.0:
        return unavoidable
    shares = counts.sum() + (program.num_presolved if spread == "all" else 0)
    risks: Vector = unavoidable + left / float(shares) * _takes_risk(program)
    return risks


def margins_of(program: DisjunctiveProgram, allocation: Vector) -> Vector:
    """Return the back-off of every row at an allocation (paper, Eq. 7).

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    allocation : (x,) array
        Risk of each event of every risk item.

    Returns
    -------
    (r,) array
        Back-offs [m], never negative.
    """
    rows = program.rows
    risks = allocation[rows.risk_items[rows.events]]
    # Nothing allocated means that the row may not be chosen; an infinite margin would turn sums
    # into NaN.
    floor = np.finfo(np.float64).tiny
    return rows.deviations * program.tail.clearance_for(np.clip(risks, floor, 0.5))


def allocated(program: DisjunctiveProgram, allocation: Vector, selection: Indices) -> float:
    """Return the risk allocated to a selection, distinct events counted once.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    allocation : (x,) array
        Risk of each event of every risk item.
    selection : (v,) int array
        The alternative chosen for each avoidance.
    """
    events = np.unique(program.rows.events[program.selected_rows(selection)])
    return float(allocation[program.rows.risk_items[events]].sum())


def allocation_from(
    program: DisjunctiveProgram, selection: Indices, z: Vector, budget: float
) -> Vector | None:
    """Allocate what a point's alternatives risk, and spread the remaining budget evenly over them.

    The point is feasible at this allocation, however far from uniform it is.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    selection : (v,) int array
        The alternative chosen for each avoidance.
    z : (n,) array
        The point.
    budget : float
        Risk to spread, > 0.

    Returns
    -------
    (x,) array or None
        Risk of each event of every risk item; None if the point runs more than the budget.
    """
    paid, needed = _needed(program, selection, z)
    left = budget - float((paid * needed).sum())
    if left < 0.0:
        return None
    return np.minimum(needed + left / max(float(paid.sum()), 1.0), 0.5)


def _needed(program: DisjunctiveProgram, selection: Indices, z: Vector) -> tuple[Indices, Vector]:
    """Return how many events of each risk item are chosen, and the largest risk among them."""
    rows, num = program.rows, len(program.risk_items)
    risks = program.event_risks(z, selection)
    events = np.unique(rows.events[program.selected_rows(selection)])
    paid = np.bincount(rows.risk_items[events], minlength=num) * _takes_risk(program)
    needed = np.zeros(num)
    np.maximum.at(needed, rows.risk_items[events], risks[events])
    return paid, needed


@dataclass(frozen=True, slots=True, eq=False)
class Reallocation:
    """One upper stage of IRA.

    Attributes
    ----------
    allocation : (x,) array
        The next allocation.
    num_active : int
        Risk items that use what they were allocated.
    num_chosen : int
        Risk items with a chosen row.
    used : float
        True risk of the chosen rows at the solution.
    """

    allocation: Vector
    num_active: int
    num_chosen: int
    used: float


def reallocate(
    program: DisjunctiveProgram,
    allocation: Vector,
    selection: Indices,
    z: Vector,
    budget: float,
    *,
    active_tol: float,
    keep: float,
    is_paid_to_active: bool = True,
) -> Reallocation:
    """Move risk from rows that do not use theirs to those that do.

    The paper states both directions; this one lowers the cost, because a row that uses all it was
    allocated is a binding constraint. The other may be asked for.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    allocation : (x,) array
        Allocation of the last solve.
    selection : (v,) int array
        Its selection.
    z : (n,) array
        Its point.
    budget : float
        What the next allocation may sum to over the selection.
    active_tol : float
        η: a row is active if its risk is within this share of its allocation.
    keep : float
        α: share of the unused risk that a row which gives keeps.
    is_paid_to_active : bool
        Whether active rows receive, or the others.

    Returns
    -------
    Reallocation
        The next allocation and what it was made from.
    """
    paid, needed = _needed(program, selection, z)
    chosen = paid > 0
    active = chosen & (np.abs(allocation - needed) <= active_tol * allocation)
    result = allocation.copy()
    giving, taking = chosen & ~active, active
    if not is_paid_to_active:
        giving, taking = taking, giving
    result[giving] = keep * allocation[giving] + (1.0 - keep) * needed[giving]
    residual = budget - float((paid * result).sum())
    if taking.any() and residual > 0.0:
        result[taking] += residual / float(paid[taking].sum())
    return Reallocation(
        allocation=np.minimum(result, 0.5),
        num_active=int(active.sum()),
        num_chosen=int(chosen.sum()),
        used=float(program.event_risks(z, selection).sum()),
    )


def _largest_counts(program: DisjunctiveProgram) -> Indices:
    """Return how many distinct events of each risk item a selection can choose at most."""
    rows = program.rows
    num = len(program.risk_items)
    if rows.count == 0:
        return np.zeros(num, dtype=np.int64)
    alternative, owner = program.entry_owners(), program.layout.owners
    # Distinct events that one alternative has of a risk item, the most of any in its avoidance.
    events = np.unique(alternative * rows.risk_items.size + rows.events[program.alternative_rows])
    holder, risk_item = (
        events // rows.risk_items.size,
        rows.risk_items[events % rows.risk_items.size],
    )
    pairs, held = np.unique(holder * num + risk_item, return_counts=True)
    keys, place = np.unique(owner[pairs // num] * num + pairs % num, return_inverse=True)
    most = np.zeros(keys.size, dtype=np.int64)
    np.maximum.at(most, place, held)
    by_avoidance = np.zeros(num, dtype=np.int64)
    np.add.at(by_avoidance, keys % num, most)
    by_event = np.bincount(rows.risk_items, minlength=num)
    return np.minimum(by_avoidance, by_event) * _takes_risk(program)


def _takes_risk(program: DisjunctiveProgram) -> Indices:
    """Return 1 for risk items that risk is allocated to, 0 for visits."""
    if not program.num_visits:
        return np.ones(len(program.risk_items), dtype=np.int64)
    return np.array([item.cause != "visit" for item in program.risk_items], dtype=np.int64)


def _unavoidable(program: DisjunctiveProgram) -> Vector:
    """Return the least risk each risk item carries through rows that no control moves."""
    rows = program.rows
    fixed = program.fixed_rows()
    least = np.zeros(len(program.risk_items))
    if not fixed.any():
        return least
    risk = program.tail.probability(program.clearances(np.zeros(program.num_columns)))
    risk_item = rows.risk_items[rows.events]
    best = np.full(least.size, np.inf)
    np.minimum.at(best, risk_item[fixed], risk[fixed])
    found = np.isfinite(best) & (_takes_risk(program) > 0)
    least[found] = best[found]
    return least
