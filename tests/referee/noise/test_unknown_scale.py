"""Covariances known up to a factor: tails, certificates, and missions that each draw their own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from fleets import stepper
from physical_scenes import DI, craft, pd, still, wall
from scipy.integrate import quad
from scipy.special import ndtr
from scipy.stats import binomtest, chi2, kstest
from scipy.stats import t as student

import radmpc
from radmpc.errors import ScenarioError
from radmpc.gaussian import Tail
from radmpc.io.native.decoding import decode_scenario
from radmpc.io.native.encoding import encode_scenario
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.vehicle import Goal
from radmpc.model.workspace import Workspace
from radmpc.referee import certify, simulate
from radmpc.referee.propagation import propagate
from radmpc.referee.sampling import Sampler
from radmpc.referee.tails import cutoff_of, exceeding


def unsure(plan: Plan, samples: int | None) -> Plan:
    return replace(plan, scenario=replace(plan.scenario, covariance_samples=samples))


def with_noise(plan: Plan, factor: float) -> Plan:
    """Return a plan in noise that is known, and the factor times what is stated."""
    vehicles = tuple(
        replace(
            v,
            initial_covariance=factor * v.initial_covariance,
            disturbance_covariance=factor * v.disturbance_covariance,
        )
        for v in plan.scenario.vehicles
    )
    scenario = replace(plan.scenario, vehicles=vehicles, covariance_samples=None)
    return replace(plan, scenario=scenario)


@pytest.mark.parametrize("samples", [3, 10, 200])
def test_the_tail_is_the_gaussian_one_mixed_over_the_factor(samples):
    levels = np.array([-2.0, -0.3, 0.0, 0.7, 3.0, 6.0])

    def weighted(c: float, q: float) -> float:
        return float(ndtr(-q * np.sqrt(c / samples)) * chi2.pdf(c, samples))

    marks = [0.1 * samples, samples, 2.0 * samples]
    most = 9.0 * samples + 90.0
    mixed = [quad(weighted, 0.0, most, (q,), limit=500, points=marks)[0] for q in levels]
    assert Tail(samples).probability(levels) == pytest.approx(np.array(mixed), rel=1e-6)
    assert exceeding(levels, samples) == pytest.approx(np.array(mixed), rel=1e-6)


@pytest.mark.parametrize("samples", [None, 3, 10, 200])
def test_tangents_stay_below_the_tail_from_the_middle_on(samples):
    tail = Tail(samples)
    at, everywhere = np.linspace(0.0, 9.0, 40)[:, None], np.linspace(0.0, 40.0, 900)
    tangents = tail.probability(at) + tail.slope(at) * (everywhere - at)
    assert np.all(tangents <= tail.probability(everywhere) + 1e-15)
    step = 1e-5
    slope = (tail.probability(at + step) - tail.probability(at - step)) / (2.0 * step)
    assert tail.slope(at) == pytest.approx(slope, rel=1e-6)


@pytest.mark.parametrize("samples", [None, 3, 10, 200])
@pytest.mark.parametrize("risk", [0.5, 0.1, 1e-3, 1e-9])
def test_the_clearance_for_a_risk_leaves_that_risk(samples, risk):
    tail = Tail(samples)
    found = tail.clearance_for(risk)
    assert tail.probability(found) == pytest.approx(risk, rel=1e-9)
    assert tail.clearance_for(1e-300) <= 1e8


@pytest.mark.parametrize(("samples", "deviations"), [(None, 3.09), (50, 3.26), (10, 4.14)])
def test_one_in_a_thousand_is_so_many_deviations_away(samples, deviations):
    assert float(Tail(samples).clearance_for(1e-3)) == pytest.approx(deviations, abs=0.005)


@pytest.mark.parametrize("samples", [3, 12, 500])
def test_what_is_far_risks_next_to_nothing(samples):
    distance, risk = cutoff_of(samples)
    assert student.sf(distance, samples) <= risk <= 1e-12


def at_a_wall() -> Plan:
    vehicle = craft("a", DI, [0, 0], gain=pd(0.3, 0.9))
    return still(vehicle, obstacles=(wall(0.15),), horizon=4)


def pair_at_a_post() -> Plan:
    a, b = craft("a", DI, [0, 0], gain=pd(1.0, 1.5), limit=0.4), craft("b", DI, [1.3, 0.3])
    return still(a, b, obstacles=(Obstacle.box("post", [0.6, -0.9], [0.8, -0.7]),), horizon=4)


def in_a_box_of_steps() -> Plan:
    vehicle = craft("a", stepper(1.0, 2, np.random.default_rng(1)), [0, 0])
    plan = still(vehicle, horizon=3)
    room = Workspace([-0.4, -0.5], [0.6, 0.6])
    return replace(plan, scenario=replace(plan.scenario, workspace=room))


SCENES = [at_a_wall, pair_at_a_post, in_a_box_of_steps]


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.__name__)
@pytest.mark.parametrize(("samples", "avoidance"), [(4, "steps"), (30, "intervals")])
def test_missions_collide_as_gaussian_ones_mixed_over_the_factor_and_less_than_certified(
    scene, samples, avoidance
):
    plan, missions = unsure(scene(), samples), 12_000
    ours = simulate(plan, missions, rng=1, avoidance=avoidance)
    rng = np.random.default_rng(2)
    factors = samples / chi2.ppf((np.arange(30) + 0.5) / 30, samples)
    mixed = saturated = 0
    for factor in rng.permutation(factors):
        found = simulate(with_noise(plan, factor), 400, rng=rng, avoidance=avoidance)
        mixed += found.collisions
        saturated += found.saturated
    for one, other in ((ours.collisions, mixed), (ours.saturated, saturated)):
        spread = np.sqrt(one * (1.0 - one / missions) + other * (1.0 - other / missions))
        assert abs(one - other) <= 4.5 * spread + 1e-9
    certificate = certify(plan, avoidance=avoidance)
    assert binomtest(ours.collisions, missions, min(certificate.certified, 1.0),
                     alternative="greater").pvalue > 1e-4  # fmt: skip
    assert binomtest(ours.saturated, missions, certificate.saturation,
                     alternative="greater").pvalue > 1e-4  # fmt: skip
    assert ours.collisions > 50


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.__name__)
@pytest.mark.parametrize("samples", [4, 30])
def test_a_certificate_along_intervals_is_that_of_gaussian_noise_mixed_over_the_factor(
    scene, samples
):
    plan = unsure(scene(), samples)
    # In the middle of fifty equally probable ranges the tail of the factor is missed a little.
    factors = samples / chi2.ppf((np.arange(50) + 0.5) / 50, samples)
    known = [certify(with_noise(plan, factor), avoidance="intervals").certified
             for factor in factors]  # fmt: skip
    found = certify(plan, avoidance="intervals").certified
    assert np.mean(known) <= found * (1.0 + 1e-3)
    assert found <= 1.02 * np.mean(known)


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.__name__)
def test_fewer_samples_are_certified_for_more_risk(scene):
    plan = scene()
    found = [certify(unsure(plan, samples)).certified for samples in (1_000_000, 100, 10, 3)]
    assert found == sorted(found)
    assert found[0] >= certify(plan).certified * (1.0 - 1e-6)
    assert found[-1] > 1.2 * found[0]


def test_the_factor_of_a_mission_is_that_of_all_its_vehicles_at_all_steps():
    fleet = [craft(f"v{i}", DI, [9.0 * i, 0.0]) for i in range(60)]
    plan = unsure(still(*fleet, horizon=3), 6)
    motion = propagate(plan.scenario, [t.controls for t in plan.trajectories])
    sampler = Sampler.of(motion, np.arange(60), np.arange(0))
    spreads = np.array([np.trace(c, axis1=1, axis2=2) for c in motion.covariances]).sum(axis=0)
    rng, factors = np.random.default_rng(0), []
    for k, state in enumerate(sampler.draw(3, 800, rng, lambda *_: None)):
        factors.append(np.square(state).sum(axis=0) / spreads[k])
    assert kstest(6.0 / factors[-1], chi2(6).cdf).pvalue > 1e-3
    assert np.corrcoef(np.log(factors))[0, -1] > 0.9


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    ("avoidance", "planner"), [("steps", "ira"), ("intervals", "ira"), ("intervals", "certified")]
)
def test_plans_pay_for_what_is_not_known_of_the_noise_and_keep_to_the_bound(avoidance, planner):
    vehicle = craft("a", DI, [0, 0])
    goal = Goal([-1.0, 3.0], [1.0, 4.0], None)
    vehicle = replace(vehicle, goal=goal, control_limit=[1.0, 1.0])
    room = Workspace([-9.0, -0.7], [9.0, 9.0])
    more = {"obstacles": (wall(0.6),), "workspace": room, "avoidance": avoidance}
    scenario = still(vehicle, horizon=4, **more).scenario
    costs = []
    for samples in (None, 50, 10):
        unsure_of = replace(scenario, covariance_samples=samples)
        result = radmpc.plan(unsure_of, planner, rng=0, time_limit=20.0)
        assert result.is_certified
        costs.append(result.require().cost)
        bound = result.require().certified_lower_bound
        assert bound is None or bound <= costs[-1]
    assert costs[0] < costs[1] < costs[2]


def test_files_keep_the_samples_and_refuse_too_few():
    scenario = unsure(at_a_wall(), 40).scenario
    content = encode_scenario(scenario)
    assert content["covariance_samples"] == 40
    assert decode_scenario(content).covariance_samples == 40
    assert "covariance_samples" not in encode_scenario(at_a_wall().scenario)
    with pytest.raises(ScenarioError, match="at least 3 independent steps, got 2") as caught:
        decode_scenario({**content, "covariance_samples": 2})
    assert caught.value.path == ("covariance_samples",)
