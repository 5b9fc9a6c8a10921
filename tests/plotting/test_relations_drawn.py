"""Obstacles for some vehicles only, and ranges, in pictures and films."""

from __future__ import annotations

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
import pytest

from radmpc import Goal, Keep, Obstacle, Plan, Scenario, Vehicle, double_integrator
from radmpc.model.dynamics import rollout
from radmpc.model.plan import Risk, Status, Trajectory
from radmpc.model.relations.concerns import all_but, only_for
from radmpc.plotting import animate_plan, plot_plan, plot_scenario

SYSTEM, HORIZON = double_integrator(1.0, 2), 4


def vehicle(name: str, y: float) -> Vehicle:
    return Vehicle(
        name=name, system=SYSTEM, start=[0.0, y, 2.0, 0.5 if name == "barge" else 0.0],
        goal=Goal.at([8.0, y], 1.0), radius=0.4, control_limit=1.0, initial_covariance=1e-3,
        disturbance_covariance=1e-3,
    )  # fmt: skip


def scenario() -> Scenario:
    shallows = only_for(Obstacle.box("shallows", [2.0, -1.0], [5.0, 1.0]), ["barge"])
    net = all_but(Obstacle.line("net", [[6.0, 1.0], [6.0, 5.0]]), ["boat"])
    rock = Obstacle.box("rock", [2.0, 2.0], [3.0, 3.0])
    fleet = [vehicle("boat", 0.0), vehicle("barge", 5.0)]
    keep = [Keep(["barge", "boat"], 9.0)]
    return Scenario("estuary", 1.0, HORIZON, 0.1, fleet, [shallows, net, rock], keep=keep)


def coasting() -> Plan:
    given = scenario()
    still = np.zeros((HORIZON, 2))
    paths = tuple(
        Trajectory(v.name, still, rollout(SYSTEM, v.start, still), v.covariances(HORIZON))
        for v in given.vehicles
    )
    sets = tuple((v.name,) for v in given.vehicles)
    return Plan(
        given, "by hand", None, Status.FEASIBLE, 0.0, None, Risk(0.1), sets, trajectories=paths
    )


def artist(ax, gid: str):
    (found,) = [child for child in ax.get_children() if child.get_gid() == gid]
    return found


def told(ax) -> list[str]:
    return [text.get_text() for text in ax.findobj(plt.Text) if text.get_text()]


@pytest.mark.parametrize("draw", [lambda: plot_scenario(scenario()), lambda: plot_plan(coasting())])
def test_obstacles_for_some_look_otherwise_and_say_for_whom(draw) -> None:
    ax = draw()
    assert artist(ax, "obstacle:shallows").get_hatch() == "////"
    assert artist(ax, "obstacle:rock").get_hatch() is None
    assert artist(ax, "obstacle:net").is_dashed()
    assert {"shallows (only barge)", "net (not boat)", "rock"} <= set(told(ax))
    plt.close("all")


def test_names_that_are_too_long_for_the_picture_are_shortened_within_it() -> None:
    given = scenario()
    shallows, net, rock = given.obstacles
    named = replace(given.vehicles[0], name="boat of the harbor master, at anchor")
    fleet = [named, given.vehicles[1]]
    obstacles = [
        only_for(replace(shallows, concerns=None), [v.name for v in fleet]),
        replace(net, name="net that was lost by a trawler in the winter", concerns=None),
        rock,
    ]
    ax = plot_scenario(replace(given, vehicles=fleet, obstacles=obstacles, keep=[]))
    ax.figure.draw_without_rendering()
    assert "shallows (only 2 vehicles)" in told(ax)
    assert artist(ax, f"label:{obstacles[1].name}").get_text() == "net that was … in the winter"
    assert artist(ax, f"label:{named.name}").get_text().startswith("boat of the")
    frame = ax.get_window_extent()
    for thing in (*obstacles, *fleet):
        written = artist(ax, f"label:{thing.name}").get_window_extent()
        assert written.x0 >= frame.x0
        assert written.x1 <= frame.x1


def test_a_range_is_a_line_where_the_two_are_farthest_apart() -> None:
    ax = plot_plan(coasting())
    line = artist(ax, "range:boat:barge").get_xydata()
    np.testing.assert_allclose(line, [[8.0, 0.0], [8.0, 7.0]])
    assert "7 of 9 m at 4" in told(ax)
    assert {"for some only", "range, widest"} <= set(told(ax.get_legend()))
    ax = plot_scenario(scenario())
    np.testing.assert_allclose(artist(ax, "range:boat:barge").get_xydata(), [[0, 0], [0, 5]])
    assert "within 9 m" in told(ax)
    plt.close("all")


def test_pictures_without_either_have_no_signs_for_them() -> None:
    given = replace(scenario(), keep=(), obstacles=scenario().obstacles[2:])
    legend = plot_plan(replace(coasting(), scenario=given)).get_legend()
    assert not {"for some only", "range, widest"} & set(told(legend))
    plt.close("all")


def test_films_move_the_line_of_a_range() -> None:
    film = animate_plan(coasting(), frames_per_step=1)
    ax = film._fig.axes[0]
    line = artist(ax, "range:barge:boat")
    np.testing.assert_allclose(line.get_xydata(), [[0, 5], [0, 0]])
    film._func(4)
    np.testing.assert_allclose(line.get_xydata(), [[8, 7], [8, 0]], atol=1e-9)
    film._draw_was_started = True
    plt.close("all")


def test_in_space_obstacles_for_some_are_paler() -> None:
    tower = Obstacle.box("tower", [2.0, 0.0, 0.0], [3.0, 1.0, 4.0])
    drone = Vehicle(
        name="drone", system=double_integrator(1.0, 3), start=[0.0, 0.0, 1.0],
        goal=Goal.at([6.0, 0.0, 1.0], 0.5), radius=0.3, control_limit=2.0, initial_covariance=1e-3,
        disturbance_covariance=1e-3,
    )  # fmt: skip
    other = replace(drone, name="heli", start=[0.0, 3.0, 1.0])
    zone = only_for(tower, ["heli"])
    strength = []
    for obstacle in (tower, zone):
        fleet = Scenario("air", 1.0, 5, 0.01, [drone, other], [obstacle])
        ax = plot_scenario(fleet)
        (faces,) = [c for c in ax.collections if c.get_gid() == "obstacle:tower"]
        strength.append(faces.get_alpha())
        assert ("tower (only heli)" in told(ax)) == (obstacle is zone)
    assert strength[1] < 0.5 * strength[0]
    plt.close("all")


def test_a_moving_obstacle_is_shown_nearest_to_those_alone_whom_it_concerns() -> None:
    outline = np.array([[-0.5, -0.3], [0.5, -0.3], [0.5, 0.3], [-0.5, 0.3]])
    places = [np.array([4.0, 2.0 * k - 2.0]) for k in range(HORIZON + 1)]
    ship = Obstacle.moving("ship", [outline + place for place in places])
    for obstacle, names in ((only_for(ship, ["barge"]), ["barge"]), (ship, ["boat", "barge"])):
        plan = coasting()
        plan = replace(plan, scenario=replace(plan.scenario, obstacles=(obstacle,)))
        ids = {child.get_gid() for child in plot_plan(plan).get_children()}
        assert [name for name in ("boat", "barge") if f"near:ship:{name}" in ids] == names
    nobody = all_but(ship, ["boat", "barge"])
    plan = replace(plan, scenario=replace(plan.scenario, obstacles=(nobody,)))
    legend = plot_plan(plan).get_legend()
    assert "when nearest" not in [text.get_text() for text in legend.get_texts()]
    plt.close("all")
