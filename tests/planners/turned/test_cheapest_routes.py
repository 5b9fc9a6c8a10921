"""Of several routes around obstacles a first plan begins with the one of least effort."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from radmpc.arrays import Matrix
from radmpc.experiments.families import clutter, paper
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.state.task import Task
from radmpc.planners.certified.turned.detours import Toll, detours
from radmpc.planners.certified.turned.grid import Grid
from radmpc.planners.certified.turned.narrow import cheapest
from radmpc.planners.certified.turned.narrow.cheapest import cheapest_routes
from radmpc.planners.certified.turned.narrow.route import Route
from radmpc.planners.certified.turned.paths import timed_by_visits
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.verdict import Verdict
from radmpc.program.build import build_program, condensed_models
from radmpc.program.hazards import Hazards
from radmpc.program.program import DisjunctiveProgram
from radmpc.solvers.solution import Limits

CLEARANCE = 2.5

PRICE = 2.0
"""Cost of risk: a tenth of a unit of effort for all that is allowed [per unit of probability]."""


def efforts(hazards: Hazards, places: Mapping[int, Matrix]) -> list[float]:
    """Return everyone's effort once all are kept apart, begun at some places step by step."""
    successive = SuccessiveLp(hazards, Limits())
    assert successive.begin_alone()
    for i, path in places.items():
        successive.refer(i, path)
    assert successive.keep_apart(CLEARANCE, TUNING.max_sweeps)
    return [float(np.abs(u).sum()) for u in successive.paths.controls]


def chosen(
    scenario: Scenario,
    price: float | None = None,
    clearance: float = CLEARANCE,
    *,
    is_quick: bool = False,
) -> dict[int, Route]:
    """Return the routes of all vehicles that a first plan would begin with."""
    hazards = Hazards.of(scenario, condensed_models(scenario))
    alone = SuccessiveLp(hazards, Limits())
    assert alone.begin_alone()

    def program(i: int) -> DisjunctiveProgram:
        return build_program(scenario, (hazards.models[i],), risk_bound=scenario.risk_bound)

    task = Task(hazards, unjudged, Limits(), 1e-3, scenario.risk_bound, program_alone=program)
    everyone = range(hazards.count)
    told = {"is_quick": is_quick}
    return cheapest_routes(task, alone, everyone, clearance, price, **told)


def unjudged(controls: Sequence[Matrix]) -> Verdict:
    """Refuse to certify: routes are chosen without the referee."""
    raise AssertionError(controls)


def test_who_would_go_far_around_goes_through_a_gap_where_that_takes_less_effort() -> None:
    scenario = clutter(2, 100, 9)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    ways = detours(hazards, [0, 1], CLEARANCE)
    shortest = efforts(hazards, {i: timed_by_visits(hazards.models[i], ways[i]) for i in ways})
    ours = efforts(hazards, {i: route.places for i, route in chosen(scenario).items()})
    assert ours[0] < 0.7 * shortest[0]


def test_in_large_fleets_the_shortest_way_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    scenario = clutter(2, 100, 9)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    monkeypatch.setattr(cheapest, "TUNING", replace(TUNING, weighed=1))
    routes, shortest = chosen(scenario), detours(hazards, [0, 1], CLEARANCE)
    assert routes.keys() == shortest.keys()
    assert all(np.array_equal(routes[i].corners, shortest[i]) for i in routes)


@pytest.mark.parametrize("is_quick", [False, True])
def test_where_sides_are_told_soon_no_ways_beside_others_are_compared(
    monkeypatch: pytest.MonkeyPatch, is_quick: bool
) -> None:
    tolls: list[Toll] = []

    def counted(*args: Any) -> dict[int, Matrix]:
        tolls.extend(each for each in args if isinstance(each, Toll))
        return detours(*args)

    monkeypatch.setattr(cheapest, "detours", counted)
    routes = chosen(clutter(2, 100, 9), is_quick=is_quick)
    assert len(routes) == 2
    assert any(len(toll.beside) > 0 for toll in tolls) != is_quick


def test_who_would_wind_on_every_route_takes_the_path_of_least_effort() -> None:
    scenario = replace(clutter(4, 100, 1), avoidance="steps")
    hazards = Hazards.of(scenario, condensed_models(scenario))
    ours, ways = chosen(scenario, PRICE), chosen(scenario)
    with_paths, on_ways = (
        efforts(hazards, {i: route.places for i, route in routes.items()})
        for routes in (ours, ways)
    )
    assert with_paths[0] < 0.7 * on_ways[0]
    assert sum(with_paths) < 0.9 * sum(on_ways)
    # With speeds of its own.
    assert np.array_equal(ours[0].places, ours[0].corners)


def test_a_route_that_leads_through_a_box_counts_as_missing_it() -> None:
    """Planned once, a vehicle may leave the boxes near its route, and cross others."""
    scenario = replace(clutter(10, 100, 2), avoidance="steps")
    hazards = Hazards.of(scenario, condensed_models(scenario))
    planned = SuccessiveLp(hazards, Limits())
    assert planned.begin_alone()
    planned.refer(6, chosen(scenario, clearance=2.8)[6].places)
    for _ in range(6):
        planned.plan_alone(6, 2.8, TUNING.first_penalty)
    # Through a box it would miss 1.9 m.
    assert planned.missed[6] < 0.5


def test_a_way_beside_another_leads_through_another_gap() -> None:
    (vehicle,) = paper(1, 1).vehicles
    goal = replace(vehicle.goal, lower=[9.5, -0.5], upper=[10.5, 0.5])
    vehicle = replace(vehicle, start=[0.0, 0.0, 0.0, 0.0], goal=goal)
    # Gaps at y = 0 and y = 3.
    bars = [(-8.0, -1.0), (1.0, 2.0), (4.0, 12.0)]
    walls = [Obstacle.box(f"bar{k}", [4.8, low], [5.2, high]) for k, (low, high) in enumerate(bars)]
    scenario = replace(paper(1, 1), vehicles=(vehicle,), obstacles=tuple(walls), workspace=None)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    grid = Grid.of(hazards)
    first = detours(hazards, [0], 0.0, grid)[0]
    second = detours(hazards, [0], 0.0, grid, Toll(beside=(first,)))[0]
    heights = [route[np.abs(route[:, 0] - 5.0).argmin(), 1] for route in (first, second)]
    assert abs(heights[0]) < 1.0
    assert 2.0 < heights[1] < 4.0
