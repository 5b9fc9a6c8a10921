"""Scenes that were certified and were not safe."""

from __future__ import annotations

from pathlib import Path

import pytest

from radmpc.io.native.scenario_file import load_scenario
from radmpc.model.plan import Status
from radmpc.planning import plan
from radmpc.referee import simulate

SCENES = Path(__file__).parents[2] / "data" / "scenes"


def test_a_peak_that_an_integral_could_step_over_is_not_certified():
    scenario = load_scenario(SCENES / "integral-peak.json")
    # One deviation is 25,000 times the other; the goal's only point runs 1e-3, Δ is 1e-4.
    assert plan(scenario, "certified").status is Status.INFEASIBLE
    careless = plan(scenario, "dlp")
    assert careless.certificate is not None
    assert not careless.certificate.holds
    assert careless.certificate.certified > 9e-4
    flown = simulate(careless.require(), 100_000, rng=0)
    assert flown.rate_low <= careless.certificate.certified
    assert flown.rate > 3e-4


@pytest.mark.slow
def test_a_plan_whose_controls_mostly_saturate_says_so():
    scenario = load_scenario(SCENES / "saturates.yaml")
    result = plan(scenario, "certified(0)")
    assert result.is_certified
    assert result.certificate is not None
    assert result.certificate.saturation > 0.5
    assert result.record.risk.saturation == result.certificate.saturation
    flown = simulate(result.require(), 5_000, rng=0)
    assert 0.5 < flown.saturation_rate <= result.certificate.saturation
