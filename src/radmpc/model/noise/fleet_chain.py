"""Vehicles that share disturbances, as one linear system under noise that is new at every step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from radmpc.arrays import Indices, Matrix
from radmpc.model.dynamics import LinearSystem
from radmpc.model.noise.shared import SharedDisturbance, lasting_parts
from radmpc.model.noise.spread import Noise
from radmpc.records import dataclass

__all__ = ["FleetChain", "Shaken", "fleet_chain"]


class Shaken(Protocol):
    """A vehicle, as far as its noise goes."""

    @property
    def system(self) -> LinearSystem:
        """Its dynamics."""

    @property
    def noise(self) -> Noise:
        """What shakes it."""


@dataclass(frozen=True, slots=True, eq=False)
class FleetChain:
    """Vehicles as one system.

    Attributes
    ----------
    rows : tuple of (2 n + s,) int array
        Of each: where in η its deviation, its own disturbance and those it shares and that last
        stand, in this order; −1 is a disturbance that is new at every step.
    free : (q, q) array
        What becomes of η without control.
    initial, fresh : (q, q) array
        Covariance of η at k = 0, and of what is new at every step.
    """

    rows: tuple[Indices, ...]
    free: Matrix
    initial: Matrix
    fresh: Matrix


def fleet_chain(vehicles: Sequence[Shaken]) -> FleetChain:
    """Return vehicles that share disturbances as one system.

    Parameters
    ----------
    vehicles : sequence of Shaken
        The vehicles, whose states come first in η.
    """
    places, size = _places(vehicles)
    free, initial, fresh = np.zeros((3, size, size))
    rows = []
    for vehicle, (state, own, shared) in zip(vehicles, places, strict=True):
        system, noise = vehicle.system, vehicle.noise
        free[np.ix_(state, state)] = system.A
        initial[np.ix_(state, state)] = noise.initial
        if noise.correlation == 0.0:
            fresh[np.ix_(state, state)] = noise.disturbance
        else:
            free[state, own] = 1.0
            _lasts((free, initial, fresh), own, noise.disturbance, noise.correlation)
        for part, at in zip(lasting_parts(noise.shared), shared, strict=True):
            free[np.ix_(state, at)] = part.matrix
            _lasts((free, initial, fresh), at, part.covariance, part.correlation)
        rows.append(np.concatenate([state, own, *shared]))
    fresh += _shared_and_new(vehicles, [state for state, _, _ in places], size)
    _begin((vehicles, rows), initial)
    return FleetChain(tuple(rows), free, initial, fresh)


def _places(
    vehicles: Sequence[Shaken],
) -> tuple[list[tuple[Indices, Indices, list[Indices]]], int]:
    """Return where states, own and shared disturbances that last stand in η, and its length."""
    states, end = [], 0
    for vehicle in vehicles:
        states.append(np.arange(end, end + vehicle.system.num_states))
        end = int(states[-1][-1]) + 1
    found, sources = [], dict[str, Indices]()
    for vehicle, state in zip(vehicles, states, strict=True):
        own = np.full(state.size, -1)
        if vehicle.noise.correlation > 0.0:
            own, end = np.arange(end, end + state.size), end + state.size
        shared = []
        for part in lasting_parts(vehicle.noise.shared):
            if part.name not in sources:
                sources[part.name], end = np.arange(end, end + part.size), end + part.size
            shared.append(sources[part.name])
        found.append((state, own, shared))
    return found, end


def _lasts(
    system: tuple[Matrix, Matrix, Matrix], at: Indices, covariance: Matrix, rho: float
) -> None:
    """Write down a disturbance that lasts."""
    free, initial, fresh = system
    free[at, at] = rho
    initial[np.ix_(at, at)] = covariance
    fresh[np.ix_(at, at)] = (1.0 - rho**2) * covariance


def _shared_and_new(vehicles: Sequence[Shaken], states: Sequence[Indices], size: int) -> Matrix:
    """Return what shared disturbances that are new at every step add to η."""
    acts: dict[str, tuple[SharedDisturbance, Matrix]] = {}
    for vehicle, state in zip(vehicles, states, strict=True):
        for part in vehicle.noise.shared:
            if part.correlation == 0.0:
                _, effect = acts.setdefault(part.name, (part, np.zeros((size, part.size))))
                effect[state] = part.matrix
    total = np.zeros((size, size))
    for part, effect in acts.values():
        total += effect @ part.covariance @ effect.T
    return total


def _begin(fleet: tuple[Sequence[Shaken], Sequence[Indices]], initial: Matrix) -> None:
    """Put what was learned before into the covariance of η at k = 0."""
    vehicles, rows = fleet
    root = np.zeros((len(initial), 0))
    for vehicle, at in zip(vehicles, rows, strict=True):
        known = vehicle.noise.belief
        if known is None:
            continue
        alone = 2 * vehicle.system.num_states
        own = at[:alone] >= 0
        initial[np.ix_(at[:alone][own], at[:alone][own])] = known.covariance[np.ix_(own, own)]
        if known.common is not None:
            if not root.size:
                root = np.zeros((len(initial), known.common.shape[1]))
            initial[np.ix_(at[alone:], at[alone:])] = 0.0
            root[at[at >= 0]] = known.common[at >= 0]
    initial += root @ root.T
