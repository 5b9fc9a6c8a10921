"""Vehicles planned one after the other, and who of them need not be planned again."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from radmpc import Goal, Scenario
from radmpc.experiments.families import circle, fleet, paper
from radmpc.planners.certified.turned import successive as module
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.neighbors import reached_by
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.solvers.solution import Limits

CLEARANCE = 3.0


def alone(scenario: Scenario) -> SuccessiveLp:
    """Everyone on the path of least effort with nothing in the way."""
    successive = SuccessiveLp(Hazards.of(scenario, condensed_models(scenario)), Limits())
    assert successive.begin_alone()
    return successive


def counted(successive: SuccessiveLp, monkeypatch: pytest.MonkeyPatch) -> Counter[int]:
    """Count how often every vehicle is planned from now on."""
    count: Counter[int] = Counter()
    plan_alone = successive.plan_alone

    def plan(i: int, clearance: float, penalty: float) -> None:
        count[i] += 1
        plan_alone(i, clearance, penalty)

    monkeypatch.setattr(successive, "plan_alone", plan)
    return count


def test_who_stays_and_has_nobody_near_is_planned_once(monkeypatch: pytest.MonkeyPatch) -> None:
    scenario = circle(6)
    far = replace(scenario.vehicles[0], name="far", start=[500.0, 0.0, 0.0, 0.0])
    far = replace(far, goal=Goal.at([500.0, 3.0], 0.5))
    successive = alone(replace(scenario, vehicles=(far, *scenario.vehicles)))
    count = counted(successive, monkeypatch)
    assert successive.keep_apart(CLEARANCE, 20)
    assert count[0] == 1
    assert min(count[i] for i in range(1, 7)) > 3


@pytest.mark.sampled(2)
@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
@pytest.mark.parametrize("scenario", [fleet(16, 1), circle(6), paper(8, 3)], ids=lambda s: s.name)
def test_who_is_left_out_would_have_stayed(
    scenario: Scenario, avoidance: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    scenario = replace(scenario, avoidance=avoidance)
    left_out, every = alone(scenario), alone(scenario)
    few = counted(left_out, monkeypatch)
    is_apart = left_out.keep_apart(CLEARANCE, 20)
    monkeypatch.setattr(
        module, "reached_by", lambda hazards, *_: np.ones(hazards.count, dtype=bool)
    )
    all_of_them = counted(every, monkeypatch)
    assert every.keep_apart(CLEARANCE, 20) == is_apart
    assert np.allclose(left_out.paths.means, every.paths.means, rtol=0.0, atol=1e-6)
    assert few.total() <= all_of_them.total()


def test_a_move_changes_no_half_space_of_those_it_does_not_reach() -> None:
    rng = np.random.default_rng(4)
    successive = alone(fleet(24, 2))
    hazards, paths = successive.hazards, successive.paths
    num_left_out = 0
    for _ in range(60):
        i = int(rng.integers(hazards.count))
        others = [j for j in range(hazards.count) if j != i]
        seen = {j: _seen(successive, j) for j in others}
        before = paths.means[i].copy()
        successive.refer(i, before + rng.normal(0.0, 2.0, 2))
        is_reached = reached_by(hazards, paths, (i, before), CLEARANCE)
        for j in others:
            if not is_reached[j]:
                num_left_out += 1
                assert np.array_equal(seen[j], _seen(successive, j))
    assert num_left_out > 100


def _seen(successive: SuccessiveLp, j: int) -> np.ndarray:
    """Return the half-spaces that a vehicle is planned between."""
    reach = float(successive.hazards.reaches[j])
    near = Near(CLEARANCE, reach, is_refined=False)
    spaces = half_spaces(successive.hazards, successive.paths, (j,), near)
    return np.hstack([spaces.second[:, None], spaces.windows[:, None], spaces.normals])


def test_a_quick_attempt_that_misses_too_much_after_four_sweeps_is_left(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    successive = alone(circle(6))
    planned = Counter[int]()

    def plan(i: int, *_: float) -> None:
        planned[i] += 1
        successive.missed[i] = 3.0 * 0.8 ** planned[i] * successive.hazards.radii[i]

    monkeypatch.setattr(successive, "plan_alone", plan)
    assert not successive.keep_apart(CLEARANCE, TUNING.quick_sweeps, is_quick=True)
    assert set(planned.values()) == {TUNING.telling + 1}
    planned.clear()
    assert not successive.keep_apart(CLEARANCE, TUNING.max_sweeps)
    assert set(planned.values()) == {TUNING.max_sweeps}
