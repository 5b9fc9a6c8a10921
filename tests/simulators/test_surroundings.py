from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from boats import sea

from radmpc.geometry import box
from radmpc.model.obstacle import Obstacle
from radmpc.model.relations.keep import Keep
from radmpc.model.scenario import Scenario
from radmpc.model.workspace import Workspace
from radmpc.referee.simulation.collisions import meets_solid
from radmpc.referee.simulation.sweep import swept
from radmpc.simulators.surroundings import Surroundings, hull_distance


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_distance_from_a_box_is_that_along_its_axes(dimension: int) -> None:
    rng = np.random.default_rng(3)
    low, high = np.full(dimension, -1.0), np.arange(1.0, dimension + 1.0)
    corners = box(low, high).vertices
    for place in rng.uniform(-4.0, 5.0, (60, dimension)):
        outside = np.maximum(np.maximum(low - place, place - high), 0.0)
        assert hull_distance(corners, place) == pytest.approx(np.linalg.norm(outside), abs=1e-9)


def test_a_corner_is_no_distance_away_from_itself() -> None:
    assert hull_distance(np.array([[2.0, 1.0]]), np.array([2.0, 1.0])) == 0.0


def past(scenario: Scenario, path: np.ndarray) -> tuple[tuple[str, str | None], ...]:
    """Return what the first vehicle hits along a path, the other far away."""
    far = np.broadcast_to([1000.0, 1000.0], path.shape)
    both = np.stack([path, far], axis=1)
    found = Surroundings(scenario).contacts(1, np.linspace(0.0, 1.0, len(path)), both)
    assert all(one.vehicle == "east" and one.step == 1 for one in found)
    return tuple((one.cause, one.other) for one in found)


@pytest.mark.parametrize("is_moving", [False, True])
def test_samples_find_the_contacts_that_the_referee_finds_exactly(is_moving: bool) -> None:
    rng = np.random.default_rng(8)
    before = np.array([[4.0, -1.0], [6.0, -1.0], [5.0, 2.0]])
    after = np.array([[5.5, -2.0], [8.0, 0.0], [5.0, 1.0]]) if is_moving else before
    outlines = [before, *[after] * 12]
    still = Obstacle.polygon("rock", before)
    scenario = sea(obstacles=(Obstacle.moving("rock", outlines) if is_moving else still,))
    obstacle, hits = scenario.obstacles[0], 0
    parts = swept(obstacle.at(0)[0], obstacle.at(1)[0])
    shares = np.linspace(0.0, 1.0, 101)[:, None]
    for begin, end in zip(*rng.uniform((0.0, -5.0), (11.0, 5.0), (2, 20, 2)), strict=True):
        none = np.zeros((1, 2))
        # What grazes by less than between two samples is not told apart.
        deep, near = (
            bool(meets_solid(begin[None], end[None], none, np.array([radius]), parts)[0])
            for radius in (1.2 - 2e-3, 1.2)
        )
        found = past(scenario, begin + shares * (end - begin))
        assert deep <= (found == (("obstacle", "rock"),)) <= near
        hits += near
    assert 4 <= hits <= 16


def test_two_that_come_too_close_are_told_once() -> None:
    paths = np.zeros((5, 2, 2))
    paths[:, 0, 0], paths[:, 1, 0] = np.linspace(0.0, 5.0, 5), np.linspace(7.0, 3.0, 5)
    found = Surroundings(sea()).contacts(4, np.linspace(0.0, 1.0, 5), paths)
    assert [(c.step, c.cause, c.vehicle, c.other) for c in found] == [(4, "pair", "east", "west")]
    assert not Surroundings(sea()).contacts(4, np.linspace(0.0, 1.0, 2), paths[:2])


def test_a_larger_hull_touches_what_a_smaller_one_passes() -> None:
    paths = np.array([[[0.0, 0.0], [2.5, 0.0]]])
    assert not Surroundings(sea()).at_start(paths[0])
    assert Surroundings(sea(), margin=0.1).at_start(paths[0])


def test_who_leaves_the_workspace_is_told() -> None:
    scenario = replace(sea(), workspace=Workspace([-5.0, -5.0], [20.0, 5.0]))
    paths = np.array([[[0.0, 0.0], [14.0, 0.0]], [[0.0, 0.0], [14.0, 5.1]]])
    found = Surroundings(scenario).contacts(2, np.array([0.0, 1.0]), paths)
    assert [(c.cause, c.vehicle, c.other) for c in found] == [("workspace", "west", None)]


def test_who_is_out_of_range_at_any_sample_loses_it() -> None:
    scenario = sea()
    one, two = (v.name for v in scenario.vehicles)
    kept = replace(scenario, keep=(Keep([two, one], 30.0),))
    shares = np.linspace(0.0, 1.0, 3)
    for farthest, is_lost in ((30.0, False), (30.1, True)):
        paths = np.zeros((3, 2, 2))
        paths[:, 1, 0] = [25.0, farthest, 25.0]
        found = Surroundings(kept).contacts(2, shares, paths)
        assert [(c.step, c.cause, c.vehicle, c.other) for c in found] == (
            [(2, "range", one, two)] if is_lost else []
        )
    # What is tracked must stay in range, the middle of its body may be elsewhere.
    assert not Surroundings(kept).contacts(2, shares, paths, 0.9 * paths)
