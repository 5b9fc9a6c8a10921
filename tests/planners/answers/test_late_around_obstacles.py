"""Ways around obstacles that take longer than there is time rule out every plan, and say so."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from radmpc import Goal, Obstacle, Scenario, Vehicle, Visit, Workspace, double_integrator, plan
from radmpc.geometry import hull
from radmpc.geometry.around import corners_around
from radmpc.model.plan import Status
from radmpc.planners.presolve import late_around
from radmpc.preflight.concerns import concerns_of
from radmpc.preflight.outlook import outlook_of
from radmpc.program.build import condensed_models

WALL = Obstacle.line("wall", [[8.0, -1.0], [8.0, 10.0]])


def walled(due: int | None = None, **changes: object) -> Scenario:
    """A wall that is passed in the north; perhaps a visit right behind it."""
    via = () if due is None else (Visit([9.5, 1.5], [10.5, 2.5], (5, due)),)
    vehicle = Vehicle(
        name="a",
        system=double_integrator(1.0, 2),
        start=[2.0, 2.0],
        goal=Goal.at([14.0, 2.0], 0.3),
        radius=0.3,
        control_limit=1.0,
        speed_limit=1.5,
        initial_covariance=1e-4,
        disturbance_covariance=1e-4,
        via=via,
    )
    room = Workspace([0.0, 0.0], [20.0, 12.0])
    made = Scenario("walled", 1.0, 20, 0.05, (vehicle,), (WALL,), workspace=room)
    return replace(made, **changes)


def told(scenario: Scenario) -> list[str]:
    return [reason.text for reason in late_around(scenario, condensed_models(scenario))]


def test_a_visit_that_is_too_early_for_the_way_around_is_named_with_a_window_that_does() -> None:
    found = plan(walled(8))
    assert found.status is Status.INFEASIBLE
    said = str(found.explanation)
    assert said.startswith("Vehicle 'a' cannot be in the box of its visit via[0] by step 8 (8 s)")
    assert "around obstacles that takes 12 steps (12 s) at least" in said
    assert "What helps, as tried: let `between` of via[0] end at step" in said
    step = int(re.findall(r"end at step (\d+)", said)[0])
    assert 12 <= step < 20
    assert plan(walled(step)).record.trajectories


def test_checks_tell_of_such_a_visit_too() -> None:
    (concern, *_) = concerns_of(outlook_of(walled(8)))
    assert concern.is_fatal
    assert concern.kind == "visit"
    assert concern.text.endswith("let its window end at step 12 or later")
    assert not any("around obstacles" in c.text for c in concerns_of(outlook_of(walled(19))))


def test_a_goal_behind_a_wall_takes_a_longer_horizon_that_is_told() -> None:
    short = walled(horizon=11)
    (text,) = told(short)
    assert "cannot be at its goal by step 11 (11 s): around obstacles that takes" in text
    least = int(re.findall(r"that takes (\d+)", text)[0])
    assert not told(walled(horizon=least))
    (concern, *_) = concerns_of(outlook_of(short))
    assert concern.text.endswith(f"lengthen the horizon to {least} or more")
    assert concern.horizon is not None
    assert concern.horizon > least


@pytest.mark.parametrize("change", [{"avoidance": "steps"}, {"obstacles": ()}])
def test_nothing_is_ruled_out_where_there_is_nothing_to_get_around(
    change: dict[str, object],
) -> None:
    assert not told(walled(8, **change))


def test_who_has_a_plan_is_not_late() -> None:
    shortest = next(n for n in range(14, 30) if plan(walled(horizon=n)).record.trajectories)
    assert all(not told(walled(horizon=n)) for n in range(shortest, 30))


@pytest.mark.sampled(8)
@pytest.mark.parametrize("seed", range(20))
def test_ways_are_no_longer_than_paths_on_a_grid(seed: int) -> None:
    rng = np.random.default_rng(seed)
    pieces = [hull(rng.uniform(1, 9, 2) + rng.uniform(-1.5, 1.5, (3, 2))) for _ in range(6)]
    low, high, speed = np.zeros(2), np.full(2, 10.0), np.array([1.0, 1.4])
    corners = corners_around(pieces, 0.2, (low, high))
    assert corners is not None
    axis = np.linspace(0.0, 10.0, 101)
    grid = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
    is_free = np.ones(len(grid), dtype=bool)
    for piece in corners.grown:
        is_free &= (grid @ piece.normals.T - piece.offsets).max(axis=1) > 0.0
    number = np.arange(101 * 101).reshape(101, 101)
    links = []
    for i, j in ((1, 0), (0, 1), (1, 1), (1, -1)):
        one = number[: 101 - i, max(0, -j) : 101 - max(0, j)].ravel()
        other = number[i:, max(0, j) : 101 - max(0, -j)].ravel()
        links += [(a, b) for a, b in zip(one, other, strict=True) if is_free[a] and is_free[b]]
    begins, ends = np.array(links).T
    lengths = (np.abs(grid[begins] - grid[ends]) / speed).max(axis=1)
    graph = coo_array((lengths, (begins, ends)), shape=(101 * 101, 101 * 101)).tocsr()
    free = np.flatnonzero(is_free)
    first, *others = rng.choice(free, 6, replace=False)
    paths = dijkstra(graph, directed=False, indices=int(first))
    for other in others:
        (time,) = corners.times(grid[[first, other]], speed)
        # Steps of 0.1 m between free places may cut corners by less than that.
        assert time <= paths[other] + 1e-9 or paths[other] > 20.0
        straight = (np.abs(grid[first] - grid[other]) / speed).max()
        assert time >= straight - 1e-9
