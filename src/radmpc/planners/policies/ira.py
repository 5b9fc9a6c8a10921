"""Iterative risk allocation: solve, move risk to the rows that use theirs, solve again."""

from __future__ import annotations

import logging
from typing import ClassVar

from radmpc.arguments import check_word, is_integer, is_number, value_text
from radmpc.arrays import Indices, Vector
from radmpc.errors import ScenarioError
from radmpc.planners.draft import Step
from radmpc.planners.policies.policy import Family, Policy, RiskUse, Solved, SolveRequest
from radmpc.planners.policies.uniform import spread_text
from radmpc.program.allocation import (
    Spread,
    allocated,
    allocation_from,
    margins_of,
    reallocate,
    uniform_allocation,
)
from radmpc.records import dataclass
from radmpc.solvers.branch.branch import Branch
from radmpc.solvers.lp.one_selection import solve_selection
from radmpc.solvers.solution import Outcome, Solution
from radmpc.wording import changed_texts, count_text, with_options

__all__ = ["Ira"]

_LOG = logging.getLogger(__name__)

_START_SIGMAS = (4.0, 3.6, 3.2, 2.9, 2.6, 2.3, 2.0, 1.7)
"""Standard deviations held back, one after the other, where equal risks have no solution."""

_START_NODES = 1_000
"""Nodes of each of these searches."""

_START_GAP = 0.01
"""Relative gap of each of these searches: only its risks are used."""


@dataclass(frozen=True, slots=True)
class Ira(Policy):
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
        Which rows receive risk. The paper states both; only the first lowers the cost.
    spread : {'reached', 'all'}
        Which rows have a share in the first pass, see `Uniform`.
    """

    family: ClassVar[Family] = "iterated"

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
                raise ScenarioError(f"{name} must lie between 0 and 1, got {value_text(share)}")
        if not (is_integer(self.max_iterations) and self.max_iterations >= 1):
            raise ScenarioError(
                f"max_iterations must be an integer >= 1, got {value_text(self.max_iterations)}"
            )

    def __str__(self) -> str:
        direction = "" if self.direction == "to_active" else self.direction
        numbers = changed_texts(self, Ira(), "active_tol", "keep", "max_iterations")
        return with_options("ira", direction, spread_text(self.spread), *numbers)

    def solve(self, request: SolveRequest) -> Solved:
        """Alternate between solving and reallocating; see `Policy.solve`."""
        if request.budget <= 0.0:
            return Solved.infeasible()
        allocation = uniform_allocation(request.program, request.budget, self.spread)
        return _Iteration(self, request).run(allocation)


@dataclass(frozen=True, slots=True)
class _Iteration:
    """The loop of IRA (paper, section Iterative Risk Allocation)."""

    policy: Ira
    request: SolveRequest

    def run(self, allocation: Vector) -> Solved:
        """Alternate until the cost stops falling, none or all are active, or a limit."""
        request = self.request
        best: Solution | None = None
        best_allocation = allocation
        steps: list[Step] = []
        start: Indices | None = None
        while True:
            iteration = len(steps)
            solution = self._solve(allocation, start)
            if solution.outcome is Outcome.INFEASIBLE and iteration == 0:
                found = self._other_start()
                if found is not None:
                    allocation, start = found
                    solution = self._solve(allocation, start)
            if solution.z is None or solution.selection is None:
                return Solved(best or solution, best_allocation, tuple(steps))
            upper = reallocate(
                request.program,
                allocation,
                solution.selection,
                solution.z,
                request.budget,
                active_tol=self.policy.active_tol,
                keep=self.policy.keep,
                is_paid_to_active=self.policy.direction == "to_active",
            )
            paid = allocated(request.program, allocation, solution.selection)
            risk_use = RiskUse(paid, upper.used, upper.num_active, upper.num_chosen)
            steps.append(request.step(iteration, solution, risk_use))
            _tell(steps[-1], solution.seconds)
            fell = best is None or solution.cost < best.cost - request.gap * abs(best.cost)
            if best is None or solution.cost < best.cost:
                best, best_allocation = solution, allocation
            is_last = iteration + 1 >= self.policy.max_iterations or request.limits.reached
            if is_last or not fell or upper.num_active in {0, upper.num_chosen}:
                return Solved(best, best_allocation, tuple(steps))
            allocation, start = upper.allocation, solution.selection

    def _other_start(self) -> tuple[Vector, Indices] | None:
        """Return an allocation and a selection to begin with where the uniform one has no solution.

        A uniform allocation starves the few rows that need much. Every row is first held back by
        the same number of standard deviations, the most that leaves a solution within budget;
        what its rows run then is what they are allocated.
        """
        search = Branch(_START_NODES)
        for count in _START_SIGMAS:
            if self.request.limits.reached:
                return None
            margins = count * self.request.program.rows.deviations
            solution = search.solve(
                self.request.program, margins, gap=_START_GAP, limits=self.request.limits
            )
            if solution.z is None or solution.selection is None:
                continue
            allocation = allocation_from(
                self.request.program, solution.selection, solution.z, self.request.budget
            )
            return None if allocation is None else (allocation, solution.selection)
        return None

    def _solve(self, allocation: Vector, start: Indices | None) -> Solution:
        """Run the lower stage; the last selection stays if a new one would be charged more than Δ.

        An allocation is made for the selection of the last solve. Under intervals another may
        use more distinct rows, and so be allocated more in total than the budget.
        """
        margins = margins_of(self.request.program, allocation)
        solution = self.request.solve(margins, start)
        if start is None or solution.selection is None:
            return solution
        if allocated(
            self.request.program, allocation, solution.selection
        ) <= self.request.budget * (1 + 1e-12):
            return solution
        return solve_selection(self.request.program, margins, start)


def _tell(step: Step, seconds: float) -> None:
    """Log an iteration."""
    _LOG.info(
        "%s, %s: iteration %d, cost %.6g; %d of %d constraints use up their risk; "
        "union bounds sum to %.3g, %.3g allocated; %.2f s",
        step.stage,
        count_text(len(step.vehicles), "vehicle"),
        step.iteration + 1,
        step.cost,
        step.num_active,
        step.num_chosen,
        step.used,
        step.allocated,
        seconds,
    )
