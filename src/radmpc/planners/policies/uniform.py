"""The same risk for every row, decided beforehand (Blackmore, Ono and Williams)."""

from __future__ import annotations

from typing import ClassVar

from radmpc.arguments import check_word
from radmpc.planners.policies.policy import Family, Policy, RiskUse, Solved, SolveRequest
from radmpc.program.allocation import Spread, allocated, margins_of, uniform_allocation
from radmpc.records import dataclass
from radmpc.wording import with_options

__all__ = ["Uniform", "solve_uniformly", "spread_text"]


@dataclass(frozen=True, slots=True)
class Uniform(Policy):
    """The same risk for every row, decided beforehand (Blackmore, Ono and Williams).

    Attributes
    ----------
    spread : {'reached', 'all'}
        Whether constraints that no admissible control can violate get a share, too. They need
        none: leaving them out gives the others more. The paper's text gives every constraint one.
    """

    family: ClassVar[Family] = "fixed"
    needs_proof: ClassVar[bool] = False

    spread: Spread = "reached"

    def __post_init__(self) -> None:
        """Refuse unknown words."""
        check_word(self.spread, ("reached", "all"), "spread")

    def __str__(self) -> str:
        return with_options("uniform", spread_text(self.spread))

    def solve(self, request: SolveRequest) -> Solved:
        """Solve once; see `Policy.solve`."""
        return solve_uniformly(request, self.spread)


def solve_uniformly(request: SolveRequest, spread: Spread) -> Solved:
    """Solve once with the budget spread evenly.

    Parameters
    ----------
    request : SolveRequest
        The program.
    spread : {'reached', 'all'}
        Which rows have a share, see `Uniform`.
    """
    program, budget = request.program, request.budget
    if budget <= 0.0:
        return Solved.infeasible()
    allocation = uniform_allocation(program, budget, spread)
    solution = request.solve(margins_of(program, allocation))
    if solution.selection is None or solution.z is None:
        return Solved(solution, allocation, ())
    paid = allocated(program, allocation, solution.selection)
    step = request.step(0, solution, RiskUse(allocated=paid, used=float("nan")))
    return Solved(solution, allocation, (step,))


def spread_text(spread: Spread) -> str:
    """Return what a policy's name says of its spread; empty of the usual one."""
    return "" if spread == "reached" else "all rows"
