"""Vehicles in narrow routes: at which pace they go, and who lets whom pass."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import count, pairwise
from pathlib import Path

import numpy as np
import pytest
from grid_worlds import cells

from radmpc import certify, import_scenario
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.turned import placing
from radmpc.planners.certified.turned.attempt import Attempt
from radmpc.planners.certified.turned.narrow import knots
from radmpc.planners.certified.turned.narrow.clear import Clear
from radmpc.planners.certified.turned.narrow.joint_search import GoalGraph, joint_search
from radmpc.planners.certified.turned.narrow.knots import joint_routes
from radmpc.planners.certified.turned.narrow.pacing import Pacing
from radmpc.planners.certified.turned.narrow.prioritized import prioritized_ticks
from radmpc.planners.certified.turned.narrow.routes import shortest_routes
from radmpc.planners.certified.turned.narrow.track import track
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.solvers.solution import Limits
from running import first_plan

INSTANCES = Path(__file__).parents[4] / "instances"
CROWD = INSTANCES / "libMultiRobotPlanning" / "map_32by32_obst204_agents20_ex3.yaml"

KNOT = CROWD.parent / "map_8by8_obst12_agents12_ex96.yaml"


def never() -> bool:
    return False


def hazards_of(scenario: Scenario) -> Hazards:
    return Hazards.of(scenario, condensed_models(scenario))


def corridor_with_a_bay(path: Path) -> Scenario:
    """Two robots that swap the ends of a corridor one cell wide, a bay in its middle."""
    free = {(x, 0) for x in range(9)} | {(4, 1)}
    return cells(path, (9, 2), free, [((0, 0), (8, 0)), ((8, 0), (0, 0))])


def test_distances_past_a_corner_are_those_of_the_corner(tmp_path: Path) -> None:
    scenario = cells(tmp_path, (3, 3), {(0, 0), (0, 1), (0, 2), (1, 2), (2, 2)}, [((0, 0), (2, 2))])
    clear = Clear.of(hazards_of(scenario))
    assert clear is not None
    corner = np.array([1.0, 2.0])
    for angle in (0.6, 0.8, 1.0):
        place = corner + 0.4 * np.array([-np.cos(angle), np.sin(angle)])
        assert clear.at(place) == pytest.approx(0.4, abs=1e-3)
    assert clear.along(np.array([0.5, 1.9]), np.array([1.1, 2.5])) == pytest.approx(
        0.4 / np.sqrt(2.0), abs=0.01
    )


def test_a_pace_keeps_room_at_corners_and_speeds_that_lead_from_place_to_place(
    tmp_path: Path,
) -> None:
    free = {(0, y) for y in range(5)} | {(x, 4) for x in range(5)}
    scenario = cells(tmp_path, (5, 5), free, [((0, 0), (4, 4))])
    hazards = hazards_of(scenario)
    clear = Clear.of(hazards)
    assert clear is not None
    route = shortest_routes(hazards, clear, 2.0)[0][0]
    laid_out = track(hazards, 0, route, (clear, 2.0))
    assert laid_out is not None
    found = laid_out.paced(hazards.horizon, ())
    assert found is not None
    places = found[0]
    assert places[0] == pytest.approx(route[0])
    assert places[-1] == pytest.approx(route[-1])
    spread = np.sqrt(hazards.variances[0].max() / 2.0)
    needed = hazards.radii[0] + 2.0 * spread
    assert clear.along(places[:-1], places[1:]).min() >= needed - 0.02
    # A double integrator covers half the sum of both speeds in a step.
    dt, limit = scenario.dt, scenario.vehicles[0].speed_limit
    speeds = [np.zeros(2)]
    for moved in np.diff(places, axis=0):
        speeds.append(2.0 * moved / dt - speeds[-1])
    # Errors of half a level add up along the route.
    assert np.abs(speeds).max() <= 1.3 * np.max(limit)


@pytest.mark.parametrize("current", [(0.2, 0.0), (-0.15, 0.1)])
def test_a_pace_in_a_current_is_one_that_the_limits_through_the_water_allow(
    current: tuple[float, float], tmp_path: Path
) -> None:
    scenario = cells(tmp_path, (9, 1), {(x, 0) for x in range(9)}, [((0, 0), (8, 0))])
    dt = scenario.dt
    [vehicle] = scenario.vehicles
    drift = np.array([*np.multiply(dt, current), 0.0, 0.0])
    scenario = replace(scenario, vehicles=(replace(vehicle, drift=drift),))
    hazards = hazards_of(scenario)
    clear = Clear.of(hazards)
    assert clear is not None
    laid_out = track(hazards, 0, shortest_routes(hazards, clear, 2.0)[0][0], (clear, 2.0))
    assert laid_out is not None
    found = laid_out.paced(hazards.horizon, ())
    assert found is not None
    # At rest through the water at the start; half the sum of both speeds, and the current.
    speeds = [np.zeros(2)]
    for moved in np.diff(found[0], axis=0):
        speeds.append(2.0 * (moved - drift[:2]) / dt - speeds[-1])
    unit = 2.0 * float(np.linalg.norm(laid_out.places[1] - laid_out.places[0])) / dt
    push = dt * float(np.max(vehicle.control_limit))
    along = np.array(speeds)[:, 0]
    assert np.abs(along).max() <= 1.1 * np.max(vehicle.speed_limit) + unit
    assert np.abs(np.diff(along)).max() <= push + 1.5 * unit
    assert abs(along[-1]) <= np.max(vehicle.goal.speed) + 1.5 * unit


def test_vehicles_paced_on_ways_that_cross_are_never_near_between_steps(tmp_path: Path) -> None:
    free = {(x, 3) for x in range(7)} | {(3, y) for y in range(7)}
    robots = [((0, 3), (6, 3)), ((3, 0), (3, 6)), ((6, 3), (0, 3))]
    hazards = hazards_of(cells(tmp_path, (7, 7), free, robots[:2]))
    clear = Clear.of(hazards)
    assert clear is not None
    pacing = Pacing(hazards, clear, 2.0)
    pacing.offer(shortest_routes(hazards, clear, 2.0))
    places = pacing.run((0, 1), never)
    assert sorted(places) == [0, 1]
    tau = np.linspace(0.0, 1.0, 21)[:, None, None]
    relative = places[0] - places[1]
    between = relative[:-1] + tau * np.diff(relative, axis=0)
    assert np.linalg.norm(between, axis=2).min() > hazards.radii.sum()


def test_two_that_meet_head_on_in_a_corridor_have_no_pace(tmp_path: Path) -> None:
    hazards = hazards_of(corridor_with_a_bay(tmp_path))
    clear = Clear.of(hazards)
    assert clear is not None
    pacing = Pacing(hazards, clear, 2.0)
    pacing.offer(shortest_routes(hazards, clear, 2.0))
    assert pacing.run((0, 1), never) == {}


@pytest.mark.parametrize("seed", range(6))
def test_joint_ways_lead_everyone_to_the_goal_without_conflict(seed: int) -> None:
    rng = np.random.default_rng(seed)
    size, count = 4, 11
    number = np.arange(size * size).reshape(size, size)
    neighbors: list[list[int]] = [[] for _ in range(size * size)]
    for one, two in ((number[1:], number[:-1]), (number[:, 1:], number[:, :-1])):
        for i, j in zip(one.ravel().tolist(), two.ravel().tolist(), strict=True):
            neighbors[i].append(j)
            neighbors[j].append(i)
    starts, goals = (tuple(rng.permutation(size * size)[:count].tolist()) for _ in range(2))
    found = joint_search(GoalGraph.to(goals, neighbors), starts, goals, 20_000, rng, never)
    assert found[0] == starts
    assert found[-1] == goals
    for before, after in pairwise(found):
        assert len(set(after)) == count
        for i in range(count):
            assert after[i] == before[i] or after[i] in neighbors[before[i]]
            for j in range(i):
                assert not (after[i] == before[j] and after[j] == before[i])


@pytest.mark.parametrize("length", [4, 8, 12])
def test_two_at_a_dead_end_change_places_where_the_passage_branches(length: int) -> None:
    # From (0, 1) to (1, 0) on a line that ends in a fork: to the fork and back, and no detour.
    edges = [(k, k + 1) for k in range(length)] + [(length - 1, length + 1)]
    neighbors: list[list[int]] = [[] for _ in range(length + 2)]
    for i, j in edges:
        neighbors[i].append(j)
        neighbors[j].append(i)
    rng = np.random.default_rng(0)
    found = joint_search(GoalGraph.to((1, 0), neighbors), (0, 1), (1, 0), 3 * length, rng, never)
    assert len(found) == 2 * length
    assert found[-1] == (1, 0)


def test_a_joint_search_says_when_there_is_no_way() -> None:
    # A corridor of four nodes: nobody can let the other pass.
    neighbors = [[1], [0, 2], [1, 3], [2]]
    rng = np.random.default_rng(0)
    assert joint_search(GoalGraph.to((3, 0), neighbors), (0, 3), (3, 0), 10_000, rng, never) == []
    # And no way at all between two parts.
    parts = GoalGraph.to((3,), [[1], [0], [3], [2]])
    assert joint_search(parts, (0,), (3,), 10, rng, never) == []


def test_an_order_that_shut_somebody_out_is_not_tried_again(tmp_path: Path) -> None:
    hazards = hazards_of(corridor_with_a_bay(tmp_path))
    asked = []
    placed, ticks = prioritized_ticks(hazards, lambda: bool(asked.append(None)))
    assert placed == {}
    # Two have two orders. Either places both, tick by tick.
    assert len(asked) <= 2 * 2 * (1 + ticks * hazards.horizon)


@pytest.mark.slow
def test_a_bay_lets_two_swap_where_no_order_of_priority_does(tmp_path: Path) -> None:
    scenario = corridor_with_a_bay(tmp_path)
    hazards = hazards_of(scenario)
    assert prioritized_ticks(hazards, never)[0] == {}
    clear = Clear.of(hazards)
    assert clear is not None
    routes = joint_routes(hazards, clear, np.random.default_rng(0), never)
    # One of them turns into the bay, which begins at y = 1.
    assert max(route[:, 1].max() for route in routes.values()) > 1.2
    result = first_plan(scenario, time_limit=60.0)
    assert result.plan is not None
    assert certify(result.plan).holds


def test_of_joint_routes_drawn_the_shortest_is_taken_whatever_other_draws_come_to(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    hazards = hazards_of(corridor_with_a_bay(tmp_path))
    clear = Clear.of(hazards)
    assert clear is not None
    lengths = iter((43, 0, 21, 0, 37, *([0] * 100)))
    monkeypatch.setattr(knots, "rerouted", lambda _, drawn, *__: drawn)
    monkeypatch.setattr(knots, "joint_search", lambda *_: [(0, 1)] * next(lengths))
    routes = joint_routes(hazards, clear, np.random.default_rng(0), never)
    assert {len(route) for route in routes.values()} == {21}


def test_joint_routes_that_take_a_long_search_are_found_after_all(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    hazards = hazards_of(corridor_with_a_bay(tmp_path))
    clear = Clear.of(hazards)
    assert clear is not None

    def searched(*given: object) -> list[tuple[int, ...]]:
        most = given[3]
        assert isinstance(most, int)
        return [(0, 1)] * 9 if most > 1000 else []

    monkeypatch.setattr(knots, "joint_search", searched)
    assert joint_routes(hazards, clear, np.random.default_rng(0), never)


@pytest.mark.slow
def test_where_one_joint_solution_leads_to_no_plan_others_are_drawn(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn, apart, missed = [], Attempt.keep_apart, count(10)

    def counted(*given: object) -> Mapping[int, np.ndarray]:
        drawn.append(given)
        return joint_routes(*given)  # type: ignore[arg-type] # handed on

    def late(attempt: Attempt, clearance: float, limits: Limits) -> bool:
        if len(drawn) > 2:
            return apart(attempt, clearance, limits)
        # Never alike, which would be turned.
        attempt.turning.successive.missed[:] = next(missed)
        return False

    monkeypatch.setattr(placing, "joint_routes", counted)
    monkeypatch.setattr(Attempt, "keep_apart", late)
    # A tenth of it is for attempts of this kind, which take their time where processors are slow.
    result = first_plan(corridor_with_a_bay(tmp_path), time_limit=600.0)
    assert len(drawn) == 3
    assert result.plan is not None
    assert certify(result.plan).holds


@pytest.mark.slow
def test_a_knot_of_twelve_is_undone_by_the_shortest_of_several_joint_routes() -> None:
    result = first_plan(import_scenario(KNOT).scenario, time_limit=120.0)
    assert result.plan is not None
    assert result.plan.cost is not None
    # The search alone finds a plan of 171, after 30 s.
    assert result.plan.cost < 60.0
    assert certify(result.plan).holds


@pytest.mark.slow
@pytest.mark.nightly
def test_twenty_robots_whose_steps_are_longer_than_the_cells_get_a_certified_plan() -> None:
    result = first_plan(import_scenario(CROWD).scenario, time_limit=120.0)
    assert result.plan is not None
    assert certify(result.plan).holds
