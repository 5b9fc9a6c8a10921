"""Who shares a linear program while half-spaces are turned, and who has anything to gain by it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import circle, fleet
from radmpc.model.dynamics import double_integrator
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planners.certified import certified
from radmpc.planners.certified.closing import close_gap
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.state.task import Task
from radmpc.planners.certified.turned.first_plan import _is_short, first_plan
from radmpc.planners.certified.turned.large.idle import not_idle
from radmpc.planners.certified.turned.large.sides import on_other_sides
from radmpc.planners.certified.turned.paths import Paths
from radmpc.planners.certified.turned.price_control import PriceControl
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.certified.turned.turning import Turning
from radmpc.planners.certified.within_budget import WithinBudget
from radmpc.planners.verdict import Verdict
from radmpc.planning import plan
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.solvers.compiled_code import is_compiled
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


def vehicle(name: str, start: list[float]) -> Vehicle:
    return Vehicle(
        name=name,
        system=double_integrator(1.0, 2),
        start=start,
        goal=Goal(np.full(2, -50.0), np.full(2, 50.0), None),
        radius=0.4,
        control_limit=1.0,
        initial_covariance=np.diag([0.04, 0.04, 1e-6, 1e-6]),
        disturbance_covariance=1e-6 * np.eye(4),
    )


def passing(other: str) -> Scenario:
    """A vehicle on its way past a box, or past another that stays in the same place."""
    hovering = [0.0, 0.0, 0.0, 0.0] if other == "vehicle" else [0.0, 40.0, 0.0, 0.0]
    box = Obstacle.box("box", np.full(2, -0.5), np.full(2, 0.5))
    return Scenario(
        name="s",
        dt=1.0,
        horizon=10,
        risk_bound=0.1,
        vehicles=(vehicle("a", [-5.0, 0.0, 1.0, 0.0]), vehicle("b", hovering)),
        obstacles=(box,) if other == "box" else (),
        avoidance="steps",
    )


def flown(bend: float) -> list[np.ndarray]:
    """Controls by which the first vehicle has come aside by 4.5 bends when it passes the origin."""
    controls = np.zeros((10, 2))
    controls[0, 1] = bend
    return [controls, np.zeros((10, 2))]


@pytest.mark.parametrize(("other", "who"), [("box", {0}), ("vehicle", {0, 1})])
def test_who_passes_on_another_side_is_told_from_who_only_moves(other: str, who: set[int]) -> None:
    scenario = passing(other)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    left, further, right = flown(0.3), flown(0.36), flown(-0.3)

    assert on_other_sides(hazards, left, further) == frozenset()
    assert on_other_sides(hazards, left, right) == who
    assert on_other_sides(hazards, right, left) == who


def test_who_stays_is_passed_on_another_side_wherever_it_stands_in_the_fleet() -> None:
    scenario = passing("vehicle")
    scenario = replace(scenario, vehicles=scenario.vehicles[::-1])
    hazards = Hazards.of(scenario, condensed_models(scenario))
    left, right = flown(0.3)[::-1], flown(-0.3)[::-1]

    assert on_other_sides(hazards, left, right) == {0, 1}
    assert on_other_sides(hazards, left, [each.copy() for each in left]) == frozenset()


def test_who_comes_near_nothing_has_no_other_side() -> None:
    scenario = passing("box")
    hazards = Hazards.of(scenario, condensed_models(scenario))

    assert on_other_sides(hazards, flown(0.9), flown(-0.9)) == frozenset()


def test_sets_without_a_vehicle_that_has_anything_to_gain_are_held_where_they_are(
    sets: tuple[tuple[int, ...], ...],
) -> None:
    held = turning(60, sets)
    held.hold_all_but(frozenset({7, 50}))

    assert sorted(i for group in held.groups for i in group) == [0, 2, 7, 30, 40, 50]


def test_who_neither_goes_out_of_the_way_nor_risks_anything_is_idle() -> None:
    scenario = passing("vehicle")
    hazards = Hazards.of(scenario, condensed_models(scenario))
    close, far, straight = Paths(hazards), Paths(hazards), Paths(hazards)
    for paths, bend in ((close, 0.3), (far, 0.9), (straight, 0.0)):
        for i, controls in enumerate(flown(bend)):
            paths.fly(i, controls)

    # Both risk something where one passes close to the other.
    assert not_idle(hazards, close, (0.3, 0.0), 10.0, 1e-3) == {0, 1}
    assert not_idle(hazards, straight, (0.0, 0.0), 10.0, 1e-3) == {0, 1}
    assert not_idle(hazards, far, (0.9, 0.0), 10.0, 1e-3) == frozenset()
    # The detour costs more than the straight route would.
    assert not_idle(hazards, far, (0.0, 0.0), 10.0, 1e-3) == {0}
    # Risk that costs nothing is nothing to gain by.
    assert not_idle(hazards, close, (0.3, 0.0), 0.0, 1e-3) == frozenset()


@pytest.mark.slow
def test_sets_of_a_large_fleet_are_not_searched_within_a_budget(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    searched: list[int] = []

    def counted(within: WithinBudget, state: SearchState) -> SearchState:
        searched.append(within.fleet.scenario.num_vehicles)
        return close_gap(within, state)

    monkeypatch.setattr(certified, "close_gap", counted)
    for scenario in (replace(circle(3), avoidance="intervals"), fleet(49, 0)):
        found = plan(scenario, "certified(0)", rng=0, time_limit=20.0)
        assert found.plan is not None
    assert searched == [3]


def lanes(count: int, blocked: int) -> Scenario:
    """Vehicles side by side, each in a lane of its own; a box stands in the way of some."""

    def ahead(i: int) -> Vehicle:
        one = vehicle(f"v{i}", [0.0, 20.0 * i])
        return replace(one, goal=Goal.at([12.0, 20.0 * i], 0.5))

    boxes = tuple(
        Obstacle.box(f"box{i}", [5.0, 20.0 * i - 1.0], [6.0, 20.0 * i + 0.5])
        for i in range(blocked)
    )
    return Scenario("lanes", 1.0, 10, 0.05, tuple(map(ahead, range(count))), boxes)


@pytest.mark.parametrize(("blocked", "is_made"), [(6, False), (20, True)])
def test_a_large_fleet_of_which_most_go_around_obstacles_gets_a_plan_before_any_search(
    blocked: int, *, is_made: bool
) -> None:
    scenario = lanes(26, blocked)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    task = Task(hazards, lambda controls: Verdict(0.0, ()), Limits(), 1e-2, 0.05)
    assert bool(first_plan(task, 1.0, np.random.default_rng(0)).controls) == is_made


@pytest.mark.parametrize("has_plan", [True, False])
def test_waiting_for_a_certificate_is_urgent_only_where_there_is_no_plan(
    monkeypatch: pytest.MonkeyPatch, *, has_plan: bool
) -> None:
    urgent: list[bool] = []

    def noted(*asked: object) -> PriceControl:
        control = PriceControl(*asked)
        urgent.append(control.is_urgent)
        return control

    monkeypatch.setattr("radmpc.planners.certified.turned.turning.PriceControl", noted)
    begun = turning(30, tuple((i,) for i in range(30)))
    if has_plan:
        controls = tuple(begun.successive.paths.controls)
        begun.incumbent = FleetIncumbent(controls, 1.0, begun.sets, certified=0.01)
    begun.run(0)
    assert urgent == [not has_plan]


@pytest.mark.skipif(not is_compiled(), reason="searches take ten times as long without")
@pytest.mark.parametrize(("avoidance", "is_short"), [("steps", False), ("intervals", True)])
def test_a_search_has_a_plan_sooner_than_what_is_made_before_it_at_steps(
    avoidance: str, *, is_short: bool
) -> None:
    scenario = replace(fleet(50, 0), avoidance=avoidance)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    task = Task(hazards, lambda controls: Verdict(0.0, ()), Limits().within(1.0), 1e-2, 0.05)
    assert _is_short(task) is is_short
