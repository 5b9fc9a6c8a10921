"""Feedback that makes deviations grow instead of bringing them back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from radmpc.arrays import Matrix
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.planners.cures.variants import WEIGHTS, regulated
from radmpc.preflight.reserve import reserve_of

__all__ = ["is_unstable", "loop_radius", "stable_cures", "unstable_text"]

_ROUNDING = 1e-6
"""By how much an eigenvalue of 1 may come out larger [-]: the double one of a double integrator by
the root of what numbers are rounded by."""


def loop_radius(vehicle: Vehicle) -> float:
    """Return by how much deviations grow per step in the long run: the spectral radius of A + BK.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.

    Returns
    -------
    float
        At most 1 where they do not grow exponentially [-]; of A without feedback.
    """
    system, gain = vehicle.system, vehicle.gain
    loop = system.A if gain is None else system.A + system.B @ gain
    return float(np.abs(np.linalg.eigvals(loop)).max())


def is_unstable(vehicle: Vehicle) -> bool:
    """Whether a vehicle has feedback under which deviations grow exponentially.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    """
    return vehicle.gain is not None and loop_radius(vehicle) > 1.0 + _ROUNDING


def unstable_text(vehicle: Vehicle) -> str:
    """Return what is to be said of feedback that is unstable.

    Parameters
    ----------
    vehicle : Vehicle
        With such feedback.
    """
    text = (
        f"feedback is unstable: A + BK has a spectral radius of {loop_radius(vehicle):.3g}, "
        "so deviations grow from step to step"
    )
    if _is_turned(vehicle):
        text += ", and its sign is opposite to a regulator's (it adds K (x - mean))"
    return text


def stable_cures(scenario: Scenario, vehicle: Vehicle, share: float) -> str:
    """Return what makes feedback stable.

    Parameters
    ----------
    scenario : Scenario
        Whose horizon counts.
    vehicle : Vehicle
        Of it, with feedback that is unstable.
    share : float
        The largest share of the control limit that feedback may keep back [-].

    Returns
    -------
    str
        In the imperative, joined by "or"; empty where nothing that was tried does.
    """
    found = []
    gain = vehicle.gain
    if gain is not None and _is_turned(vehicle):
        turned = replace(vehicle, gain=-gain)
        if not is_unstable(turned):
            found.append("turn the sign of the gain")
    for weight in WEIGHTS:
        candidate = regulated(vehicle, weight)
        if candidate is None or is_unstable(candidate):
            continue
        bounds = candidate.control_bounds(candidate.covariances(scenario.horizon))
        if reserve_of(candidate, bounds).share <= share:
            found.append(f"take the gain of a regulator (lqr with Q = 1, R = {weight:g} does)")
            break
    return ", or ".join(found)


def _is_turned(vehicle: Vehicle) -> bool:
    """Whether a gain points away from where a regulator's does."""
    regulator = regulated(vehicle, 1.0)
    mine: Matrix | None = vehicle.gain
    if mine is None or regulator is None or regulator.gain is None:
        return False
    return float(np.sum(mine * regulator.gain)) < 0.0
