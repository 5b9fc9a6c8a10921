"""What turning and mirroring space exchanges: sets of vehicles that cost the same."""

from __future__ import annotations

from itertools import combinations, permutations

import numpy as np
import pytest

from radmpc.experiments.families import circle
from radmpc.model.dynamics import LinearSystem
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.model.workspace import Workspace
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.proof import part
from radmpc.planners.certified.proof.part import Part, PartOrder, PartTask
from radmpc.planners.certified.proof.part_search import search_part
from radmpc.planners.certified.proof.symmetry import (
    bound_of_image,
    images_of,
    symmetries,
    with_images,
)
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planning import plan
from radmpc.program.build import condensed_models
from radmpc.records import replace
from radmpc.solvers.solution import Limits


def group_of(scenario: Scenario) -> tuple[tuple[int, ...], ...]:
    """The symmetries of a whole fleet."""
    return symmetries(scenario, condensed_models(scenario))


def middle_of(scenario: Scenario) -> np.ndarray:
    """The mean of the starts."""
    return np.mean([vehicle.start[:2] for vehicle in scenario.vehicles], axis=0)


def changed(scenario: Scenario, i: int, **values: object) -> Scenario:
    """The scenario with another vehicle in the place of one."""
    vehicles = list(scenario.vehicles)
    vehicles[i] = replace(vehicles[i], **values)
    return replace(scenario, vehicles=tuple(vehicles))


@pytest.mark.parametrize(("count", "size"), [(2, 1), (3, 1), (4, 7), (6, 3), (8, 7), (16, 7)])
@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_a_circle_is_turned_by_right_angles_and_mirrored(
    count: int, size: int, avoidance: str
) -> None:
    found = group_of(replace(circle(count), avoidance=avoidance))
    assert len(found) == size
    # Neighbors on the circle stay neighbors.
    steps = {(each[1] - each[0]) % count for each in found}
    assert steps <= {1, count - 1}


def test_they_are_a_group() -> None:
    found = {*group_of(circle(8)), tuple(range(8))}
    assert {tuple(a[i] for i in b) for a in found for b in found} == found


def nudged(vehicle: Vehicle) -> np.ndarray:
    """A start a millionth of a meter aside."""
    return vehicle.start + 1e-6 * np.eye(vehicle.start.size)[0]


ONE_OF_ITS_KIND = {
    "a start": lambda v: {"start": nudged(v)},
    "a radius": lambda v: {"radius": 1.001 * v.radius},
    "what effort costs": lambda v: {"cost_weight": 2.0},
    "a limit": lambda v: {"control_limit": 1.01 * v.control_limit},
    "noise": lambda v: {"disturbance_covariance": 1.01 * v.disturbance_covariance},
    "drift": lambda v: {"drift": 1e-3 * np.eye(v.start.size)[0]},
    "dynamics": lambda v: {"system": LinearSystem(**_slower(v))},
}


def _slower(vehicle: Vehicle) -> dict[str, object]:
    """The fields of the dynamics of a vehicle whose controls do less."""
    system = vehicle.system
    fields = {name: getattr(system, name) for name in ("A", "position", "velocity")}
    return fields | {"B": 0.99 * system.B}


@pytest.mark.parametrize("what", ONE_OF_ITS_KIND)
def test_nobody_takes_the_place_of_one_that_differs(what: str) -> None:
    scenario = circle(4)
    other = changed(scenario, 1, **ONE_OF_ITS_KIND[what](scenario.vehicles[1]))
    assert all(each[1] == 1 for each in group_of(other))
    assert len(group_of(other)) < 7


def test_a_current_keeps_what_mirrors_it() -> None:
    scenario = circle(4)
    for i, vehicle in enumerate(scenario.vehicles):
        scenario = changed(scenario, i, drift=0.1 * np.eye(vehicle.start.size)[0])
    # Those that start ahead of and behind the current stay, the others may change places.
    assert group_of(scenario) == ((0, 3, 2, 1),)


def test_a_workspace_aside_of_the_middle_keeps_what_it_is_mirrored_by() -> None:
    middle = middle_of(circle(4))
    around = replace(circle(4), workspace=Workspace(middle - 50.0, middle + 50.0))
    assert len(group_of(around)) == 7
    aside = replace(around, workspace=Workspace(middle - 50.0, middle + np.array([60.0, 50.0])))
    assert group_of(aside) == ((0, 3, 2, 1),)


@pytest.mark.parametrize(
    ("faces", "size"), [(None, 7), (4, 7), (8, 7), (12, 7), (3, 0), (5, 0), (6, 3), (10, 3)]
)
def test_what_maps_the_faces_around_pairs_elsewhere_is_no_symmetry(
    faces: int | None, size: int
) -> None:
    assert len(group_of(replace(circle(8), pair_faces=faces))) == size


def test_images_are_all_that_a_set_is_mapped_onto() -> None:
    group = group_of(circle(8))
    assert set(images_of((0, 1), group)) == {tuple(sorted((i, (i + 1) % 8))) for i in range(8)}
    assert images_of((0, 1), ()) == [(0, 1)]
    told = with_images({(0, 1): 2.0, (1, 2): 3.0}, group)
    assert told[1, 2] == 3.0
    assert told[0, 7] == bound_of_image(3.0) == pytest.approx(3.0)
    assert with_images({(0,): float("inf")}, group)[4,] == float("inf")


def task_of(count: int, *, is_by_faces: bool) -> PartTask:
    """All who cross a circle, with a plan of theirs, to be searched in sets of up to three."""
    scenario = circle(count)
    result = plan(scenario, time_limit=1.0).require()
    fleet = Fleet.of(scenario, 1e-3, Limits())
    every = tuple(range(count))
    incumbent = FleetIncumbent(
        tuple(each.controls for each in result.trajectories), result.cost, (every,)
    )
    tails = None if is_by_faces else part.tails_for(scenario)
    order = PartOrder(20.0, 16, 1e-3, 300, 0.0, float("inf"), True, 3)
    return PartTask(Part.of(fleet, incumbent, every, tails), {}, order)


@pytest.mark.slow
@pytest.mark.parametrize("is_by_faces", [True, False], ids=["by faces", "any"])
def test_every_image_costs_what_one_of_them_was_found_to(is_by_faces: bool) -> None:
    task = task_of(6, is_by_faces=is_by_faces)
    assert len(task.part.symmetries) == 3
    alike = search_part(task, Limits())
    apart = search_part(replace(task, part=replace(task.part, symmetries=())), Limits())
    told = with_images({m: one.bound for m, one in alike.sets.items()}, task.part.symmetries)
    for size in (1, 2, 3):
        for members in combinations(range(6), size):
            searched = apart.sets[members]
            # Each is proven to a thousandth of its value.
            assert told[members] <= searched.value * (1.0 + 1e-9)
            assert told[members] == pytest.approx(searched.bound, rel=2e-3)
    assert len(alike.sets) < 0.6 * len(apart.sets)


def test_paths_of_any_two_that_are_exchanged_are_images_of_each_other() -> None:
    """What flies: turned controls lead along turned paths, by the dynamics themselves."""
    scenario = circle(8)
    rng, middle = np.random.default_rng(3), middle_of(scenario)
    for order in group_of(scenario):
        starts = np.array([v.start[:2] for v in scenario.vehicles]) - middle
        # The turn that the starts tell.
        turn, *_ = np.linalg.lstsq(starts, starts[list(order)], rcond=None)
        assert np.abs(turn @ turn.T - np.eye(2)).max() < 1e-9
        for i, j in enumerate(order):
            controls = rng.normal(size=(scenario.horizon, 2))
            one, other = (condensed_models(scenario)[k] for k in (i, j))
            paths = one.path(controls) - middle, other.path(controls @ turn) - middle
            assert np.abs(paths[0] @ turn - paths[1]).max() < 1e-9
            goals = [m.vehicle.goal for m in (one, other)]
            ends = [0.5 * (goal.lower + goal.upper) - middle for goal in goals]
            assert np.abs(ends[0] @ turn - ends[1]).max() < 1e-9


def test_no_exchange_is_missed_in_the_plane() -> None:
    """By brute force over permutations: those that keep all distances of starts and goals."""
    scenario = circle(4)
    starts = np.array([v.start[:2] for v in scenario.vehicles])
    goals = np.array([0.5 * (v.goal.lower + v.goal.upper) for v in scenario.vehicles])
    points = np.hstack([starts, goals])
    apart = np.linalg.norm(points[:, None] - points[None], axis=2)
    kept = {
        order for order in permutations(range(4)) if np.allclose(apart[np.ix_(order, order)], apart)
    }
    assert {*group_of(scenario), (0, 1, 2, 3)} == kept
