"""Warnings about noise: none, none along an axis, chosen by an import; tracks poorly known."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Literal

import numpy as np

from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.records import replace
from radmpc.rounding import rounded_down

__all__ = ["NoiseKind", "idle_measurement", "noise_warnings", "quiet_axes"]

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
    if not any(_is_shaken(vehicle) for vehicle in scenario.vehicles):
        yield "noise", _without_noise(scenario)
    for name in _idle_sources(scenario):
        text = (
            f"Shared disturbance {name!r} acts on nobody, its matrices in `on` are all zeros: "
            "state what it does to vehicles, or leave it out"
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


def _is_shaken(vehicle: Vehicle) -> bool:
    """Whether anything is uncertain about a vehicle."""
    own = vehicle.initial_covariance.any() or vehicle.disturbance_covariance.any()
    shared = (part.covariance.any() and part.matrix.any() for part in vehicle.shared)
    return bool(own or any(shared))


def _without_noise(scenario: Scenario) -> str:
    """Return what a plan without any noise of vehicles is worth."""
    astray = [obstacle.name for obstacle in scenario.obstacles if obstacle.spread is not None]
    state = "state initial_covariance and disturbance_covariance"
    if not astray:
        return (
            "No vehicle has any noise: plans may touch what they pass, and their certificate says "
            f"nothing; {state}"
        )
    more = f" and {len(astray) - 1} more" if len(astray) > 1 else ""
    return (
        f"No vehicle has any noise, only where {astray[0]!r}{more} will be is uncertain: plans may "
        f"touch all else that they pass, and their certificate speaks of that alone; {state}"
    )


def _idle_sources(scenario: Scenario) -> Iterator[str]:
    """Yield the names of shared disturbances that do nothing to anybody."""
    acts: dict[str, bool] = {}
    for vehicle in scenario.vehicles:
        for part in vehicle.shared:
            acts[part.name] = acts.get(part.name, False) or bool(part.matrix.any())
    yield from (name for name, does in acts.items() if not does)


def idle_measurement(vehicle: Vehicle) -> str | None:
    """Return why a measurement changes nothing, as text.

    Parameters
    ----------
    vehicle : Vehicle
        With or without one.

    Returns
    -------
    str or None
        None where there is none, or it has an effect.
    """
    if vehicle.measurement is None:
        return None
    if vehicle.gain is None:
        return "measurement changes no plan without feedback: state feedback, or leave it out"
    if not vehicle.measurement.matrix.any():
        return (
            "measurement.matrix is all zeros: nothing is measured and feedback never acts; "
            "state what is measured, or leave measurement out if the state is known"
        )
    return None


def quiet_axes(vehicle: Vehicle, horizon: int) -> str | None:
    """Return the axes that no disturbance ever reaches where one reaches others, as text.

    Parameters
    ----------
    vehicle : Vehicle
        With its feedback.
    horizon : int
        Number of steps T.

    Returns
    -------
    str or None
        What to say of them; None where there are none.
    """
    places = list(vehicle.system.position)
    if np.diag(vehicle.disturbance_covariance)[places].all():
        return None
    # Noise of a velocity, of feedback or of measurements reaches positions later.
    still = replace(vehicle, initial_covariance=np.zeros_like(vehicle.initial_covariance))
    variances = np.diagonal(still.covariances(horizon), axis1=1, axis2=2)[:, places].max(axis=0)
    quiet = variances <= 0.0
    if quiet.all() or not quiet.any():
        return None
    names = [" and ".join(np.array(list("xyz"[: len(places)]))[part]) for part in (quiet, ~quiet)]
    return (
        f"disturbances reach {names[1]} and never {names[0]}, and certificates count on that; "
        f"state disturbance_covariance along {names[0]}, too, unless it is so"
    )
