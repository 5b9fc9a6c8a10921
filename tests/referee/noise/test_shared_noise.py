"""Disturbances that vehicles share, against sums over all normals and the second simulator."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from fleets import stepper
from physical import fly
from physical_scenes import DI, craft, pd, still
from scipy.stats import fisher_exact

from radmpc.errors import ScenarioError
from radmpc.model.noise.measurement import Measurement
from radmpc.model.noise.shared import SharedDisturbance
from radmpc.model.plan import Plan
from radmpc.model.vehicle import Vehicle
from radmpc.program.build import condensed_models
from radmpc.program.relative import relative_bent_covariances, relative_covariances
from radmpc.program.relaxed.instants import Instants, Part
from radmpc.referee import certify, simulate
from radmpc.referee.bound.parts import part_sites
from radmpc.referee.gather import gather_pairs
from radmpc.referee.propagation import propagate

MISSIONS = 4_000
GUST = np.vstack([0.5 * np.eye(2), np.eye(2)])
TURNED = GUST @ np.array([[0.6, 0.8], [-0.8, 0.6]])


def in_wind(vehicle: Vehicle, matrix: np.ndarray = GUST, rho: float = 0.0) -> Vehicle:
    wind = SharedDisturbance("wind", matrix, [[0.02, 0.005], [0.005, 0.01]], rho)
    return replace(vehicle, shared=(wind,))


def alike() -> Plan:
    """One gust, felt the same: apart they stay."""
    return still(in_wind(craft("a", DI, [0, 0])), in_wind(craft("b", DI, [1.2, 0.2])), horizon=4)


def against_each_other() -> Plan:
    a = in_wind(craft("a", DI, [0, 0], gain=pd(0.3, 0.9)), rho=0.7)
    b = in_wind(craft("b", DI, [1.3, 0.3], gain=pd(1.0, 1.5)), -0.5 * GUST, rho=0.7)
    return still(a, b, craft("c", DI, [0.2, -1.3]), horizon=4)


def measured() -> Plan:
    sensor = Measurement.of([0, 1], 4, [[0.02, 0.004], [0.004, 0.01]])
    a = in_wind(craft("a", DI, [0, 0], gain=pd(1.0, 1.5)), TURNED, rho=0.6)
    a = replace(a, measurement=sensor, disturbance_correlation=0.4)
    b = replace(in_wind(craft("b", DI, [1.3, 0.3], gain=pd(0.3, 0.9)), rho=0.6))
    swell = SharedDisturbance("swell", np.eye(4)[:, :1], 0.01)
    b = replace(b, measurement=sensor, shared=(swell, *b.shared))
    return still(a, b, replace(craft("c", DI, [0, -1.3]), shared=(swell,)), horizon=4)


def of_other_dynamics() -> Plan:
    other = craft("b", stepper(1.0, 2, np.random.default_rng(1)), [1.3, 0.3])
    other = replace(other, shared=(SharedDisturbance("wind", np.eye(2), [0.02, 0.01], 0.3),))
    wind = SharedDisturbance("wind", GUST, [0.02, 0.01], 0.3)
    return still(replace(craft("a", DI, [0, 0]), shared=(wind,)), other, horizon=4)


SCENES = [alike, against_each_other, measured, of_other_dynamics]


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.__name__)
def test_program_and_referee_agree_about_pairs(scene):
    plan = scene()
    models = condensed_models(plan.scenario)
    motion = propagate(plan.scenario, [t.controls for t in plan.trajectories])
    (batch,) = gather_pairs(plan.scenario, motion, intervals=True).batches
    for pair, (i, j) in enumerate(zip(batch.first, batch.other, strict=True)):
        expected = relative_covariances(models[i], models[j])
        assert batch.covariances[pair] == pytest.approx(expected, rel=1e-9, abs=1e-14)
        bent = relative_bent_covariances(models[i], models[j])
        if batch.bent_covariances is not None and bent is not None:
            assert batch.bent_covariances[pair] == pytest.approx(bent, rel=1e-9, abs=1e-14)
        sites, _ = part_sites(batch.take(np.array([pair])), motion, 4)
        part = Part(1.0, 0, 0, np.zeros((4, 2)), np.zeros((2, 2)))
        shares = (0.25, 0.5, 0.75, 1.0)
        one, two = (Instants.of(models[k], part, shares) for k in (i, j))
        between = one.relative_to(two)
        assert sites.covariances[:, -1] == pytest.approx(between.covariances, rel=1e-9, abs=1e-14)


def test_two_that_feel_the_same_gust_stray_from_each_other_by_their_own_noise_alone():
    plan = alike()
    windy = condensed_models(plan.scenario)
    calm = [replace(vehicle, shared=()) for vehicle in plan.scenario.vehicles]
    still_air = condensed_models(replace(plan.scenario, vehicles=calm))
    own = relative_covariances(*still_air)
    assert relative_covariances(*windy) == pytest.approx(own, rel=1e-9, abs=1e-15)
    assert (windy[0].position_covariances[1:] > still_air[0].position_covariances[1:]).any()


def test_whoever_answers_the_same_gust_alike_is_certified_as_in_still_air():
    gusty = [in_wind(craft(n, DI, [x, 0.0], gain=pd(0.3, 0.9)), rho=0.6)
             for n, x in (("a", 0.0), ("b", 1.0))]  # fmt: skip
    calm = [replace(vehicle, shared=()) for vehicle in gusty]
    found = [certify(still(*vehicles, horizon=4)).certified for vehicles in (gusty, calm)]
    assert found[0] == pytest.approx(found[1], rel=1e-6)
    assert found[1] > 1e-4


def test_without_noise_of_their_own_they_keep_their_distance_for_sure():
    vehicles = [replace(in_wind(craft(n, DI, [x, 0.0])), initial_covariance=np.zeros((4, 4)),
                        disturbance_covariance=np.zeros((4, 4)))
                for n, x in (("a", 0.0), ("b", 0.81))]  # fmt: skip
    plan = still(*vehicles, horizon=4)
    models = condensed_models(plan.scenario)
    both = sum(np.trace(m.position_covariances, axis1=1, axis2=2) for m in models)
    # Nothing, as far as digits tell.
    assert np.all(relative_covariances(*models) <= 1e-13 * both[:, None, None])
    assert certify(plan).certified == 0.0
    assert simulate(plan, MISSIONS, rng=0).pair_collisions == 0


@pytest.mark.parametrize("own", [2e-5, 1e-3])
def test_noise_of_their_own_counts_however_strong_the_gust_that_cancels(own):
    # Half a deviation apart: the gust moves both alike, and they touch by their own noise.
    names = (("a", 0.0), ("b", 0.6 + 0.5 * own))
    gusty = [replace(craft(n, DI, [x, 0.0]), initial_covariance=np.zeros((4, 4)),
                     disturbance_covariance=np.diag([own**2, own**2, 0.0, 0.0]),
                     shared=(SharedDisturbance("gust", np.eye(4, 2), 1e4 * np.eye(2)),))
             for n, x in names]  # fmt: skip
    moved = own * np.random.default_rng(0).standard_normal((20_000, 3, 2, 2)).cumsum(axis=1)
    apart = moved[:, :, 0] - moved[:, :, 1] + [0.6 + 0.5 * own, 0.0]
    truth = (np.linalg.norm(apart, axis=2) < 0.6).any(axis=1).mean()
    assert truth > 0.5
    assert certify(still(*gusty, horizon=3)).certified >= truth


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.__name__)
def test_simulation_counts_what_the_second_simulator_counts_in_shared_gusts(scene):
    plan = scene()
    ours = simulate(plan, 4 * MISSIONS, rng=1)
    theirs = fly(plan, MISSIONS, seed=2)
    assert theirs.collisions > 20
    for one, other in (
        (ours.pair_collisions, theirs.pair_collisions),
        (ours.saturated, theirs.saturated),
    ):
        table = [[one, ours.samples - one], [other, MISSIONS - other]]
        assert fisher_exact(table).pvalue > 1e-4
    assert certify(plan).certified >= ours.rate_low


def test_vehicles_that_know_one_source_agree_about_it():
    a = in_wind(craft("a", DI, [0, 0]))
    b = in_wind(craft("b", DI, [3, 0]), rho=0.2)
    with pytest.raises(ScenarioError, match="another covariance or correlation") as caught:
        still(a, b)
    assert caught.value.path == ("vehicles", 1, "shared", 0)
