"""Who shares a linear program while half-spaces are turned."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.experiments.families import fleet
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.certified.turned.turning import Task, Turning
from radmpc.planners.verdict import Verdict
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.solvers.solution import Limits, never


def turning(count: int, sets: tuple[tuple[int, ...], ...]) -> Turning:
    scenario = fleet(count, 0)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    task = Task(hazards, lambda controls: Verdict(0.0, ()), Limits(np.inf, never), 1e-3, 0.05)
    return Turning(task, FleetIncumbent(), sets, 1.0)


@pytest.fixture(scope="module")
def sets() -> tuple[tuple[int, ...], ...]:
    """Sixty vehicles: two sets, of five and of thirteen, whose numbers are mixed; else alone."""
    sets = ((2, 0, 40, 7, 30), tuple(range(10, 23)))
    taken = {i for members in sets for i in members}
    return (*sets, *((i,) for i in range(60) if i not in taken))


def test_a_small_fleet_shares_one_linear_program() -> None:
    alone = tuple((i,) for i in range(8))

    assert turning(8, alone).groups == (tuple(range(8)),)


def test_the_small_sets_of_a_large_fleet_share_linear_programs(
    sets: tuple[tuple[int, ...], ...],
) -> None:
    groups = turning(60, sets).groups

    assert sorted(i for group in groups for i in group) == list(range(60))
    assert all(list(group) == sorted(group) for group in groups)
    assert sum(len(group) > TUNING.side_by_side for group in groups) == 1
    assert len(groups) <= 6
    for members in sets:
        assert sum(bool(set(members) & set(group)) for group in groups) == 1


def test_the_vehicles_of_a_set_too_large_for_one_program_are_spread_over_several() -> None:
    count = TUNING.most_together + 12
    groups = turning(count, (tuple(range(count)),)).groups

    assert sorted(i for group in groups for i in group) == list(range(count))
    assert max(len(group) for group in groups) == TUNING.side_by_side
