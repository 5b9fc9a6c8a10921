"""Disturbances that vehicles share as files state them, to and from the vehicles' parts in them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from graphlib import CycleError, TopologicalSorter
from itertools import pairwise

import numpy as np

from radmpc.arrays import Matrix
from radmpc.errors import ScenarioError
from radmpc.io.native.noise import correlation_of, encode_correlation
from radmpc.io.native.schema import SharedDisturbanceSpec
from radmpc.model.noise.shared import SharedDisturbance
from radmpc.model.vehicle import Vehicle

__all__ = ["encode_shared", "with_shared"]

_DEFAULT = "default"
"""Stands for every vehicle that is not named itself."""


def with_shared(
    vehicles: Sequence[Vehicle], specs: Sequence[SharedDisturbanceSpec], dt: float
) -> tuple[Vehicle, ...]:
    """Return vehicles with their parts in shared disturbances.

    Parameters
    ----------
    vehicles : sequence of Vehicle
        Without any.
    specs : sequence of SharedDisturbanceSpec
        What the file gives.
    dt : float
        Step [s].

    Raises
    ------
    ScenarioError
        If a name is that of no vehicle or stands twice, or a value is not allowed.
    """
    names = [vehicle.name for vehicle in vehicles]
    parts: dict[str, list[SharedDisturbance]] = {name: [] for name in names}
    seen: set[str] = set()
    for k, spec in enumerate(specs):
        path = ("shared_disturbances", k)
        if spec.name in seen:
            raise ScenarioError(f"{spec.name!r} stands there twice", (*path, "name"))
        seen.add(spec.name)
        unknown = [name for name in spec.on if name not in {*names, _DEFAULT}]
        if unknown:
            text = f"must name vehicles, or be {_DEFAULT}; got {unknown[0]!r}"
            raise ScenarioError(text, (*path, "on", unknown[0]))
        if all(spec.on.get(name, spec.on.get(_DEFAULT)) is None for name in names):
            text = f"must name a vehicle that it acts on, or {_DEFAULT}; got nobody"
            raise ScenarioError(text, (*path, "on"))
        try:
            rho = correlation_of(spec.time_constant, spec.correlation, dt)
        except ScenarioError as error:
            raise error.under(*path) from error
        for vehicle in vehicles:
            key = vehicle.name if vehicle.name in spec.on else _DEFAULT
            given = spec.on.get(key)
            if given is None:
                continue
            matrix = _matrix(given, vehicle.system.num_states, (*path, "on", key))
            try:
                part = SharedDisturbance(spec.name, matrix, spec.covariance, rho)
            except ScenarioError as error:
                raise error.under(*path) from error
            parts[vehicle.name].append(part)
    return tuple(
        replace(vehicle, shared=tuple(parts[vehicle.name])) if parts[vehicle.name] else vehicle
        for vehicle in vehicles
    )


def _matrix(
    given: float | list[float] | list[list[float]], num_states: int, path: tuple[str | int, ...]
) -> Matrix:
    """Return G from a number, a diagonal or its rows."""
    array = np.asarray(given, dtype=np.float64)
    if array.ndim == 0:
        return np.asarray(array * np.eye(num_states))
    if len(array) != num_states:
        kind = "numbers" if array.ndim == 1 else "rows"
        raise ScenarioError(f"must have {num_states} {kind} like the state, got {len(array)}", path)
    return np.diag(array) if array.ndim == 1 else array


def encode_shared(vehicles: Sequence[Vehicle], dt: float) -> list[dict[str, object]]:
    """Return the entries of a file for the disturbances that vehicles share.

    Parameters
    ----------
    vehicles : sequence of Vehicle
        All of a scenario.
    dt : float
        Step [s].
    """
    sources: dict[str, SharedDisturbance] = {}
    for vehicle in vehicles:
        for part in vehicle.shared:
            sources.setdefault(part.name, part)
    entries = []
    for name in _in_order(vehicles, sources):
        rows: dict[str, object] = {}
        source = sources[name]
        for vehicle in vehicles:
            own = [part.matrix.tolist() for part in vehicle.shared if part.name == name]
            rows[vehicle.name] = own[0] if own else None
        first = rows[vehicles[0].name]
        if first is not None and all(repr(one) == repr(first) for one in rows.values()):
            rows = {_DEFAULT: first}
        elif _DEFAULT not in rows:
            rows = {vehicle: one for vehicle, one in rows.items() if one is not None}
        entry: dict[str, object] = {"name": name, "covariance": source.covariance.tolist()}
        if source.correlation > 0.0:
            entry |= encode_correlation(source.correlation, dt)
        entries.append({**entry, "on": rows})
    return entries


def _in_order(vehicles: Sequence[Vehicle], names: Iterable[str]) -> list[str]:
    """Return sources as every vehicle has its own, if all agree: sums add up in that order."""
    sorter: TopologicalSorter[str] = TopologicalSorter({name: () for name in names})
    for vehicle in vehicles:
        for before, name in pairwise(part.name for part in vehicle.shared):
            sorter.add(name, before)
    try:
        return list(sorter.static_order())
    except CycleError:
        return list(names)
