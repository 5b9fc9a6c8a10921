"""How long vehicles wait for each other in narrow ways."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.importing.free_space import free_spaces_of
from radmpc.importing.problem import ForeignProblem, ForeignVehicle
from radmpc.importing.waiting import waiting_times
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Workspace


def vehicle(name: str, start: list[float], goal: list[float], speed: float = 1.0) -> ForeignVehicle:
    at_rest = np.zeros(2)
    return ForeignVehicle(
        name=name,
        start=np.array(start),
        goal=np.array(goal),
        start_velocity=at_rest,
        goal_velocity=at_rest,
        radius=0.5,
        speed_limit=speed,
        control_limit=1.0,
    )


def lane(half_width: float, *vehicles: ForeignVehicle) -> ForeignProblem:
    """Two rooms, and a lane of 20 m between them."""
    walls = (
        Obstacle.box("north", [10.0, half_width], [30.0, 6.0]),
        Obstacle.box("south", [10.0, -6.0], [30.0, -half_width]),
    )
    bounds = Workspace(np.array([0.0, -6.0]), np.array([40.0, 6.0]))
    return ForeignProblem("test", "lane.yaml", "lane", vehicles, walls, bounds, (), {})


EAST = vehicle("east", [3.0, 0.0], [37.0, 0.0])
WEST = vehicle("west", [37.0, 0.0], [3.0, 0.0])


def waits(problem: ForeignProblem) -> list[float]:
    space = free_spaces_of(problem)
    assert space is not None
    return waiting_times(space, problem.vehicles, [0.2] * len(problem.vehicles))


def test_in_a_narrow_lane_each_waits_as_long_as_the_other_takes() -> None:
    one, two = waits(lane(1.0, EAST, replace(WEST, speed_limit=2.0)))
    assert one == pytest.approx(20.0 / 2.0, abs=1.5)
    assert two == pytest.approx(20.0 / 1.0, abs=2.0)


def test_who_goes_the_same_way_does_not_wait() -> None:
    behind = vehicle("behind", [1.5, 0.0], [35.0, 0.0])
    assert waits(lane(1.0, EAST, behind)) == [0.0, 0.0]


def test_in_a_wide_lane_nobody_waits() -> None:
    assert waits(lane(3.0, EAST, WEST)) == [0.0, 0.0]


def test_several_that_come_toward_one_pass_one_behind_the_other() -> None:
    second = vehicle("second", [38.5, 0.0], [5.0, 0.0])
    one, *others = waits(lane(1.0, EAST, WEST, second))
    assert one == pytest.approx(others[0] + 2.0)


def test_between_two_short_gates_there_is_room_to_wait() -> None:
    gates = tuple(
        Obstacle.box(f"{side}{x}", [x, low], [x + 1.5, high])
        for x in (4.0, 34.0)
        for side, low, high in (("north", 0.7, 6.0), ("south", -6.0, -0.7))
    )
    problem = replace(lane(1.0, EAST, WEST), obstacles=gates)
    assert max(waits(problem)) <= 4.0


def window(*vehicles: ForeignVehicle) -> ForeignProblem:
    """A wall across the middle with a window for one at a time."""
    wall = tuple(
        Obstacle.box(side, [19.5, low], [20.5, high])
        for side, low, high in (("north", 0.9, 6.0), ("south", -6.0, -0.9))
    )
    return replace(lane(1.0, *vehicles), obstacles=wall)


FACING = tuple(
    vehicle(f"{side}{row}", [start, row], [goal, -row])
    for side, start, goal in (("west", 15.0, 25.0), ("east", 25.0, 15.0))
    for row in (-2.0, 2.0)
)


def test_two_that_meet_at_a_window_have_time_to_give_way() -> None:
    assert waits(window(*FACING[1:3])) == [0.0, 0.0]


def test_at_a_window_three_and_more_queue() -> None:
    # All would be there at once. The second follows after 1 s, the third, from the other side, 2 s
    # later, the last after another: less the 2 s that one gives way for in any case.
    assert waits(window(*FACING)) == pytest.approx([0.0, 0.0, 0.0, 2.0], abs=0.2)


def test_who_comes_to_a_window_later_does_not_queue() -> None:
    late = [vehicle(f"late{k}", [15.0 - 4.0 * k, 0.0], [25.0, 0.0]) for k in range(1, 4)]
    assert waits(window(*late)) == [0.0, 0.0, 0.0]
