"""A programme under a risk policy: one solve, or IRA's alternation of solving and reallocating."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass

from radmpc.arrays import Indices, Vector
from radmpc.planners.draft import Step
from radmpc.program.policy import (
    Ira,
    NoRisk,
    Policy,
    Pool,
    Sigmas,
    Uniform,
    allocated,
    allocation_from,
    margins_of,
    reallocate,
    uniform_allocation,
)
from radmpc.program.program import DisjunctiveProgram
from radmpc.solvers.branch import Branch
from radmpc.solvers.frozen import solve_selection
from radmpc.solvers.solution import Guide, Limits, Outcome, Solution, Solver

__all__ = ["Propose", "Solved", "solve_under_policy"]

_LOG = logging.getLogger(__name__)

Propose = Callable[[Vector], Indices | None]
"""Proposes one alternative per avoidance at given margins."""

_NOTHING = Solution(Outcome.INFEASIBLE, None, None, float("inf"), float("inf"))

_START_SIGMAS = (4.0, 3.6, 3.2, 2.9, 2.6, 2.3, 2.0, 1.7)
_START_NODES = 1_000
_START_GAP = 0.01

_RESERVE = 1e-7
"""Share of the budget left over for the linear solver's feasibility tolerance."""


@dataclass(frozen=True, slots=True, eq=False)
class Solved:
    """Answer to a programme under a policy.

    Attributes
    ----------
    solution : Solution
        The best solve.
    allocation : (x,) array or None
        The allocation it was made at; None where the policy allots none.
    steps : tuple of Step
        Every solve.
    """

    solution: Solution
    allocation: Vector | None
    steps: tuple[Step, ...]


def solve_under_policy(
    program: DisjunctiveProgram,
    policy: Policy,
    solver: Solver,
    *,
    gap: float,
    limits: Limits,
    stage: str,
    vehicles: tuple[str, ...],
    propose: Propose | None = None,
) -> Solved:
    """Solve a programme under a risk policy.

    Parameters
    ----------
    program : DisjunctiveProgram
        The programme.
    policy : Policy
        How its Δ becomes margins.
    solver : Solver
        How its disjunctions are searched.
    gap : float
        Relative gap of each solve.
    limits : Limits
        When to stop early.
    stage : str
        For the steps' record.
    vehicles : tuple of str
        For the steps' record.
    propose : callable or None
        Proposes a selection at given margins, for solvers that are slow to find any.

    Returns
    -------
    Solved
        Infeasible where the risk at k = 0 alone is beyond Δ.
    """
    if isinstance(policy, NoRisk | Sigmas):
        count = policy.count if isinstance(policy, Sigmas) else 0.0
        margins = count * program.rows.deviations
        if any(risk >= 0.5 for _, risk in program.initial):
            return Solved(_NOTHING, None, ())
        solution = solver.solve(
            program, margins, gap=gap, limits=limits, guide=_guide(propose, margins)
        )
        step = _step(stage, vehicles, 0, solution, (0, 0, 0.0, 0.0))
        return Solved(solution, None, (step,) if solution.z is not None else ())
    budget = program.budget * (1.0 - _RESERVE)
    if budget <= 0.0:
        return Solved(_NOTHING, None, ())
    spread = policy.spread if isinstance(policy, Uniform | Ira | Pool) else "reached"
    allotment = uniform_allocation(program, budget, spread)
    if isinstance(policy, Ira):
        ira = _Ira(program, policy, solver, gap, limits, budget, stage, vehicles, propose)
        return ira.run(allotment)
    margins = margins_of(program, allotment)
    solution = solver.solve(
        program, margins, gap=gap, limits=limits, guide=_guide(propose, margins)
    )
    if solution.selection is None or solution.z is None:
        return Solved(solution, allotment, ())
    paid = allocated(program, allotment, solution.selection)
    return Solved(
        solution, allotment, (_step(stage, vehicles, 0, solution, (0, 0, paid, float("nan"))),)
    )


@dataclass(frozen=True, slots=True)
class _Ira:
    """The loop of IRA (paper, section Iterative Risk Allocation)."""

    program: DisjunctiveProgram
    policy: Ira
    solver: Solver
    gap: float
    limits: Limits
    budget: float
    stage: str
    vehicles: tuple[str, ...]
    propose: Propose | None

    def run(self, allocation: Vector) -> Solved:
        """Alternate until the cost stops falling, none or all are active, or a limit."""
        best: Solution | None = None
        best_allocation = allocation
        steps: list[Step] = []
        start: Indices | None = None
        for iteration in range(self.policy.max_iterations):
            solution = self._solve(allocation, start)
            if solution.outcome is Outcome.INFEASIBLE and iteration == 0:
                found = self._other_start()
                if found is not None:
                    allocation, start = found
                    solution = self._solve(allocation, start)
            if solution.z is None or solution.selection is None:
                return Solved(best or solution, best_allocation, tuple(steps))
            upper = reallocate(
                self.program, allocation, solution.selection, solution.z, self.budget, self.policy
            )
            paid = allocated(self.program, allocation, solution.selection)
            counts = (upper.num_active, upper.num_chosen, paid, upper.used)
            steps.append(_step(self.stage, self.vehicles, iteration, solution, counts))
            _LOG.info(
                "%s, %d vehicles: iteration %d, cost %.6g; %d of %d constraints use up their risk; "
                "simple bounds sum to %.3g, %.3g allotted; %.2f s",
                self.stage,
                len(self.vehicles),
                iteration + 1,
                solution.cost,
                upper.num_active,
                upper.num_chosen,
                upper.used,
                paid,
                solution.seconds,
            )
            fell = best is None or solution.cost < best.cost - self.gap * abs(best.cost)
            if best is None or solution.cost < best.cost:
                best, best_allocation = solution, allocation
            if not fell or upper.num_active in {0, upper.num_chosen} or self.limits.reached:
                break
            allocation, start = upper.allocation, solution.selection
        if best is None:  # max_iterations < 1
            return Solved(self._solve(allocation, None), allocation, ())
        return Solved(best, best_allocation, tuple(steps))

    def _other_start(self) -> tuple[Vector, Indices] | None:
        """Return an allocation and sides to begin with where the uniform one has no solution.

        A uniform allocation starves the few rows that need much. Every row is first held back by
        the same number of standard deviations, the most that leaves a solution within budget;
        what its rows run then is what they are allotted.
        """
        search = Branch(_START_NODES)
        for count in _START_SIGMAS:
            if self.limits.reached:
                return None
            margins = count * self.program.rows.deviations
            solution = search.solve(self.program, margins, gap=_START_GAP, limits=self.limits)
            if solution.z is None or solution.selection is None:
                continue
            allocation = allocation_from(self.program, solution.selection, solution.z, self.budget)
            return None if allocation is None else (allocation, solution.selection)
        return None

    def _solve(self, allocation: Vector, start: Indices | None) -> Solution:
        """Run the lower stage; the sides of the last solve stay if new ones would pay more than Δ.

        An allocation is made for the sides of the last solve. Under intervals other sides may
        use more distinct rows, and so be allotted more in total than the budget.
        """
        margins = margins_of(self.program, allocation)
        solution = self.solver.solve(
            self.program,
            margins,
            gap=self.gap,
            limits=self.limits,
            start=start,
            guide=_guide(self.propose, margins) if start is None else None,
        )
        if start is None or solution.selection is None:
            return solution
        if allocated(self.program, allocation, solution.selection) <= self.budget * (1 + 1e-12):
            return solution
        return solve_selection(self.program, margins, start)


def _guide(propose: Propose | None, margins: Vector) -> Guide | None:
    """Return a guide that proposes at these margins."""
    return None if propose is None else lambda: propose(margins)


def _step(
    stage: str,
    vehicles: tuple[str, ...],
    iteration: int,
    solution: Solution,
    counts: tuple[int, int, float, float],
) -> Step:
    """Return the record of a solve."""
    return Step(
        stage,
        vehicles,
        iteration,
        solution.cost,
        *counts,
        gap=solution.gap,
        nodes=solution.nodes,
        seconds=solution.seconds,
    )
