"""Planning independent sets of vehicles, here or on an executor."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from dataclasses import dataclass, replace
from pathlib import Path

from radmpc.arrays import Matrix
from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario
from radmpc.planners.draft import Step
from radmpc.planners.explain import explain_infeasible
from radmpc.planners.ira import solve_under_policy
from radmpc.planners.planner import SolverChoice
from radmpc.planners.sides import propose_sides
from radmpc.program.build import build_program, controls_of, whole_subjects
from radmpc.program.policy import Policy
from radmpc.solvers.solution import Limits, Outcome

__all__ = ["SetPlan", "SetTask", "plan_sets", "run_sets", "verdict_of_sets"]

_POLL_SECONDS = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class SetTask:
    """A set of vehicles to be planned together; pickles.

    Attributes
    ----------
    scenario : Scenario
        These vehicles alone, with their share of Δ.
    policy : Policy
        Risk policy.
    solver : BigM or Branch
        Solver.
    gap : float
        Relative gap of each solve.
    stage : str
        For the steps' record.
    """

    scenario: Scenario
    policy: Policy
    solver: SolverChoice
    gap: float
    stage: str


@dataclass(frozen=True, slots=True, eq=False)
class SetPlan:
    """What planning a set gave.

    Attributes
    ----------
    outcome : Outcome
        How it ended.
    controls : tuple of (T, m) array
        Empty without a plan.
    steps : tuple of Step
        Every solve.
    explanation : str or None
        Why there is no plan.
    """

    outcome: Outcome
    controls: tuple[Matrix, ...]
    steps: tuple[Step, ...]
    explanation: str | None = None


def plan_set(task: SetTask, limits: Limits) -> SetPlan:
    """Plan one set of vehicles together.

    Parameters
    ----------
    task : SetTask
        The set.
    limits : Limits
        When to stop early.

    Returns
    -------
    SetPlan
        Infeasible is an answer, with its reason.
    """
    scenario = task.scenario
    subjects = whole_subjects(scenario)
    program = build_program(scenario, subjects, risk_bound=scenario.risk_bound)
    solved = solve_under_policy(
        program,
        task.policy,
        task.solver,
        gap=task.gap,
        limits=limits,
        stage=task.stage,
        vehicles=tuple(v.name for v in scenario.vehicles),
        propose=lambda margins: propose_sides(program, subjects, margins, limits),
    )
    solution = solved.solution
    if solution.z is not None:
        controls = tuple(controls_of(subjects, solution.z))
        return SetPlan(solution.outcome, controls, solved.steps)
    explanation = None
    if solution.outcome is Outcome.INFEASIBLE:
        explanation = explain_infeasible(scenario, task.policy, task.gap, limits)
    return SetPlan(solution.outcome, (), solved.steps, explanation)


def plan_sets(
    scenario: Scenario,
    sets: Sequence[tuple[int, ...]],
    task: Callable[[Scenario], SetTask],
    limits: Limits,
    executor: Executor | None,
    progress: Callable[[int, int], None],
) -> list[SetPlan]:
    """Plan every set with its share of Δ by head count (paper, Algorithm 1, line 5).

    Parameters
    ----------
    scenario : Scenario
        The whole fleet.
    sets : sequence of tuple of int
        A partition of its vehicles.
    task : callable
        Makes the task of a set from its scenario.
    limits : Limits
        When to stop early.
    executor : Executor or None
        None plans in this thread, one after the other.
    progress : callable
        Told how many sets are done, of how many.

    Returns
    -------
    list of SetPlan
        In the order of the sets, whatever the executor.
    """
    share = scenario.risk_bound / scenario.num_vehicles
    tasks = [task(scenario.subset(members, share * len(members))) for members in sets]
    return run_sets(tasks, limits, executor, progress)


def run_sets(
    tasks: Sequence[SetTask],
    limits: Limits,
    executor: Executor | None,
    progress: Callable[[int, int], None],
) -> list[SetPlan]:
    """Run tasks; see `plan_sets`."""
    if executor is None:
        plans = []
        for done, one in enumerate(tasks):
            # An equal part of the time left for each, so that one hard set starves no other.
            part = limits.seconds_left / (len(tasks) - done)
            plans.append(plan_set(one, replace(limits, deadline=time.monotonic() + part)))
            progress(done + 1, len(tasks))
        return plans
    return _run_elsewhere(tasks, limits, executor, progress)


def _run_elsewhere(
    tasks: Sequence[SetTask],
    limits: Limits,
    executor: Executor,
    progress: Callable[[int, int], None],
) -> list[SetPlan]:
    """Run tasks on an executor.

    Only the wall clock means the same in another process, and a queued task must not restart it.
    A stop reaches the workers of this machine as a file that appears.
    """
    deadline = time.time() + limits.seconds_left
    with tempfile.TemporaryDirectory(prefix="radmpc-") as folder:
        flag = Path(folder) / "stop"
        futures = [executor.submit(_plan_set_until, task, deadline, str(flag)) for task in tasks]
        waiting: set[Future[SetPlan]] = set(futures)
        while waiting:
            _, waiting = wait(waiting, timeout=_POLL_SECONDS, return_when=FIRST_COMPLETED)
            progress(len(tasks) - len(waiting), len(tasks))
            if waiting and limits.is_stopped():
                flag.touch()
        return [future.result() for future in futures]


def _plan_set_until(task: SetTask, deadline: float, flag: str) -> SetPlan:
    """Plan a set until a time of the wall clock, or until a file appears."""
    left = max(0.0, deadline - time.time())
    return plan_set(task, Limits(time.monotonic() + left, lambda: Path(flag).exists()))


def verdict_of_sets(
    scenario: Scenario, sets: tuple[tuple[int, ...], ...], plans: list[SetPlan]
) -> tuple[Status, str | None]:
    """Return the status of the whole from those of the sets, and what failed.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    sets : tuple of tuple of int
        A partition of it.
    plans : list of SetPlan
        The plan of each.

    Returns
    -------
    (Status, str or None)
        Feasible where every set has a plan; else why not.
    """
    names_of: dict[str, list[str]] = {}
    status = Status.FEASIBLE
    for members, plan in zip(sets, plans, strict=True):
        if plan.controls:
            continue
        limited = plan.outcome is Outcome.LIMIT
        if not limited:
            status = Status.INFEASIBLE
        elif status is Status.FEASIBLE:
            status = Status.LIMIT
        names = ", ".join(repr(scenario.vehicles[i].name) for i in members)
        why = "no plan within the limit." if limited else plan.explanation or "no plan."
        names_of.setdefault(why, []).append(names)
    if len(sets) == 1:
        return status, next(iter(names_of), None)
    reasons = [
        f"Set{'s' if len(names) > 1 else ''} of {'; '.join(names)}: {why}"
        for why, names in names_of.items()
    ]
    return status, " ".join(reasons) or None
