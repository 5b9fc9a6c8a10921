"""Vehicles in one log whose sensors are noisy: alike unless their noise differs."""

from __future__ import annotations

from dataclasses import replace

import pytest

from radmpc.identification import Track, identify
from simulator import Truth, fly

NOISY = Truth(steps=1000, seen=(0.04, 0.04, 0.0025, 0.0025), scale=0.1, vehicles=2)
SOLID = replace(NOISY, dimension=3, seen=(0.04, 0.04, 0.04, 0.0025, 0.0025, 0.0025), steps=600)


def beside(truth: Truth, other: Truth, seed: int) -> list[Track]:
    """Two flights of one vehicle each."""
    [one] = fly(replace(truth, vehicles=1), seed)
    [two] = fly(replace(other, vehicles=1), seed + 1)
    return [one, Track("other", two.source, two.clock, two.times, two.positions, two.velocities,
                       two.controls)]  # fmt: skip


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    ("truth", "seed"), [(NOISY, 2), (NOISY, 3), (SOLID, 1)], ids=["flat", "flat again", "solid"]
)
def test_the_same_vehicle_twice_is_not_called_different_for_its_noisy_sensors(
    truth: Truth, seed: int
) -> None:
    assert not identify(fly(truth, seed)).differ


@pytest.mark.slow
@pytest.mark.nightly
@pytest.mark.parametrize(
    "truth",
    [NOISY, replace(NOISY, steps=200, vehicles=3), replace(NOISY, color=0.8)],
    ids=["long", "short", "memory"],
)
def test_vehicles_that_are_alike_are_called_different_as_seldom_as_the_level_says(
    truth: Truth,
) -> None:
    assert sum(identify(fly(truth, seed)).differ for seed in range(100)) <= 3


@pytest.mark.parametrize(
    "other",
    [replace(NOISY, scale=0.2), replace(NOISY, seen=(0.08, 0.08, 0.005, 0.005))],
    ids=["disturbance", "measurement"],
)
def test_noise_that_is_twice_as_large_is_told_apart_beside_noisy_sensors(other: Truth) -> None:
    longer = replace(NOISY, steps=2000)
    assert identify(beside(longer, replace(other, steps=2000), 40)).differ


def test_noisy_sensors_of_one_vehicle_alone_are_told_from_good_ones() -> None:
    assert identify(beside(Truth(), Truth(seen=(0.05, 0.05, 0.01, 0.01)), 50)).differ
