"""Runs of planners that nobody watches, that have done once there is a plan, or need a license."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.planners import Run
from radmpc.planners.certified.phases import searching
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


def plan_before_any_search(scenario: Scenario, patches: pytest.MonkeyPatch) -> Plan:
    """Return the first certified plan; fails where a search of all sides comes before it."""
    found: list[Plan] = []
    before = searching.at_prices

    def searched(*asked: Any) -> Any:
        assert found, "nothing but a search of all sides led to a plan"
        return before(*asked)

    patches.setattr(searching, "at_prices", searched)
    plan(scenario, improved=found.append, stop=lambda: bool(found))
    return found[0]


def need_gurobi() -> None:
    """Skip the test where Gurobi is not installed, or the license that it brings has expired."""
    gurobi = pytest.importorskip("gurobipy")
    try:
        gurobi.Env().dispose()
    except gurobi.GurobiError as error:
        pytest.skip(f"Gurobi: {error}")
