"""What plans by linear programs are asked for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor

from radmpc.arrays import Matrix
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.verdict import Judge
from radmpc.program.hazards import Hazards
from radmpc.program.program import DisjunctiveProgram
from radmpc.records import dataclass
from radmpc.solvers.solution import Limits

__all__ = ["Task", "task_of"]


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


def task_of(fleet: Fleet, judge: Judge, controls: Sequence[Matrix]) -> Task:
    """Return what turning half-spaces is asked of a fleet.

    Parameters
    ----------
    fleet : Fleet
        The fleet, with the limits that end it.
    judge : callable
        The referee.
    controls : sequence of (T, m) array
        Of a plan: visits are made at its steps.
    """
    hazards, bound = fleet.programs.hazards.visiting(controls), fleet.scenario.risk_bound
    say = lambda one: fleet.improved(one.controls)  # noqa: E731 - said at once
    return Task(hazards, judge, fleet.limits, fleet.gap, bound, say, executor=fleet.executor)
