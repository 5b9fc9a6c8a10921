"""Cures of one vehicle's concerns, each tried on the vehicle before it is told."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import islice

import numpy as np

from radmpc.arrays import Tensor
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.planners.cures.variants import (
    LIMIT_FACTORS,
    WEIGHTS,
    longer_horizons,
    regulated,
    vehicle_with_noise,
)
from radmpc.preflight.pace import Pace
from radmpc.preflight.reserve import expected_saturation, reserve_of
from radmpc.rounding import rounded_down, rounded_up

__all__ = [
    "control_cures",
    "deviation_cures",
    "largest_deviation",
    "saturation_cures",
    "time_cures",
    "visit_cures",
]

_SIGMAS = (3.5, 4.0, 4.5, 5.0, 6.0, 7.0)
"""Values of ``control_sigmas`` that are tried [-]."""

_Test = Callable[[Vehicle], bool]


def control_cures(scenario: Scenario, vehicle: Vehicle, share: float) -> str:
    """Return what makes feedback keep back no more than a share of the control limit.

    Parameters
    ----------
    scenario : Scenario
        Whose horizon counts.
    vehicle : Vehicle
        Of it.
    share : float
        The largest that is no concern [-].

    Returns
    -------
    str
        In the imperative, joined by "or"; empty where nothing that was tried does.
    """

    def does(candidate: Vehicle) -> bool:
        return _share(candidate, candidate.covariances(scenario.horizon)) <= share

    kept = _share(vehicle, vehicle.covariances(scenario.horizon))
    found = list(_softer(vehicle, does))
    # What is kept back grows with the noise, and does not depend on the limit.
    quieter = rounded_down(share / kept)
    if does(vehicle_with_noise(vehicle, quieter**2)):
        found.append(f"reduce the noise to {quieter:g} of its standard deviations")
    found += _raised(vehicle, "control_limit", does, [kept / share * 1.001])
    return ", or ".join(found)


def time_cures(scenario: Scenario, vehicle: Vehicle) -> str:
    """Return which limits, raised, let a vehicle reach its goal in time through empty space.

    Parameters
    ----------
    scenario : Scenario
        Whose horizon counts.
    vehicle : Vehicle
        Of it, late with its present limits.

    Returns
    -------
    str
        In the imperative, joined by "or"; empty where raising one of them does not help.
    """
    horizon = scenario.horizon

    def does(candidate: Vehicle) -> bool:
        pace = Pace.of(candidate)
        bounds = candidate.control_bounds(candidate.covariances(horizon))
        return pace is not None and pace.arrives(np.maximum(bounds, 0.0))

    return " or ".join(_faster(vehicle, does))


def visit_cures(scenario: Scenario, vehicle: Vehicle) -> str:
    """Return what lets a vehicle make its visits and reach its goal in time.

    Parameters
    ----------
    scenario, vehicle
        As in `time_cures`.

    Returns
    -------
    str
        In the imperative; empty where nothing that was tried does.
    """
    from radmpc.preflight.visits import is_in_time  # noqa: PLC0415 - few visit anything

    longer = (n for n in longer_horizons(scenario) if is_in_time(scenario, vehicle, n))
    found = [f"lengthen the horizon to {horizon}" for horizon in islice(longer, 1)]
    found += _faster(vehicle, lambda one: is_in_time(scenario, one, scenario.horizon))
    return ", or ".join(found)


def saturation_cures(scenario: Scenario, vehicle: Vehicle, most: float) -> str:
    """Return what makes feedback ask for too much control no more often than with a probability.

    Parameters
    ----------
    scenario : Scenario
        Whose horizon counts.
    vehicle : Vehicle
        Of it.
    most : float
        The largest probability that is no concern [-].

    Returns
    -------
    str
        As in `control_cures`.
    """

    def does(candidate: Vehicle) -> bool:
        covariances = candidate.covariances(scenario.horizon)
        bounds = candidate.control_bounds(covariances)
        pace = Pace.of(candidate)
        if pace is None or not np.all(bounds >= 0.0):
            return False
        controls = pace.cheapest(bounds)
        samples = scenario.covariance_samples
        return controls is not None and (
            expected_saturation(candidate, covariances, controls, samples) <= most
        )

    tried = (replace(vehicle, control_sigmas=sigmas) for sigmas in _SIGMAS)
    higher = next((v for v in tried if v.control_sigmas > vehicle.control_sigmas and does(v)), None)
    found = [] if higher is None else [f"raise control_sigmas to {higher.control_sigmas:g}"]
    found += _raised(vehicle, "control_limit", does)
    found += _softer(vehicle, does)
    return ", or ".join(found)


def deviation_cures(scenario: Scenario, vehicle: Vehicle, most: float, share: float) -> str:
    """Return what keeps a vehicle near its path until the horizon.

    Parameters
    ----------
    scenario : Scenario
        Whose horizon counts.
    vehicle : Vehicle
        Of it.
    most : float
        The largest standard deviation at the end that is no concern [m].
    share : float
        The largest share of the control limit that feedback may keep back for it [-].

    Returns
    -------
    str
        In the imperative, joined by "or"; empty where nothing that was tried does.
    """

    def is_near(candidate: Vehicle) -> bool:
        return largest_deviation(candidate, candidate.covariances(scenario.horizon)) <= most

    def does(candidate: Vehicle) -> bool:
        kept = _share(candidate, candidate.covariances(scenario.horizon))
        return kept <= share and is_near(candidate)

    found = []
    weight = _weight(vehicle, does)
    if weight is not None:
        word = "add feedback" if vehicle.gain is None else "stiffen the gain"
        found.append(f"{word} (lqr with Q = 1, R = {weight:g} does)")
    deviation = largest_deviation(vehicle, vehicle.covariances(scenario.horizon))
    quieter = rounded_down(most / deviation)
    if is_near(vehicle_with_noise(vehicle, quieter**2)):
        found.append(f"reduce the noise to {quieter:g} of its standard deviations")
    return ", or ".join(found)


def largest_deviation(vehicle: Vehicle, covariances: Tensor) -> float:
    """Return the largest standard deviation of a position at the horizon, in any direction [m].

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    covariances : (T+1, n, n) array
        Of its state.
    """
    axes = list(vehicle.system.position)
    last = covariances[-1][np.ix_(axes, axes)]
    return float(np.sqrt(max(np.linalg.eigvalsh(last)[-1], 0.0)))


def _share(vehicle: Vehicle, covariances: Tensor) -> float:
    """Return the largest share of a control limit that feedback keeps back."""
    return reserve_of(vehicle, vehicle.control_bounds(covariances)).share


def _softer(vehicle: Vehicle, does: _Test) -> Iterator[str]:
    """Yield the stiffest regulator that does, of those tried."""
    weight = _weight(vehicle, does)
    if weight is not None:
        yield f"soften the gain (lqr with Q = 1, R = {weight:g} does)"


def _weight(vehicle: Vehicle, does: _Test) -> float | None:
    """Return the weight R of the stiffest regulator that does, of those tried."""
    for weight in WEIGHTS:
        candidate = regulated(vehicle, weight)
        if candidate is not None and does(candidate):
            return weight
    return None


def _faster(vehicle: Vehicle, does: _Test) -> list[str]:
    """Return the smallest limits that do, each alone."""
    return [*_raised(vehicle, "speed_limit", does), *_raised(vehicle, "control_limit", does)]


def _raised(
    vehicle: Vehicle, limit: str, does: _Test, factors: Sequence[float] = LIMIT_FACTORS
) -> Iterator[str]:
    """Yield the smallest limit that does, of those tried."""
    value = getattr(vehicle, limit)
    if value is None:
        return
    for factor in factors:
        raised = np.array([rounded_up(factor * x, 3) for x in np.atleast_1d(value).tolist()])
        if limit == "control_limit":
            candidate = replace(vehicle, control_limit=raised)
        else:
            candidate = replace(vehicle, speed_limit=raised)
        if does(candidate):
            told = sorted({f"{x:g}" for x in raised.tolist()}, key=float)
            yield f"raise {limit} to {told[0] if len(told) == 1 else raised.tolist()}"
            return
