"""Before anything is measured, what is left of a certificate is the certificate."""

from __future__ import annotations

from dataclasses import replace

import pytest
from conditional_scenes import SCENES as NOISY
from estimating_missions import left_after
from estimating_scenes import SCENES as ESTIMATING
from fleets import random_plan
from gusty_missions import SCENES as GUSTY

from radmpc.referee import certify
from radmpc.referee.conditional.conditional import conditional, witnesses_of

SCENES = {
    f"{kind}: {name}": scene
    for kind, scenes in (("noisy", NOISY), ("gusty", GUSTY), ("estimating", ESTIMATING))
    for name, scene in scenes.items()
}
KINDS = ("steps", "intervals")


@pytest.mark.slow
@pytest.mark.sampled(6)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("scene", SCENES)
def test_the_value_of_a_plan_in_noise_is_its_certificate(scene: str, kind: str) -> None:
    plan = SCENES[scene](kind)
    value = conditional(witnesses_of(plan), 0, None)
    assert value.total == pytest.approx(certify(plan).certified, rel=1e-7)
    assert value.total / 1.0171 <= value.least <= value.total


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("scene", ESTIMATING)
def test_the_value_of_a_leg_that_begins_under_way_is_its_certificate(scene: str, kind: str) -> None:
    leg = left_after(ESTIMATING[scene](kind), 1)
    value = conditional(witnesses_of(leg), 0, None)
    assert value.total == pytest.approx(certify(leg).certified, rel=1e-7)


@pytest.mark.slow
@pytest.mark.sampled(10)
@pytest.mark.parametrize("seed", range(120))
def test_the_value_of_a_random_plan_is_its_certificate(seed: int) -> None:
    plan = random_plan(seed)
    value = conditional(witnesses_of(plan), 0, None)
    assert value.total == pytest.approx(certify(plan).certified, rel=1e-7, abs=1e-15)
    assert value.total / 1.0171 - 1e-14 <= value.least <= value.total


@pytest.mark.slow
@pytest.mark.sampled(6)
@pytest.mark.parametrize("seed", range(120))
def test_the_value_of_a_random_plan_of_unknown_scale_is_its_certificate(seed: int) -> None:
    plan = random_plan(seed)
    plan = replace(plan, scenario=replace(plan.scenario, covariance_samples=3 + seed % 40))
    value = conditional(witnesses_of(plan), 0, None)
    assert value.total == pytest.approx(certify(plan).certified, rel=1e-7, abs=1e-12)
    # Beside what Gaussians are known to, 0.1 % each way of the sum that stands for Student's t.
    assert value.total / 1.0195 - 1e-11 <= value.least <= value.total
