"""What is left of a certificate where estimates hang together through shared disturbances."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from estimating_missions import flown_estimating, left_after, told_at, wanted_rows, world_of
from estimating_scenes import SCENES
from gusty_missions import SCENES as GUSTY_SCENES
from noisy_missions import check_charges

from radmpc.flying.knowing import expected_start, known_after
from radmpc.flying.leg import leg_of
from radmpc.flying.sensing.observing import Observer
from radmpc.program.build import condensed_models
from radmpc.program.relative import relative_bent_covariances, relative_covariances
from radmpc.referee.conditional import conditional as module
from radmpc.referee.conditional import loops
from radmpc.referee.conditional.conditional import witnesses_of
from radmpc.referee.conditional.gusts import Gusts
from radmpc.referee.gather import gather_pairs
from radmpc.referee.propagation import propagate
from sampling import IS_THOROUGH

KINDS = ("steps", "intervals")

FEW = 20_000 if IS_THOROUGH else 1_500
"""Missions: nightly those that tell small mistakes, too."""


@pytest.mark.parametrize("scene", SCENES)
def test_what_plans_begin_with_is_what_brute_force_conditioning_says(scene):
    scenario = SCENES[scene]("steps").scenario
    fleet = scenario.vehicles
    world, rows = world_of(fleet, 4), wanted_rows(fleet)
    members = [i for i, v in enumerate(fleet) if v.shared]
    for step in range(4):
        _, due = told_at(world, step)
        known = known_after(scenario, step, [expected_start(v) for v in fleet])
        for i in members:
            for j in members:
                if known[i] is None or known[j] is None:
                    continue
                found = known[i].common @ known[j].common.T
                if i == j:
                    found[:8, :8] += known[i].covariance
                np.testing.assert_allclose(
                    found, due[np.ix_(rows[i], rows[j])], atol=1e-10, err_msg=f"{step} {i} {j}"
                )


@pytest.mark.parametrize("scene", SCENES)
def test_an_observer_makes_of_what_is_told_what_brute_force_conditioning_says(scene):
    witnesses = witnesses_of(SCENES[scene]("steps"))
    scenario = witnesses.plan.scenario
    flown = flown_estimating(witnesses, 2, seed=3)
    observer = Observer.of(scenario)
    expected = [expected_start(v) for v in scenario.vehicles]
    leg = leg_of(
        replace(scenario, risk_bound=0.49), [t.controls for t in witnesses.plan.trajectories], 0
    )
    for step in range(5):
        due = [known[step][1] for known in flown.known]
        told = [each[: v.start.size] for v, each in zip(scenario.vehicles, due, strict=True)]
        known = observer.observed(step, expected, told)
        for one, other in zip(known, due, strict=True):
            np.testing.assert_allclose(one, other, atol=1e-8)
        if step < 4:
            expected = leg.expected(step, known, leg.controls(step, known))


@pytest.mark.parametrize("scene", [*SCENES, *GUSTY_SCENES])
def test_planners_and_referee_agree_about_pairs_of_a_leg_that_began_under_way(scene):
    plan = left_after({**SCENES, **GUSTY_SCENES}[scene]("intervals"), 1)
    models = condensed_models(plan.scenario)
    motion = propagate(plan.scenario, [path.controls for path in plan.trajectories])
    for path, covariances in zip(plan.trajectories, motion.covariances, strict=True):
        np.testing.assert_allclose(path.covariances, covariances, atol=1e-13)
    (batch,) = gather_pairs(plan.scenario, motion, intervals=True).batches
    for pair, (i, j) in enumerate(zip(batch.first, batch.other, strict=True)):
        due = relative_covariances(models[i], models[j])
        np.testing.assert_allclose(batch.covariances[pair], due, rtol=1e-8, atol=1e-13)
        bent = relative_bent_covariances(models[i], models[j])
        if batch.bent_covariances is not None and bent is not None:
            np.testing.assert_allclose(batch.bent_covariances[pair], bent, rtol=1e-8, atol=1e-13)


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("scene", SCENES)
def test_rows_fail_as_often_as_they_are_charged_for_given_what_all_know(scene, kind):
    witnesses = witnesses_of(SCENES[scene](kind))
    check_charges(witnesses, flown_estimating(witnesses, FEW, seed=7), (1, 3))


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("scene", SCENES)
def test_rows_of_a_leg_that_began_under_way_fail_as_often_as_they_are_charged_for(scene, kind):
    witnesses = witnesses_of(left_after(SCENES[scene](kind), 1))
    check_charges(witnesses, flown_estimating(witnesses, FEW, seed=9), (0, 2))


# Mutants: each is a mistake that is easily made.


def by_its_own_filter(monkeypatch: pytest.MonkeyPatch) -> None:
    """Take what a vehicle believes for all that is known of it."""
    right = module._deviations

    def wrong(*given):
        found = right(*given).copy()
        seen = given[0].motion.seen_rows[0]
        found[:, 0, :seen] = found[:, 0, seen : 2 * seen]
        return found

    monkeypatch.setattr(module, "_deviations", wrong)


def by_all_that_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    """Take feedback to act on what all know, where it acts on what a vehicle believes."""
    right = module._deviations

    def wrong(*given):
        found = right(*given).copy()
        seen = given[0].motion.seen_rows[0]
        found[:, 0, seen : 2 * seen] = found[:, 0, :seen]
        return found

    monkeypatch.setattr(module, "_deviations", wrong)


def errors_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    """Take errors of two estimates for independent."""
    right = loops.since

    def wrong(*given, **named):
        return loops.replace(right(*given, **named), roots=None)

    monkeypatch.setattr(module, "since", wrong)


def nothing_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Take each one's estimate for as uncertain as if it heard of no others."""
    right = Gusts.left_open
    monkeypatch.setattr(Gusts, "left_open", lambda self, step: right(self, 0))


MUTANTS = [
    ("told by another", by_its_own_filter),
    ("at a wall", by_all_that_is_known),
    ("close", errors_apart),
    ("told by another", nothing_told),
]


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize(("scene", "mutant"), MUTANTS)
def test_rows_are_charged_wrongly_by_who_mistakes_what_is_known(scene, mutant, monkeypatch):
    witnesses = witnesses_of(SCENES[scene]("steps"))
    flown = flown_estimating(witnesses, 4_000, seed=8)
    check_charges(witnesses, flown, (0, 1, 2))
    mutant(monkeypatch)
    with pytest.raises(AssertionError, match="are charged"):
        check_charges(witnesses, flown, (0, 1, 2))
