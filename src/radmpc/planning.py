"""The entry point: from a scenario to a certified plan."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import replace

import numpy as np

from radmpc.arguments import (
    check_callable,
    check_executor,
    check_rng,
    check_time_limit,
    value_text,
)
from radmpc.arrays import Matrix
from radmpc.errors import ArgumentTypeError, ScenarioError
from radmpc.model.given import check_scenario
from radmpc.model.plan import Plan, Status
from radmpc.model.scenario import Scenario
from radmpc.planners import Planner, Run
from radmpc.planners.draft import Draft
from radmpc.planners.outcome.best_of_all import Cheaper
from radmpc.planners.outcome.first import NotingFirst
from radmpc.planners.outcome.improving import Improving
from radmpc.planners.outcome.record import Certifying, plan_of
from radmpc.planners.outcome.trajectories import trajectories_of
from radmpc.planners.planner import Improved, no_listener
from radmpc.planners.presets import DEFAULT, PRESETS, called, parse_planner
from radmpc.planners.verdict import RoughJudge, Verdict
from radmpc.planners.wording import limit_clause
from radmpc.result import Result
from radmpc.solvers.solution import Limits, never

__all__ = ["check_takes", "plan", "seconds_allowed", "unjudged_plan"]


def plan(
    scenario: Scenario,
    planner: str | Planner = DEFAULT,
    *,
    rng: np.random.Generator | int | None = None,
    time_limit: float | None = None,
    executor: Executor | None = None,
    progress: Callable[[str, int, int | None], None] | None = None,
    stop: Callable[[], bool] | None = None,
    found: Callable[[float, float | None], None] | None = None,
    improved: Callable[[Plan], None] | None = None,
) -> Result:
    """Plan a fleet, and have the plan judged by the referee.

    Parameters
    ----------
    scenario : Scenario
        The scenario to plan.
    planner : str or Planner
        A preset's name, with an argument where it takes one, or a record of choices.
    rng : Generator or int or None
        Source of every random choice; an int is kept in the plan as its seed, None is seed 0.
    time_limit : float or None
        Seconds after which planning returns what it has; None is 60 for `certified`, whose proof
        may take long, and no limit for others.
    executor : Executor or None
        Where independent sets are planned; None plans them here. The plan is the same.
    progress : callable or None
        Called with the stage, the parts done and their number.
    stop : callable or None
        Asked often; planning ends with what it has once it returns True.
    found : callable or None
        Called by `certified`, now and then, with the cost of the best plan so far and a lower
        bound on what plans by the scenario's faces cost; None without one, or above that cost.
    improved : callable or None
        Given by `certified` every plan that is the best so far while it looks for better ones,
        judged by the referee; its time counts. None costs nothing. The last one is the result's,
        or dearer. Where vehicles share goals, its scenario has those that were assigned.

    Returns
    -------
    Result
        With a plan also when its certificate exceeds Δ; without one, an explanation.

    Raises
    ------
    ScenarioError
        If there is no such planner, or it takes no visits, no ranges or no disturbances that
        vehicles share, and the scenario has some.
    ArgumentTypeError
        If an argument is of another kind; the message says what to do instead.
    ArgumentError
        If the time limit is negative or nan, or the seed negative.

    References
    ----------
    Paper, Algorithm 1 (`multi-vehicle`), Algorithm 2 (`radmpc`).

    Examples
    --------
    >>> import radmpc
    >>> from radmpc.experiments.families import paper
    >>> plan = radmpc.plan(paper(2, seed=1), rng=0).require()
    >>> plan.risk.certified <= plan.scenario.risk_bound
    True
    """
    begun = time.perf_counter()
    check_scenario(scenario)
    record = _record(planner)
    check_takes(scenario, record)
    _check_options(rng, time_limit, executor, progress, stop)
    check_callable(found, "found")
    check_callable(improved, "improved")
    seed = 0 if rng is None else int(rng) if isinstance(rng, int | np.integer) else None
    limits = _limits(record, time_limit, stop)
    cheaper = None if improved is None else Cheaper(improved)

    def asked_of(one: Scenario) -> tuple[Certifying, Improved]:
        asked = Certifying(one, record)
        if cheaper is None:
            return asked, no_listener
        return asked, Improving(one, record, seed, cheaper, begun, asked)

    referee, hand_on = asked_of(scenario)
    noting = NotingFirst(found or no_listener, begun)
    run = Run(
        rng if isinstance(rng, np.random.Generator) else np.random.default_rng(seed),
        limits,
        executor,
        progress or no_listener,
        referee.judge,
        noting,
        hand_on,
    )
    if scenario.goals:
        from radmpc.planners.assignment import assigned  # noqa: PLC0415 - few share goals

        scenario, draft = assigned(scenario, record, run, asked_of)
        referee = Certifying(scenario, record)
    else:
        draft = record.decomposition.plan(scenario, record, run)
    draft = replace(_with_limits(draft, limits), first=noting.first if draft.controls else None)
    return _judged(referee, scenario, record, seed, draft, begun)


def unjudged_plan(
    scenario: Scenario, planner: Planner, *, seed: int, time_limit: float | None
) -> Plan:
    """Plan a fleet without a certificate, for callers that certify the plan themselves.

    Parameters
    ----------
    scenario : Scenario
        The scenario to plan; its vehicles have goals of their own.
    planner : Planner
        A record of choices.
    seed : int
        Of every random choice.
    time_limit : float or None
        As in `plan`.

    Returns
    -------
    Plan
        Without trajectories where none was found; without a certificate in any case.

    Raises
    ------
    ScenarioError
        As in `plan`.
    """
    check_takes(scenario, planner)
    referee = Certifying(scenario, planner)
    limits, rng = _limits(planner, time_limit, None), np.random.default_rng(seed)

    def judge(controls: tuple[Matrix, ...]) -> Verdict:
        # A plan that comes too late is none.
        return Verdict(np.inf, ()) if limits.reached else referee.verdict(controls)

    is_quick = isinstance(referee.judge, RoughJudge)
    timely = RoughJudge(judge, referee.rough) if is_quick else judge
    run = Run(rng, limits, None, no_listener, timely, no_listener)
    draft = planner.decomposition.plan(scenario, planner, run)
    trajectories = trajectories_of(scenario, draft.controls)
    return plan_of(scenario, planner, seed, draft, trajectories, None, {})


def check_takes(scenario: Scenario, planner: Planner) -> None:
    """Refuse a scenario that a planner cannot plan, whatever its numbers.

    Parameters
    ----------
    scenario : Scenario
        What is to be planned.
    planner : Planner
        A record of choices.

    Raises
    ------
    ScenarioError
        If it has visits, ranges, norms or shared disturbances that these choices do not take.
    """
    if not planner.decomposition.takes_shared:
        for key, is_there in (
            ("shared_disturbances", scenario.has_shared),
            ("keep", scenario.keep),
        ):
            if is_there:
                raise ScenarioError(
                    f"not supported by '{called(planner)}', whose decomposition relies on planning "
                    "one vehicle at a time; use certified, ira or distance",
                    (key,),
                )
    planner.check_visits(scenario, called)


def seconds_allowed(planner: Planner, time_limit: float | None) -> float | None:
    """Return the time limit of a planner: the one asked for, or its own; None is none.

    Parameters
    ----------
    planner : Planner
        Whose own limit counts by default.
    time_limit : float or None
        What was asked for [s]; None is the planner's own.
    """
    return planner.decomposition.default_seconds if time_limit is None else time_limit


def _limits(planner: Planner, time_limit: float | None, stop: Callable[[], bool] | None) -> Limits:
    """Return the limits of a plan that begins now."""
    time_limit = seconds_allowed(planner, time_limit)
    deadline = float("inf") if time_limit is None else time.monotonic() + time_limit
    return Limits(deadline, never if stop is None else stop, time_limit)


def _record(planner: str | Planner) -> Planner:
    """Return the record of choices that a planner is."""
    if isinstance(planner, str):
        return parse_planner(planner)
    if isinstance(planner, Planner):
        return planner
    known = ", ".join(PRESETS)
    raise ArgumentTypeError(
        f"planner must be a Planner or one of {known}, got {value_text(planner)}"
    )


def _check_options(
    rng: object, time_limit: object, executor: object, progress: object, stop: object
) -> None:
    """Refuse options that planning would stumble over only after a while."""
    check_rng(rng)
    check_time_limit(time_limit)
    check_executor(executor)
    check_callable(progress, "progress")
    check_callable(stop, "stop")


def _judged(
    referee: Certifying,
    scenario: Scenario,
    planner: Planner,
    seed: int | None,
    draft: Draft,
    begun: float,
) -> Result:
    """Return what was planned since `begun`, with the certificate that the referee gives it."""
    judging = time.perf_counter()
    trajectories = trajectories_of(scenario, draft.controls)
    unjudged = plan_of(scenario, planner, seed, draft, trajectories, None, {})
    certificate = referee.certificate(unjudged) if trajectories else None
    ended = time.perf_counter()
    seconds = {**draft.seconds, "certificate": ended - judging, "total": ended - begun}
    judged = plan_of(scenario, planner, seed, draft, trajectories, certificate, seconds)
    return Result(judged, certificate, draft.steps, draft.events)


def _with_limits(draft: Draft, limits: Limits) -> Draft:
    """Return a draft that says which limit ended its search, if one did."""
    stopped_by = None
    if draft.status in {Status.FEASIBLE, Status.LIMIT}:
        stopped_by = draft.stopped_by or limits.reason or None
    explanation = draft.explanation
    if draft.status is Status.LIMIT and not explanation:
        explanation = f"No plan was found, and none was ruled out: {limit_clause(limits)}"
    return replace(draft, stopped_by=stopped_by, explanation=explanation)
