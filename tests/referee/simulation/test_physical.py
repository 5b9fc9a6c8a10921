"""What is simulated and certified against a second simulator that shares no code with either."""

from __future__ import annotations

import pytest
from fleets import random_plan
from physical import fly
from physical_scenes import (
    KINDS,
    SCENES,
    clipped_beside_a_wall,
    clipped_on_the_way,
    clipped_pair,
    clipped_stepper,
    turning_solid,
)
from scipy.stats import binomtest
from second_opinion import check_certificate, check_counts

from radmpc.referee import certify, simulate

MISSIONS = 20_000
FEWER = 1_500
FALSE_ALARM = 1e-4 / (len(SCENES) * len(KINDS))


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.__name__)
def test_simulation_counts_what_the_second_simulator_counts(scene):
    missions = FEWER if scene is turning_solid else MISSIONS
    check_counts(scene(), missions, FALSE_ALARM)


def test_most_missions_of_the_clipped_scenes_saturate():
    for scene in (clipped_beside_a_wall, clipped_on_the_way, clipped_pair, clipped_stepper):
        assert simulate(scene(), 2000, rng=0).saturation_rate > 0.5


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    "scene",
    [s for s in SCENES if not s.__name__.startswith("clipped")],
    ids=lambda scene: scene.__name__,
)
def test_the_certificate_is_not_below_the_second_simulator(scene):
    missions = FEWER if scene is turning_solid else MISSIONS
    check_certificate(scene(), missions, most=None)


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("first", range(0, 120, 20))
def test_certificates_of_fleets_nobody_planned_are_not_below_the_second_simulator(first):
    told = 0
    for seed in range(first, first + 20):
        plan = random_plan(seed)
        solids = [o for o in plan.scenario.obstacles if o.is_moving]
        certified = certify(plan).certified
        # Turning solids in space take their time, and have tests of their own.
        if not 1e-3 < certified < 0.9 or (plan.scenario.dimension == 3 and solids):
            continue
        flown = fly(plan, 4000, seed)
        low = binomtest(flown.collisions, 4000).proportion_ci(1 - 2e-6, "exact").low
        assert certified >= low, seed
        told += flown.collisions > 4000 * 0.3 * certified
    assert told >= 1
