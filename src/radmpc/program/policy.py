"""How Δ becomes risks of rows, and risks margins. Arithmetic only; nothing is solved here.

Fixed allocations give a risk to every exposure; all events of the exposure (the faces of one
thing at one step) get it, and each distinct event that is chosen pays it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from radmpc.arguments import check_word, is_integer, is_number, told
from radmpc.arrays import Indices, Vector
from radmpc.errors import ScenarioError
from radmpc.gaussian import clearance_for, tail_probability
from radmpc.program.program import DisjunctiveProgram

__all__ = [
    "Ira",
    "NoRisk",
    "Optimal",
    "Policy",
    "Pool",
    "Reallocation",
    "Sigmas",
    "Uniform",
    "allocated",
    "allocation_from",
    "margins_of",
    "reallocate",
    "uniform_allocation",
]


@dataclass(frozen=True, slots=True)
class NoRisk:
    """Deterministic: noise is ignored."""

    def __str__(self) -> str:
        return "none"


@dataclass(frozen=True, slots=True)
class Sigmas:
    """Bounded disturbance as robust MPC treats it: every row keeps a number of deviations.

    Attributes
    ----------
    count : float
        Standard deviations kept, 0 to 7: what always keeps 7 is left out of programs.
    """

    count: float = 3.0

    def __post_init__(self) -> None:
        """Refuse counts that programs cannot keep."""
        if not (is_number(self.count) and 0.0 <= self.count <= 7.0):
            raise ScenarioError(f"sigmas must lie between 0 and 7, got {told(self.count)}")

    def __str__(self) -> str:
        return f"sigmas({self.count:g})"


Spread = Literal["reached", "all"]
"""Over which constraints Δ is spread evenly: those that reach leaves, or all there are."""


@dataclass(frozen=True, slots=True)
class Uniform:
    """The same risk for every row, decided beforehand (Blackmore, Ono and Williams).

    Attributes
    ----------
    spread : {'reached', 'all'}
        Whether constraints that no admissible control can violate get a share, too. They need
        none: leaving them out gives the others more. The paper's text gives every constraint one.
    """

    spread: Spread = "reached"

    def __post_init__(self) -> None:
        """Refuse unknown words."""
        check_word(self.spread, ("reached", "all"), "spread")

    def __str__(self) -> str:
        return "uniform" + _spread_text(self.spread)


@dataclass(frozen=True, slots=True)
class Ira:
    """Iterative risk allocation (paper, section Iterative Risk Allocation).

    Attributes
    ----------
    active_tol : float
        η: a row is active if its risk is within this share of its allocation.
    keep : float
        α: share of the unused risk that an inactive row keeps.
    max_iterations : int
        Solves at the most.
    direction : {'to_active', 'to_inactive'}
        Who receives risk. The paper states both; only the first lowers the cost.
    spread : {'reached', 'all'}
        Who has a share in the first pass, see `Uniform`.
    """

    active_tol: float = 0.01
    keep: float = 0.7
    max_iterations: int = 20
    direction: str = "to_active"
    spread: Spread = "reached"

    def __post_init__(self) -> None:
        """Refuse unknown words, and numbers out of range."""
        check_word(self.direction, ("to_active", "to_inactive"), "direction")
        check_word(self.spread, ("reached", "all"), "spread")
        for name in ("active_tol", "keep"):
            share = getattr(self, name)
            if not (is_number(share) and 0.0 <= share <= 1.0):
                raise ScenarioError(f"{name} must lie between 0 and 1, got {told(share)}")
        if not (is_integer(self.max_iterations) and self.max_iterations >= 1):
            raise ScenarioError(
                f"max_iterations must be an integer >= 1, got {told(self.max_iterations)}"
            )

    def __str__(self) -> str:
        name = "ira" if self.direction == "to_active" else f"ira({self.direction})"
        return name + _spread_text(self.spread)


@dataclass(frozen=True, slots=True)
class Pool:
    """RADMPC's: each subproblem spreads its share of a common pool uniformly.

    Attributes
    ----------
    charge : {'allocated', 'used'}
        What leaves the pool for an executed step: what its rows were allotted (the paper), or
        only the risk they turned out to run.
    spread : {'reached', 'all'}
        Who has a share in a subproblem, see `Uniform`.
    """

    charge: str = "allocated"
    spread: Spread = "reached"

    def __post_init__(self) -> None:
        """Refuse unknown words."""
        check_word(self.charge, ("allocated", "used"), "charge")
        check_word(self.spread, ("reached", "all"), "spread")

    def __str__(self) -> str:
        name = "pool" if self.charge == "allocated" else f"pool({self.charge})"
        return name + _spread_text(self.spread)


@dataclass(frozen=True, slots=True)
class Optimal:
    """Risk allocated together with the faces, at one price for the whole fleet."""

    def __str__(self) -> str:
        return "optimal"


Policy = NoRisk | Sigmas | Uniform | Ira | Pool | Optimal


def _spread_text(spread: Spread) -> str:
    """Return what a policy's name says of its spread."""
    return "" if spread == "reached" else "(all rows)"


def uniform_allocation(
    program: DisjunctiveProgram, budget: float, spread: Spread = "reached"
) -> Vector:
    """Spread a budget evenly, so that no selection can spend more.

    Exposures whose rows no control moves get the least risk they carry in any case on top.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    budget : float
        Risk to spread, > 0.
    spread : {'reached', 'all'}
        Whether what reach has settled gets a share, too.

    Returns
    -------
    (x,) array
        Risk of each event of every exposure.
    """
    counts = _largest_counts(program)
    unavoidable = _unavoidable(program)
    left = budget - float((counts * unavoidable).sum())
    if counts.sum() == 0 or left <= 0.0:
        return unavoidable
    shares = counts.sum() + (program.num_settled if spread == "all" else 0)
    allotted: Vector = unavoidable + left / float(shares)
    return allotted


def margins_of(program: DisjunctiveProgram, allocation: Vector) -> Vector:
    """Return the back-off of every row at an allocation, (r,) [m] (paper, Eq. 7)."""
    rows = program.rows
    risks = allocation[rows.exposures[rows.events]]
    # Nothing allotted means the row may not be chosen; an infinite margin would spoil the sums.
    floor = np.finfo(np.float64).tiny
    return rows.deviations * clearance_for(np.clip(risks, floor, 0.5))


def allocated(program: DisjunctiveProgram, allocation: Vector, selection: Indices) -> float:
    """Return what a selection pays: the allocation of its distinct events."""
    events = np.unique(program.rows.events[program.selected_rows(selection)])
    return float(allocation[program.rows.exposures[events]].sum())


def allocation_from(
    program: DisjunctiveProgram, selection: Indices, z: Vector, budget: float
) -> Vector | None:
    """Allot what a point's sides run, and spread the rest of the budget evenly over them.

    The point is feasible at this allocation, however far from uniform it is.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    selection : (v,) int array
        The sides.
    z : (n,) array
        The point.
    budget : float
        Risk to spread, > 0.

    Returns
    -------
    (x,) array or None
        Risk of each event of every exposure; None if the point runs more than the budget.
    """
    paid, needed = _needed(program, selection, z)
    left = budget - float((paid * needed).sum())
    if left < 0.0:
        return None
    return np.minimum(needed + left / max(float(paid.sum()), 1.0), 0.5)


def _needed(program: DisjunctiveProgram, selection: Indices, z: Vector) -> tuple[Indices, Vector]:
    """Return how many events of each exposure are chosen, and the largest risk among them."""
    rows, num = program.rows, len(program.exposures)
    risks = program.event_risks(z, selection)
    events = np.unique(rows.events[program.selected_rows(selection)])
    paid = np.bincount(rows.exposures[events], minlength=num)
    needed = np.zeros(num)
    np.maximum.at(needed, rows.exposures[events], risks[events])
    return paid, needed


@dataclass(frozen=True, slots=True, eq=False)
class Reallocation:
    """One upper stage of IRA.

    Attributes
    ----------
    allocation : (x,) array
        The next allocation.
    num_active : int
        Exposures that use what they were given.
    num_chosen : int
        Exposures with a chosen row.
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
    policy: Ira,
) -> Reallocation:
    """Move risk from rows that do not use theirs to those that do.

    The paper states both directions; this one lowers the cost, because a row that uses all it
    was given is one that holds the solution back. The policy may ask for the other.

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
    policy : Ira
        η and α.

    Returns
    -------
    Reallocation
        The next allocation and what it was made from.
    """
    paid, needed = _needed(program, selection, z)
    chosen = paid > 0
    active = chosen & (np.abs(allocation - needed) <= policy.active_tol * allocation)
    result = allocation.copy()
    giving, taking = chosen & ~active, active
    if policy.direction == "to_inactive":
        giving, taking = taking, giving
    result[giving] = policy.keep * allocation[giving] + (1.0 - policy.keep) * needed[giving]
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
    """Return how many distinct events of each exposure a selection can choose at most."""
    rows = program.rows
    num = len(program.exposures)
    if rows.count == 0:
        return np.zeros(num, dtype=np.int64)
    alternative = np.repeat(
        np.arange(program.num_alternatives), np.diff(program.alternative_starts)
    )
    owner = np.repeat(np.arange(program.num_avoidances), np.diff(program.avoidance_starts))
    # Distinct events that one alternative has of an exposure, the most of any in its avoidance.
    events = np.unique(alternative * rows.exposures.size + rows.events[program.alternative_rows])
    holder, exposure = events // rows.exposures.size, rows.exposures[events % rows.exposures.size]
    pairs, held = np.unique(holder * num + exposure, return_counts=True)
    keys, place = np.unique(owner[pairs // num] * num + pairs % num, return_inverse=True)
    most = np.zeros(keys.size, dtype=np.int64)
    np.maximum.at(most, place, held)
    by_avoidance = np.zeros(num, dtype=np.int64)
    np.add.at(by_avoidance, keys % num, most)
    by_event = np.bincount(rows.exposures, minlength=num)
    return np.minimum(by_avoidance, by_event)


def _unavoidable(program: DisjunctiveProgram) -> Vector:
    """Return the least risk each exposure carries through rows that no control moves."""
    rows = program.rows
    fixed = program.fixed_rows()
    least = np.zeros(len(program.exposures))
    if not fixed.any():
        return least
    risk = tail_probability(program.clearances(np.zeros(program.num_columns)))
    exposure = rows.exposures[rows.events]
    best = np.full(least.size, np.inf)
    np.minimum.at(best, exposure[fixed], risk[fixed])
    found = np.isfinite(best)
    least[found] = best[found]
    return least
