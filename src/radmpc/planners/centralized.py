"""The whole fleet in one program."""

from __future__ import annotations

import time
from collections.abc import Callable

from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario
from radmpc.planners.draft import Draft
from radmpc.planners.planner import Planner
from radmpc.planners.sets import SetTask, run_sets
from radmpc.solvers.solution import Limits, Outcome

__all__ = ["plan_centralized"]


def plan_centralized(
    scenario: Scenario,
    planner: Planner,
    limits: Limits,
    progress: Callable[[str, int, int | None], None],
) -> Draft:
    """Plan all vehicles together.

    Parameters
    ----------
    scenario : Scenario
        The question.
    planner : Planner
        Policy, solver and gap.
    limits : Limits
        When to stop early.
    progress : callable
        Told the stage.

    Returns
    -------
    Draft
        One set.
    """
    begun = time.perf_counter()
    progress("solving", 0, 1)
    task = SetTask(scenario, planner.policy, planner.solver, planner.gap, "centralized")
    [answer] = run_sets([task], limits, None, lambda done, total: progress("solving", done, total))
    status = Status.FEASIBLE
    if not answer.controls:
        limited = answer.outcome is Outcome.LIMIT
        status = Status.LIMIT if limited else Status.INFEASIBLE
    return Draft(
        status=status,
        controls=answer.controls,
        sets=(tuple(range(scenario.num_vehicles)),),
        steps=answer.steps,
        events=(),
        seconds={"solving": time.perf_counter() - begun},
        explanation=answer.explanation,
    )
