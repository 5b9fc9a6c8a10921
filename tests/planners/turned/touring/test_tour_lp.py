"""Linear programs of vehicles on their way from visit to visit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from visiting import scene, vehicle

from radmpc import Obstacle, Scenario, Visit
from radmpc.model.dynamics import LinearSystem
from radmpc.planners.certified.turned.grid import Grid
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.linear.group_lp import GroupLp
from radmpc.planners.certified.turned.linear.margins import fixed_margins
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.normals.spaces import HalfSpaces
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.touring.tour_lp import TourLp
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.program.visits.steps import at_steps
from radmpc.solvers.solution import Limits

PENALTY = 30.0
ROCK = Obstacle.box("rock", [3.0, 0.5], [5.0, 2.0])


def fleet(avoidance: str = "intervals") -> Scenario:
    """Three that cross each other beside a rock, two of them with a visit at a step."""
    slow = Visit.at([4.0, 3.0], 0.5, between=(4, 4), speed=0.6)
    others = (
        vehicle("b", [9.0, 0.0], [0.0, 0.0], Visit.at([4.0, -3.0], 0.5, between=(6, 6))),
        vehicle("c", [4.5, 5.0], [4.5, -5.0]),
    )
    given = scene(slow, horizon=10, others=others)
    return replace(given, obstacles=(ROCK,), avoidance=avoidance)


def begun(given: Scenario) -> SuccessiveLp:
    """What everybody does alone."""
    successive = SuccessiveLp(Hazards.of(given, condensed_models(given)), Limits())
    assert successive.begin_alone()
    return successive


def turned(successive: SuccessiveLp, group: tuple[int, ...], clearance: float) -> HalfSpaces:
    near = Near(clearance, 1.0, is_refined=False, is_start_given=True)
    return half_spaces(successive.hazards, successive.paths, group, near)


def values(
    successive: SuccessiveLp, group: tuple[int, ...], programs: tuple[GroupLp, TourLp], keeps: float
) -> tuple[float, float]:
    """Solve both programs between the same half-spaces; return what is minimized by each."""
    spaces, weights = (
        turned(successive, group, keeps),
        [successive.hazards.models[i].vehicle.cost_weight for i in group],
    )
    margins = fixed_margins(spaces.deviations, keeps, PENALTY)
    dense = programs[0].solve(spaces, successive.paths, margins)
    found = programs[1].solve(spaces, successive.paths, keeps, PENALTY)
    assert dense is not None
    assert found is not None
    both = (dense.controls, dense.shortfall), found
    one, two = (
        sum(w * float(np.abs(u).sum()) for w, u in zip(weights, controls, strict=True))
        + PENALTY * missed
        for controls, missed in both
    )
    return one, two


CHANGES = {
    "as they are": {},
    "a speed limit": {"speed_limit": 1.3},
    "norms": {"speed_norm": 1.9, "control_norm": 1.2},
    "a current": {"drift": [0.05, -0.1, 0.0, 0.02]},
}


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_rows_from_step_to_step_say_what_rows_over_controls_do(change: str, avoidance: str) -> None:
    given = fleet(avoidance)
    vehicles = tuple(replace(each, **CHANGES[change]) for each in given.vehicles)
    successive = begun(replace(given, vehicles=vehicles))
    for group in ((0,), (1,), (2,), (0, 2), (0, 1, 2)):
        programs = GroupLp(successive.hazards, group), TourLp(successive.hazards, group)
        programs[1].visit([successive.hazards.models[i] for i in group])
        # Warm from the second on, with other half-spaces.
        for keeps in (1.0, 4.0, 2.0):
            one, two = values(successive, group, programs, keeps)
            assert two == pytest.approx(one, rel=1e-7, abs=1e-7)


def test_a_vehicle_without_a_name_for_its_velocity_is_planned_all_the_same() -> None:
    given = fleet()
    first = given.vehicles[0]
    system = LinearSystem(first.system.A, first.system.B, first.system.position, None)
    slow = tuple(replace(visit, speed=None) for visit in first.via)
    goal = replace(first.goal, speed=None)
    nameless = replace(first, system=system, via=slow, goal=goal, speed_limit=None)
    successive = begun(replace(given, vehicles=(nameless, *given.vehicles[1:])))
    programs = GroupLp(successive.hazards, (0,)), TourLp(successive.hazards, (0,))
    programs[1].visit(successive.hazards.models[:1])
    one, two = values(successive, (0,), programs, 3.0)
    assert two == pytest.approx(one, rel=1e-7)


def test_a_program_whose_visits_move_is_that_of_the_other_steps() -> None:
    successive = begun(fleet())
    hazards, program = successive.hazards, TourLp(successive.hazards, (0,))
    for step in (4, 6, 3, 4):
        model = at_steps(condensed_models(replace(fleet(), vehicles=opened()))[0], (step,))
        successive.hazards = replace(hazards, models=(model, *hazards.models[1:]))
        program.visit([model])
        anew = TourLp(successive.hazards, (0,))
        anew.visit([model])
        spaces = turned(successive, (0,), 3.0)
        both = [each.solve(spaces, successive.paths, 3.0, PENALTY) for each in (program, anew)]
        kept = [float(np.abs(u[0]).sum()) + PENALTY * missed for u, missed in both]
        assert kept[0] == pytest.approx(kept[1], rel=1e-9)
        route = model.drift_position + model.position @ both[0][0][0].ravel()
        assert np.all(np.abs(route[step] - [4.0, 3.0]) < 0.5 + 1e-7)


def opened() -> tuple:
    """The same, its first visit at any step."""
    first, *others = fleet().vehicles
    return replace(first, via=(replace(first.via[0], between=None),)), *others


def test_a_program_without_a_path_says_so_and_finds_the_next_one() -> None:
    successive = begun(fleet())
    model = condensed_models(replace(fleet(), vehicles=opened()))[0]
    program = TourLp(successive.hazards, (0,))
    program.visit([at_steps(model, (1,))])
    assert program.alone() is None
    program.visit([at_steps(model, (5,))])
    assert program.alone() is not None


def test_what_is_asked_again_takes_no_pivots() -> None:
    successive = begun(fleet())
    program = TourLp(successive.hazards, (0, 1, 2))
    program.visit(successive.hazards.models)
    spaces = turned(successive, (0, 1, 2), 3.0)
    works = []
    for _ in range(2):
        assert program.solve(spaces, successive.paths, 3.0, PENALTY) is not None
        works.append(program.work)
    assert works[1] == works[0] > 0.0


def test_half_spaces_of_those_that_count_are_those_of_all_that_count() -> None:
    successive = begun(fleet())
    counts = np.random.default_rng(3).random((4, 10)) < 0.5
    near = Near(3.0, 1.0, is_refined=False, is_start_given=True)
    every = half_spaces(successive.hazards, successive.paths, (0,), near)
    asked = half_spaces(successive.hazards, successive.paths, (0,), near, counts=counts)
    expected = every.of(counts[every.second, every.windows])
    assert 0 < asked.count < every.count
    assert np.array_equal(asked.keys, expected.keys)
    assert np.array_equal(asked.heights, expected.heights)


def test_the_nearest_open_point_of_a_grid_is_the_nearest_of_all() -> None:
    hazards, rng = begun(fleet()).hazards, np.random.default_rng(5)
    grid = Grid.of(hazards)
    for share in (0.9, 0.02, 0.0005):
        is_open = rng.random(len(grid.points)) < share
        # Many of these places are off the grid.
        for place in rng.uniform(-20.0, 20.0, (40, 2)):
            found = grid.nearest(place, is_open)
            away = np.linalg.norm(grid.points - place, axis=1)
            assert found == (np.flatnonzero(is_open)[away[is_open].argmin()])
    assert grid.nearest(np.zeros(2), np.zeros(len(grid.points), dtype=bool)) == -1
