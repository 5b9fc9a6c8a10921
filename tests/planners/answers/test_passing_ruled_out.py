"""Two that would have to pass each other in a passage too narrow for two have no plan."""

from __future__ import annotations

from dataclasses import replace

import pytest

from radmpc import Goal, Obstacle, Scenario, Vehicle, Workspace, double_integrator, plan
from radmpc.model.plan import Status
from radmpc.planners.reaching.passing import blocked_pairs
from radmpc.preflight.concerns import concerns_of
from radmpc.preflight.outlook import outlook_of


def robot(name: str, start: list[float], goal: list[float], radius: float = 0.6) -> Vehicle:
    return Vehicle(
        name=name,
        system=double_integrator(1.0, 2),
        start=start,
        goal=Goal.at(goal, 0.3),
        radius=radius,
        control_limit=1.0,
        speed_limit=1.5,
        initial_covariance=1e-6,
        disturbance_covariance=1e-7,
    )


def corridor(width: float = 2.0, *more: Obstacle, **changes: object) -> Scenario:
    """Two swap their places in a corridor."""
    walls = (
        Obstacle.box("south", [0.0, -2.0], [20.0, 0.0]),
        Obstacle.box("north", [0.0, width], [20.0, width + 5.0]),
    )
    made = Scenario(
        "corridor",
        1.0,
        40,
        0.05,
        (robot("a", [2.0, 1.0], [18.0, 1.0]), robot("b", [18.0, 1.0], [2.0, 1.0])),
        (*walls, *more),
        workspace=Workspace([0.6, 0.6], [19.4, 4.0]),
    )
    return replace(made, **changes)


def turned(scenario: Scenario) -> Scenario:
    """The same along the other axis."""
    vehicles = tuple(
        robot(v.name, v.start_position[::-1].tolist(), v.goal.center[::-1].tolist())
        for v in scenario.vehicles
    )
    obstacles = tuple(
        Obstacle.box(o.name, lower[::-1], upper[::-1])
        for o in scenario.obstacles
        for piece in o.at(0)
        for lower, upper in [(piece.vertices.min(axis=0), piece.vertices.max(axis=0))]
    )
    room = scenario.workspace
    assert room is not None
    room = Workspace(room.lower[::-1], room.upper[::-1])
    return replace(scenario, vehicles=vehicles, obstacles=obstacles, workspace=room)


def test_two_that_swap_in_a_corridor_without_a_bay_have_no_plan() -> None:
    found = plan(corridor())
    assert found.status is Status.INFEASIBLE
    assert found.explanation == (
        "Vehicles 'a' and 'b' have to pass each other along x and cannot: wherever they can get "
        "to, their centers are 0.8 m apart at most side by side, and their hulls need 1.2 m."
    )
    (blocked,) = blocked_pairs(turned(corridor()))
    assert blocked.axis == 1


@pytest.mark.parametrize(("width", "is_blocked"), [(2.1, True), (2.39, True), (2.41, False)])
def test_a_corridor_is_too_narrow_where_two_hulls_are_wider(width: float, is_blocked: bool) -> None:
    assert bool(list(blocked_pairs(corridor(width)))) is is_blocked


def test_checks_tell_of_them_too() -> None:
    (concern, *_) = concerns_of(outlook_of(corridor()))
    assert concern.is_fatal
    assert concern.vehicles == ("a", "b")
    assert "have to pass each other along x and cannot" in concern.text


def test_a_bay_lets_them_pass() -> None:
    # North of the corridor between x = 8 and 12.
    scenario = corridor()
    parts = (
        Obstacle.box("west", [0.0, 2.0], [8.0, 7.0]),
        Obstacle.box("east", [12.0, 2.0], [20.0, 7.0]),
    )
    assert not list(blocked_pairs(replace(scenario, obstacles=(scenario.obstacles[0], *parts))))


def test_who_follows_another_passes_nobody() -> None:
    ahead = (robot("a", [2.0, 1.0], [14.0, 1.0]), robot("b", [6.0, 1.0], [18.0, 1.0]))
    assert not list(blocked_pairs(corridor(vehicles=ahead)))


def test_hulls_that_jump_between_steps_may_pass() -> None:
    assert not list(blocked_pairs(corridor(avoidance="steps")))


def test_what_is_beyond_a_wall_is_no_room_to_pass() -> None:
    # There is room for two north of the wall, and no way to it.
    fence = Obstacle.line("fence", [[0.0, 2.0], [20.0, 2.0]])
    scenario = corridor(workspace=Workspace([0.6, 0.6], [19.4, 9.0]))
    walled = replace(scenario, obstacles=(scenario.obstacles[0], fence))
    assert list(blocked_pairs(walled))
    short = Obstacle.line("fence", [[0.0, 2.0], [15.0, 2.0]])
    assert not list(blocked_pairs(replace(walled, obstacles=(walled.obstacles[0], short))))


def test_vehicles_beside_each_other_in_corridors_of_their_own_pass() -> None:
    middle = Obstacle.line("middle", [[0.0, 2.0], [20.0, 2.0]])
    both = (robot("a", [2.0, 1.0], [18.0, 1.0]), robot("b", [18.0, 3.0], [2.0, 3.0]))
    scenario = corridor(4.0, middle, vehicles=both, workspace=Workspace([0.6, 0.6], [19.4, 3.4]))
    assert not list(blocked_pairs(scenario))
