"""What a risk policy is, what it is asked, and what it answers. Knows none of them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import ClassVar, Literal

import numpy as np

from radmpc.arrays import Indices, Vector
from radmpc.planners.draft import Step
from radmpc.program.program import DisjunctiveProgram
from radmpc.records import dataclass
from radmpc.solvers.solution import Guide, Limits, Outcome, Solution, Solver

__all__ = ["Family", "Policy", "Propose", "RiskUse", "SolveRequest", "Solved"]

Propose = Callable[[Vector], Indices | None]
"""Proposes one alternative per avoidance at given margins."""

Family = Literal["deterministic", "fixed", "iterated", "pooled", "priced"]
"""How a policy uses Δ: not at all, in shares fixed beforehand, in shares moved from solve to solve,
in shares of a pool that one vehicle after the other draws from, or as a variable of the search."""

_NOTHING = Solution(Outcome.INFEASIBLE, None, None, float("inf"), float("inf"))

_RESERVE = 1e-7
"""Share of the budget left over for the linear solver's feasibility tolerance [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Solved:
    """Answer to a program under a policy.

    Attributes
    ----------
    solution : Solution
        The best solve.
    allocation : (x,) array or None
        The allocation it was made at; None where the policy allocates none.
    steps : tuple of Step
        Every solve.
    """

    solution: Solution
    allocation: Vector | None
    steps: tuple[Step, ...]

    @classmethod
    def infeasible(cls) -> Solved:
        """Return the answer where the risk at k = 0 alone is beyond Δ.

        Returns
        -------
        Solved
            Without a point.
        """
        return cls(_NOTHING, None, ())


@dataclass(frozen=True, slots=True)
class RiskUse:
    """How a solve used its risk; what a policy does not know stays as it is.

    Attributes
    ----------
    allocated : float
        Risk that the chosen rows were allocated [-].
    used : float
        Risk that they run [-]; nan where it was not computed.
    num_active, num_chosen : int
        Risk items that used all their risk, and risk items with a chosen row.
    """

    allocated: float = 0.0
    used: float = 0.0
    num_active: int = 0
    num_chosen: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class SolveRequest:
    """A program, and how it is to be solved.

    Attributes
    ----------
    program : DisjunctiveProgram
        The program.
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
    rng : Generator or None
        For solvers that draw samples.
    """

    program: DisjunctiveProgram
    solver: Solver
    gap: float
    limits: Limits
    stage: str
    vehicles: tuple[str, ...]
    propose: Propose | None = None
    rng: np.random.Generator | None = None

    @property
    def budget(self) -> float:
        """What the rows may risk in all; not positive where the start alone exceeds Δ."""
        return self.program.budget * (1.0 - _RESERVE)

    def solve(self, margins: Vector, start: Indices | None = None) -> Solution:
        """Solve once.

        Parameters
        ----------
        margins : (r,) array
            Back-off of each row [m].
        start : (v,) int array or None
            A selection to begin with.

        Returns
        -------
        Solution
            Infeasible is an answer.
        """
        return self.solver.solve(
            self.program,
            margins,
            gap=self.gap,
            limits=self.limits,
            start=start,
            guide=self._guide(margins) if start is None else None,
            rng=self.rng,
        )

    def step(self, iteration: int, solution: Solution, risk_use: RiskUse) -> Step:
        """Make the record of a solve.

        Parameters
        ----------
        iteration : int
            Counts from 0.
        solution : Solution
            The solve.
        risk_use : RiskUse
            How it used its risk.

        Returns
        -------
        Step
            The record.
        """
        return Step(
            self.stage,
            self.vehicles,
            iteration,
            solution.cost,
            risk_use.num_active,
            risk_use.num_chosen,
            risk_use.allocated,
            risk_use.used,
            gap=solution.gap,
            nodes=solution.nodes,
            seconds=solution.seconds,
        )

    def _guide(self, margins: Vector) -> Guide | None:
        """Return a guide that proposes at these margins."""
        propose = self.propose
        return None if propose is None else lambda: propose(margins)


class Policy(ABC):
    """How Δ becomes risks of rows. A frozen record of options; ``str`` is the name users type."""

    __slots__ = ()

    family: ClassVar[Family]
    """How the policy uses Δ: what decompositions choose by."""

    needs_proof: ClassVar[bool] = True
    """Whether it takes "none found" for "there is none", or costs for the least."""

    @property
    def draws_from_pool(self) -> bool:
        """Whether it plans nothing where its share of a common pool of risk is used up."""
        return self.family == "pooled"

    @property
    def charges_used(self) -> bool:
        """Whether only the risk that rows run leaves the pool, not all that they were allocated."""
        return False

    def sought(self, risk_bound: float) -> str:
        """Return which paths are looked for, in words after "finds no path".

        Parameters
        ----------
        risk_bound : float
            Δ [-].

        Returns
        -------
        str
            What such a path keeps to, and whether the planner looks at anything else.
        """
        return f"within the risk bound {risk_bound:g} that this planner sees"

    @abstractmethod
    def solve(self, request: SolveRequest) -> Solved:
        """Solve a program under this policy.

        Parameters
        ----------
        request : SolveRequest
            The program, the solver, limits.

        Returns
        -------
        Solved
            Infeasible where the risk at k = 0 alone is beyond Δ.
        """
