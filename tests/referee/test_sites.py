"""What is computed for many directions at once is what each direction gives alone."""

from __future__ import annotations

import numpy as np
import pytest
from fleets import random_plan

from radmpc.model.plan import Plan
from radmpc.referee import certify
from radmpc.referee.bound import bounds
from radmpc.referee.bound.certificate import judged
from radmpc.referee.bound.parts import NUM_PARTS, part_sites
from radmpc.referee.bound.persistence import path_charges
from radmpc.referee.encounters import Encounters, interval_sites
from radmpc.referee.gather import gather_obstacles, gather_pairs
from radmpc.referee.motion import FleetMotion
from radmpc.referee.propagation import FleetNoise, propagate
from radmpc.referee.sites import chords, joined_rows

SEEDS = [seed for seed in range(12) if seed not in (3, 9, 10)]
"""Of random plans in which something is met: the others have one vehicle and no obstacle."""


def batches(plan: Plan) -> tuple[FleetMotion, tuple[Encounters, ...]]:
    """Return all encounters of a plan."""
    motion = propagate(plan.scenario, [t.controls for t in plan.trajectories])
    found = (
        gather(plan.scenario, motion, intervals=True) for gather in (gather_obstacles, gather_pairs)
    )
    return motion, tuple(batch for each in found for batch in each.batches)


def unit_vectors(rng: np.random.Generator, *shape: int) -> np.ndarray:
    """Return random directions."""
    vectors = rng.normal(size=shape)
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


@pytest.mark.parametrize("seed", SEEDS)
def test_along_directions_sites_look_as_defined(seed):
    rng = np.random.default_rng(seed)
    num_sites = 0
    for batch in batches(random_plan(seed))[1]:
        sites = interval_sites(batch)
        num_sites += len(sites.means)
        count, ends, d = sites.means.shape
        directions = unit_vectors(rng, count, 3, d)
        seen = chords(sites, directions)
        supports = np.einsum("scd,smvd->scmv", directions, sites.vertices).max(axis=3)
        for end in range(ends):
            share = sites.blends[:, None, end]
            support = (1.0 - share) * supports[:, :, 0] + share * supports[:, :, -1]
            along = np.einsum("scd,sd->sc", directions, sites.means[:, end])
            margins = along - support - sites.radii[:, None]
            assert seen.margins[:, :, end] == pytest.approx(margins, abs=1e-12)
            variance = np.einsum(
                "scd,sde,sce->sc", directions, sites.covariances[:, end], directions
            )
            assert seen.deviations[:, :, end] ** 2 == pytest.approx(variance, abs=1e-14)
        sagittas = np.einsum("scd,sd->sc", directions, sites.sagittas).clip(min=0.0)
        assert seen.sagittas == pytest.approx(sagittas, abs=1e-12)
    assert num_sites > 0


@pytest.mark.parametrize("seed", SEEDS)
def test_choices_of_half_spaces_cost_what_they_cost_alone(seed):
    rng = np.random.default_rng(seed)
    motion, found = batches(random_plan(seed))
    assert sum(batch.means.size for batch in found) > 0
    for batch in found:
        sites, crossed = part_sites(batch, motion, NUM_PARTS)
        count, d = len(batch.means), sites.means.shape[2]
        directions = unit_vectors(rng, count, len(sites.means) // count, 3, d)
        together = path_charges(sites, directions, crossed, NUM_PARTS)
        for choice in range(3):
            chosen = directions[:, :, choice : choice + 1]
            alone = path_charges(sites, chosen, crossed, NUM_PARTS)[:, 0]
            assert together[:, choice] == pytest.approx(alone, rel=1e-6, abs=1e-300)


@pytest.mark.parametrize("seed", SEEDS)
def test_what_is_far_away_is_charged_no_less_than_a_closer_look_finds(seed, monkeypatch):
    encountered = batches(random_plan(seed))[1]
    assert sum(batch.means.size for batch in encountered) > 0
    for batch in encountered:
        found = bounds.instant_risks([batch])[0]
        boxes = bounds._box_risks(batch)
        assert np.all(found <= np.minimum(boxes, 1.0))
        monkeypatch.setattr(bounds, "_FAR", -1.0)
        closely = bounds.instant_risks([batch])[0]
        monkeypatch.undo()
        assert np.all(boxes >= closely * (1.0 - 1e-9))
        assert np.all(found <= closely + 1e-20)


@pytest.mark.parametrize("seed", SEEDS)
def test_pairs_and_obstacles_looked_at_in_one_go_risk_what_they_do_one_by_one(seed, monkeypatch):
    found = batches(random_plan(seed))[1]
    assert sum(batch.means.size for batch in found) > 0
    together = bounds.instant_risks(found)
    monkeypatch.setattr(bounds, "_FEW", 0)
    for risks, alone in zip(together, bounds.instant_risks(found), strict=True):
        assert risks == pytest.approx(alone, rel=1e-9, abs=1e-24)
    assert [one.shape for one in together] == [one.means.shape[:2] for one in found]


def test_rows_that_are_joined_repeat_their_first_vector():
    one, two = np.arange(6.0).reshape(1, 3, 2), 10.0 + np.arange(2.0).reshape(1, 1, 2)
    rows = joined_rows([one, two])
    assert np.array_equal(rows[0], one[0])
    assert np.array_equal(rows[1], np.repeat(two[0], 3, axis=0))


@pytest.mark.parametrize("at", [(0.0, 0.0), (0.9, 0.0), (1.1, 1.1), (1.25, 0.0), (1.8, 1.5)])
def test_who_is_in_a_box_or_beside_it_is_charged_what_samples_hit(at):
    covariance = np.array([[0.09, 0.02], [0.02, 0.01]])
    box, radius = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]), 0.3
    one = np.zeros(1, dtype=np.int64)
    encounter = Encounters(
        kind="obstacle",
        first=one,
        other=one,
        piece=one,
        partner=one - 1,
        track=one - 1,
        means=np.array([[at]]),
        covariances=covariance[None, None],
        bent_covariances=None,
        sagittas=np.zeros((1, 0, 2)),
        radii=np.array([radius]),
        vertices=box[None, None],
        directions=np.vstack([np.eye(2), -np.eye(2)])[None],
        edges=np.zeros((1, 1, 0, 2, 2)),
    )
    risk = bounds.instant_risks([encounter])[0][0, 0]
    drawn = np.random.default_rng(3).multivariate_normal(at, covariance, 200_000)
    beside = np.maximum(np.abs(drawn) - 1.0, 0.0)
    rate = np.mean(np.linalg.norm(beside, axis=1) < radius)
    assert risk == pytest.approx(rate, abs=5.0 * np.sqrt(rate * (1.0 - rate) / 200_000) + 1e-5)


@pytest.mark.parametrize("seed", range(12))
def test_a_plan_is_judged_alike_with_its_fleets_noise_at_hand(seed):
    plan = random_plan(seed)
    noise = FleetNoise.of(plan.scenario)
    first, second, anew = judged(plan, noise), judged(plan, noise), certify(plan)
    assert first.ledger == second.ledger == anew.ledger
    assert first.problems == second.problems == anew.problems
