"""First plans of vehicles on their way from visit to visit."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from visiting import scene, vehicle

from radmpc import Obstacle, Scenario, Vehicle, Visit, certify
from radmpc.model.visits import steps_visited
from radmpc.planners.certified.turned.narrow.clear import Clear
from radmpc.planners.certified.turned.normals.pair_normals import pair_encounter, start_normals
from radmpc.planners.certified.turned.paths import Paths, timed_by_visits
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.touring.crowding import crowding
from radmpc.planners.certified.turned.touring.leg_steps import steps_by_legs
from radmpc.planners.certified.turned.touring.shifting import shifted, warped
from radmpc.planners.certified.turned.touring.tour import Tour, tour
from radmpc.planners.certified.turned.touring.touring import Touring
from radmpc.planners.certified.turned.touring.visit_lp import VisitLp
from radmpc.planners.certified.turned.touring.visiting import at_good_visits, good_steps
from radmpc.program.build import condensed_models
from radmpc.program.condensed import CondensedModel
from radmpc.program.hazards import Hazards
from radmpc.program.visits.columns import windows_of
from radmpc.program.visits.steps import at_steps, steps_on
from radmpc.solvers.solution import Limits
from running import first_plan

WAY = np.array([[0.0, 0.0], [4.0, 3.0], [9.0, 0.0]])
VISIT = Visit.at([4.0, 3.0], 0.5)


def laid_out(scenario: Scenario, route: np.ndarray = WAY) -> tuple[Hazards, Tour]:
    hazards = Hazards.of(scenario, condensed_models(scenario))
    clear = Clear.of(hazards)
    assert clear is not None
    found = tour(hazards, hazards.models[0], 0, route, (clear, 3.0))
    assert found is not None
    return hazards, found


@pytest.mark.parametrize("window", [None, (2, 3), (8, 9)])
def test_a_pace_stops_in_every_box_within_its_window(window: tuple[int, int] | None) -> None:
    hazards, found = laid_out(scene(replace(VISIT, between=window), horizon=12))
    paced = found.laid_out.paced(12, found.due)
    assert paced is not None
    (step,), arrival = steps_on(hazards.models[0], paced[0])
    assert arrival is None
    assert np.all(np.abs(paced[0][step] - VISIT.center) <= 1.3 * 0.5)
    first, last = window or (1, 11)
    assert first <= step <= last


def test_a_pace_arrives_sooner_where_time_costs_more() -> None:
    given = scene(horizon=14)
    arrivals = []
    for price in (1e-3, 10.0):
        first = given.vehicles[0]
        goal = replace(first.goal, within=(5, 14))
        free = replace(given, vehicles=(replace(first, goal=goal),), time_weight=price)
        hazards, found = laid_out(free, np.array([[0.0, 0.0], [0.0, 6.0], [9.0, 0.0]]))
        paced = found.laid_out.paced(14, found.due)
        assert paced is not None
        arrivals.append(steps_on(hazards.models[0], paced[0])[1])
    assert arrivals[1] < arrivals[0]


def test_places_cost_something_near_others_and_only_when_these_count() -> None:
    other = vehicle("b", [4.0, 3.0], [4.0, 3.0])
    hazards, found = laid_out(scene(VISIT, horizon=8, others=(other,)))
    paths = Paths(hazards)
    counts = np.zeros((2, 8), dtype=bool)
    assert not crowding(found.laid_out, hazards, paths, counts, 3.0).any()
    counts[1, 5] = True
    lack = crowding(found.laid_out, hazards, paths, counts, 3.0)
    assert np.flatnonzero(lack.any(axis=(1, 2))).tolist() == [5]
    apart = np.linalg.norm(found.laid_out.places - [4.0, 3.0], axis=1)
    touching = hazards.radii.sum()
    assert np.all(lack[5][:, apart < touching] > 0.0)
    longest = found.laid_out.num_displacements * np.linalg.norm(
        np.diff(found.laid_out.places[:2], axis=0)
    )
    assert not lack[5][:, apart > touching + 3.0 + longest].any()


def test_a_way_is_timed_by_the_steps_of_its_visits() -> None:
    given = scene(VISIT, horizon=8)
    model = at_steps(condensed_models(given)[0], (2,))
    places = timed_by_visits(model, WAY)
    assert places[2] == pytest.approx(VISIT.center)
    assert places[1] == pytest.approx(0.5 * np.array(VISIT.center))
    assert places[-1] == pytest.approx(WAY[-1])


def test_vehicles_that_would_meet_at_a_visit_make_it_at_different_times() -> None:
    other = vehicle("b", [9.0, 0.0], [0.0, 0.0], VISIT)
    given = scene(VISIT, horizon=10, others=(other,))
    to_choose = condensed_models(given)
    hazards = at_good_visits(Hazards.of(given, to_choose)).hazards
    alone = SuccessiveLp(hazards, Limits())
    assert alone.begin_alone()
    touring = Touring(hazards, to_choose, Limits(), 3.0)
    assert touring.run(alone.paths, {})
    assert touring.successive.missed.sum() < 0.05
    means = touring.successive.paths.means
    steps = [steps_visited(v.via, one, None) for v, one in zip(given.vehicles, means, strict=True)]
    assert steps[0] != steps[1]


def side_by_side(gap: float) -> Scenario:
    """Two that start next to each other and cross in the first second; one is in a hurry."""
    north = vehicle("a", [0.0, 0.0], [12.0, 9.0], Visit.at([2.0, 9.0], 0.5, between=(3, 3)))
    south = vehicle("b", [0.0, gap], [12.0, -9.0], Visit.at([2.0, -9.0], 0.5, between=(6, 6)))
    pair = tuple(replace(each, control_limit=3.0) for each in (north, south))
    return Scenario("side by side", 1.0, 10, 0.01, pair)


@pytest.mark.parametrize("gap", [0.9, 1.2, 2.0])
def test_neighbors_whose_first_legs_cross_at_once_let_each_other_pass(gap: float) -> None:
    given = side_by_side(gap)
    successive = SuccessiveLp(Hazards.of(given, condensed_models(given)), Limits())
    assert successive.begin_alone()
    assert successive.keep_apart(3.0, 20)


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.5, 3.0, np.pi, -1.5])
def test_a_half_space_between_neighbors_keeps_the_clearance_where_they_start(angle: float) -> None:
    given = side_by_side(1.2)
    hazards = Hazards.of(given, condensed_models(given))
    paths, distance = Paths(hazards), np.array([0.6])
    meeting = tuple(np.array([k]) for k in (1, 0, 0))
    met = pair_encounter(hazards, paths, meeting, distance)
    asked = np.array([[np.sin(angle), np.cos(angle)]])
    turned, is_kept = start_normals(met, asked, 3.0)
    assert is_kept.all()
    assert np.linalg.norm(turned) == pytest.approx(1.0)
    assert met.clearances(turned[:, None])[0, 0] >= 3.0 - 1e-9
    if abs(angle) < 0.5:
        assert turned == pytest.approx(asked)
    if 0.5 < abs(angle) < 3.1:
        assert np.sign(turned[0, 0]) == np.sign(asked[0, 0])
    assert not start_normals(met, asked, 30.0)[1].any()


def test_visits_are_shifted_within_their_windows_and_in_order() -> None:
    windows = [(2, 4), (5, 8), (5, 9)]
    visits = [replace(VISIT, between=each) for each in windows]
    model = condensed_models(scene(*visits, horizon=12))[0]
    found = set(shifted(model, (4, 5, 6)))
    assert found == {(3, 5, 6), (4, 5, 7)}


def all_steps(model: CondensedModel) -> dict[tuple[int, ...], float]:
    """Return what every choice of steps costs in empty space."""
    program, last = VisitLp(model), model.horizon
    count = len(model.vehicle.via)
    return {steps: program.cost([*steps, last]) for steps in combinations(range(1, last), count)}


@pytest.mark.parametrize(
    "places", [((0.0, 6.0), (1.5, 6.0), (3.0, 0.0)), ((4.0, 3.0), (6.0, -3.0))]
)
def test_good_steps_cost_little_more_than_the_best(places: tuple[tuple[float, float], ...]) -> None:
    model = condensed_models(scene(*(Visit.at(each, 0.5) for each in places), horizon=10))[0]
    costs = all_steps(model)
    least = min(costs.values())
    assert costs[good_steps(model)[:-1]] <= 1.01 * least
    assert costs[good_steps(model, is_thorough=False)[:-1]] <= 1.1 * least


def test_legs_find_steps_that_even_speed_does_not() -> None:
    # Near each other at first, then far: at even speed the first two are a turn in one step.
    places = ([1.0, 2.0], [1.5, 0.0], [9.0, 6.0])
    model = condensed_models(scene(*(Visit.at(each, 0.3) for each in places), horizon=14))[0]
    windows, even = windows_of(model), [2, 3, 9]
    found = steps_by_legs(model, windows, even)
    assert found is not None
    assert sorted(set(found)) == found
    program = VisitLp(model)
    assert program.cost([*found, 14]) < 0.9 * program.cost([*even, 14])


def test_steps_by_legs_keep_windows_and_stops() -> None:
    stop = Visit.at([4.0, 3.0], 0.5, between=(6, 8), speed=0.0)
    model = condensed_models(scene(stop, Visit.at([6.0, 3.0], 0.5), horizon=14))[0]
    found = steps_by_legs(model, windows_of(model), [6, 9])
    assert found is not None
    assert 6 <= found[0] <= 8 < found[1] < 14


@pytest.mark.parametrize("fastest", [1.3, 1.6, 2.0])
@pytest.mark.parametrize("places", [([6.0, 4.0], [4.0, 2.0]), ([7.0, 3.0], [2.0, 3.0])])
def test_steps_by_legs_rise_where_every_leg_is_too_fast(
    places: tuple[list[float], ...], fastest: float
) -> None:
    given = scene(*(Visit.at(each, 0.3) for each in places), horizon=8)
    slow = replace(given.vehicles[0], speed_limit=[fastest, fastest])
    model = condensed_models(replace(given, vehicles=(slow,)))[0]
    found = steps_by_legs(model, windows_of(model), [6, 7])
    assert found is not None
    assert 1 <= found[0] < found[1] <= 7


def test_a_visit_at_the_horizon_leaves_the_others_in_order() -> None:
    last = Visit.at([8.8, 0.0], 0.3, between=(10, 10))
    model = condensed_models(scene(VISIT, Visit.at([6.0, 3.0], 0.5), last, horizon=10))[0]
    found = steps_by_legs(model, windows_of(model), [4, 7, 10])
    assert found is not None
    assert 1 < found[0] < found[1] < found[2] == 10


def test_visits_are_moved_by_a_step_while_that_is_cheaper() -> None:
    touring = toured(
        vehicle("a", [0.0, 0.0], [9.0, 0.0], VISIT), vehicle("b", [20.0, 0.0], [20.0, 0.0])
    )
    successive = touring.successive
    (good,), _ = steps_on(successive.hazards.models[0], good_path(touring))
    late = at_steps(condensed_models(scene(VISIT, horizon=10))[0], (good + 2,))
    successive.make_visits(0, late)
    assert successive.begin_alone()
    successive.missed[:] = 0.0
    before = successive.paths.cost()
    touring.improve()
    assert successive.paths.cost() < before
    assert successive.hazards.models[0].vehicle.via[0].between in ((good, good), (good + 1,) * 2)
    assert successive.missing(3.0).sum() < 0.01


def good_path(touring: Touring) -> np.ndarray:
    assert touring.successive.begin_alone()
    return touring.successive.paths.means[0].copy()


def test_a_path_is_warped_to_make_its_visits_at_other_steps() -> None:
    path = np.cumsum(np.arange(26.0).reshape(13, 2), axis=0)
    other = warped(path, (3, 8), (5, 7))
    assert np.array_equal(other[[0, 5, 7, 12]], path[[0, 3, 8, 12]])
    assert np.array_equal(warped(path, (3, 8), (3, 8)), path)


def toured(*fleet: Vehicle, obstacles: tuple[Obstacle, ...] = (), horizon: int = 10) -> Touring:
    given = Scenario("tour", 1.0, horizon, 0.01, fleet, obstacles)
    to_choose = condensed_models(given)
    hazards = at_good_visits(Hazards.of(given, to_choose)).hazards
    return Touring(hazards, to_choose, Limits(), 3.0)


def test_who_goes_back_does_what_it_did() -> None:
    touring = toured(vehicle("a", [0.0, 0.0], [9.0, 0.0], VISIT))
    successive = touring.successive
    assert successive.begin_alone()
    known, before = successive.solo_plan(0), successive.paths.means[0].copy()
    successive.make_visits(0, at_steps(condensed_models(scene(VISIT, horizon=10))[0], (7,)))
    successive.refer(0, np.zeros((11, 2)))
    assert successive.keep_clear(0, 3.0, (2, 30.0), np.ones((2, 10), dtype=bool)) < 1e-7
    assert not np.allclose(successive.paths.means[0], before)
    successive.come_back(0, known)
    assert successive.hazards.models[0] is known.model
    assert np.array_equal(successive.paths.means[0], before)


def test_what_a_vehicle_comes_near_far_from_its_last_path_is_kept_clear_of() -> None:
    late = replace(VISIT, between=(8, 8))
    touring = toured(
        vehicle("a", [0.0, 0.0], [9.0, 0.0], late), vehicle("b", [5.0, 0.9], [5.0, 0.9])
    )
    successive = touring.successive
    assert successive.begin_alone()
    # A path far from what controls can do, and from the other vehicle.
    successive.refer(0, np.linspace([0.0, 0.0], [0.0, 30.0], 11))
    counts = np.ones((3, 10), dtype=bool)
    successive.keep_clear(0, 3.0, (8, 30.0), counts)
    assert successive.missing(3.0).sum() < 1e-6


def test_a_fleet_that_starts_side_by_side_and_crosses_keeps_clear_of_each_other() -> None:
    fleet = [
        vehicle(f"v{i}", [0.0, 1.2 * i], [14.0, 1.2 * (5 * i % 6)], Visit.at([5.0, y], 0.6))
        for i, y in enumerate([9.0, -6.0, 7.0, -4.0, 12.0, -9.0])
    ]
    touring = toured(*(replace(each, control_limit=3.0) for each in fleet), horizon=12)
    alone = SuccessiveLp(touring.successive.hazards, Limits())
    assert alone.begin_alone()
    assert touring.run(alone.paths, {})
    assert touring.successive.missed.sum() < 0.06


def test_a_first_plan_leads_around_a_box_between_visits() -> None:
    box = Obstacle.box("box", [5.0, 0.5], [7.0, 2.5])
    given = scene(VISIT, Visit.at([8.0, 1.0], 0.5), horizon=14)
    found = first_plan(replace(given, obstacles=(box,)), time_limit=20.0)
    assert found.plan is not None
    assert certify(found.plan).holds
