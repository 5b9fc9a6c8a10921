"""A planner is a record of three choices about one program: policy, solver, decomposition."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from concurrent.futures import Executor
from typing import ClassVar

import numpy as np

from radmpc.arguments import is_number, value_text
from radmpc.arrays import Matrix
from radmpc.errors import ScenarioError
from radmpc.model.scenario import Scenario
from radmpc.planners.draft import Draft
from radmpc.planners.policies.policy import Family, Policy
from radmpc.planners.verdict import Judge
from radmpc.records import dataclass, replace
from radmpc.solvers.solution import Limits, Solver
from radmpc.wording import number_text

__all__ = ["Decomposition", "Improved", "Planner", "Progress", "Run", "no_listener"]

_GAP = 1e-3
"""Relative gap at which each solve stops where none is asked for [-]."""

Progress = Callable[[str, int, int | None], None]
"""Called with the stage, its parts done, and how many there are, None if that is not known."""

TellBest = Callable[[float, float | None], None]
"""Called with the cost of the best plan so far and a lower bound on plans like it, or None."""

Improved = Callable[[tuple[Matrix, ...]], None]
"""Called with every vehicle's controls in a plan that is certified and the best so far."""


def no_listener(*_: object) -> None:
    """Ignore progress, costs and plans: the default of callbacks."""


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """What one run of a planner is given beside scenario and planner.

    Attributes
    ----------
    rng : Generator
        Source of every random choice.
    limits : Limits
        When to stop early; to be asked often.
    executor : Executor or None
        Where independent sets are planned; None plans them here. The plan is the same.
    progress : callable
        Called with the stage of planning, its parts done and their number.
    judge : callable
        Called with every vehicle's controls, in the scenario's order; returns a verdict.
    found : callable
        Called with the cost of the best plan so far, and a lower bound or None.
    improved : callable
        Given the controls of the best plan so far, now and then, also the same twice.
    """

    rng: np.random.Generator
    limits: Limits
    executor: Executor | None
    progress: Progress
    judge: Judge
    found: TellBest
    improved: Improved = no_listener

    def in_silence(self) -> Run:
        """Return the same run, which does not hand on its plans.

        Returns
        -------
        Run
            With the same limits, randomness and referee.
        """
        return replace(self, found=no_listener, improved=no_listener)


class Decomposition(ABC):
    """Which vehicles are planned together. A frozen record; ``str`` is the name users type."""

    __slots__ = ()

    families: ClassVar[frozenset[Family]] = frozenset({"deterministic", "fixed", "iterated"})
    """Risk policies that it can plan with, by how they use Δ."""

    solvers: ClassVar[tuple[type[Solver], ...]] = (Solver,)
    """Solvers that it can plan with."""

    needs_proof: ClassVar[bool] = False
    """Whether it takes "none found" for "there is none", or costs for the least."""

    takes_shared: ClassVar[bool] = True
    """Whether it plans vehicles whose disturbances are partly the same, or that keep a range."""

    default_seconds: ClassVar[float | None] = None
    """Time limit where none is given [s]; None is no limit."""

    plans_visits: ClassVar[bool] = True
    """Whether its plans make visits (`via`) and arrive within windows (`Goal.within`)."""

    @abstractmethod
    def plan(self, scenario: Scenario, planner: Planner, run: Run) -> Draft:
        """Plan a fleet.

        Parameters
        ----------
        scenario : Scenario
            The question.
        planner : Planner
            Policy, solver and gap.
        run : Run
            Limits, randomness, executor, progress and the referee.

        Returns
        -------
        Draft
            Also without a plan: then it says why.
        """


@dataclass(frozen=True, slots=True)
class Planner:
    """How a scenario is planned: risk policy × solver × decomposition.

    Attributes
    ----------
    policy : Policy
        How Δ becomes risks of rows.
    solver : Solver
        How the disjunctions are searched.
    decomposition : Decomposition
        Which vehicles are planned together.
    gap : float
        Relative gap at which each solve stops, > 0.

    Examples
    --------
    >>> from radmpc.planners import Branch, Centralized, Uniform
    >>> print(Planner(Uniform(), Branch(), Centralized()))
    uniform, branch, centralized
    """

    policy: Policy
    solver: Solver
    decomposition: Decomposition
    gap: float = _GAP

    def __post_init__(self) -> None:
        """Refuse choices that do not go together."""
        for name, kind, example in (
            ("policy", Policy, "Uniform()"),
            ("solver", Solver, "Branch()"),
            ("decomposition", Decomposition, "Centralized()"),
        ):
            choice = getattr(self, name)
            if not isinstance(choice, kind):
                raise ScenarioError(
                    f"{name} must be a record such as {example}, got {value_text(choice)}"
                )
        if not (is_number(self.gap) and 0.0 < self.gap < 1.0):
            raise ScenarioError(f"gap must lie between 0 and 1, got {value_text(self.gap)}")
        if self.policy.family not in self.decomposition.families:
            known = ", ".join(sorted(self.decomposition.families))
            raise ScenarioError(
                f"policy '{self.policy}' ({self.policy.family}) does not go with "
                f"'{self.decomposition}', which takes policies that are {known}"
            )
        if not isinstance(self.solver, self.decomposition.solvers):
            known = ", ".join(kind.__name__ for kind in self.decomposition.solvers)
            raise ScenarioError(
                f"decomposition '{self.decomposition}' needs the solver {known}, "
                f"got '{self.solver}'"
            )
        for name, part in (("policy", self.policy), ("decomposition", self.decomposition)):
            if part.needs_proof and not self.solver.proves:
                raise ScenarioError(
                    f"solver '{self.solver}' does not go with the {name} '{part}', which needs one "
                    "that proves that there is no solution"
                )

    def check_visits(self, scenario: Scenario, called: Callable[[Planner], str] = str) -> None:
        """Refuse a scenario whose visits, windows of arrival or norms these choices cannot plan.

        Parameters
        ----------
        scenario : Scenario
            What is to be planned.
        called : callable
            Returns what users call these choices.

        Raises
        ------
        ScenarioError
            With the first vehicle that has any.
        """
        if self.decomposition.plans_visits and self.solver.plans_visits:
            return
        for i, vehicle in enumerate(scenario.vehicles):
            if not self.solver.plans_visits and (vehicle.control_norm or vehicle.speed_norm):
                raise ScenarioError(
                    f"limits a norm, which '{called(self)}' does not know: limit each axis, or "
                    "take certified",
                    ("vehicles", i, "control_limit" if vehicle.control_norm else "speed_limit"),
                )
        for i, vehicle in enumerate(scenario.vehicles):
            if vehicle.via or vehicle.goal.within is not None:
                raise ScenarioError(
                    f"the planner '{called(self)}' does not support visits or arrival windows; use "
                    "certified, distance, or a centralized planner with branch or big_m",
                    ("vehicles", i, *(("via",) if vehicle.via else ("goal", "within"))),
                )

    @property
    def bounds_risk(self) -> bool:
        """Whether its policy allocates Δ; otherwise the certificate may be anything."""
        return self.policy.family != "deterministic"

    def __str__(self) -> str:
        gap = "" if self.gap == _GAP else f", gap={number_text(self.gap)}"
        return f"{self.policy}, {self.solver}, {self.decomposition}{gap}"
