"""What samples meet between steps."""

from dataclasses import replace

import numpy as np
import pytest
from referee_scenes import (
    glider,
    make_plan,
    walk,
    walk_plan,
)

from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario, Workspace
from radmpc.referee import simulate


def test_a_thin_wall_is_not_jumped_between_steps():
    wall = Obstacle.box("wall", [2.5, -50.0], [2.501, 50.0])
    walker = walk("a", [[0, 0], [5, 0]], sigma=0.01)
    assert simulate(walk_plan(walker, obstacles=(wall,)), 100, rng=0).rate == 0.0
    between = walk_plan(walker, obstacles=(wall,), avoidance="intervals")
    assert simulate(between, 100, rng=0).rate == 1.0


def test_swapping_places_is_seen_between_steps_only():
    walks = walk("a", [[0, 0], [5, 0]], sigma=0.01), walk("b", [[5, 0], [0, 0]], sigma=0.01)
    assert simulate(walk_plan(*walks), 100, rng=0).rate == 0.0
    assert simulate(walk_plan(*walks, avoidance="intervals"), 100, rng=0).rate == 1.0


@pytest.mark.parametrize(("face", "rate"), [(0.89, 1.0), (0.91, 0.0)])
def test_the_curve_between_steps_is_the_parabola(face, rate):
    vehicle = replace(
        glider("a", [0, 0], [0, 0], dt=2.0, noise=1e-9), start=np.array([0.0, 0.0, 1.0, 0.0])
    )
    # Position τ − τ²/2: it returns after 2 s from a turning point at 0.5, plus the radius 0.4.
    wall = Obstacle.box("wall", [face, -50.0], [2.0, 50.0])
    scenario = Scenario("bow", 2.0, 1, 0.05, (vehicle,), (wall,), avoidance="intervals")
    plan = make_plan(scenario, [np.array([[-1.0, 0.0]])])
    assert simulate(plan, 200, rng=0).rate == rate


@pytest.mark.parametrize(("side", "rate"), [(0.49, 1.0), (0.51, 0.0)])
def test_the_workspace_is_left_on_the_parabola(side, rate):
    vehicle = replace(
        glider("a", [0, 0], [0, 0], dt=2.0, noise=1e-9), start=np.array([0.0, 0.0, 1.0, 0.0])
    )
    workspace = Workspace([-50.0, -50.0], [side, 50.0])
    scenario = Scenario("bow", 2.0, 1, 0.05, (vehicle,), workspace=workspace)
    plan = make_plan(scenario, [np.array([[-1.0, 0.0]])])
    assert simulate(plan, 200, rng=0).rate == rate


@pytest.mark.parametrize(("gap", "rate"), [(1.79, 1.0), (1.81, 0.0)])
def test_a_pair_meets_on_its_relative_parabola(gap, rate):
    right = replace(
        glider("a", [0, 0], [0, 0], dt=2.0, noise=1e-9), start=np.array([0.0, 0.0, 1.0, 0.0])
    )
    left = replace(
        glider("b", [0, 0], [0, 0], dt=2.0, noise=1e-9), start=np.array([gap, 0.0, -1.0, 0.0])
    )
    scenario = Scenario("bow", 2.0, 1, 0.05, (right, left))
    push = np.array([[1.0, 0.0]])
    assert simulate(make_plan(scenario, [-push, push]), 200, rng=0).rate == rate


@pytest.mark.parametrize(("y", "rate"), [(1.39, 1.0), (1.41, 0.0)])
def test_a_ferry_is_met_where_it_is_between_steps(y, rate):
    # It crosses from left to right in one step and passes under the vehicle half way.
    ferry = np.array([[-6, -1], [-4, -1], [-4, 1], [-6, 1]], dtype=float)
    obstacle = Obstacle.moving("ferry", [ferry, ferry + np.array([10.0, 0.0])])
    walker = walk("a", [[0, y], [0, y]], sigma=1e-4)
    plan = walk_plan(walker, obstacles=(obstacle,), avoidance="intervals")
    assert simulate(plan, 200, rng=0).rate == rate
    assert simulate(walk_plan(walker, obstacles=(obstacle,)), 200, rng=0).rate == 0.0


@pytest.mark.parametrize(("x", "rate"), [(1.89, 1.0), (1.92, 0.0)])
def test_an_obstacle_that_swells_is_met_half_way(x, rate):
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], dtype=float)
    swelling = Obstacle.moving("swell", [square, 2.0 * square])
    # At t the side is at 1 + t and the vehicle at x + t, 0.4 + 0.5 clear until it drops back.
    walker = walk("a", [[x - 0.5, 0], [x + 0.5, 0]], sigma=1e-4)
    plan = walk_plan(walker, obstacles=(swelling,), avoidance="intervals")
    assert simulate(plan, 200, rng=0).rate == rate
