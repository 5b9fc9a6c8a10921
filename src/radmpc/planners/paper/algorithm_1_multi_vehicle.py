"""The paper's Algorithm 1 and, alone, its first stage."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from concurrent.futures import Executor

import numpy as np

from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario
from radmpc.planners.draft import Draft, Step
from radmpc.planners.explain import explain_infeasible
from radmpc.planners.paper.algorithm_2_radmpc import approximate
from radmpc.planners.paper.approximation import Approximation
from radmpc.planners.paper.coupling import connected_sets, couplings_of, share_couplings
from radmpc.planners.planner import Couplings, Planner, Receding
from radmpc.planners.sets import SetPlan, SetTask, plan_sets, verdict_of_sets
from radmpc.program.policy import Policy
from radmpc.solvers.solution import Limits, Outcome

__all__ = ["plan_multi_vehicle", "plan_receding"]

_LOG = logging.getLogger(__name__)

Progress = Callable[[str, int, int | None], None]

_MOST_TOGETHER = 12
"""Sets that are planned as one after some of them had no plan on its own share."""


def plan_receding(
    scenario: Scenario,
    planner: Planner,
    receding: Receding,
    rng: np.random.Generator,
    limits: Limits,
    progress: Progress,
) -> Draft:
    """Run Algorithm 2 alone: its executed controls are the plan.

    Parameters
    ----------
    scenario : Scenario
        The question.
    planner : Planner
        Policy, solver and gap.
    receding : Receding
        Options.
    rng : Generator
        For the order of the vehicles.
    limits : Limits
        When to stop early.
    progress : callable
        Told stage, subproblems done, and of how many.

    Returns
    -------
    Draft
        One set per vehicle.
    """
    begun = time.perf_counter()
    run = _approximate(scenario, planner.policy, receding, planner, rng, limits, progress)
    return Draft(
        status=_status(run),
        controls=run.controls or (),
        sets=tuple((i,) for i in range(scenario.num_vehicles)),
        steps=run.steps,
        events=run.events,
        seconds={"radmpc": time.perf_counter() - begun},
        explanation=_explanation(scenario, planner.policy, planner.gap, run, limits),
    )


def plan_multi_vehicle(
    scenario: Scenario,
    planner: Planner,
    couplings: Couplings,
    rng: np.random.Generator,
    limits: Limits,
    executor: Executor | None,
    progress: Progress,
) -> Draft:
    """Run Algorithm 1: approximate, find couplings, plan every set with its share of Δ.

    Parameters
    ----------
    scenario : Scenario
        The question.
    planner : Planner
        Policy, solver and gap for the sets.
    couplings : Couplings
        Ψ and how the approximation is made.
    rng : Generator
        For the order of the vehicles.
    limits : Limits
        When to stop early.
    executor : Executor or None
        Where the sets are planned.
    progress : callable
        Told stage, parts done, and of how many.

    Returns
    -------
    Draft
        Its sets are the connected components of the coupling graph; all vehicles together where
        a share by head count was too little for some of them.
    """
    begun = time.perf_counter()
    run = _approximate(
        scenario,
        couplings.approximation_policy,
        couplings.approximation,
        planner,
        rng,
        limits,
        progress,
    )
    approximated = time.perf_counter()
    seconds = {"radmpc": approximated - begun}
    if run.is_limited:
        return Draft(Status.LIMIT, (), (), run.steps, run.events, seconds)
    everyone: tuple[tuple[int, ...], ...] = (tuple(range(scenario.num_vehicles)),)
    sets = everyone
    if not run.stuck:
        sets = connected_sets(run.pair_risk, couplings.threshold, run.forced)

    _LOG.info(
        "approximation: %.2f s, %d subproblems without a solution; %d sets, the largest of %d",
        seconds["radmpc"],
        len(run.events),
        len(sets),
        max(len(members) for members in sets),
    )

    def plan_all(sets: tuple[tuple[int, ...], ...]) -> list[SetPlan]:
        return plan_sets(
            scenario,
            sets,
            lambda part: SetTask(part, planner.policy, planner.solver, planner.gap, "sets"),
            limits,
            executor,
            lambda done, total: progress("sets", done, total),
        )

    edges = couplings_of(scenario, run.pair_risk, couplings.threshold, run.forced)
    plans = plan_all(sets)
    steps = run.steps + _steps_of(plans)
    if any(p.outcome is Outcome.INFEASIBLE for p in plans) and 1 < len(sets) <= _MOST_TOGETHER:
        # Shares by head count may starve a set that needs more: together they may share freely.
        edges += share_couplings(scenario, sets)
        sets, plans = everyone, plan_all(everyone)
        steps += _steps_of(plans)
    seconds["sets"] = time.perf_counter() - approximated
    status, explanation = verdict_of_sets(scenario, sets, plans)
    controls = {
        i: c for s, p in zip(sets, plans, strict=True) for i, c in zip(s, p.controls, strict=False)
    }
    ordered = tuple(controls[i] for i in sorted(controls)) if status is Status.FEASIBLE else ()
    return Draft(status, ordered, sets, steps, run.events, seconds, explanation, couplings=edges)


def _steps_of(plans: list[SetPlan]) -> tuple[Step, ...]:
    """Return the solves of all sets."""
    return tuple(step for plan in plans for step in plan.steps)


def _approximate(
    scenario: Scenario,
    policy: Policy,
    receding: Receding,
    planner: Planner,
    rng: np.random.Generator,
    limits: Limits,
    progress: Progress,
) -> Approximation:
    """Run RADMPC with the planner's solver."""
    return approximate(
        scenario,
        policy,
        planner.solver,
        receding,
        gap=planner.gap,
        rng=rng,
        limits=limits,
        progress=lambda done, total: progress("radmpc", done, total),
    )


def _status(run: Approximation) -> Status:
    """Return how an approximation ended."""
    if run.controls is not None:
        return Status.FEASIBLE
    return Status.LIMIT if run.is_limited else Status.INFEASIBLE


def _explanation(
    scenario: Scenario, policy: Policy, gap: float, run: Approximation, limits: Limits
) -> str | None:
    """Say why an approximation found nothing."""
    if not run.stuck:
        return None
    # They were planned with their share of the risk; with more they might have been.
    share = scenario.risk_bound * len(run.stuck) / scenario.num_vehicles
    alone = scenario.subset(run.stuck, share)
    return explain_infeasible(alone, policy, gap, limits)
