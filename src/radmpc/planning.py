"""The entry point: from a scenario to a certified plan."""

from __future__ import annotations

import platform
import time
from collections.abc import Callable, Mapping
from concurrent.futures import Executor
from dataclasses import replace
from functools import cache, partial
from importlib.metadata import PackageNotFoundError, version

import numpy as np
import scipy

from radmpc.arguments import check_callable, check_kind, check_rng, check_time_limit, told
from radmpc.arrays import Matrix
from radmpc.errors import ArgumentTypeError, ScenarioError
from radmpc.model.dynamics import rollout
from radmpc.model.given import check_scenario
from radmpc.model.plan import Plan, Risk, Status, Trajectory
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.planners import Planner, Run
from radmpc.planners.draft import Draft
from radmpc.planners.presets import DEFAULT, PRESETS, parse_planner
from radmpc.planners.verdict import Verdict
from radmpc.planners.wording import limit_clause
from radmpc.referee import Certificate, certify
from radmpc.result import Result
from radmpc.solvers.solution import Limits, never
from radmpc.version import __version__

__all__ = ["plan", "seconds_granted"]


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
        bound on the cost, None without one.

    Returns
    -------
    Result
        With a plan also when its certificate exceeds Δ; without one, an explanation.

    Raises
    ------
    ScenarioError
        If there is no such planner, or it takes no visits or no disturbances that vehicles share,
        and the scenario has some.
    ArgumentTypeError
        If an argument is of another kind; the message says what to do instead.
    ArgumentError
        If the time limit is negative or nan, or the seed negative.

    References
    ----------
    Paper, Algorithm 1 (`multi-vehicle`), Algorithm 2 (`radmpc`).
    """
    begun = time.perf_counter()
    check_scenario(scenario)
    record = _record(planner)
    _check_shared(scenario, record)
    record.check_visits(scenario)
    _check_options(rng, time_limit, executor, progress, stop)
    check_callable(found, "found")
    seed = 0 if rng is None else int(rng) if isinstance(rng, int | np.integer) else None
    generator = rng if isinstance(rng, np.random.Generator) else np.random.default_rng(seed)
    time_limit = seconds_granted(record, time_limit)
    deadline = float("inf") if time_limit is None else time.monotonic() + time_limit
    limits = Limits(deadline, never if stop is None else stop, time_limit)
    judge = partial(_verdict, scenario, record)
    run = Run(generator, limits, executor, progress or _silent, judge, found or _silent_best)
    draft = _with_limits(record.decomposition.plan(scenario, record, run), limits)
    judging = time.perf_counter()
    trajectories = _trajectories(scenario, draft.controls)
    unjudged = _plan(scenario, record, seed, draft, trajectories, None, {})
    certificate = certify(unjudged) if trajectories else None
    ended = time.perf_counter()
    seconds = {**draft.seconds, "certificate": ended - judging, "total": ended - begun}
    judged = _plan(scenario, record, seed, draft, trajectories, certificate, seconds)
    return Result(judged, certificate, draft.steps, draft.events)


def seconds_granted(planner: Planner, time_limit: float | None) -> float | None:
    """Return the time limit of a planner: the one asked for, or its own; None is none.

    Parameters
    ----------
    planner : Planner
        Whose own limit counts by default.
    time_limit : float or None
        What was asked for [s]; None is the planner's own.
    """
    return planner.decomposition.default_seconds if time_limit is None else time_limit


def _record(planner: str | Planner) -> Planner:
    """Return the record of choices that a planner is."""
    if isinstance(planner, str):
        return parse_planner(planner)
    if isinstance(planner, Planner):
        return planner
    known = ", ".join(PRESETS)
    raise ArgumentTypeError(f"planner must be a Planner or one of {known}, got {told(planner)}")


def _check_shared(scenario: Scenario, planner: Planner) -> None:
    """Refuse shared disturbances where others' paths count as independent of one's own."""
    if scenario.has_shared and not planner.decomposition.takes_shared:
        raise ScenarioError(
            f"are not for '{planner.decomposition}', which plans one vehicle at a time; take "
            "certified, ira or distance",
            ("shared_disturbances",),
        )


def _check_options(
    rng: object, time_limit: object, executor: object, progress: object, stop: object
) -> None:
    """Refuse options that planning would stumble over only after a while."""
    check_rng(rng)
    check_time_limit(time_limit)
    if executor is not None and not callable(getattr(executor, "submit", None)):
        check_kind(executor, Executor, "executor", "a concurrent.futures.Executor or None")
    check_callable(progress, "progress")
    check_callable(stop, "stop")


def _silent(stage: str, done: int, total: int | None) -> None:
    """Take progress without showing it."""
    del stage, done, total


def _silent_best(cost: float, bound: float | None) -> None:
    """Take the best plan so far without showing it."""
    del cost, bound


def _verdict(scenario: Scenario, planner: Planner, controls: tuple[Matrix, ...]) -> Verdict:
    """Return the referee's verdict on controls, for planners to ask for while they search."""
    trajectories = _trajectories(scenario, controls)
    everyone = (tuple(range(scenario.num_vehicles)),)
    draft = Draft(Status.FEASIBLE, controls, everyone, (), (), {})
    said = certify(_plan(scenario, planner, None, draft, trajectories, None, {}))
    return Verdict(said.certified, said.ledger)


def _with_limits(draft: Draft, limits: Limits) -> Draft:
    """Return a draft that says which limit ended its search, if one did."""
    stopped_by = None
    if draft.status in {Status.FEASIBLE, Status.LIMIT}:
        stopped_by = draft.stopped_by or limits.reason or None
    explanation = draft.explanation
    if draft.status is Status.LIMIT and not explanation:
        explanation = f"No plan was found, and none was ruled out: {limit_clause(limits)}"
    return replace(draft, stopped_by=stopped_by, explanation=explanation)


def _trajectories(
    scenario: Scenario, controls_of_all: tuple[Matrix, ...]
) -> tuple[Trajectory, ...]:
    """Return what follows from the controls."""
    if not controls_of_all:
        return ()
    return tuple(
        Trajectory(
            name=vehicle.name,
            controls=controls,
            means=rollout(
                vehicle.system, vehicle.start, controls, vehicle.pushes(scenario.horizon)
            ),
            covariances=vehicle.covariances(scenario.horizon),
            gain=vehicle.gain,
        )
        for vehicle, controls in zip(scenario.vehicles, controls_of_all, strict=True)
    )


def _plan(
    scenario: Scenario,
    planner: Planner,
    seed: int | None,
    draft: Draft,
    trajectories: tuple[Trajectory, ...],
    certificate: Certificate | None,
    seconds: Mapping[str, float],
) -> Plan:
    """Return the content of the plan file."""
    risk = Risk(scenario.risk_bound)
    if certificate is not None:
        risk = Risk(
            scenario.risk_bound,
            certificate.certified,
            certificate.ledger,
            draft.price,
            certificate.saturation,
        )
    cost = _cost(scenario, trajectories) if trajectories else None
    bound, on_any = draft.lower_bound, draft.certified_lower_bound
    # The same cost, summed in another order, differs by rounding.
    if cost is not None and bound is not None:
        bound = min(bound, cost)
    if cost is not None and on_any is not None:
        on_any = min(on_any, cost)
    return Plan(
        scenario=scenario,
        planner=str(planner),
        seed=seed,
        status=draft.status,
        cost=cost,
        lower_bound=bound,
        risk=risk,
        sets=tuple(tuple(scenario.vehicles[i].name for i in s) for s in draft.sets),
        seconds=seconds,
        versions=dict(_versions()),
        explanation=draft.explanation,
        trajectories=trajectories,
        couplings=draft.couplings,
        stopped_by=draft.stopped_by,
        certified_lower_bound=on_any,
    )


def _cost(scenario: Scenario, trajectories: tuple[Trajectory, ...]) -> float:
    """Return ``Σ weight · ‖u‖₁``, and what the times until arrival cost where these are free."""
    pairs = list(zip(scenario.vehicles, trajectories, strict=True))
    efforts = [
        vehicle.cost_weight * float(np.abs(trajectory.controls).sum())
        for vehicle, trajectory in pairs
    ]
    cost = float(np.sum(efforts))
    if scenario.time_weight > 0.0:
        steps = [_arrival(v, t.means) for v, t in pairs if v.goal.within is not None]
        cost += scenario.time_weight * scenario.dt * sum(steps)
    return cost


def _arrival(vehicle: Vehicle, means: Matrix) -> int:
    """Return the step at which a vehicle arrives, the last of its window where it is late."""
    velocity = vehicle.system.velocity
    speeds = None if velocity is None else means[:, list(velocity)]
    step = vehicle.goal.arrival(means[:, list(vehicle.system.position)], speeds)
    return vehicle.goal.window(len(means) - 1)[1] if step is None else step


@cache
def _versions() -> dict[str, str]:
    """Return the versions a plan depends on."""
    try:
        highspy = version("highspy")
    except PackageNotFoundError:  # pragma: no cover - a vendored copy without metadata
        highspy = "unknown"
    return {
        "radmpc": __version__,
        "python": platform.python_version(),
        "highspy": highspy,
        "numpy": np.__version__,
        "scipy": scipy.__version__,
    }
