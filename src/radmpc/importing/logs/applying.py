"""Identified noise in a scenario, and as a file of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from datetime import UTC, datetime

import numpy as np

from radmpc.arrays import Matrix
from radmpc.errors import ScenarioError
from radmpc.identification.estimate import Estimate
from radmpc.identification.identify import Identification
from radmpc.identification.sharing import nearest_covariance
from radmpc.importing.logs.block import noise_block, white_covariance
from radmpc.io.text.yaml_writing import write_yaml
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.version import __version__

__all__ = ["noise_text", "provenance", "recorded", "with_noise"]

_EVIDENCE = {
    "commands": "with logged commands",
    "references": "with logged references",
    "states": "from states alone",
}


def provenance(found: Identification, day: str) -> dict[str, object]:
    """Return from what and when noise was identified, as plain values for ``source``.

    Parameters
    ----------
    found : Identification
        What logs tell.
    day : str
        When that was found out.
    """
    content: dict[str, object] = {
        "by": f"radmpc {__version__} identify",
        "on": day,
        "logs": list(found.sources),
        "steps": found.pooled.num_steps,
        "dt": found.model.dt,
        "from": _EVIDENCE[found.evidence],
        "independent_steps": round(found.pooled.worth),
    }
    if found.start is not None:
        content["recorded"] = recorded(found.start)
    return content


def recorded(start: float) -> str:
    """Return a time since 1970 in words.

    Parameters
    ----------
    start : float
        Seconds since 1970.
    """
    return datetime.fromtimestamp(start, tz=UTC).strftime("%Y-%m-%d %H:%M UTC")


def noise_text(found: Identification, day: str) -> str:
    """Return what was identified as YAML that a scenario takes as it is.

    Parameters
    ----------
    found : Identification
        What logs tell.
    day : str
        When that was found out.

    Returns
    -------
    str
        ``defaults`` or ``vehicles``; from what and when, and what the format does not take yet, as
        comments.
    """
    block = noise_block(found)
    lines = ["Noise of vehicles, for a scenario."]
    lines += [f"{key}: {_told(entry)}" for key, entry in provenance(found, day).items()]
    if any(one.color > 0.0 for one in found.groups) and _is_pending(block.pending, "disturbance"):
        lines.append(
            "The noise has memory, which this format does not take: the covariance below is that of"
        )
        lines.append("white noise that leads to deviations at least as large.")
    if found.evidence == "states":
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
    scenario: Scenario, found: Identification, day: str
) -> tuple[Scenario, tuple[str, ...]]:
    """Return a scenario with the noise, and the feedback, that were identified.

    Parameters
    ----------
    scenario : Scenario
        Of double integrators, or of single ones if no velocities were logged.
    found : Identification
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
    """
    if abs(scenario.dt - found.model.dt) > 1e-9 * scenario.dt:
        raise ScenarioError(
            f"is {scenario.dt:g} s, and the noise is that of steps of {found.model.dt:g} s", ("dt",)
        )
    by_name = {one.vehicles[0]: one for one in found.each} if found.differ else {}
    vehicles, warnings = [], []
    for i, vehicle in enumerate(scenario.vehicles):
        one = by_name.get(vehicle.name, found.pooled)
        if found.differ and vehicle.name not in by_name:
            warnings.append(
                f"vehicle {vehicle.name!r} is in no log: it gets the mean of the others"
            )
        order = _order(vehicle, found, i)
        vehicles.append(_changed(vehicle, one, order))
    pending = noise_block(found).pending
    if pending:
        keys = {key for fields in pending.values() if isinstance(fields, dict) for key in fields}
        names = ", ".join(sorted(keys | (set(pending) & {"shared_disturbances"})))
        warnings.append(f"identified, and not a part of scenarios yet: {names}")
    source = {**(scenario.source or {}), "noise": provenance(found, day)}
    return replace(scenario, vehicles=tuple(vehicles), source=source), tuple(warnings)


def _order(vehicle: Vehicle, found: Identification, index: int) -> list[int]:
    """Return where the estimates' states stand in a vehicle's."""
    system = vehicle.system
    if system.dimension != found.model.dimension:
        raise ScenarioError(
            f"vehicle {vehicle.name!r} has {system.dimension} axes, the logs have "
            f"{found.model.dimension}",
            ("vehicles", index),
        )
    rates = system.rates
    if found.model.has_velocity and rates is not None:
        return [*system.position, *rates[0]]
    is_single = system.num_states == system.dimension and np.allclose(
        system.A, np.eye(len(system.A))
    )
    if not found.model.has_velocity and is_single:
        return list(system.position)
    wanted = "a double integrator" if found.model.has_velocity else "a single integrator"
    lack = "" if found.model.has_velocity else " (the logs have no velocities)"
    raise ScenarioError(
        f"must be those of {wanted}{lack}: noise of another model does not apply",
        ("vehicles", index, "dynamics"),
    )


def _changed(vehicle: Vehicle, one: Estimate, order: list[int]) -> Vehicle:
    """Return a vehicle with an estimate's covariance and gain."""
    covariance = np.zeros((len(order), len(order)))
    covariance[np.ix_(order, order)] = nearest_covariance(white_covariance(one))
    gain: Matrix | None = vehicle.gain
    if one.gain is not None and one.gain.excludes_zero:
        gain = np.zeros(one.gain.value.shape)
        gain[:, order] = one.gain.value
    return replace(vehicle, disturbance_covariance=covariance, gain=gain)
