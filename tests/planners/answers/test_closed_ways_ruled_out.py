"""Ways that are closed at all times rule out every plan, at once and with the reason."""

from __future__ import annotations

from dataclasses import replace

import pytest

from radmpc import Goal, Obstacle, Scenario, Vehicle, Visit, Workspace, double_integrator, plan
from radmpc.model.plan import Status
from radmpc.model.relations.concerns import only_for
from radmpc.planners.presolve import enclosed_reasons

RING = [[12.0, 3.0], [18.0, 3.0], [18.0, 9.0], [12.0, 9.0], [12.0, 3.0]]


def robot(name: str, start: list[float], goal: list[float], **changes: object) -> Vehicle:
    made = Vehicle(
        name=name,
        system=double_integrator(1.0, 2),
        start=start,
        goal=Goal.at(goal, 0.3),
        radius=0.3,
        control_limit=1.0,
        speed_limit=1.5,
        initial_covariance=1e-4,
        disturbance_covariance=1e-4,
    )
    return replace(made, **changes)


def rooms(*obstacles: Obstacle, **changes: object) -> Scenario:
    """One goes to (15, 6), another stays in the west."""
    made = Scenario(
        "rooms",
        1.0,
        20,
        0.05,
        (robot("a", [2.0, 6.0], [15.0, 6.0]), robot("b", [2.0, 2.0], [5.0, 10.0])),
        obstacles,
        workspace=Workspace([0.0, 0.0], [20.0, 12.0]),
    )
    return replace(made, **changes)


def test_a_closed_room_is_infeasible_and_what_closes_it_is_named() -> None:
    found = plan(rooms(Obstacle.line("ring", RING)))
    assert found.status is Status.INFEASIBLE
    assert found.explanation == (
        "Vehicle 'a' has no way to its goal, however long it takes: obstacle 'ring' leaves no "
        "opening, for a hull of any size. The other vehicle can be planned within the risk bound."
    )


def test_another_planner_gives_the_same_reason() -> None:
    found = plan(rooms(Obstacle.line("ring", RING)), "radmpc")
    assert found.status is not Status.OPTIMAL
    assert "'ring' leaves no opening" in (found.explanation or "")


def test_a_visit_in_a_closed_room_is_named() -> None:
    west = robot("a", [2.0, 6.0], [5.0, 6.0], via=(Visit([14.0, 5.0], [15.0, 6.0]),))
    (reason,) = enclosed_reasons(rooms(Obstacle.line("ring", RING), vehicles=(west,), horizon=60))
    assert "has no way to the box of its visit via[0]" in reason.text


def test_a_door_that_never_opens_closes_a_way_and_one_that_does_so_once_may_leave_one() -> None:
    walls = (
        Obstacle.box("low", [9.8, -4.0], [10.2, 1.9]),
        Obstacle.box("high", [9.8, 6.1], [10.2, 13.0]),
    )
    shut = [[9.8, 2.0], [10.2, 2.0], [10.2, 6.0], [9.8, 6.0]]
    ajar = [[x, y + 0.5] for x, y in shut]
    door = Obstacle.moving("door", [shut] * 21)
    (reason,) = enclosed_reasons(rooms(*walls, door))
    assert "and obstacle 'door' near (10" in reason.text
    assert reason.text.endswith("is 0.1 m wide (its hull 0.6 m).")
    assert not enclosed_reasons(rooms(*walls, Obstacle.moving("door", [shut] * 20 + [ajar])))


@pytest.mark.parametrize("change", [{"avoidance": "steps"}, {"obstacles": ()}])
def test_nothing_is_ruled_out_where_walls_may_be_passed(change: dict[str, object]) -> None:
    assert not enclosed_reasons(replace(rooms(Obstacle.line("ring", RING)), **change))


def test_an_obstacle_of_others_closes_no_way() -> None:
    ring = Obstacle.line("ring", RING)
    assert enclosed_reasons(rooms(only_for(ring, ["a"])))
    assert not enclosed_reasons(rooms(only_for(ring, ["b"])))


def test_who_begins_and_ends_in_the_same_room_has_a_way() -> None:
    inside = robot("a", [13.0, 6.0], [17.0, 6.0])
    assert not enclosed_reasons(rooms(Obstacle.line("ring", RING), vehicles=(inside,)))
