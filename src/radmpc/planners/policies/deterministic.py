"""Policies that allocate no risk: noise ignored, or held back by standard deviations."""

from __future__ import annotations

from typing import ClassVar

from radmpc.arguments import is_number, value_text
from radmpc.errors import ScenarioError
from radmpc.planners.policies.policy import Family, Policy, RiskUse, Solved, SolveRequest
from radmpc.records import dataclass
from radmpc.wording import number_text

__all__ = ["NoRisk", "Sigmas"]


@dataclass(frozen=True, slots=True)
class NoRisk(Policy):
    """Deterministic: noise is ignored."""

    family: ClassVar[Family] = "deterministic"
    needs_proof: ClassVar[bool] = False

    def __str__(self) -> str:
        return "none"

    def sought(self, risk_bound: float) -> str:
        """Return which paths are looked for; see `Policy.sought`."""
        del risk_bound  # ignored, as is noise
        return "whose mean touches nothing (all that this planner looks at)"

    def solve(self, request: SolveRequest) -> Solved:
        """Solve once; see `Policy.solve`."""
        return _solve_at(0.0, request)


@dataclass(frozen=True, slots=True)
class Sigmas(Policy):
    """Bounded disturbance as robust MPC treats it: every row keeps a number of deviations.

    Attributes
    ----------
    count : float
        Standard deviations kept, 0 to 7: what always keeps 7 is left out of programs.
    """

    family: ClassVar[Family] = "deterministic"
    needs_proof: ClassVar[bool] = False

    count: float = 3.0

    def __post_init__(self) -> None:
        """Refuse counts that programs cannot keep."""
        if not (is_number(self.count) and 0.0 <= self.count <= 7.0):
            raise ScenarioError(f"sigmas must lie between 0 and 7, got {value_text(self.count)}")

    def __str__(self) -> str:
        return f"sigmas({number_text(self.count)})"

    def sought(self, risk_bound: float) -> str:
        """Return which paths are looked for; see `Policy.sought`."""
        del risk_bound  # ignored: deviations count whatever they risk
        kept = number_text(self.count)
        return f"that keeps {kept} standard deviations clear (all that this planner looks at)"

    def solve(self, request: SolveRequest) -> Solved:
        """Solve once; see `Policy.solve`."""
        return _solve_at(self.count, request)


def _solve_at(count: float, request: SolveRequest) -> Solved:
    """Solve with every row held back by a number of standard deviations."""
    program = request.program
    if any(risk >= 0.5 for _, risk in program.initial):
        return Solved.infeasible()
    solution = request.solve(count * program.rows.deviations)
    step = request.step(0, solution, RiskUse())
    return Solved(solution, None, (step,) if solution.z is not None else ())
