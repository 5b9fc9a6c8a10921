from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc import Goal, Obstacle, Scenario, Vehicle, Workspace, double_integrator
from radmpc.preflight.concerns import concerns_of
from radmpc.preflight.outlook import outlook_of
from radmpc.preflight.places import Narrowest, Passage

DEVIATION = 0.1


def boat(**changes: object) -> Vehicle:
    """A boat that goes 20 m east, uncertain by 0.1 m all along."""
    vehicle = Vehicle(
        name="boat",
        system=double_integrator(1.0, 2),
        start=[0.0, 0.0],
        goal=Goal.at([20.0, 0.0], 0.5),
        radius=0.5,
        control_limit=2.0,
        initial_covariance=np.diag([DEVIATION**2, DEVIATION**2, 0.0, 0.0]),
        disturbance_covariance=0.0,
        speed_limit=2.0,
    )
    return replace(vehicle, **changes)


def past(*obstacles: Obstacle, vehicle: Vehicle | None = None, **changes: object) -> Scenario:
    """The boat's way with something in it."""
    scenario = Scenario("way", 1.0, 16, 0.02, (vehicle or boat(),), obstacles)
    return replace(scenario, **changes)


@pytest.mark.parametrize("radius", [0.02, 0.05, 0.1, 0.3, 0.5, 1.0])
def test_a_wall_without_thickness_is_crossed_by_no_hull_however_small(radius: float) -> None:
    fence = Obstacle.line("fence", [[9.7, -200.0], [9.7, 200.0]])
    place = outlook_of(past(fence, vehicle=boat(radius=radius))).vehicles[0].narrowest
    assert place in {Passage.CLOSED, Passage.TOO_LARGE}


@pytest.mark.parametrize("radius", [0.3, 0.5, 0.8])
@pytest.mark.parametrize("room", [0.04, 0.2, 0.35])
def test_a_gap_in_a_wall_without_thickness_is_found(radius: float, room: float) -> None:
    low, high = 1.3 - radius - room, 1.3 + radius + room
    walls = (
        Obstacle.line("south", [[9.7, -200.0], [9.7, low]]),
        Obstacle.line("north", [[9.7, high], [9.7, 200.0]]),
    )
    quiet = boat(radius=radius, initial_covariance=np.diag([0.01, 0.01, 0.0, 0.0]))
    place = outlook_of(past(*walls, vehicle=quiet)).vehicles[0].narrowest
    assert isinstance(place, Narrowest)
    assert place.clearance == pytest.approx(room, abs=0.04)
    assert place.position == pytest.approx((9.7, 1.3), abs=0.4)
    assert set(place.beside) == {"south", "north"}


def test_a_way_around_the_end_of_a_wall_takes_no_more_time_than_it_takes() -> None:
    wall = Obstacle.line("wall", [[9.7, -200.0], [9.7, 4.0]])
    least = outlook_of(past(wall)).vehicles[0].least_steps
    assert least is not None
    looks = {n: outlook_of(past(wall, horizon=n)).vehicles[0] for n in range(least, 25)}
    wide = [horizon for horizon, seen in looks.items() if seen.narrowest is Passage.WIDE]
    # Up to 5 m aside and back at 2 m/s on either axis, while it goes on along the other.
    assert min(wide) <= least + 2
    assert wide == list(range(min(wide), 25))


def closed_room(*obstacles: Obstacle, radius: float = 0.5) -> Scenario:
    """The boat's goal in a room."""
    room = Workspace([-2.0, -8.0], [24.0, 8.0])
    return past(*obstacles, vehicle=boat(radius=radius), workspace=room, horizon=40)


RING = [[17.0, -2.0], [23.0, -2.0], [23.0, 2.0], [17.0, 2.0], [17.0, -2.0]]


@pytest.mark.parametrize("radius", [0.02, 0.1, 0.5])
def test_a_closed_room_is_told_as_closed_for_every_hull(radius: float) -> None:
    outlook = outlook_of(closed_room(Obstacle.line("ring", RING), radius=radius))
    (closed, *_) = concerns_of(outlook)
    assert closed.text == (
        "Vehicle 'boat': has no way to its goal, however long it takes: obstacle 'ring' leaves no "
        "opening, for a hull of any size"
    )
    assert closed.is_fatal


@pytest.mark.parametrize("width", [0.01, 0.3, 0.9])
def test_a_room_whose_door_is_too_narrow_is_closed_for_this_hull(width: float) -> None:
    door = Obstacle.line("ring", [[17.0, -2.0 + width], *RING[3::-1], [17.0, -2.0]][::-1])
    outlook = outlook_of(closed_room(door))
    (closed, *_) = concerns_of(outlook)
    assert closed.is_fatal
    assert (
        f"between sides of obstacle 'ring' near (17, {-2 + width / 2:.4g}), is {width:g} m wide"
        in (closed.text)
    )
    assert outlook.vehicles[0].narrowest.clearance == pytest.approx(0.5 * width - 0.5)
    (open_,) = outlook_of(closed_room(door, radius=0.4 * width)).vehicles
    assert open_.closed is None


def test_a_room_in_space_without_an_opening_has_no_path() -> None:
    drone = Vehicle(
        name="drone",
        system=double_integrator(1.0, 3),
        start=[0.0, 0.0, 2.0],
        goal=Goal.at([8.0, 0.0, 2.0], 0.5),
        radius=0.5,
        control_limit=2.0,
        initial_covariance=np.diag([DEVIATION**2] * 3 + [0.0] * 3),
        disturbance_covariance=0.0,
        speed_limit=2.0,
    )
    plate = Obstacle.box("plate", [3.0, -50.0, -50.0], [3.0, 50.0, 50.0])
    seen = outlook_of(Scenario("plate", 1.0, 9, 0.02, (drone,), (plate,))).vehicles[0]
    assert seen.narrowest is Passage.CLOSED
