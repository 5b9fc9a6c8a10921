"""Identified noise as plain values."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.identification.estimate import Estimate
from radmpc.identification.identify import Identification
from radmpc.identification.intervals import Interval
from radmpc.importing.logs.applying import recorded
from radmpc.importing.logs.block import noise_block

__all__ = ["identification_json", "plain_array"]


def identification_json(identified: Identification) -> dict[str, object]:
    """Return what was identified as plain values.

    Parameters
    ----------
    identified : Identification
        What logs tell.
    """
    block = noise_block(identified)
    shared = identified.shared
    return {
        "logs": list(identified.sources),
        "recorded": None if identified.start is None else recorded(identified.start),
        "dt": identified.model.dt,
        "dimension": identified.model.dimension,
        "model": "double_integrator" if identified.model.has_velocity else "single_integrator",
        "evidence": identified.evidence,
        "differ": identified.differ,
        "groups": [_group_json(one) for one in identified.groups],
        "shared": None
        if shared is None
        else {
            "vehicles": list(shared.vehicles),
            "is_sure": shared.is_sure,
            "is_mixed": shared.is_mixed,
            "alike": [list(pair) for pair in shared.alike],
            "opposed": [list(pair) for pair in shared.opposed],
            "opposition": shared.opposition,
            "share": _interval_json(shared.share),
            "covariance": _interval_json(shared.covariance),
        },
        "block": dict(block.content),
        "pending": dict(block.pending),
        "unknown": list(identified.unknown),
        "warnings": list(identified.warnings),
    }


def _group_json(one: Estimate) -> dict[str, object]:
    """Return one estimate as plain values."""
    kind = one.tails
    return {
        "vehicles": list(one.vehicles),
        "steps": one.num_steps,
        "independent_steps": one.worth,
        "is_bound": one.is_bound,
        "covariance": _interval_json(one.covariance),
        "drift": _interval_json(one.drift),
        "has_drift": one.has_drift,
        "gain": _interval_json(one.gain),
        "time_constant": _interval_json(one.time_constant),
        "measurement": _interval_json(None if one.measurement is None else _sure(one.measurement)),
        "gaussian": None if kind is None else kind.is_gaussian,
        "anderson_darling": None if kind is None else kind.chance,
        "excess_kurtosis": None if kind is None else kind.excess_kurtosis,
        "freedom": None
        if kind is None
        else {
            "value": plain_array(np.array(kind.freedom)),
            "low": plain_array(np.array(kind.freedom_low)),
            "high": plain_array(np.array(kind.freedom_high)),
        },
    }


def _sure(measurement: Interval) -> Interval:
    """Return measurement noise without lower ends of variances that may be none."""
    low = np.array(measurement.low)
    may_be_none = np.diag(low) <= 0.0
    low[may_be_none, may_be_none] = np.nan
    return Interval(measurement.value, low, measurement.high)


def _interval_json(interval: Interval | None) -> dict[str, object] | None:
    """Return values and ends."""
    if interval is None:
        return None
    return {name: plain_array(getattr(interval, name)) for name in ("value", "low", "high")}


def plain_array(array: npt.NDArray[np.float64]) -> object:
    """Return an array as lists; what is not finite is null.

    Parameters
    ----------
    array : array
        Of any shape.
    """
    if array.ndim == 0:
        return float(array) if np.isfinite(array) else None
    return [plain_array(part) for part in array]
