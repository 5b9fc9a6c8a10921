"""Runs of planners that nobody watches, or that have done once there is a plan."""

from __future__ import annotations

import numpy as np

from radmpc.model.scenario import Scenario
from radmpc.planners import Run
from radmpc.planning import plan
from radmpc.result import Result
from radmpc.solvers.solution import Limits


def silent_run(seed: int = 0) -> Run:
    """Return a run without limits that is told to nobody and asks no referee."""

    def judge(controls):
        raise AssertionError("no referee is asked")

    def silent(*said):
        del said

    return Run(np.random.default_rng(seed), Limits(), None, silent, judge, silent)


def first_plan(scenario: Scenario, *, time_limit: float) -> Result:
    """Plan until there is a plan: of searches whose proof would take all the time there is."""
    told: list[float] = []
    return plan(
        scenario,
        time_limit=time_limit,
        found=lambda cost, bound: told.append(cost),
        stop=lambda: bool(told),
    )
