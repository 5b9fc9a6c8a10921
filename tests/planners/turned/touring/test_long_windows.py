"""Steps of visits and arrivals over long horizons."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from visiting import scene

from radmpc import Visit
from radmpc.planners.certified.turned.touring import visit_lp
from radmpc.planners.certified.turned.touring.visit_lp import VisitLp
from radmpc.planners.certified.turned.touring.visiting import good_steps
from radmpc.program.build import condensed_models
from radmpc.program.condensed import CondensedModel


def arriving(horizon: int, *via: Visit, price: float = 0.02, **limits: object) -> CondensedModel:
    """One that may arrive at any step, as soon as is worth it."""
    given = scene(*via, horizon=horizon)
    one = given.vehicles[0]
    goal = replace(one.goal, within=(1, horizon), speed=[0.3, 0.3])
    given = replace(given, vehicles=(replace(one, goal=goal, **limits),), time_weight=price)
    return condensed_models(given)[0]


def asked(monkeypatch: pytest.MonkeyPatch) -> list[tuple[int | None, ...]]:
    """Return a list of all steps that costs are asked for."""
    seen: list[tuple[int | None, ...]] = []
    cost = VisitLp.cost

    def noted(self, steps, cutoff=np.inf):
        seen.append(tuple(steps))
        return cost(self, steps, cutoff)

    monkeypatch.setattr(VisitLp, "cost", noted)
    return seen


@pytest.mark.parametrize("price", [1e-3, 0.02, 0.3])
def test_the_best_of_many_steps_of_arrival_is_found_by_few_programs(
    price: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = arriving(160, price=price)
    program = VisitLp(model)
    best = min(program.cost([step]) for step in range(1, 161))
    seen = asked(monkeypatch)
    (arrival,) = good_steps(model)
    assert len(seen) <= 25
    assert program.cost([arrival]) <= best * (1.0 + 1e-5)


def test_no_steps_are_looked_at_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    model = arriving(40, Visit.at([4.0, 3.0], 0.5), Visit.at([6.0, -2.0], 0.5))
    seen = asked(monkeypatch)
    good_steps(model)
    assert len(seen) == len(set(seen))


def test_a_vehicle_that_cannot_reach_its_goal_has_its_steps_at_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    model = arriving(80, Visit.at([4.0, 3.0], 0.5), speed_limit=[0.05, 0.05])
    seen = asked(monkeypatch)
    assert good_steps(model)[-1] == 80
    assert len(seen) == 1


LIMITS = [{}, {"speed_limit": [0.5, 0.5]}, {"speed_norm": 0.6}, {"drift": [0.02, -0.01, 0.0, 0.0]}]


@pytest.mark.parametrize("limits", LIMITS)
def test_rows_that_wait_until_they_are_missed_leave_costs_as_they_are(
    limits: dict[str, object], monkeypatch: pytest.MonkeyPatch
) -> None:
    model = arriving(70, Visit.at([4.0, 3.0], 0.5), **limits)
    waiting = VisitLp(model)
    monkeypatch.setattr(visit_lp, "_LONG", 70)
    all_at_once = VisitLp(model)
    for steps in ([30, 70], [30, 50], [20, 35], [10, 20], [20, 22], [None, 40], [20, None]):
        assert waiting.cost(steps) == pytest.approx(all_at_once.cost(steps), rel=1e-6)
        assert waiting.missed == pytest.approx(all_at_once.missed, abs=1e-6)


def test_few_rows_are_added_to_programs_over_long_horizons() -> None:
    model = arriving(200, speed_limit=[0.5, 0.5])
    program = VisitLp(model)
    for step in range(196, 60, -4):
        program.cost([step])
    assert program.num_rows < 400  # all of them are more than 1500


def test_a_cost_beyond_the_cutoff_is_not_told_below_it() -> None:
    program = VisitLp(arriving(70))
    cost = program.cost([15])
    program.cost([70])
    assert 0.9 * cost <= program.cost([15], 0.9 * cost) <= cost * (1.0 + 1e-6)
    assert program.cost([15], 1.1 * cost) == pytest.approx(cost, rel=1e-6)
