"""What certificates charge at workspaces and at what moves."""

import numpy as np
import pytest
from charged import beyond, row_risks, turning_back
from referee_scenes import make_plan, walk, walk_plan
from scipy.special import ndtr

from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario, Workspace
from radmpc.referee import certify


def test_workspace_is_charged_per_face_and_step():
    plan = walk_plan(
        walk("a", [[0.3, 5.0], [0.5, 5.0]], sigma=0.2),
        workspace=Workspace([0.0, 0.0], [10.0, 10.0]),
    )
    risks = row_risks(certify(plan))
    assert risks["workspace", "a", None, 0] == pytest.approx(ndtr(-1.5), rel=1e-12)
    assert risks["workspace", "a", None, 1] == pytest.approx(ndtr(-2.5), rel=1e-12)


def test_the_workspace_keeps_the_sagitta_in_reserve_and_charges_what_persists_once():
    vehicle, controls = turning_back()
    workspace = Workspace([-50.0, -50.0], [1.0, 50.0])
    scenario = Scenario("bow", 2.0, 2, 0.05, (vehicle,), workspace=workspace)
    plan = make_plan(scenario, [controls])
    sigma = np.sqrt(plan.trajectories[0].covariances[:, 0, 0])
    first_order = ndtr(-(1.0 - np.array([0.5, 0.5, 0.0])) / sigma).sum()
    exact = beyond(1.0)
    assert exact <= certify(plan).certified < 1.5 * exact
    assert certify(plan).certified < first_order


def test_a_moving_obstacle_is_judged_where_it_is_at_each_step():
    square = np.array([[1, -5], [2, -5], [2, 5], [1, 5]], dtype=float)
    ferry = Obstacle.moving("ferry", [square, square + np.array([1.0, 0.0])])
    plan = walk_plan(walk("a", [[0, 0], [0, 0]], sigma=0.3), obstacles=(ferry,))
    risks = row_risks(certify(plan))
    assert risks["obstacle", "a", "ferry", 0] == pytest.approx(ndtr(-0.6 / 0.3), rel=1e-3)
    assert risks["obstacle", "a", "ferry", 1] == pytest.approx(ndtr(-1.6 / 0.3), rel=1e-3)


def test_a_moving_obstacle_is_judged_at_both_ends_of_an_interval():
    square = np.array([[1, -5], [2, -5], [2, 5], [1, 5]], dtype=float)
    ferry = Obstacle.moving("ferry", [square, square + np.array([1.0, 0.0]), square])
    plan = walk_plan(
        walk("a", [[0, 0], [0, 0], [0, 0]], sigma=0.3), obstacles=(ferry,), avoidance="intervals"
    )
    expected = 2 * ndtr(-0.6 / 0.3) + ndtr(-1.6 / 0.3)
    assert certify(plan).certified == pytest.approx(expected, rel=1e-6)


def test_swapping_places_between_steps_is_seen_by_intervals_only():
    walks = walk("a", [[0, 0], [5, 0]], sigma=0.01), walk("b", [[5, 0], [0, 0]], sigma=0.01)
    assert certify(walk_plan(*walks, avoidance="steps")).certified < 1e-12
    assert certify(walk_plan(*walks, avoidance="intervals")).certified > 0.5
