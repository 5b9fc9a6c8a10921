"""Identified noise in a scenario, and as a file of its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from typing import Any

import numpy as np

from radmpc.errors import FileFormatError, ScenarioError
from radmpc.identification.estimate import Estimate
from radmpc.identification.identify import Identification
from radmpc.identification.intervals import Interval
from radmpc.importing.logs.block import (
    FEWEST_SAMPLES,
    acts_on_measured,
    noise_block,
    reordered,
    vehicle_fields,
)
from radmpc.io.native.decoding import decode_scenario
from radmpc.io.native.encoding import encode_scenario
from radmpc.io.text.yaml_writing import write_yaml
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.records import replace
from radmpc.version import __version__
from radmpc.wording import count_text

__all__ = ["check_worth", "noise_text", "provenance", "recorded", "with_noise"]

_SHARED = "shared_disturbances"

_SAMPLES = "covariance_samples"

_EVIDENCE = {
    "commands": "with logged commands",
    "references": "with logged references",
    "states": "from states alone",
}


def provenance(identified: Identification, day: str) -> dict[str, object]:
    """Return from what and when noise was identified, as plain values for ``source``.

    Parameters
    ----------
    identified : Identification
        What logs tell.
    day : str
        When that was found out.
    """
    content: dict[str, object] = {
        "by": f"radmpc {__version__} identify",
        "on": day,
        "logs": list(identified.sources),
        "steps": identified.pooled.num_steps,
        "dt": identified.model.dt,
        "from": _EVIDENCE[identified.evidence],
        "independent_steps": round(identified.pooled.worth),
    }
    if identified.start is not None:
        content["recorded"] = recorded(identified.start)
    return content


def recorded(start: float) -> str:
    """Return a time since 1970 in words.

    Parameters
    ----------
    start : float
        Seconds since 1970.
    """
    return datetime.fromtimestamp(start, tz=UTC).strftime("%Y-%m-%d %H:%M UTC")


def check_worth(identified: Identification) -> None:
    """Refuse to write noise that hardly anything is known of.

    Parameters
    ----------
    identified : Identification
        What logs tell.

    Raises
    ------
    FileFormatError
        If the logs are worth fewer independent steps than scenarios take for a covariance.
    """
    least = min(one.worth for one in identified.groups)
    if least < FEWEST_SAMPLES:
        raise FileFormatError(
            f"{', '.join(identified.sources)}: is worth about "
            f"{count_text(round(least), 'independent step')}, and "
            f"noise is written from {FEWEST_SAMPLES} on: log more"
        )


def noise_text(identified: Identification, day: str) -> str:
    """Return what was identified as YAML that a scenario takes as it is.

    Parameters
    ----------
    identified : Identification
        What logs tell.
    day : str
        When that was found out.

    Returns
    -------
    str
        ``defaults`` or ``vehicles``; from what and when, and what the format does not take yet, as
        comments.

    Raises
    ------
    FileFormatError
        If the logs tell too little for any scenario.
    """
    check_worth(identified)
    block = noise_block(identified)
    lines = ["Noise of vehicles, for a scenario."]
    lines += [f"{key}: {_told(entry)}" for key, entry in provenance(identified, day).items()]
    if any(one.color > 0.0 for one in identified.groups) and _is_pending(
        block.pending, "disturbance"
    ):
        lines.append(
            "The noise has memory, which this format does not take: the covariance below is that of"
        )
        lines.append("white noise that leads to deviations at least as large.")
    if any(acts_on_measured(one, identified.model) for one in identified.groups):
        lines.append("Noise of the sensors counts as disturbance, and there is no `measurement`:")
        lines.append("the feedback acts on the measured states, not on those of a filter.")
    if identified.evidence == "states":
        lines.append("Maneuvers count as noise here: too large where the vehicles maneuvered.")
    if block.pending:
        lines.append("Identified, and not a part of this format yet:")
        lines += [f"  {line}" for line in write_yaml(block.pending).splitlines()]
    return "".join(f"# {line}\n" for line in lines) + write_yaml(block.content)


def _told(entry: object) -> str:
    """Return a plain value on a line."""
    return ", ".join(map(str, entry)) if isinstance(entry, list) else str(entry)


def _is_pending(pending: Mapping[str, object], key: str) -> bool:
    """Whether any vehicle has a key that the format does not take."""
    return any(isinstance(fields, Mapping) and key in fields for fields in pending.values())


def with_noise(
    scenario: Scenario, identified: Identification, day: str
) -> tuple[Scenario, tuple[str, ...]]:
    """Return a scenario with the noise, and the feedback, that were identified.

    Parameters
    ----------
    scenario : Scenario
        Of double integrators, or of single ones if no velocities were logged.
    identified : Identification
        At the scenario's step.
    day : str
        When that was found out; goes to ``source``.

    Returns
    -------
    scenario : Scenario
        With the vehicles' new covariances and gains.
    warnings : tuple of str
        What could not be taken over.

    Raises
    ------
    ScenarioError
        If step or dynamics are others than those of the estimates.
    FileFormatError
        If the logs tell too little for any scenario.
    """
    check_worth(identified)
    if abs(scenario.dt - identified.model.dt) > 1e-9 * scenario.dt:
        raise ScenarioError(
            f"is {scenario.dt:g} s, and the noise is that of steps of {identified.model.dt:g} s",
            ("dt",),
        )
    content = encode_scenario(scenario)
    orders = [_order(vehicle, identified, i) for i, vehicle in enumerate(scenario.vehicles)]
    entries, warnings = _entries(scenario, content, identified, orders)
    block = noise_block(identified)
    if block.pending:
        parts = [part for part in block.pending.values() if isinstance(part, dict)]
        keys = {key for part in parts for key in part} | set(block.pending) & {_SHARED}
        warnings.append(f"identified, and not a part of scenarios yet: {', '.join(sorted(keys))}")
    if _SHARED in content and _SHARED not in block.content:
        warnings.append(
            "the scenario's shared disturbances are left out: the logs do not tell what vehicles "
            "have in common, so all of their noise counts as their own"
        )
    source = {**(scenario.source or {}), "noise": provenance(identified, day)}
    kept = {key: part for key, part in content.items() if key not in {_SHARED, _SAMPLES}}
    names = [vehicle.name for vehicle in scenario.vehicles]
    beside: dict[str, object] = dict(_shared(block.content, dict(zip(names, orders, strict=True))))
    if _SAMPLES in block.content:
        beside[_SAMPLES] = block.content[_SAMPLES]
    # By way of the format: what it takes, scenarios have.
    changed = {**kept, "defaults": {}, "vehicles": entries, **beside, "source": source}
    return decode_scenario(changed), tuple(warnings)


def _shared(
    content: Mapping[str, Any], orders: Mapping[str, Sequence[int]]
) -> dict[str, list[dict[str, object]]]:
    """Return what vehicles share, for states in their own order."""
    if _SHARED not in content:
        return {}
    entries = []
    for entry in content[_SHARED]:
        rows = entry["on"]["default"]
        on = {name: [rows[k] for k in np.argsort(order)] for name, order in orders.items()}
        entries.append({**entry, "on": on})
    return {_SHARED: entries}


def _entries(
    scenario: Scenario,
    content: Mapping[str, Any],
    identified: Identification,
    orders: Sequence[Sequence[int]],
) -> tuple[list[dict[str, object]], list[str]]:
    """Return the vehicles of a scenario's file with their new noise."""
    by_name = {one.vehicles[0]: one for one in identified.each} if identified.differ else {}
    defaults, given = content.get("defaults", {}), content["vehicles"]
    unknown = _largest(identified.each) if identified.differ else identified.pooled
    entries, warnings = [], []
    for i, (vehicle, entry) in enumerate(zip(scenario.vehicles, given, strict=True)):
        if identified.differ and vehicle.name not in by_name:
            warnings.append(
                f"vehicle {vehicle.name!r} is in no log, and the others differ: it gets the "
                "largest noise of any of them"
            )
        one = by_name.get(vehicle.name, unknown)
        fields = reordered(vehicle_fields(one, identified)[0], orders[i])
        fields.pop("dynamics", None)
        replaced = {"disturbance", "disturbance_covariance"}
        replaced |= set() if identified.evidence == "states" else {"drift"}
        if acts_on_measured(one, identified.model):
            replaced |= {"measurement"}
        kept = {k: part for k, part in {**defaults, **entry}.items() if k not in replaced}
        entries.append({**kept, **fields})
    return entries, warnings


def _largest(each: Sequence[Estimate]) -> Estimate:
    """Return an estimate whose variances and time constant are the largest of all."""
    sizes = np.array([np.diag(one.covariance.value) for one in each])
    mean = np.maximum(sizes.mean(axis=0), 1e-300)
    one = each[int(np.argmax((sizes / mean).sum(axis=1)))]
    own = np.maximum(np.diag(one.covariance.value), 1e-300)
    grown = np.sqrt(sizes.max(axis=0) / own)
    covariance = np.array(one.covariance.value) * np.outer(grown, grown)
    # What never moved in that vehicle's log has no row to be scaled.
    np.fill_diagonal(covariance, sizes.max(axis=0))
    constants = [other for other in each if other.time_constant is not None]
    longest = max(constants, key=lambda other: other.color, default=one)
    return replace(
        one,
        covariance=Interval(covariance, one.covariance.low, covariance),
        color=longest.color,
        time_constant=longest.time_constant,
    )


def _order(vehicle: Vehicle, identified: Identification, index: int) -> list[int]:
    """Return where the estimates' states stand in a vehicle's."""
    system = vehicle.system
    if system.dimension != identified.model.dimension:
        raise ScenarioError(
            f"vehicle {vehicle.name!r} has {system.dimension} axes, the logs have "
            f"{identified.model.dimension}",
            ("vehicles", index),
        )
    rates = system.rates
    if identified.model.has_velocity and rates is not None:
        return [*system.position, *rates[0]]
    is_single = system.num_states == system.dimension and np.allclose(
        system.A, np.eye(len(system.A))
    )
    if not identified.model.has_velocity and is_single:
        return list(system.position)
    wanted = "a double integrator" if identified.model.has_velocity else "a single integrator"
    lack = "" if identified.model.has_velocity else " (the logs have no velocities)"
    raise ScenarioError(
        f"must be those of {wanted}{lack}: noise of another model does not apply",
        ("vehicles", index, "dynamics"),
    )
