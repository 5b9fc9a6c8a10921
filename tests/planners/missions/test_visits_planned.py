from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from visiting import scene, vehicle

from radmpc import Goal, Scenario, ScenarioError, Visit, certify, double_integrator, plan
from radmpc.experiments.comparing import compare
from radmpc.model.visits import steps_of_visits, steps_visited
from radmpc.planners.presets import PRESETS

REFUSING = {"dmpc", "radmpc", "multi-vehicle", "rmpc-rrt"}


def steps_of(planned, i: int = 0) -> tuple[int, ...]:
    visiting = planned.scenario.vehicles[i]
    means = planned.trajectories[i].means
    return steps_visited(visiting.via, means[:, :2], means[:, 2:])


def choices(given: Scenario) -> list[Scenario]:
    """Return the scenario with visits of its first vehicle at every choice of steps there is."""
    first, *rest = given.vehicles
    windows = steps_of_visits(first.via, given.horizon)
    found = []
    for steps in itertools.product(*(range(a, b + 1) for a, b in windows)):
        if all(one < two for one, two in itertools.pairwise(steps)):
            via = [replace(v, between=(k, k)) for v, k in zip(first.via, steps, strict=True)]
            found.append(replace(given, vehicles=(replace(first, via=tuple(via)), *rest)))
    return found


TWO = (Visit.at([2.0, 2.0], 0.5), Visit.at([6.0, -1.5], 0.5, speed=3.0))


@pytest.mark.parametrize("via", [TWO, (TWO[0], TWO[0])], ids=["way", "stay"])
def test_no_choice_of_steps_is_cheaper_at_fixed_margins(via: tuple[Visit, ...]) -> None:
    given = scene(*via)
    found = plan(given, "dlp")
    costs = [plan(one, "dlp").cost for one in choices(given)]
    assert len(costs) == 10
    least = min(cost for cost in costs if cost is not None)
    assert found.cost == pytest.approx(least, rel=1e-3)
    assert found.plan is not None
    assert len(steps_of(found.plan)) == 2


@pytest.mark.slow
def test_certified_finds_the_best_choice_of_steps_and_its_bounds_hold() -> None:
    given = scene(replace(TWO[0], between=(1, 2)), replace(TWO[1], between=(4, 4)))
    found = plan(given)
    assert found.is_certified
    assert found.plan is not None
    assert certify(found.plan).problems == ()
    possible = [one for one in choices(given) if plan(one, "dlp").plan is not None]
    one_by_one = [plan(one, "certified(0)") for one in possible]
    assert len(one_by_one) == 2
    assert all(one.is_certified for one in one_by_one if one.plan is not None)
    least = min(one.cost for one in one_by_one if one.cost is not None)
    assert found.cost is not None
    assert found.certified_lower_bound is not None
    assert found.cost <= least * (1.0 + 2e-3)
    assert found.certified_lower_bound <= least * (1.0 + 1e-9)


def test_big_m_and_branch_agree_on_visits() -> None:
    given = scene(*TWO)
    costs = [plan(given, name).cost for name in ("milp", "dlp")]
    assert costs[0] == pytest.approx(costs[1], rel=2e-3)


@pytest.mark.slow
def test_risk_is_spread_over_what_is_avoided_and_not_over_visits() -> None:
    # A visit that holds anyway takes nothing from the allocation.
    empty = scene()
    free = scene(Visit([-100.0, -100.0], [100.0, 100.0]))
    for name in ("uniform", "ira"):
        assert plan(free, name).cost == pytest.approx(plan(empty, name).cost, rel=2e-3)


def test_visits_at_given_steps_are_made_at_these() -> None:
    given = scene(replace(TWO[0], between=(2, 2)), replace(TWO[1], between=(4, 4)))
    found = plan(given, "dlp").plan
    assert found is not None
    means = found.trajectories[0].means
    assert np.all(np.abs(means[2, :2] - TWO[0].center) <= 0.5 + 1e-6)
    assert np.all(np.abs(means[4, :2] - TWO[1].center) <= 0.5 + 1e-6)
    assert np.all(np.abs(means[4, 2:]) <= 3.0 + 1e-6)


def test_vehicles_that_visit_the_same_place_keep_apart() -> None:
    place = Visit.at([4.5, 3.0], 0.4)
    other = vehicle("b", [9.0, 4.0], [0.0, 4.0], place)
    found = plan(scene(place, horizon=8, others=(other,)), time_limit=20.0)
    assert found.is_certified
    assert found.plan is not None
    assert certify(found.plan).problems == ()
    assert len(steps_of(found.plan, 0)) == len(steps_of(found.plan, 1)) == 1


@pytest.mark.parametrize("name", sorted(REFUSING))
def test_planners_that_make_no_visits_refuse_them_in_one_line(name: str) -> None:
    with pytest.raises(
        ScenarioError, match=rf"^vehicles\[0\]\.via: the planner '{name}' does not support visits"
    ):
        plan(scene(*TWO), name)
    assert "\n" not in str(PRESETS[name].planner)


def test_a_comparison_tells_who_makes_no_visits_and_goes_on() -> None:
    refused, planned = compare(scene(*TWO), ["dmpc", "dlp"], samples=10)
    assert refused.result is None
    assert "does not support visits" in str(refused.problem)
    assert planned.result is not None
    assert planned.result.plan is not None


def test_a_visit_out_of_reach_is_told() -> None:
    found = plan(scene(Visit.at([60.0, 60.0], 0.5)))
    assert found.plan is None
    assert found.explanation is not None
    assert "Vehicle 'a' cannot be in the box of via[0] at any step from 1 to 5" in found.explanation


def test_the_referee_names_what_is_not_visited() -> None:
    found = plan(scene(*TWO), "dlp").plan
    assert found is not None
    first = found.scenario.vehicles[0]

    def judged(*via: Visit) -> tuple[str, ...]:
        changed = replace(found.scenario, vehicles=(replace(first, via=via),))
        return certify(replace(found, scenario=changed)).problems

    assert judged(*TWO) == ()
    (turned,) = judged(*TWO[::-1])
    assert "vehicle 'a': does not visit via[1] at any step from" in turned
    (slow,) = judged(replace(TWO[0], speed=np.zeros(2)))
    assert "does not visit via[0]" in slow
    assert "beyond box or speed by" in slow
    made = steps_of(found)
    (late,) = judged(TWO[0], replace(TWO[1], between=(1, made[1] - 1)))
    assert "does not visit via[1]" in late
    (never,) = judged(TWO[0], Visit.at([0.0, 0.0], 99.0, (1, made[0])))
    assert never == (
        f"vehicle 'a': does not visit via[1]: the one before takes place at step {made[0]}, "
        f"allowed is up to {made[0]}"
    )


@pytest.mark.parametrize("dt", [100.0, 300.0])
def test_plans_with_visits_hold_at_long_steps(dt: float) -> None:
    one = replace(
        vehicle("a", [2000.0, -2510.0], [1942.0, -3087.0]),
        system=double_integrator(dt, 2),
        goal=Goal.at([1942.236, -3087.455], 0.0),
        radius=100.0,
        control_limit=4e3 / dt**2,
        gain=None,
        via=(Visit.at([1806.106, -3212.133], 100.0),),
    )
    found = plan(Scenario("long steps", dt, 6, 0.001, (one,), avoidance="steps"))
    assert found.is_certified, found.certificate
