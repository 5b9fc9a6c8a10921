"""The interface of solvers: limits, outcomes, solutions."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from enum import Enum
from typing import ClassVar

import numpy as np

from radmpc.arrays import Indices, Vector
from radmpc.program.program import DisjunctiveProgram
from radmpc.records import dataclass, replace

__all__ = [
    "INSIDE",
    "Guide",
    "Limits",
    "Outcome",
    "Solution",
    "Solver",
    "cutoff_below",
    "never",
    "relative_gap",
]

Guide = Callable[[], Indices | None]
"""Proposes one alternative per avoidance, or None, from knowledge that solvers do not have."""


def never() -> bool:
    """Return False: no stop was requested."""
    return False


@dataclass(frozen=True, slots=True)
class Limits:
    """When to stop early.

    Attributes
    ----------
    deadline : float
        Value of ``time.monotonic()`` at which to stop; inf is never.
    is_stopped : callable
        Returns True once the user asked to stop.
    time_limit : float or None
        Seconds allowed in all, for messages.
    """

    deadline: float = float("inf")
    is_stopped: Callable[[], bool] = never
    time_limit: float | None = None

    @property
    def reached(self) -> bool:
        """Whether it is time to stop."""
        return self.is_stopped() or time.monotonic() >= self.deadline

    def within(self, seconds: float) -> Limits:
        """Return limits that end some seconds from now, or earlier."""
        return replace(self, deadline=min(self.deadline, time.monotonic() + seconds))

    @property
    def reason(self) -> str:
        """Which limit was reached, as a clause; empty where none was."""
        if self.is_stopped():
            return "it was stopped on request (Ctrl-C)"
        if time.monotonic() < self.deadline:
            return ""
        if self.time_limit is None:
            return "the time limit was reached"
        return f"the time limit of {self.time_limit:g} s was reached"

    @property
    def seconds_left(self) -> float:
        """Seconds until the deadline, never negative."""
        return max(0.0, self.deadline - time.monotonic())


class Outcome(Enum):
    """How a solve ended."""

    OPTIMAL = "solved within the gap"
    FEASIBLE = "a limit was hit with a solution at hand"
    INFEASIBLE = "no point satisfies the program"
    LIMIT = "a limit was hit before any solution was found"


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """Answer to a program at fixed margins.

    Attributes
    ----------
    outcome : Outcome
        How the solve ended.
    z : (n,) array or None
        The best point found.
    selection : (v,) int array or None
        The alternative chosen for each avoidance.
    cost : float
        Its cost; inf without a point.
    bound : float
        Proven lower bound on the cost; inf where infeasible.
    nodes : int
        Nodes of the search tree.
    lps : int
        Linear programs solved; 0 where the backend does not report it.
    seconds : float
        Time taken.
    """

    outcome: Outcome
    z: Vector | None
    selection: Indices | None
    cost: float
    bound: float
    nodes: int = 0
    lps: int = 0
    seconds: float = 0.0

    @property
    def gap(self) -> float:
        """Relative distance between cost and bound."""
        return relative_gap(self.cost, self.bound)


_LEAST_SCALE = 1e-9
"""Costs below this count as this in relative gaps: a plan may cost nothing."""

INSIDE = 1.0 - 1e-6
"""Share of the gap at which the cutoff lies [-]: a node cut off counts as within the gap whatever
rounding does."""


def relative_gap(cost: float, bound: float) -> float:
    """Return ``(cost − bound) / |cost|``; 0 where they agree, inf without a cost.

    Parameters
    ----------
    cost : float
        Cost of the incumbent; inf without one.
    bound : float
        Proven lower bound.
    """
    if cost <= bound:
        return 0.0
    if cost == float("inf"):
        return float("inf")
    return (cost - bound) / max(abs(cost), _LEAST_SCALE)


def cutoff_below(value: float, gap: float, scale: float = _LEAST_SCALE) -> float:
    """Return the bound from which on a node cannot improve an incumbent by more than the gap.

    Parameters
    ----------
    value : float
        Value of the incumbent.
    gap : float
        Relative gap at which the search stops.
    scale : float
        Values below this count as this.
    """
    return value - gap * INSIDE * max(abs(value), scale)


class Solver(ABC):
    """Searches the disjunctions of a program whose rows have fixed margins. A frozen record."""

    __slots__ = ()

    proves: ClassVar[bool] = True
    """Whether "none found" means that there is none, and costs come with a lower bound."""

    plans_visits: ClassVar[bool] = True
    """Whether it takes disjunctions over steps, as visits and arrivals are."""

    @abstractmethod
    def solve(
        self,
        program: DisjunctiveProgram,
        margins: Vector,
        *,
        gap: float,
        limits: Limits,
        start: Indices | None = None,
        guide: Guide | None = None,
        rng: np.random.Generator | None = None,
    ) -> Solution:
        """Minimize the cost with every chosen row held back by its margin.

        Parameters
        ----------
        program : DisjunctiveProgram
            The program.
        margins : (r,) array
            Back-off of each row [m].
        gap : float
            Relative gap at which to stop.
        limits : Limits
            When to stop early.
        start : (v,) int array or None
            A selection to try first.
        guide : callable or None
            Proposes a selection; called at most once, where the search is slow to find a solution.
        rng : Generator or None
            For solvers that draw samples; None is seed 0.

        Returns
        -------
        Solution
            Infeasible is an answer.
        """
