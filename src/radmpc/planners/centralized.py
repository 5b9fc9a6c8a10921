"""The whole fleet in one program."""

from __future__ import annotations

import time
from functools import partial

from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario
from radmpc.planners.draft import Draft
from radmpc.planners.planner import Decomposition, Planner, Run
from radmpc.planners.sets import SetTask, run_sets
from radmpc.records import dataclass
from radmpc.solvers.solution import Outcome

__all__ = ["Centralized"]


@dataclass(frozen=True, slots=True)
class Centralized(Decomposition):
    """All vehicles in one program."""

    def __str__(self) -> str:
        return "centralized"

    def plan(self, scenario: Scenario, planner: Planner, run: Run) -> Draft:
        """Plan all vehicles together, as one set.

        Parameters
        ----------
        scenario, planner, run
            As in `Decomposition.plan`.
        """
        begun = time.perf_counter()
        run.progress("solving", 0, 1)
        task = SetTask(scenario, planner, "centralized", run.rng)
        [answer] = run_sets([task], run.limits, None, partial(run.progress, "solving"))
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
