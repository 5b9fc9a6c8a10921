"""Bounds that can be computed by hand."""

from dataclasses import replace

import numpy as np
import pytest
from charged import beyond, row_risks, turning_back
from referee_scenes import glider, make_plan, straight_plan, walk, walk_plan
from scipy.special import ndtr
from scipy.stats import chi2, multivariate_normal

from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario, Workspace
from radmpc.referee import certify, simulate


def test_a_resting_pair_is_charged_one_half_space_per_step():
    plan = walk_plan(
        walk("a", [[0, 0], [0, 0]], sigma=0.1), walk("b", [[1.2, 0], [1.2, 0]], sigma=0.1)
    )
    risks = row_risks(certify(plan))
    expected = ndtr(-(1.2 - 0.8) / np.sqrt(0.02))
    for step in (0, 1):
        assert risks["pair", "a", "b", step] <= expected * (1 + 1e-9)
        # The half-space is a bound on a disc, and no worse than it by more than a few times.
        assert risks["pair", "a", "b", step] > 0.2 * expected
    assert set(risks) == {("pair", "a", "b", 0), ("pair", "a", "b", 1)}


def resting_pair(horizon, growth):
    """Two walkers 0.4 m clear of each other that stay where they are."""
    return walk_plan(
        walk("a", np.zeros((horizon + 1, 2)), growth=growth),
        walk("b", np.tile([1.2, 0.0], (horizon + 1, 1)), growth=growth),
        avoidance="intervals",
    )


def test_a_deviation_that_persists_is_charged_once():
    each = ndtr(-0.4 / np.sqrt(0.02))
    assert certify(resting_pair(6, 0.0)).certified == pytest.approx(each, rel=1e-4)
    # The half-space is a bound on a disc, but at every step the same one.
    assert certify(resting_pair(6, 0.0)).certified >= each


@pytest.mark.slow
@pytest.mark.parametrize("growth", [0.01, 0.03, 0.05])
def test_fresh_noise_is_charged_between_the_union_and_the_sum_over_steps(growth):
    steps = np.arange(7)
    covariance = 0.02 + 2 * growth**2 * np.minimum.outer(steps, steps)
    union = 1 - multivariate_normal.cdf(
        np.full(7, 0.4), np.zeros(7), covariance, abseps=1e-8, maxpts=1_000_000
    )
    boole = ndtr(-0.4 / np.sqrt(np.diag(covariance))).sum()
    certified = certify(resting_pair(6, growth)).certified
    assert union * (1 - 1e-4) <= certified < 0.6 * boole
    # What second order leaves open: little, for a deviation that moves on little by little.
    assert certified < 1.25 * union


def test_interval_bound_charges_both_sides_of_a_corner_once_each():
    # Past a corner: first left of the wall, then above it, no half-space serves both intervals.
    wall = Obstacle.box("wall", [0.0, -10.0], [10.0, 0.0])
    walker = walk("a", [[-0.7, -5.0], [-0.7, 0.7], [5.0, 0.7]], sigma=0.1)
    plan = walk_plan(walker, avoidance="intervals", obstacles=(wall,))
    # The deviation persists: its two components are too large or not, whenever one looks.
    each = ndtr(-(0.7 - 0.4) / 0.1)
    union = 1 - (1 - each) ** 2
    assert union * (1 - 1e-9) <= certify(plan).certified <= 2 * each * (1 + 1e-9)


def test_an_obstacle_is_charged_by_its_best_face():
    box = Obstacle.box("box", [1.0, -5.0], [2.0, 5.0])
    plan = walk_plan(walk("a", [[0, 0], [0, 0]], sigma=0.2), obstacles=(box,))
    risks = row_risks(certify(plan))
    expected = ndtr(-(1.0 - 0.4) / 0.2)
    assert risks["obstacle", "a", "box", 0] == pytest.approx(expected, rel=1e-3)
    assert risks["obstacle", "a", "box", 0] <= expected * (1 + 1e-9)


def test_pieces_of_one_obstacle_share_a_row():
    corner = [[0, 0], [4, 0], [4, 1], [1, 1], [1, 4], [0, 4]]
    obstacle = Obstacle.polygon("corner", corner)
    assert len(obstacle.at(0)) == 2
    plan = walk_plan(walk("a", [[2, 2], [2, 2]], sigma=0.2), obstacles=(obstacle,))
    risks = row_risks(certify(plan))
    each = ndtr(-(1.0 - 0.4) / 0.2)
    assert risks["obstacle", "a", "corner", 0] == pytest.approx(2 * each, rel=2e-2)


def test_step_zero_counts():
    plan = walk_plan(walk("a", [[0, 0], [-50, 0]]), walk("b", [[0.9, 0], [50, 0]]))
    risks = row_risks(certify(plan))
    assert risks["pair", "a", "b", 0] > 0.1
    assert not certify(plan).holds


def test_without_noise_touching_is_free_and_overlap_is_certain():
    still = {"sigma": 0.0, "radius": 0.4}
    touching = walk_plan(
        walk("a", [[0, 0], [0, 0]], **still), walk("b", [[0.8, 0], [0.8, 0]], **still)
    )
    assert certify(touching).certified == 0.0
    assert certify(touching).ledger == ()
    assert certify(touching).holds
    overlap = walk_plan(
        walk("a", [[0, 0], [0, 0]], **still), walk("b", [[0.799, 0], [0.799, 0]], **still)
    )
    assert certify(overlap).certified == 1.0


def test_a_mean_inside_at_two_steps_is_charged_at_most_once():
    box = Obstacle.box("box", [-5.0, -5.0], [5.0, 5.0])
    plan = walk_plan(walk("a", [[0, 0], [0, 0]], sigma=0.1), obstacles=(box,))
    assert certify(plan).certified == pytest.approx(1.0)


def test_the_direction_follows_an_anisotropic_covariance():
    # The wide axis points at the other vehicle's flank: the best normal is tilted off the line.
    covariance = np.array([[0.2, 0.19], [0.19, 0.2]])
    plan = walk_plan(
        walk("a", [[0, 0], [0, 0]], covariance=0.5 * covariance),
        walk("b", [[1.6, 0.0], [1.6, 0.0]], covariance=0.5 * covariance),
    )
    angles = np.linspace(0, 2 * np.pi, 100_001)
    n = np.column_stack([np.cos(angles), np.sin(angles)])
    clearance = (n @ [-1.6, 0.0] - 0.8) / np.sqrt(np.einsum("na,ab,nb->n", n, covariance, n))
    best = ndtr(-clearance.max())
    along_the_line = ndtr(-0.8 / np.sqrt(0.2))
    certified = certify(plan).certified / 2
    assert certified <= best * (1 + 1e-6)
    assert certified < along_the_line / 10


def test_a_double_integrator_keeps_the_sagitta_of_its_curve_in_reserve():
    # Straight up, braking away from a wall on the right: the curve bulges toward it.
    vehicle, controls = turning_back()
    wall = Obstacle.box("wall", [1.5, -50.0], [2.0, 50.0])
    scenario = Scenario("bow", 2.0, 2, 0.05, (vehicle,), (wall,), avoidance="intervals")
    plan = make_plan(scenario, [controls])
    np.testing.assert_allclose(plan.trajectories[0].means[:, 0], [0.0, 0.0, 0.0], atol=1e-12)
    sigma = np.sqrt(plan.trajectories[0].covariances[:, 0, 0])
    # All of the sagitta of 0.5 m in reserve at both ends of the first interval is far too much.
    first_order = ndtr(-(1.1 - np.array([0.5, 0.5, 0.0])) / sigma).sum()
    exact = beyond(1.1)
    assert exact <= certify(plan).certified < 1.5 * exact
    assert certify(plan).certified < first_order


def test_acceleration_toward_an_obstacle_needs_no_reserve():
    vehicle = glider("a", [0, 0], [0, 0], dt=2.0, noise=0.0, initial_covariance=np.eye(4) * 0.01)
    vehicle = replace(vehicle, start=np.array([0.0, 0.0, -1.0, 0.0]))
    wall = Obstacle.box("wall", [1.5, -50.0], [2.0, 50.0])
    scenario = Scenario("bow", 2.0, 1, 0.05, (vehicle,), (wall,), avoidance="intervals")
    plan = make_plan(scenario, [np.array([[1.0, 0.0]])])
    sigma = np.sqrt(plan.trajectories[0].covariances[:, 0, 0])
    assert certify(plan).certified == pytest.approx(ndtr(-1.1 / sigma).sum(), rel=1e-6)


def test_a_ball_in_space_is_bounded_from_above_by_one_half_space():
    plan = walk_plan(
        walk("a", [[0, 0, 0], [0, 0, 0]], sigma=0.1),
        walk("b", [[0.8, 0.8, 0.8], [0.8, 0.8, 0.8]], sigma=0.1),
    )
    gap = 0.8 * np.sqrt(3.0) - 0.8
    expected = ndtr(-gap / np.sqrt(0.02))
    assert certify(plan).certified / 2 <= expected * (1 + 1e-6)
    # At least the ball itself: the half-space cannot be below the mass near the contact point.
    assert certify(plan).certified / 2 > expected * chi2.cdf(1.0, 2)


def test_a_polytope_in_space_is_charged_by_its_nearest_edge():
    box = Obstacle.box("box", [1.0, 1.0, -5.0], [3.0, 3.0, 5.0])
    plan = walk_plan(walk("a", [[0, 0, 0], [0, 0, 0]], sigma=0.2), obstacles=(box,))
    expected = ndtr(-(np.sqrt(2.0) - 0.4) / 0.2)
    assert certify(plan).certified / 2 <= expected * (1 + 1e-6)


def test_the_ledger_sums_to_the_certificate():
    scenario = Scenario(
        "sum",
        1.0,
        10,
        0.05,
        (glider("a", [0, 0], [10, 0]), glider("b", [10, 1.4], [0, 1.4])),
        (Obstacle.box("box", [4, -3], [6, -1.0]),),
        workspace=Workspace([-1, -5], [11, 5]),
    )
    certificate = certify(straight_plan(scenario))
    assert {row.cause for row in certificate.ledger} == {"pair", "obstacle", "workspace"}
    total = sum(row.risk for row in certificate.ledger)
    assert total == pytest.approx(certificate.certified, rel=1e-12)
    assert certificate.certified > 0.0


def test_the_bound_is_compared_without_tolerance():
    walks = walk("a", [[0, 0], [0, 0]]), walk("b", [[1.2, 0], [1.2, 0]])
    risk = certify(walk_plan(*walks)).certified
    assert certify(walk_plan(*walks, risk_bound=risk)).holds
    below = certify(walk_plan(*walks, risk_bound=float(np.nextafter(risk, 0.0))))
    assert not below.holds
    assert below.problems == ()
    assert "does not hold" in below.summary


@pytest.mark.parametrize("gap", [1e-3, 5e-3])
def test_driving_off_from_contact_is_charged_by_what_each_end_has_to_spare(gap: float):
    # Accelerating away, the curve hangs 0.06 m toward the wall it touches: nearly all of that is
    # to be kept at the far end, 0.24 + gap away, and only what there is at the near one.
    start = np.array([0.0, 0.4 + gap, 0.0, 0.0])
    vehicle = replace(
        glider("v", [0.0, 0.0], [0.0, 4.0]),
        start=start,
        initial_covariance=np.zeros((4, 4)),
        disturbance_covariance=np.diag([0.0, 4e-4, 0.0, 0.0]),
    )
    wall = Obstacle.box("wall", [-9, -1], [9, 0])
    scenario = Scenario("off", 1.0, 1, 0.05, (vehicle,), (wall,), avoidance="intervals")
    certificate = certify(make_plan(scenario, [np.array([[0.3, 0.48]])]))
    # Margins m0 and m1 hold if their roots sum to the root of it; the mean ends 0.24 m further.
    share = np.sqrt(gap / 0.24)
    left = 0.24 + gap - 0.24 * (1.0 - share) ** 2
    assert certificate.certified <= 1.05 * ndtr(-left / 0.02) + 1e-12


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("sigma", [1e-2, 1e-4, 1e-6])
def test_a_path_that_only_just_passes_a_corner_is_charged_by_the_direction_across_it(
    dimension: int, sigma: float
):
    # At a distance of five deviations from the corner, on the way from one side to another: few
    # directions separate, however long the way and whatever its angle.
    across = np.array([0.3, 0.8, 0.0][:dimension]) / np.hypot(0.3, 0.8)
    along = np.array([0.8, -0.3, 0.0][:dimension]) / np.hypot(0.3, 0.8)
    corner = np.array([1.0, 1.0, 0.0][:dimension])
    nearest = corner + (0.4 + 5.0 * sigma) * across
    # In space the wall is high: its edge is passed, not its corner.
    low = np.array([-1.0, -1.0, -9.0][:dimension])
    block = Obstacle.box("block", low, np.array([1.0, 1.0, 9.0][:dimension]))
    flight = walk("a", [nearest - 0.9 * along, nearest + 1.7 * along], sigma=sigma)
    plan = walk_plan(flight, avoidance="intervals", obstacles=(block,))
    assert ndtr(-5.0) * (1.0 - 1e-6) <= certify(plan).certified <= 2.01 * ndtr(-5.0)


def test_a_plan_made_at_steps_is_judged_along_its_path_where_that_is_asked_for():
    # Through the wall within one step, and clear of it at both ends.
    wall = Obstacle.box("wall", [1.9, -1.0], [2.1, 1.0])
    plan = walk_plan(walk("a", [[0, 0], [4, 0]], sigma=0.1), obstacles=(wall,), avoidance="steps")
    stated = replace(plan, risk=replace(plan.risk, certified=certify(plan).certified))
    assert certify(stated).certified < 1e-6
    along = certify(stated, avoidance="intervals")
    assert along.certified >= 1.0 - 1e-9
    assert along.problems == ()
    assert simulate(stated, 100, rng=0).rate == 0.0
    assert simulate(stated, 100, rng=0, avoidance="intervals").rate == 1.0
    back = replace(stated, scenario=replace(stated.scenario, avoidance="intervals"))
    assert certify(back, avoidance="steps").certified == certify(stated).certified
