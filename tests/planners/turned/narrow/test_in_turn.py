"""Few vehicles that wait for each other beside a lane."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from grid_worlds import cells

from radmpc.experiments.swarms import swarm
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.state.task import Task
from radmpc.planners.certified.turned.narrow.in_turn import paths_in_turn
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.verdict import Verdict
from radmpc.planning import plan
from radmpc.program.build import build_program, condensed_models
from radmpc.program.hazards import Hazards
from radmpc.program.program import DisjunctiveProgram
from radmpc.solvers.solution import Limits


@pytest.fixture
def overtaken(tmp_path: Path) -> Scenario:
    """A lane with a bay, in which the one ahead has to let the other pass."""
    free = {(x, 0) for x in range(5)} | {(2, 1)}
    return cells(tmp_path, (5, 2), free, [((0, 0), (4, 0)), ((1, 0), (3, 0))])


def task_of(scenario: Scenario) -> Task:
    """Return what is asked of a scenario, with nobody to judge it."""
    hazards, bound = Hazards.of(scenario, condensed_models(scenario)), scenario.risk_bound

    def alone(i: int) -> DisjunctiveProgram:
        return build_program(scenario, (hazards.models[i],), risk_bound=bound)

    judge = lambda controls: Verdict(1.0, ())  # noqa: E731 - a stub
    return Task(hazards, judge, Limits(), 1e-3, bound, lambda one: None, alone)


def test_later_ones_keep_clear_of_those_before_them(overtaken: Scenario) -> None:
    task = task_of(overtaken)
    alone = SuccessiveLp(task.hazards, task.limits)
    assert alone.begin_alone()
    found = list(paths_in_turn(task, alone.paths.means, 100.0))
    assert found
    for placed in found:
        first, later = placed
        assert np.array_equal(placed[first], alone.paths.means[first])
        assert not np.array_equal(placed[later], alone.paths.means[later])
        apart = np.linalg.norm(placed[first] - placed[later], axis=1)
        assert apart.min() >= task.hazards.radii.sum()


def test_in_space_there_are_no_such_paths() -> None:
    task = task_of(swarm(3, 0))
    means = np.zeros((3, task.hazards.horizon + 1, 3))
    assert list(paths_in_turn(task, means, 1.0)) == []


def test_a_first_plan_of_who_waits_in_a_bay_costs_little_more_than_the_best(
    overtaken: Scenario,
) -> None:
    told: list[float] = []
    result = plan(overtaken, "certified", found=lambda cost, bound: told.append(cost))
    assert result.is_certified
    assert result.cost is not None
    assert told[0] <= 1.4 * result.cost
