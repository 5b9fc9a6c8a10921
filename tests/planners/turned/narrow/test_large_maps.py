"""Ways that are narrow beside the map they are in: doors of a meter in a hall of eighty."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from radmpc import Goal, Obstacle, Scenario, Vehicle, Workspace, double_integrator
from radmpc.planners.certified.turned.detours import detours
from radmpc.planners.certified.turned.narrow.clear import Clear
from radmpc.planners.certified.turned.narrow.routes import shortest_routes
from radmpc.planners.certified.turned.narrow.track import track
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from running import plan_before_any_search

CLEARANCE = 2.0

DOORS = {20.0: 4.36, 40.0: 15.03, 60.0: 7.27}
"""Where walls across the hall have the middle of their doors [m]."""


def hall(length: float = 80.0, radius: float = 0.25) -> Scenario:
    """A robot goes through a hall with three walls, each with a door of a meter."""
    walls = []
    for x, y in DOORS.items():
        walls += [
            Obstacle.box(f"below {x:g}", [x, 0.0], [x + 1.0, y - 0.5]),
            Obstacle.box(f"above {x:g}", [x, y + 0.5], [x + 1.0, 20.0]),
        ]
    robot = Vehicle(
        name="robot",
        system=double_integrator(2.0, 2),
        start=[2.0, 10.0],
        goal=Goal.at([length - 2.0, 10.0], 0.1),
        radius=radius,
        control_limit=2.0,
        speed_limit=1.0,
        initial_covariance=1e-4,
        disturbance_covariance=1e-4,
        gain=np.kron([[-0.075, -0.45]], np.eye(2)),
    )
    room = Workspace([0.0, 0.0], [length, 20.0])
    return Scenario("hall", 2.0, 56, 0.05, (robot,), tuple(walls), workspace=room)


def hazards_of(scenario: Scenario) -> Hazards:
    return Hazards.of(scenario, condensed_models(scenario))


def windows() -> Scenario:
    """A drone goes through a hall of the same length, its wall in the middle with a window."""
    (drone,) = hall().vehicles
    drone = replace(
        drone,
        system=double_integrator(2.0, 3),
        start=[2.0, 10.0, 4.0, 0.0, 0.0, 0.0],
        goal=Goal.at([78.0, 10.0, 4.0], 0.2),
        control_limit=2.0,
        speed_limit=1.0,
        initial_covariance=1e-4,
        disturbance_covariance=1e-4,
        gain=np.kron([[-0.075, -0.45]], np.eye(3)),
    )
    (x, y), z = (40.0, 14.6), 5.3
    around = {
        "left": ([x, 0.0, 0.0], [x + 0.5, y - 0.6, 8.0]),
        "right": ([x, y + 0.6, 0.0], [x + 0.5, 20.0, 8.0]),
        "below": ([x, y - 0.6, 0.0], [x + 0.5, y + 0.6, z - 0.6]),
        "above": ([x, y - 0.6, z + 0.6], [x + 0.5, y + 0.6, 8.0]),
    }
    wall = tuple(Obstacle.box(name, *corners) for name, corners in around.items())
    room = Workspace([0.0, 0.0, 0.0], [80.0, 20.0, 8.0])
    return Scenario("windows", 2.0, 56, 0.05, (drone,), wall, workspace=room)


@pytest.mark.parametrize("made", [hall, windows])
def test_ways_that_are_narrow_beside_the_hall_have_a_plan_before_any_search(
    made: Callable[[], Scenario], monkeypatch: pytest.MonkeyPatch
) -> None:
    scenario = made()
    assert detours(hazards_of(scenario), [0], CLEARANCE) == {}
    certified = plan_before_any_search(scenario, monkeypatch).risk.certified
    assert certified is not None
    assert certified <= 0.05


def test_doors_that_fall_between_points_of_the_usual_grid_are_found_on_a_finer_one() -> None:
    hazards = hazards_of(hall())
    clear = Clear.of(hazards)
    assert clear is not None
    assert clear.grid.spacing <= 0.25
    route = shortest_routes(hazards, clear, CLEARANCE)[0][0]
    for x, y in DOORS.items():
        before, after = route[route[:, 0] <= x], route[route[:, 0] >= x + 1.0]
        ends = before[-1], after[0]
        through = np.interp([x, x + 1.0], *np.array(ends).T)
        assert np.all(np.abs(through - y) <= 0.25)


def test_no_grid_takes_more_points_than_there_is_room_for() -> None:
    hazards = hazards_of(hall(radius=0.02))
    assert Clear.of(hazards) is None


def test_a_long_route_has_a_pace_on_fewer_places() -> None:
    scenario = hall()
    (robot,) = scenario.vehicles
    slow = replace(robot, system=double_integrator(5.0, 2), gain=None)
    hazards = hazards_of(replace(scenario, dt=5.0, horizon=100, vehicles=(slow,)))
    clear = Clear.of(hazards)
    assert clear is not None
    straight = np.array([[2.0, 10.0], [18.0, 10.0]])
    winding = np.array([[2.0 + x % 16.0, 10.0 + x / 40.0] for x in np.arange(0.0, 320.0, 8.0)])
    near, far = (track(hazards, 0, route, (clear, 1.0)) for route in (straight, winding))
    assert near is not None
    assert far is not None
    apart = [
        float(np.linalg.norm(np.diff(one.places, axis=0), axis=1).max()) for one in (near, far)
    ]
    assert apart[0] < apart[1] <= 0.75
    assert far.paced(100, ()) is not None
    assert track(hazards, 0, winding, (clear, 1.0), 1.25) is None
