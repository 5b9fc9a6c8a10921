"""Neighborhoods of a plan: who gives up much is rerouted or retimed, for a cheaper plan."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from radmpc import import_scenario
from radmpc.arrays import Matrix
from radmpc.experiments.families import circle, clutter, paper
from radmpc.experiments.swarms import swarm
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.planners import Branch, Centralized, Certified, Ira, Optimal, Planner
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.phases import improving, neighborhoods
from radmpc.planners.certified.phases.neighborhoods import search_neighborhoods
from radmpc.planners.certified.search import PriceSearch
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.outcome.record import Certifying
from radmpc.planners.verdict import Judge
from radmpc.planning import plan
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.solvers.solution import Limits

INSTANCES = Path(__file__).parents[3] / "instances"

BOX = Obstacle.box("box", [4.5, -3.0], [5.5, 0.8])
"""The way over it is the shorter one."""

WALL = Obstacle.box("wall", [4.5, 0.8], [5.5, 9.0])
"""Shuts that way."""


def side_by_side(*obstacles: Obstacle) -> Scenario:
    """Two vehicles from left to right, far from each other, and what the first one passes."""
    (vehicle,) = paper(1, 1).vehicles
    goals = [([9.5, y - 0.5], [10.5, y + 0.5]) for y in (0.0, -30.0)]
    starts = [[0.0, 0.0, 0.0, 0.0], [0.0, -30.0, 0.0, 0.0]]
    vehicles = tuple(
        replace(
            vehicle,
            name=name,
            start=np.array(start),
            goal=replace(vehicle.goal, lower=np.array(lower), upper=np.array(upper)),
        )
        for name, start, (lower, upper) in zip("ab", starts, goals, strict=True)
    )
    return replace(paper(1, 1), vehicles=vehicles, obstacles=obstacles, workspace=None)


def plan_of(scenario: Scenario) -> FleetIncumbent:
    """A plan by the paper's method."""
    made = plan(scenario, Planner(Ira(), Branch(), Centralized())).require()
    controls = tuple(t.controls for t in made.trajectories)
    assert made.cost is not None
    sets = ((0,), (1,))
    return FleetIncumbent(controls, made.cost, sets, certified=scenario.risk_bound)


def judge_of(scenario: Scenario) -> Judge:
    return Certifying(scenario, Planner(Optimal(), Branch(), Certified())).verdict


@pytest.mark.sampled(1)
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_vehicle_on_the_dearer_side_of_a_box_is_rerouted(seed: int) -> None:
    around, scenario = plan_of(side_by_side(BOX, WALL)), side_by_side(BOX)
    problem, judge, told = Fleet.of(scenario, 1e-3, Limits()), judge_of(scenario), list[float]()
    assert judge(around.controls).certified <= scenario.risk_bound
    problem = replace(problem, improved=lambda controls: told.append(effort(controls)))
    found = search_neighborhoods(problem, around, judge, np.random.default_rng(seed))
    assert found.cost == pytest.approx(effort(found.controls))
    assert found.cost <= 1.02 * plan_of(scenario).cost < 0.95 * around.cost
    assert judge(found.controls).certified <= scenario.risk_bound
    # Every better plan is handed on, and no other.
    assert told[-1] == found.cost
    assert told == sorted(told, reverse=True)


def test_every_cheaper_plan_is_told_as_soon_as_it_is_found() -> None:
    around, scenario = plan_of(side_by_side(BOX, WALL)), side_by_side(BOX)
    problem, judge, told = Fleet.of(scenario, 1e-3, Limits()), judge_of(scenario), list[float]()
    tell = lambda one: told.append(one.cost)  # noqa: E731 - a word for it
    found = search_neighborhoods(problem, around, judge, np.random.default_rng(0), tell)
    assert told[-1] == found.cost < around.cost
    assert len(told) == len(set(told))


def effort(controls: tuple[Matrix, ...]) -> float:
    return float(sum(np.abs(each).sum() for each in controls))


def test_the_same_seed_leads_to_the_same_plan() -> None:
    scenario = side_by_side(BOX)
    around, judge = plan_of(side_by_side(BOX, WALL)), judge_of(scenario)
    problem = Fleet.of(scenario, 1e-3, Limits())
    both = [
        search_neighborhoods(problem, around, judge, np.random.default_rng(5)) for _ in range(2)
    ]
    assert all(map(np.array_equal, both[0].controls, both[1].controls))


def test_who_gives_up_most_is_rerouted_most_often_and_nobody_never() -> None:
    scenario = circle(6)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    controls = [np.full(model.control_bounds.shape, 0.1) for model in hazards.models]
    each = float(np.abs(controls[0]).sum())
    draws = neighborhoods._Draws(hazards, 3.0, np.random.default_rng(0))
    base = [0.1 * each, *[each] * 5]
    drawn = [draws.vehicles(FleetIncumbent(tuple(controls), 6 * each), base) for _ in range(600)]
    firsts = Counter(chosen[0] for chosen in drawn)
    assert firsts[0] > 0.5 * len(drawn)
    assert set(firsts) == set(range(6))
    assert {len(chosen) for chosen in drawn} == {1, 2, 3}
    assert all(len(set(chosen)) == len(chosen) for chosen in drawn)


def test_new_paths_lead_from_the_start_to_the_goal_and_around_what_stands_in_the_way() -> None:
    scenario = side_by_side(BOX)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    around = plan_of(side_by_side(BOX, WALL)).controls[0]
    draws = neighborhoods._Draws(hazards, 3.0, np.random.default_rng(0))
    paths = [draws.places(0, around) for _ in range(60)]
    goal = scenario.vehicles[0].goal
    for path in paths:
        assert path.shape == (scenario.horizon + 1, 2)
        assert path[0] == pytest.approx(scenario.vehicles[0].start[:2])
        assert np.all((goal.lower - 1e-6 <= path[-1]) & (path[-1] <= goal.upper + 1e-6))
    below = [path[:, 1].min() < -3.0 for path in paths]
    above = [path[:, 1].max() > 0.8 for path in paths]
    # On its own route, on the other one, and straight ahead.
    assert min(sum(below), sum(above), len(paths) - sum(below) - sum(above)) > 5


def test_between_a_few_obstacles_neighborhoods_are_searched_instead_of_sets(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scenario = import_scenario(INSTANCES / "s2m2" / "zigzag.yaml").scenario
    searched = list[float]()

    def nearby(fleet, found, judge, rng, on_cheaper):
        searched.append(found.cost)
        return found

    monkeypatch.setattr(neighborhoods, "search_neighborhoods", nearby)
    monkeypatch.setattr(PriceSearch, "run", lambda *_: pytest.fail("sets are searched"))
    told = list[float]()
    result = plan(
        scenario, "certified", rng=0, stop=lambda: bool(searched), found=lambda c, _: told.append(c)
    )
    assert searched == [told[-1]]
    assert result.is_certified
    assert result.cost == pytest.approx(searched[0])


@pytest.mark.parametrize(("gap", "is_searched"), [(0.1, True), (0.01, False)])
def test_in_the_open_they_are_searched_where_the_search_left_a_gap(
    gap: float, *, is_searched: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    scenario, searched = replace(circle(3), avoidance="intervals"), list[float]()

    def nearby(fleet, found, judge, rng, on_cheaper):
        searched.append(found.cost)
        return replace(found, cost=found.cost - 1e-3)

    monkeypatch.setattr(neighborhoods, "search_neighborhoods", nearby)
    open_bound = lambda fleet, state, _: (1.0 - gap) * state.incumbent.cost  # noqa: E731 - a stub
    monkeypatch.setattr(improving, "bound_of_programs", open_bound)
    result = plan(scenario, "certified", rng=0, time_limit=20.0)
    assert bool(searched) == is_searched
    if is_searched:
        assert result.cost is not None
        assert result.cost <= searched[0]


@pytest.mark.parametrize(
    ("scenario", "is_nearby"),
    [
        (replace(circle(4), obstacles=()), True),
        (paper(8, 0), True),
        (paper(4, 0), False),
        (clutter(10, 20, 0), False),
        (swarm(6, 0), True),
        (replace(swarm(6, 0), obstacles=(Obstacle.box("box", [90.0] * 3, [91.0] * 3),)), False),
    ],
)
def test_after_the_search_they_are_for_few_vehicles_among_few_obstacles_in_the_plane(
    scenario: Scenario, *, is_nearby: bool
) -> None:
    assert improving.is_searched_nearby(scenario) == is_nearby
