"""Warnings about the noise of a whole scenario: none, chosen by an import, tracks poorly known."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Literal

from radmpc.model.scenario import Scenario
from radmpc.rounding import rounded_down

__all__ = ["NoiseKind", "noise_warnings"]

NoiseKind = Literal["noise", "assumed noise", "track"]

_ASTRAY = 3.0
"""Standard deviation of an obstacle's place at the end from which on it is a concern [radii of the
largest hull]: three of them are then a way around of nine radii."""


def noise_warnings(scenario: Scenario) -> Iterator[tuple[NoiseKind, str]]:
    """Yield what is to be said of noise, each with what it is about.

    Parameters
    ----------
    scenario : Scenario
        The scenario.
    """
    if not any(
        v.initial_covariance.any() or v.disturbance_covariance.any() for v in scenario.vehicles
    ):
        text = (
            "No vehicle has any noise: plans may touch what they pass, and their certificate says "
            "nothing; state initial_covariance and disturbance_covariance"
        )
        yield "noise", text
    choices = (scenario.source or {}).get("choices")
    noise = choices.get("noise") if isinstance(choices, Mapping) else None
    if isinstance(noise, str):
        text = (
            f"The noise was chosen by the import, the problem states none "
            f"({' '.join(noise.split())}): replace it by what was measured"
        )
        yield "assumed noise", text
    largest = max(vehicle.radius for vehicle in scenario.vehicles)
    for obstacle in scenario.obstacles:
        if obstacle.spread is None:
            continue
        begin, end = (obstacle.spread.deviation(k) for k in (0, scenario.horizon))
        if end > _ASTRAY * largest:
            text = (
                f"Obstacle {obstacle.name!r}: its place deviates by {end:.3g} m at the end, "
                f"{begin:.3g} m at the start: plans keep three or four of that away from it; "
                f"a track of {rounded_down(_ASTRAY * largest / end):g} of these deviations is "
                f"good enough"
            )
            yield "track", text
