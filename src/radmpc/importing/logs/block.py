"""What was identified as scenarios spell it: fields of ``defaults`` or ``vehicles``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from radmpc.arrays import Matrix, as_covariance
from radmpc.errors import ScenarioError
from radmpc.identification.estimate import Estimate
from radmpc.identification.identify import Identification
from radmpc.identification.model import StepModel
from radmpc.identification.sharing import against_others, nearest_covariance, own_part
from radmpc.identification.unknown import growth_of_loop, safe_constant
from radmpc.importing.logs.sensed import feeds_measurement, steered_by_noise
from radmpc.records import dataclass

__all__ = [
    "FEWEST_SAMPLES",
    "KEYS",
    "Block",
    "acts_on_measured",
    "noise_block",
    "reordered",
    "vehicle_fields",
]

KEYS: Mapping[str, bool] = {
    "dynamics": True,
    "feedback": True,
    "disturbance_covariance": True,
    "disturbance": True,  # {covariance, time_constant}
    "drift": True,  # {velocity} or {state}
    "measurement": True,  # {of, covariance}
    "covariance_samples": True,  # beside `vehicles`, not in them
    "shared_disturbances": True,  # beside `vehicles`, not in them
}
"""Keys that identification has values for, and whether the scenario format takes them yet. What it
does not take is written as a comment."""

_MOST_SAMPLES = 1000.0
"""Independent steps [-] above which a covariance counts as known: at a risk of 1e-3 the margin
grows by less than 0.3 % for it."""

FEWEST_SAMPLES = 3
"""Least that scenarios take [-]."""

_DIGITS = 6
"""Digits that are written: far more than the logs tell."""

Fields = dict[str, object]


@dataclass(frozen=True, slots=True)
class Block:
    """A part of a scenario file.

    Attributes
    ----------
    content : mapping
        ``defaults``, or ``vehicles`` with names where they differ; keys that the format takes;
        beside them what holds for all.
    pending : mapping
        By ``defaults``, or vehicle, or ``shared_disturbances``: what the format does not take yet.
    """

    content: Mapping[str, object]
    pending: Mapping[str, object]


def noise_block(identified: Identification) -> Block:
    """Return what was identified as a scenario file spells it.

    Parameters
    ----------
    identified : Identification
        What logs tell.
    """
    pending: Fields = {}
    entries = []
    for one in identified.groups:
        taken, rest = vehicle_fields(one, identified)
        name = one.vehicles[0] if identified.differ else "defaults"
        entries.append({"name": name, **taken} if identified.differ else taken)
        if rest:
            pending[name] = rest
    content: Fields = {"vehicles": entries} if identified.differ else {"defaults": entries[0]}
    least = min(one.worth for one in identified.groups)
    if least < _MOST_SAMPLES:
        place = content if KEYS["covariance_samples"] else pending
        place["covariance_samples"] = max(round(least), FEWEST_SAMPLES)
    shared = identified.shared
    if shared is not None and shared.is_sure:
        common: Fields = {
            "name": "shared",
            "covariance": _rows(nearest_covariance(shared.covariance.value)),
            "on": {"default": _rows(np.eye(identified.model.num_states))},
        }
        if identified.pooled.time_constant is not None:
            common["time_constant"] = _short(safe_constant(identified.pooled.time_constant))
        place = content if KEYS["shared_disturbances"] else pending
        place["shared_disturbances"] = [common]
    return Block(content, pending)


def vehicle_fields(one: Estimate, identified: Identification) -> tuple[Fields, Fields]:
    """Return a vehicle's fields: those that the format takes, and the others.

    Parameters
    ----------
    one : Estimate
        Of the vehicle, or of all.
    identified : Identification
        What it is a part of.
    """
    fields = _fields(one, identified)
    rest = {key: entry for key, entry in fields.items() if not KEYS[key]}
    taken = {key: entry for key, entry in fields.items() if KEYS[key]}
    if "disturbance_covariance" not in taken and "disturbance" not in taken:
        taken["disturbance_covariance"] = _rows(_white_covariance(one))
    return taken, rest


def reordered(fields: Mapping[str, object], order: Sequence[int]) -> Fields:
    """Return a vehicle's fields for a state in another order.

    Parameters
    ----------
    fields : mapping
        For positions, then velocities.
    order : sequence of int
        Where each of these stands in the state.
    """
    identified: Fields = dict(fields)
    places = np.argsort(order)

    def turned(covariance: object) -> list[list[float]]:
        """Return a covariance's rows in the new order."""
        rows: list[list[float]] = np.array(covariance)[np.ix_(places, places)].tolist()
        return rows

    if "disturbance_covariance" in identified:
        identified["disturbance_covariance"] = turned(identified["disturbance_covariance"])
    disturbance, feedback = identified.get("disturbance"), identified.get("feedback")
    if isinstance(disturbance, dict):
        identified["disturbance"] = {**disturbance, "covariance": turned(disturbance["covariance"])}
    if isinstance(feedback, dict):
        identified["feedback"] = {"gain": np.array(feedback["gain"])[:, places].tolist()}
    drift, measurement = identified.get("drift"), identified.get("measurement")
    if isinstance(drift, dict) and "state" in drift:
        identified["drift"] = {"state": np.array(drift["state"])[places].tolist()}
    if isinstance(measurement, dict):
        identified["measurement"] = {
            **measurement,
            "of": [int(order[i]) for i in measurement["of"]],
        }
    return identified


def _white_covariance(one: Estimate) -> Matrix:
    """Return the covariance of white noise that leads to deviations at least as large.

    The spectrum of noise with autocorrelation ρ is nowhere above (1 + ρ) / (1 − ρ) times that of
    white noise, so no linear feedback makes more of it. White noise stays what it is.

    Parameters
    ----------
    one : Estimate
        With or without color.
    """
    color = max(one.color, 0.0)
    return nearest_covariance(one.covariance.value) * (1.0 + color) / (1.0 - color)


def _fields(one: Estimate, identified: Identification) -> Fields:
    """Return all fields, whether or not the format takes them."""
    model = identified.model
    d = model.dimension
    fields: Fields = {}
    if not model.has_velocity:
        fields["dynamics"] = {
            "A": np.eye(d).tolist(),
            "B": (model.dt * np.eye(d)).tolist(),
            "position": list(range(d)),
        }
    has_shared = (
        identified.shared is not None and identified.shared.is_sure and KEYS["shared_disturbances"]
    )
    own = own_part(one.covariance.value, identified.shared if has_shared else None)
    own = own * against_others(one.vehicles, identified.shared)
    has_feedback = _has_feedback(one, model)
    is_fed = acts_on_measured(one, model)
    if is_fed:
        own = own + steered_by_noise(one, model)
    if one.time_constant is None:
        fields["disturbance_covariance"] = _rows(own)
    else:
        constant = _short(safe_constant(one.time_constant))
        fields["disturbance"] = {"covariance": _rows(own), "time_constant": constant}
    if one.gain is not None and has_feedback:
        fields["feedback"] = {"gain": [[_short(entry) for entry in row] for row in one.gain.value]}
    if one.has_drift:
        fields["drift"] = _drift(one, identified)
    if one.measurement is not None and not is_fed:
        of = np.flatnonzero(np.diag(one.measurement.low) > 0.0)
        if of.size:
            seen = one.measurement.value[np.ix_(of, of)]
            fields["measurement"] = {"of": of.tolist(), "covariance": _rows(seen)}
    return fields


def _has_feedback(one: Estimate, model: StepModel) -> bool:
    """Whether feedback is sure, and settles."""
    gain = one.gain
    return gain is not None and gain.excludes_zero and growth_of_loop(gain, model) <= 1.0


def acts_on_measured(one: Estimate, model: StepModel) -> bool:
    """Whether feedback is written that acts on measured states, so that their noise disturbs.

    A scenario's ``measurement`` would stand for a filter before the feedback, which logs of such
    vehicles rule out.

    Parameters
    ----------
    one : Estimate
        Of the vehicle, or of all.
    model : StepModel
        Its dynamics.
    """
    return _has_feedback(one, model) and feeds_measurement(one)


def _drift(one: Estimate, identified: Identification) -> Fields:
    """Return the drift as a current where it moves positions alone, else per step."""
    d = identified.model.dimension
    value = one.drift.value
    pushes = (one.drift.low[d:] > 0.0) | (one.drift.high[d:] < 0.0)
    if pushes.any():
        return {"state": [_short(entry) for entry in value]}
    return {"velocity": [_short(entry / identified.model.dt) for entry in value[:d]]}


def _rows(matrix: Matrix) -> list[list[float]]:
    """Return a covariance's rows with few digits, as far as it stays one."""
    identified = nearest_covariance(matrix)
    rows = [[_short(entry) for entry in row] for row in identified]
    try:
        as_covariance(rows, len(rows), ())
    except ScenarioError:
        rows = identified.tolist()
    return rows


def _short(value: float) -> float:
    """Return a number with few digits."""
    return float(f"{value:.{_DIGITS}g}")
