"""From the best alternatives at a price of risk to a plan within a budget, exactly."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Vector
from radmpc.gaussian import CONVEX_RISK
from radmpc.planners.certified.problem import SetProblem
from radmpc.planners.certified.tuning import TUNING
from radmpc.solvers.compiled_code import is_compiled
from radmpc.solvers.lp.bounded_lp import BoundedLp
from radmpc.solvers.lp.choosing import bounded_lp
from radmpc.solvers.lp.outcome import LpOutcome
from radmpc.solvers.priced.nodes import Incumbent
from radmpc.solvers.priced.tree import RiskTree
from radmpc.solvers.solution import Limits

__all__ = ["AllocatedPrograms", "repair", "repriced"]

_TUNED = TUNING.acceptance

Flags = npt.NDArray[np.bool_]

_LEAST = 1e-9
"""Share of the budget that every row is allocated at least [-]."""

_NEAR = 5e-9
"""Share of the unit below which an alternative is not worth holding on to when the price rises
[-]."""

_FAR = 12.0
"""Clearance in standard deviations beyond which a row is left out while risks are rescaled [-]."""

_WARM, _WARM_BY_HIGHS = 512, 64
"""Linear programs that are kept from one rescaling to the next [-]: in HiGHS each takes 0.3 MB, in
compiled code a tenth of it."""

_SLACK = 1e-6
"""Share of the budget kept back, so that the solver's tolerance cannot exceed it [-]."""


def repair(
    problems: Sequence[SetProblem],
    incumbents: Sequence[Incumbent],
    budget: float,
    programs: AllocatedPrograms,
    *,
    is_large: bool = False,
) -> tuple[Vector, ...] | None:
    """Rescale a fleet's risks to a budget, every alternative as it is.

    The risks that the rows run are scaled to the budget and allocated to them as fixed margins,
    which is optimal at the price where the budget is just used, and nearly so near it.

    Parameters
    ----------
    problems : sequence of SetProblem
        The sets.
    incumbents : sequence of Incumbent
        The plan of each.
    budget : float
        What the rows of all sets may risk together [-].
    programs : AllocatedPrograms
        Those of other budgets.
    is_large : bool
        Whether the fleet is: where it risks too much, only its riskiest sets are rescaled then.

    Returns
    -------
    tuple of (n,) array or None
        Points whose true risks stay within the budget; None where these alternatives allow none.
    """
    if budget <= 0.0:
        return None
    points = [incumbent.z for incumbent in incumbents]
    best, least = None, float("inf")
    risks = [programs.risks(*each) for each in zip(problems, incumbents, points, strict=True)]
    is_some = is_large and float(sum(r.sum() for r in risks)) > budget
    slack = _TUNED.spare if is_some else _SLACK
    can_change = np.ones(len(points), dtype=bool)
    for _ in range(_TUNED.repairs):
        sums = np.array([r.sum() for r in risks])
        total = float(sums.sum())
        if total <= budget:
            cost = sum(float(p.program.cost @ z) for p, z in zip(problems, points, strict=True))
            is_better = cost < least * (1.0 - 1e-5)
            if cost < least:
                best, least = tuple(points), cost
            if is_some or not is_better or total >= budget * (1.0 - 1e-3):
                break
        is_free = _riskiest(sums, can_change, budget) if is_some else can_change
        held = float(sums[~is_free].sum())
        scale = (budget * (1.0 - slack) - held) / max(total - held, 1e-300)
        if scale <= 0.0:
            break
        for number in np.flatnonzero(is_free & (sums > _LEAST * budget)).tolist():
            problem, incumbent = problems[number], incumbents[number]
            allocated = np.clip(risks[number] * scale, _LEAST * budget, CONVEX_RISK)
            z = programs.of(problem, incumbent).point(allocated)
            # Some risks cannot shrink, such as those next to the start: leave the set as it is.
            can_change[number] = z is not None
            if z is not None:
                points[number], risks[number] = z, programs.risks(problem, incumbent, z)
    return best


def _riskiest(sums: Vector, can_change: Flags, budget: float) -> Flags:
    """Tell the fewest sets, the riskiest, that come to the budget by a little less risk each."""
    sums_of_some = np.where(can_change, sums, 0.0)
    order = np.argsort(-sums_of_some, kind="stable")
    given_up = (1.0 - _TUNED.gentle) * np.cumsum(sums_of_some[order])
    count = int(np.searchsorted(given_up, sums.sum() - budget)) + 1
    is_free = np.zeros_like(can_change)
    is_free[order[:count]] = True
    return is_free & can_change


def repriced(
    problem: SetProblem, incumbent: Incumbent, unit: float, unit_price: float, limits: Limits
) -> Incumbent:
    """Return a good plan with the same alternatives at another price of risk, by a single node.

    Parameters
    ----------
    problem : SetProblem
        The set.
    incumbent : Incumbent
        Its plan.
    unit : float
        The fleet's unit of risk [-].
    unit_price : float
        Cost of one unit of risk.
    limits : Limits
        When to stop early.

    Returns
    -------
    Incumbent
        No worse at that price than the plan given.
    """
    program = problem.program
    clearances = program.clearances(incumbent.z)
    alternatives = incumbent.selection.tolist()
    far = float(program.tail.clearance_for(_NEAR * unit))
    near = tuple(
        a
        for v, a in enumerate(alternatives)
        if clearances[program.rows_of(a)].min(initial=np.inf) < far
        or v >= program.num_avoidances - program.num_visits
    )
    tree = RiskTree(
        program, unit, unit_price, gap=1e-3, scale=unit_price, limits=limits, rater=problem.rater
    )
    tree.resume(((-np.inf, near),), unit_price, incumbent)
    tree.run(1)
    return incumbent if tree.best is None else tree.best


class AllocatedPrograms:
    """The linear programs of plans whose risks are rescaled, from one budget to the next."""

    def __init__(self) -> None:
        self._kept: dict[Incumbent, _AllocatedLp] = {}
        self._chosen: dict[Incumbent, _ChosenRows] = {}
        self._most = _WARM if is_compiled() else _WARM_BY_HIGHS

    def of(self, problem: SetProblem, incumbent: Incumbent) -> _AllocatedLp:
        """Return the program of a plan, with its alternatives held.

        Parameters
        ----------
        problem : SetProblem
            The set.
        incumbent : Incumbent
            Its plan.
        """
        if incumbent not in self._kept:
            is_warm = len(self._kept) < self._most
            self._kept[incumbent] = _AllocatedLp(problem, incumbent, is_warm=is_warm)
        return self._kept[incumbent]

    def risks(self, problem: SetProblem, incumbent: Incumbent, z: Vector) -> Vector:
        """Return the risk of each event at a point, alternatives as in a plan, (e,) [-].

        Parameters
        ----------
        problem : SetProblem
            The set.
        incumbent : Incumbent
            The plan.
        z : (n,) array
            The point: most sets stay where the plan has them.
        """
        if incumbent not in self._chosen:
            self._chosen[incumbent] = _ChosenRows(problem, incumbent)
        chosen = self._chosen[incumbent]
        return chosen.as_planned if z is incumbent.z else chosen.risks(z)


class _ChosenRows:
    """The rows of a plan's alternatives, and what they risk.

    Parameters
    ----------
    problem : SetProblem
        The set.
    incumbent : Incumbent
        The plan.
    """

    def __init__(self, problem: SetProblem, incumbent: Incumbent) -> None:
        program = problem.program
        self._rater, self._tail = problem.rater, program.tail
        rows = program.selected_rows(incumbent.selection)
        order = program.rows.events[rows].argsort(kind="stable")
        self._rows, events = rows[order], program.rows.events[rows[order]]
        self._begins = np.flatnonzero(np.append(True, events[1:] != events[:-1])[: events.size])
        self._events, self._count = events[self._begins], program.rows.risk_items.size
        self.as_planned = self.risks(incumbent.z)

    def risks(self, z: Vector) -> Vector:
        """Return the risk of each event at a point, 0 of those that are not chosen, (e,) [-]."""
        risks = np.zeros(self._count)
        if self._begins.size:
            clearances = self._rater.rate(z).clearances[self._rows]
            risks[self._events] = np.maximum.reduceat(
                self._tail.probability(clearances), self._begins
            )
        return risks


class _AllocatedLp:
    """The linear program of a set whose events take at most what they are allocated.

    Rows far away are left out: the true risk of the outcome tells if it comes near them.

    Parameters
    ----------
    problem : SetProblem
        The set.
    incumbent : Incumbent
        The plan whose alternatives are held.
    is_warm : bool
        Whether it is kept for the next solve.
    """

    def __init__(self, problem: SetProblem, incumbent: Incumbent, *, is_warm: bool) -> None:
        program = problem.program
        chosen = program.selected_rows(incumbent.selection)
        deviations = program.rows.deviations[chosen]
        is_held = (deviations == 0.0) | (
            program.clearances(incumbent.z)[chosen] < program.tail.beyond(_FAR)
        )
        chosen = chosen[is_held]
        self._program, self._is_warm = program, is_warm
        self._deviations, self._events = deviations[is_held], program.rows.events[chosen]
        self._matrix, self._right = program.column_rows(chosen)
        self._lp: tuple[BoundedLp, int] | None = None

    def point(self, allocated: Vector) -> Vector | None:
        """Return the point of least cost, (n,), for what events are allocated, (e,) [-]."""
        margins = self._deviations * self._program.tail.clearance_for(allocated[self._events])
        right = self._right - margins
        free = np.full(right.size, -np.inf)
        if self._lp is None:
            program = self._program
            lp = bounded_lp(program.cost, program.lower, program.upper)
            lp.add_rows(program.hard, program.hard_lower, program.hard_upper)
            first = lp.add_rows(self._matrix, free, right)
            self._lp = (lp, first) if self._is_warm else None
        else:
            lp, first = self._lp
            lp.bound_rows(list(range(first, first + right.size)), free, right)
        outcome, _ = lp.solve()
        return lp.point() if outcome is LpOutcome.OPTIMAL else None
