"""Planning independent sets of vehicles, here or on an executor."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from functools import partial

import numpy as np

from radmpc.arrays import Matrix
from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario
from radmpc.planners.coarse_search import propose_alternatives
from radmpc.planners.draft import Step
from radmpc.planners.executing import run_elsewhere
from radmpc.planners.explain import explain_infeasible
from radmpc.planners.planner import Planner, Run
from radmpc.planners.policies.policy import SolveRequest
from radmpc.planners.randomness import children
from radmpc.planners.wording import limit_clause
from radmpc.program.build import build_program, condensed_models, controls_of
from radmpc.records import dataclass
from radmpc.solvers.solution import Limits, Outcome

__all__ = ["SetPlan", "SetTask", "in_order", "plan_set", "plan_sets", "run_sets", "verdict_of_sets"]

_LIMITED = "No plan was found, and none was ruled out"
"""Said of sets that a limit stopped; which one follows."""


@dataclass(frozen=True, slots=True, eq=False)
class SetTask:
    """A set of vehicles to be planned together; pickles.

    Attributes
    ----------
    scenario : Scenario
        These vehicles alone, with their share of Δ.
    planner : Planner
        Policy, solver and gap.
    stage : str
        For the steps' record.
    rng : Generator or None
        For solvers that draw samples.
    fleet_bound : float or None
        Δ of the whole fleet; None where these are all of it.
    """

    scenario: Scenario
    planner: Planner
    stage: str
    rng: np.random.Generator | None = None
    fleet_bound: float | None = None


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
    models = condensed_models(scenario)
    program = build_program(scenario, models, risk_bound=scenario.risk_bound)
    request = SolveRequest(
        program,
        task.planner.solver,
        task.planner.gap,
        limits,
        task.stage,
        tuple(v.name for v in scenario.vehicles),
        propose=lambda margins: propose_alternatives(program, models, margins, limits),
        rng=task.rng,
    )
    solved = task.planner.policy.solve(request)
    solution = solved.solution
    if solution.z is not None:
        controls = tuple(controls_of(models, solution.z))
        return SetPlan(solution.outcome, controls, solved.steps)
    explanation = None
    if solution.outcome is Outcome.INFEASIBLE:
        explanation = explain_infeasible(scenario, task.planner, limits, task.fleet_bound)
    return SetPlan(solution.outcome, (), solved.steps, explanation)


def plan_sets(
    scenario: Scenario,
    sets: Sequence[tuple[int, ...]],
    planner: Planner,
    run: Run,
    stage: str,
) -> list[SetPlan]:
    """Plan every set with its share of Δ by head count (paper, Algorithm 1, line 5).

    Parameters
    ----------
    scenario : Scenario
        The whole fleet.
    sets : sequence of tuple of int
        A partition of its vehicles.
    planner : Planner
        Policy, solver and gap.
    run : Run
        Limits, executor, progress.
    stage : str
        What progress and the steps' record call it.

    Returns
    -------
    list of SetPlan
        In the order of the sets, whatever the executor.
    """
    whole = scenario.risk_bound
    share = whole / scenario.num_vehicles
    tasks = [
        SetTask(scenario.subset(members, share * len(members)), planner, stage, rng, whole)
        for members, rng in zip(sets, children(run.rng, len(sets)), strict=True)
    ]
    progress = partial(run.progress, stage)
    return run_sets(tasks, run.limits, run.executor, progress)


def run_sets(
    tasks: Sequence[SetTask],
    limits: Limits,
    executor: Executor | None,
    progress: Callable[[int, int], None],
) -> list[SetPlan]:
    """Run tasks, here or on an executor; what a worker that died took with it is planned here.

    Parameters
    ----------
    tasks : sequence of SetTask
        The sets.
    limits : Limits
        When to stop early.
    executor : Executor or None
        None plans in this thread, one after the other.
    progress : callable
        Called with the number of sets done, and of all.

    Returns
    -------
    list of SetPlan
        In the order of the tasks.
    """
    if executor is not None:
        found = run_elsewhere(plan_set, tasks, limits, executor, progress)
        return [
            plan_set(task, limits) if plan is None else plan
            for task, plan in zip(tasks, found, strict=True)
        ]
    plans = []
    for done, task in enumerate(tasks):
        # An equal part of the time left for each, so that one hard set starves no other.
        plans.append(plan_set(task, limits.within(limits.seconds_left / (len(tasks) - done))))
        progress(done + 1, len(tasks))
    return plans


def in_order(sets: Sequence[tuple[int, ...]], plans: Sequence[SetPlan]) -> tuple[Matrix, ...]:
    """Return the controls of all vehicles that have any, in the scenario's order.

    Parameters
    ----------
    sets : sequence of tuple of int
        A partition of the fleet.
    plans : sequence of SetPlan
        The plan of each.

    Returns
    -------
    tuple of (T, m) array
        One per vehicle with a plan.
    """
    controls = {
        i: control
        for members, plan in zip(sets, plans, strict=True)
        for i, control in zip(members, plan.controls, strict=False)
    }
    return tuple(controls[i] for i in sorted(controls))


def verdict_of_sets(
    scenario: Scenario, sets: tuple[tuple[int, ...], ...], plans: list[SetPlan], limits: Limits
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
    limits : Limits
        When planning was to stop.

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
        why = f"{_LIMITED}: {limit_clause(limits)}" if limited else plan.explanation or "no plan."
        names_of.setdefault(why, []).append(names)
    if len(sets) == 1:
        return status, next(iter(names_of), None)
    reasons = [
        f"Set{'s' if len(names) > 1 else ''} of {'; '.join(names)}: {why}"
        for why, names in names_of.items()
    ]
    return status, " ".join(reasons) or None
