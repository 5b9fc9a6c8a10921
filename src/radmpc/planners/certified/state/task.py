"""What plans by linear programs are asked for."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor

from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.verdict import Judge
from radmpc.program.hazards import Hazards
from radmpc.program.program import DisjunctiveProgram
from radmpc.records import dataclass
from radmpc.solvers.solution import Limits

__all__ = ["Task"]


@dataclass(frozen=True, slots=True, eq=False)
class Task:
    """What is asked.

    Attributes
    ----------
    hazards : Hazards
        The fleet.
    judge : callable
        The referee.
    limits : Limits
        When to stop early.
    gap : float
        Relative difference of costs below which plans count as equal [-].
    risk_bound : float
        Δ [-].
    found : callable
        Given every better plan.
    program_alone : callable or None
        Returns the program of a vehicle alone, by its number; None where no path alone is sought.
    executor : Executor or None
        Where linear programs of a large fleet are solved; None is here.
    """

    hazards: Hazards
    judge: Judge
    limits: Limits
    gap: float
    risk_bound: float
    found: Callable[[FleetIncumbent], None] = lambda incumbent: None
    program_alone: Callable[[int], DisjunctiveProgram] | None = None
    executor: Executor | None = None
