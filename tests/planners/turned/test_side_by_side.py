"""Sets of a large fleet planned at once: each as if all others stayed, wherever it is planned."""

from __future__ import annotations

from concurrent.futures import BrokenExecutor, Executor, Future, ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import circle, fleet
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.large import side_by_side
from radmpc.planners.certified.turned.large.side_by_side import share_risk_side_by_side
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.solvers.solution import Limits

COSTS = 30.0, 0.5

GROUPS = (0, 5, 17), (1, 2), (3, 4, 6, 7, 8, 9, 10), (11, 12, 13, 14, 15, 16), (20, 23)
"""Most of a fleet of 24."""

CROWD = (0, 3, 7), (1, 2, 9), (4, 5), (6,), (8,)
"""Ten vehicles that cross in one place."""


def apart(scenario: Scenario) -> SuccessiveLp:
    """Vehicles that keep apart, planned one after the other."""
    successive = SuccessiveLp(Hazards.of(scenario, condensed_models(scenario)), Limits())
    assert successive.begin_alone()
    successive.keep_apart(3.0, 12)
    successive.restore(successive.paths.state())
    return successive


class Dying(Executor):
    """Runs nothing: its workers are dead."""

    def submit(self, task: object, /, *args: object, **more: object) -> Future[object]:
        del task, args, more
        future: Future[object] = Future()
        future.set_exception(BrokenExecutor())
        return future


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_each_group_is_planned_as_if_all_others_stayed(avoidance: str) -> None:
    scenario = replace(fleet(24, 0), avoidance=avoidance)
    together, begun = apart(scenario), apart(scenario).paths.state()
    risk = share_risk_side_by_side(together, GROUPS, COSTS, None)

    single, total = apart(scenario), 0.0
    for group in GROUPS:
        single.restore(begun)
        total += single.share_risk(group, *COSTS)
        for i in group:
            np.testing.assert_allclose(
                together.paths.controls[i], single.paths.controls[i], atol=1e-7
            )
            np.testing.assert_allclose(together.ahead.means[i], single.ahead.means[i], atol=1e-6)
    assert risk == pytest.approx(total, abs=1e-9)


@pytest.mark.parametrize("most", [1, 4, 100])
def test_it_does_not_matter_where_groups_are_planned(
    most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(side_by_side, "_AT_ONCE", most)
    expected = apart(circle(10))
    risk = share_risk_side_by_side(expected, CROWD, COSTS, None)
    with ThreadPoolExecutor(2) as pool:
        for executor in (pool, Dying()):
            found = apart(circle(10))
            assert share_risk_side_by_side(found, CROWD, COSTS, executor) == risk
            for ours, theirs in zip(found.paths.controls, expected.paths.controls, strict=True):
                np.testing.assert_array_equal(ours, theirs)
            assert found.work == expected.work


def test_who_is_planned_by_nobody_stays() -> None:
    scenario = fleet(12, 0)
    found = apart(scenario)
    before = list(found.paths.controls)
    share_risk_side_by_side(found, ((0, 5), (7,)), COSTS, None)

    for i in set(range(12)) - {0, 5, 7}:
        assert found.paths.controls[i] is before[i]


def test_what_went_where_nothing_was_near_is_planned_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Two that keep far apart see nothing of each other, and would go straight through."""
    far = apart(circle(2))
    for sideways, i in ((1.0, 0), (-1.0, 1)):
        far.paths.means[i, 1:-1, 1] += 6.0 * sideways
    near = Near(6.5, 0.0, is_refined=False)
    assert half_spaces(far.hazards, far.paths, (0, 1), near).count == 0
    monkeypatch.setattr(side_by_side, "_reach", lambda successive, groups: 1e-3)

    share_risk_side_by_side(far, ((0,), (1,)), COSTS, None)
    spaces = half_spaces(far.hazards, far.paths, (0, 1), near)
    assert spaces.count
    assert spaces.clearances.min() > 1.0


def test_nothing_moves_once_time_is_up() -> None:
    late = apart(circle(10))
    before = late.paths.means.copy()
    late.limits = Limits(deadline=0.0)
    share_risk_side_by_side(late, CROWD, COSTS, None)
    np.testing.assert_array_equal(late.paths.means, before)
