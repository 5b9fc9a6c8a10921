"""Monte Carlo against closed forms, its reproducibility and its paths between steps."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from referee_scenes import (
    glider,
    make_plan,
    random_scene,
    scene_plan,
    straight_plan,
    walk,
    walk_plan,
)
from scipy.special import ndtr
from scipy.stats import binomtest, ncx2

from radmpc.errors import NoPlanError, ScenarioError
from radmpc.experiments.families import paper
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario, Workspace
from radmpc.referee import certify, simulate
from radmpc.referee.simulation import simulation
from sampling import examples


def agrees(count, samples, probability):
    """Whether a count is no accident of one in a million."""
    return binomtest(count, samples, probability).pvalue > 1e-6


def test_a_pair_collides_as_often_as_the_noncentral_chi_square_says():
    # One step without growth: both steps see the same deviation.
    plan = walk_plan(
        walk("a", [[0, 0], [0, 0]], sigma=0.2), walk("b", [[1.2, 0], [1.2, 0]], sigma=0.3)
    )
    variance = 0.2**2 + 0.3**2
    probability = ncx2.cdf(0.8**2 / variance, 2, 1.2**2 / variance)
    result = simulate(plan, 50_000, rng=1)
    assert agrees(result.collisions, 50_000, probability)
    assert result.pair_collisions == result.collisions
    assert result.obstacle_collisions == result.workspace_exits == 0


def test_balls_collide_as_often_as_the_noncentral_chi_square_says():
    plan = walk_plan(
        walk("a", [[0, 0, 0], [0, 0, 0]], sigma=0.2),
        walk("b", [[0.8, 0.6, 0.4], [0.8, 0.6, 0.4]], sigma=0.3),
    )
    variance = 0.2**2 + 0.3**2
    probability = ncx2.cdf(0.8**2 / variance, 3, 1.16 / variance)
    assert agrees(simulate(plan, 50_000, rng=1).collisions, 50_000, probability)


def test_a_wall_is_hit_as_often_as_the_tail_says():
    wall = Obstacle.box("wall", [1.0, -50.0], [2.0, 50.0])
    plan = walk_plan(walk("a", [[0, 0], [0, 0]], sigma=0.3), obstacles=(wall,))
    probability = ndtr(-0.6 / 0.3) - ndtr(-2.4 / 0.3)
    result = simulate(plan, 50_000, rng=2)
    assert agrees(result.obstacle_collisions, 50_000, probability)
    assert result.obstacle_rate == result.rate


def test_a_corner_is_round_not_mitred():
    # A quarter plane seen from its corner: the disc reaches it over a rounded corner.
    quarter = Obstacle.box("quarter", [0.0, 0.0], [50.0, 50.0])
    plan = walk_plan(walk("a", [[-1.0, -1.0], [-1.0, -1.0]], sigma=0.5), obstacles=(quarter,))
    rng = np.random.default_rng(0)
    points = np.array([-1.0, -1.0]) + 0.5 * rng.standard_normal((400_000, 2))
    gaps = np.linalg.norm(np.maximum(-points, 0.0), axis=1)
    round_share = (gaps < 0.4).mean()
    mitred_share = (points > -0.4).all(axis=1).mean()
    result = simulate(plan, 50_000, rng=3)
    assert agrees(result.collisions, 50_000, round_share)
    assert not agrees(result.collisions, 50_000, mitred_share)


def test_the_workspace_is_left_as_often_as_the_tail_says():
    plan = walk_plan(
        walk("a", [[0.5, 5.0], [0.5, 5.0]], sigma=0.3), workspace=Workspace([0, 0], [10, 10])
    )
    result = simulate(plan, 50_000, rng=4)
    assert agrees(result.workspace_exits, 50_000, ndtr(-0.5 / 0.3))
    assert result.workspace_rate == result.rate


def test_deviations_keep_their_correlation_in_time():
    # The deviation never changes: being hit at one of many steps is being hit at the first.
    wall = Obstacle.box("wall", [1.0, -50.0], [2.0, 50.0])
    plan = walk_plan(walk("a", np.zeros((12, 2)), sigma=0.3), obstacles=(wall,))
    assert agrees(simulate(plan, 50_000, rng=5).collisions, 50_000, ndtr(-2.0))
    assert certify(plan).certified == pytest.approx(12 * ndtr(-2.0), rel=1e-2)


def test_noise_adds_up_under_feedback_to_the_propagated_covariance():
    gain = np.array([[-0.3, 0.0, -0.9, 0.0], [0.0, -0.3, 0.0, -0.9]])
    vehicle = glider("a", [0, 0], [0, 0], noise=0.02, gain=gain)
    vehicle = replace(
        vehicle,
        disturbance_covariance=np.array(
            [[0.02, 0.005, 0, 0], [0.005, 0.01, 0, 0], [0, 0, 0.002, 0], [0, 0, 0, 0.002]]
        ),
    )
    wall = Obstacle.box("wall", [0.8, -50.0], [2.0, 50.0])
    scenario = Scenario("wall", 1.0, 1, 0.05, (vehicle,), (wall,), avoidance="steps")
    sigma = np.sqrt(vehicle.covariances(1)[:, 0, 0])
    result = simulate(make_plan(scenario, [np.zeros((1, 2))]), 50_000, rng=6)
    both = ndtr(-0.4 / sigma)
    assert result.rate > both.max() - 5e-3
    assert result.rate < both.sum() + 5e-3
    longer = replace(scenario, horizon=15)
    last = np.sqrt(vehicle.covariances(15)[-1, 0, 0])
    stay = make_plan(longer, [np.zeros((15, 2))])
    rate_at_end = simulate(stay, 50_000, rng=6).rate
    assert rate_at_end > ndtr(-0.4 / last)


def test_saturation_counts_flights_that_ask_for_too_much():
    gain = np.array([[-0.3, 0.0, -0.9, 0.0], [0.0, -0.3, 0.0, -0.9]])
    vehicle = glider("a", [0, 0], [0, 0], noise=0.01, gain=gain)
    scenario = Scenario("still", 1.0, 1, 0.05, (vehicle,))
    plan = make_plan(scenario, [np.zeros((1, 2))])
    sigma = np.sqrt(0.09 * 0.01 + 0.81 * 0.001)
    for sigmas in (1.0, 2.5):
        tight = replace(vehicle, control_limit=np.full(2, sigmas * sigma))
        limited = replace(plan, scenario=replace(scenario, vehicles=(tight,)))
        inside = 1.0 - 2.0 * ndtr(-sigmas)
        result = simulate(limited, 50_000, rng=7)
        assert agrees(result.saturated, 50_000, 1.0 - inside**2)
        assert result.collisions == 0


@pytest.mark.parametrize("norm", [None, 1e-5])
def test_saturation_is_bounded_at_limits_of_micrometers_too(norm):
    gain = np.array([[-1e-6, 0.0, 0.0, 0.0], [0.0, -1e-6, 0.0, 0.0]])
    vehicle = glider("a", [0, 0], [0, 0], noise=25.0, gain=gain)
    small = replace(vehicle, control_limit=1e-5, control_norm=norm)
    plan = make_plan(Scenario("slow", 1.0, 1, 0.05, (small,)), [np.zeros((1, 2))])
    either = 1.0 - (1.0 - 2.0 * ndtr(-2.0)) ** 2 if norm is None else np.exp(-2.0)
    assert either <= certify(plan).saturation


def test_open_loop_never_saturates_within_its_limit():
    plan = straight_plan(paper(2, 0))
    assert simulate(plan, 1000, rng=0).saturation_rate == 0.0
    vehicles = tuple(replace(v, control_limit=np.full(2, 0.01)) for v in plan.scenario.vehicles)
    weak = replace(plan, scenario=replace(plan.scenario, vehicles=vehicles))
    assert simulate(weak, 1000, rng=0).saturation_rate == 1.0


def test_equal_seeds_give_equal_results_on_any_number_of_cores(monkeypatch):
    plan = walk_plan(
        walk("a", [[0, 0], [0, 0]], sigma=0.2), walk("b", [[1.2, 0], [1.2, 0]], sigma=0.3)
    )
    monkeypatch.setattr(simulation, "_CHUNK_NUMBERS", 4096)
    first = simulate(plan, 20_001, rng=11)
    monkeypatch.setattr(simulation, "num_processors", lambda: 1)
    alone = simulate(plan, 20_001, rng=np.random.default_rng(11))
    assert first.collisions == alone.collisions
    assert simulate(plan, 20_001, rng=12).collisions != first.collisions


def test_a_generator_moves_on():
    plan = walk_plan(
        walk("a", [[0, 0], [0, 0]], sigma=0.2), walk("b", [[1.2, 0], [1.2, 0]], sigma=0.3)
    )
    rng = np.random.default_rng(11)
    assert simulate(plan, 20_000, rng=rng).collisions != simulate(plan, 20_000, rng=rng).collisions


def test_progress_ends_at_all_samples():
    seen = []
    plan = straight_plan(paper(2, 0))
    simulate(plan, 30_000, rng=0, progress=lambda done, total: seen.append((done, total)))
    assert seen[-1] == (30_000, 30_000)
    assert [done for done, _ in seen] == sorted(done for done, _ in seen)


def test_the_interval_is_clopper_pearson():
    plan = walk_plan(
        walk("a", [[0, 0], [0, 0]], sigma=0.2), walk("b", [[1.2, 0], [1.2, 0]], sigma=0.3)
    )
    result = simulate(plan, 2000, rng=1)
    interval = binomtest(result.collisions, 2000).proportion_ci(0.95, "exact")
    assert result.rate_low == pytest.approx(interval.low, rel=1e-9)
    assert result.rate_high == pytest.approx(interval.high, rel=1e-9)
    none = replace(result, collisions=0)
    assert none.rate_low == 0.0
    assert none.rate_high == pytest.approx(1.0 - 0.025 ** (1 / 2000))
    assert replace(result, collisions=2000).rate_high == 1.0


def test_a_plan_that_cannot_be_flown_is_refused():
    plan = straight_plan(paper(2, 0))
    with pytest.raises(NoPlanError, match="no trajectories"):
        simulate(replace(plan, trajectories=()))
    with pytest.raises(ScenarioError, match="missing"):
        simulate(replace(plan, trajectories=plan.trajectories[:1]))
    with pytest.raises(ValueError, match="samples must be an integer >= 1, got 0"):
        simulate(plan, 0)


@pytest.mark.slow
@settings(max_examples=examples(12), deadline=None, derandomize=True)
@given(st.integers(0, 2**32 - 1), st.sampled_from(["steps", "intervals"]), st.sampled_from([2, 3]))
def test_the_certificate_is_never_below_what_flights_show(seed, avoidance, dimension):
    paths, covariances, clouds = random_scene(seed, dimension)
    plan = scene_plan(
        paths + 1.0 * np.arange(len(paths))[:, None, None],
        covariances,
        clouds,
        avoidance=avoidance,
        workspace=Workspace([-1.0] * dimension, [11.0] * dimension),
    )
    certificate, result = certify(plan), simulate(plan, 4000, rng=seed)
    total = result.collisions
    assert certificate.certified >= 1.0 or not (
        binomtest(total, 4000, certificate.certified, alternative="greater").pvalue < 1e-6
    )
    for cause, count in (
        ("pair", result.pair_collisions),
        ("obstacle", result.obstacle_collisions),
        ("workspace", result.workspace_exits),
    ):
        share = sum(row.risk for row in certificate.ledger if row.cause == cause)
        assert share >= 1.0 or (binomtest(count, 4000, share, alternative="greater").pvalue > 1e-6)


def test_intervals_collide_at_least_as_often_as_their_steps():
    plan = straight_plan(replace(paper(6, 5), obstacles=()))
    between = replace(plan, scenario=replace(plan.scenario, avoidance="intervals"))
    assert simulate(between, 5000, rng=3).collisions >= simulate(plan, 5000, rng=3).collisions


def test_nothing_to_watch_is_nothing_to_draw():
    still = {"sigma": 0.0, "radius": 0.4}
    plan = walk_plan(walk("a", [[0, 0], [0, 0]], **still), walk("b", [[9, 0], [9, 0]], **still))
    result = simulate(plan, 1000, rng=0)
    assert result.rate == result.saturation_rate == result.overlooked == 0.0


def test_an_error_in_the_progress_report_ends_the_simulation():
    def fail(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        simulate(straight_plan(paper(2, 0)), 200_000, rng=0, progress=fail)


def test_long_horizons_under_feedback_agree_with_the_propagated_covariance():
    gain = np.array([[-0.3, 0.0, -0.9, 0.0], [0.0, -0.3, 0.0, -0.9]])
    vehicle = glider("a", [0, 0], [0, 0], noise=0.01, gain=gain)
    final = np.sqrt(vehicle.covariances(30)[-1, 0, 0])
    workspace = Workspace([-60.0, -60.0], [60.0, 60.0])
    scenario = Scenario("far", 1.0, 30, 0.05, (vehicle,), avoidance="steps", workspace=workspace)
    plan = make_plan(scenario, [np.zeros((30, 2))])
    # Only the last step looks at a wall that has moved next to the vehicle by then.
    far, near = np.array([50.0, 0.0]), np.array([0.4 + final, 0.0])
    square = np.array([[0, -40], [5, -40], [5, 40], [0, 40]], dtype=float)
    wall = Obstacle.moving("wall", [square + (near if k == 30 else far) for k in range(31)])
    watched = replace(plan, scenario=replace(scenario, obstacles=(wall,)))
    result = simulate(watched, 40_000, rng=8)
    assert agrees(result.obstacle_collisions, 40_000, ndtr(-1.0))
