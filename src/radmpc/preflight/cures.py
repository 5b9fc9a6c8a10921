"""Cures of one vehicle's concerns, each tried on the vehicle before it is told."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from math import floor, log10

import numpy as np

from radmpc.arrays import Tensor
from radmpc.errors import ScenarioError
from radmpc.model.dynamics import lqr_gain
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.preflight.pace import Pace
from radmpc.preflight.reserve import expected_saturation, reserve_of

__all__ = ["control_cures", "saturation_cures", "time_cures"]

_FACTORS = (1.1, 1.2, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0, 100.0)
"""What limits are multiplied by, one after the other [-]."""

_SIGMAS = (3.5, 4.0, 4.5, 5.0, 6.0, 7.0)
"""Values of ``control_sigmas`` that are tried [-]."""

_WEIGHTS = (1.0, 10.0, 100.0, 1e3, 1e4, 1e5)
"""Weights R of the control that are tried for feedback, with Q = 1 [-]: a softer gain each."""

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
        In the imperative, joined by "or"; what is in words only where no trial did.
    """

    def does(candidate: Vehicle) -> bool:
        return _share(candidate, candidate.covariances(scenario.horizon)) <= share

    kept = _share(vehicle, vehicle.covariances(scenario.horizon))
    found = list(_softer(vehicle, does))
    # What is kept back grows with the noise, and does not depend on the limit.
    quieter = _rounded_down(share / kept)
    if does(_with_noise(vehicle, quieter)):
        found.append(f"reduce the noise to {quieter:g} of its standard deviations")
    found += _raised(vehicle, "control_limit", does, [kept / share * 1.001])
    return _joined(found, "soften the gain, reduce the noise, or raise control_limit")


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

    found = [*_raised(vehicle, "speed_limit", does), *_raised(vehicle, "control_limit", does)]
    return " or ".join(found)


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
        As of `control_cures`.
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
    return _joined(found, "raise control_sigmas or control_limit, or soften the gain")


def _share(vehicle: Vehicle, covariances: Tensor) -> float:
    """Return the largest share of a control limit that feedback keeps back."""
    return reserve_of(vehicle, vehicle.control_bounds(covariances)).share


def _softer(vehicle: Vehicle, does: _Test) -> Iterator[str]:
    """Yield the stiffest regulator that does, of those tried."""
    system = vehicle.system
    for weight in _WEIGHTS:
        try:
            gain = lqr_gain(system, np.eye(system.num_states), weight * np.eye(system.num_controls))
            candidate = replace(vehicle, gain=gain)
        except ScenarioError:
            continue
        if does(candidate):
            yield f"soften the gain (lqr with Q = 1, R = {weight:g} does)"
            return


def _raised(
    vehicle: Vehicle, limit: str, does: _Test, factors: Sequence[float] = _FACTORS
) -> Iterator[str]:
    """Yield the smallest limit that does, of those tried."""
    value = getattr(vehicle, limit)
    if value is None:
        return
    for factor in factors:
        raised = np.array([_rounded_up(factor * x) for x in np.atleast_1d(value).tolist()])
        if limit == "control_limit":
            candidate = replace(vehicle, control_limit=raised)
        else:
            candidate = replace(vehicle, speed_limit=raised)
        if does(candidate):
            told = sorted({f"{x:g}" for x in raised.tolist()}, key=float)
            yield f"raise {limit} to {told[0] if len(told) == 1 else raised.tolist()}"
            return


def _with_noise(vehicle: Vehicle, factor: float) -> Vehicle:
    """Return a vehicle with all its noise multiplied, in standard deviations."""
    return replace(
        vehicle,
        initial_covariance=factor**2 * vehicle.initial_covariance,
        disturbance_covariance=factor**2 * vehicle.disturbance_covariance,
        measurement=(
            None
            if vehicle.measurement is None
            else replace(vehicle.measurement, covariance=factor**2 * vehicle.measurement.covariance)
        ),
    )


def _joined(found: Sequence[str], words: str) -> str:
    """Return what was found to help; in words where nothing that was tried did."""
    return f"{', or '.join(found)}" if found else f"{words} (none did that was tried)"


def _rounded_up(value: float) -> float:
    """Return a number > 0 of three digits, no smaller."""
    digits = 2 - floor(log10(value))
    return round(-floor(-value * 10.0**digits + 1e-9) / 10.0**digits, max(digits, 0))


def _rounded_down(value: float) -> float:
    """Return a number > 0 of two digits, no larger."""
    digits = 1 - floor(log10(value))
    return round(floor(value * 10.0**digits + 1e-9) / 10.0**digits, max(digits, 0))
