"""What CONTRIBUTING says of adding a part: a toy of each kind works with nothing else touched."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

from radmpc.errors import ScenarioError
from radmpc.experiments.families import paper
from radmpc.model.plan import Status
from radmpc.planners import (
    Branch,
    Centralized,
    Decomposition,
    Planner,
    Policy,
    Receding,
    Run,
    Solver,
)
from radmpc.planners.draft import Draft
from radmpc.planners.policies import Family, RiskUse, Solved, SolveRequest
from radmpc.planning import plan
from radmpc.program.allocation import margins_of
from radmpc.solvers.solution import Solution


@dataclass(frozen=True, slots=True)
class Cautious(Policy):
    """Half of Δ, spread evenly over all risk items."""

    family: ClassVar[Family] = "fixed"
    needs_proof: ClassVar[bool] = False

    def __str__(self) -> str:
        return "cautious"

    def solve(self, request: SolveRequest) -> Solved:
        """Solve once."""
        program = request.program
        count = len(program.risk_items)
        most = int(np.bincount(program.rows.risk_items, minlength=count).max(initial=1))
        allocation = np.full(count, 0.5 * request.budget / (count * most))
        solution = request.solve(margins_of(program, allocation))
        step = request.step(
            0, solution, RiskUse(allocated=float(allocation.sum()), used=float("nan"))
        )
        return Solved(solution, allocation, (step,))


@dataclass(frozen=True, slots=True)
class Twice(Decomposition):
    """The whole fleet, planned twice: the second plan counts."""

    default_seconds: ClassVar[float | None] = 30.0

    def __str__(self) -> str:
        return "twice"

    def plan(self, scenario, planner: Planner, run: Run) -> Draft:
        """Plan as `Centralized` does, two times."""
        Centralized().plan(scenario, planner, run)
        return Centralized().plan(scenario, planner, run)


@dataclass(frozen=True, slots=True)
class Patient(Solver):
    """`Branch`, asked for a tenth of the gap."""

    def __str__(self) -> str:
        return "patient"

    def solve(self, program, margins, *, gap, limits, start=None, guide=None, rng=None) -> Solution:
        """Minimize the cost at fixed margins."""
        return Branch().solve(
            program, margins, gap=0.1 * gap, limits=limits, start=start, guide=guide, rng=rng
        )


def test_a_policy_of_ones_own_plans_with_every_decomposition_that_takes_its_family():
    for decomposition in (Centralized(), Receding(), Twice()):
        result = plan(paper(2, 1), Planner(Cautious(), Branch(), decomposition))
        assert result.status is Status.FEASIBLE
        assert result.is_certified
        assert result.plan.planner == f"cautious, branch, {decomposition}"


def test_a_solver_of_ones_own_is_asked_like_any_other():
    ours = plan(paper(2, 1), Planner(Cautious(), Patient(), Centralized()))
    theirs = plan(paper(2, 1), Planner(Cautious(), Branch(), Centralized(), gap=1e-4))
    assert ours.cost == pytest.approx(theirs.cost, rel=1e-9)


def test_what_does_not_go_together_is_refused_by_what_the_parts_say_of_themselves():
    @dataclass(frozen=True, slots=True)
    class Priced(Cautious):
        family: ClassVar[Family] = "priced"

    with pytest.raises(ScenarioError, match="does not go with 'twice'"):
        Planner(Priced(), Branch(), Twice())
