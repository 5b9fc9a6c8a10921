r"""What the measurements of a whole fleet tell of disturbances that vehicles have in common.

What one vehicle measures tells of a disturbance that lasts, and so of all that meet it. Deviations
of the vehicles that share, their own disturbances that last, and the shared ones that do, are
together the state η of one linear system under noise that is new at every step; of that one Kalman
filter sees what all of them measure.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Protocol

import numpy as np

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.model.dynamics import LinearSystem
from radmpc.model.noise.known import Known
from radmpc.model.noise.shared import SharedDisturbance, lasting_parts
from radmpc.model.noise.spread import Noise
from radmpc.records import dataclass

__all__ = ["FleetLearning", "fleet_learning", "tied"]

_SINGULAR = 1e-12
"""Eigenvalue of the correlations of what is measured up to which there is nothing to learn [-]."""


class Shaken(Protocol):
    """A vehicle, as far as its noise goes."""

    @property
    def system(self) -> LinearSystem:
        """Its dynamics."""

    @property
    def noise(self) -> Noise:
        """What shakes it."""


def tied(noises: Sequence[Noise]) -> tuple[int, ...]:
    """Return the vehicles of which each one's measurements tell of the others' disturbances.

    Parameters
    ----------
    noises : sequence of Noise
        Of all vehicles.

    Returns
    -------
    tuple of int
        All that share a disturbance, if anything of theirs lasts; else none.
    """
    sharing = [i for i, noise in enumerate(noises) if noise.shared]
    lasts = any(noises[i].correlation > 0.0 or lasting_parts(noises[i].shared) for i in sharing)
    return tuple(sharing) if lasts else ()


@dataclass(frozen=True, slots=True, eq=False)
class FleetLearning:
    """What the measurements of vehicles that share disturbances tell, at k = 0..T.

    Attributes
    ----------
    members : tuple of int
        The vehicles, in the scenario's order.
    rows : tuple of (2 n + s,) int array
        Of each: where in η its deviation, its own disturbance and those it shares and that last
        stand, in this order; −1 is a disturbance that is new at every step.
    gains : tuple of (q, p) array
        What the filter makes of the difference between measured and expected states.
    unknown : tuple of (q, q) array
        Covariance of η, once measured.
    told : tuple of (p, p) array
        Covariance of what is measured about what was expected.
    """

    members: tuple[int, ...]
    rows: tuple[Indices, ...]
    gains: tuple[Matrix, ...]
    unknown: tuple[Matrix, ...]
    told: tuple[Matrix, ...]

    def learned(self, step: int, moved: Sequence[Vector]) -> list[Vector]:
        """Return by how much what is known of members changes, (2 n + s,) each.

        Parameters
        ----------
        step : int
            0..T.
        moved : sequence of (n,) array
            By how much each one's state differs from what was expected.
        """
        change = self.gains[step] @ np.concatenate(moved)
        return [np.where(rows < 0, 0.0, change[rows]) for rows in self.rows]

    def told_of(self, step: int) -> list[Matrix]:
        """Return by how much each one's state was to differ from what was expected, (n, n) each."""
        found, start = [], 0
        for size in self._sizes():
            block = slice(start, start + size)
            found.append(self.told[step][block, block])
            start += size
        return found

    def root(self, step: int) -> list[Matrix]:
        """Return what standard normals that all have in common make of each one, (2 n + s, E).

        Their products are the covariances of what is not known at a step, of one vehicle and
        between two.

        Parameters
        ----------
        step : int
            0..T.
        """
        values, vectors = np.linalg.eigh(self.unknown[step])
        kept = values > _SINGULAR * max(values[-1], 0.0)
        root = vectors[:, kept] * np.sqrt(values[kept])
        return [np.where(rows[:, None] < 0, 0.0, root[rows]) for rows in self.rows]

    def known(self, step: int, noises: Sequence[Noise], means: Sequence[Vector]) -> list[Known]:
        """Return what is known of members at a step, for plans that begin there.

        Parameters
        ----------
        step : int
            0..T.
        noises : sequence of Noise
            Of the members.
        means : sequence of (2 n + s,) array
            What is known of each.
        """
        found = []
        for noise, mean, root in zip(noises, means, self.root(step), strict=True):
            n = len(noise.initial)
            alone = np.zeros((2 * n, 2 * n))
            if noise.correlation == 0.0:
                alone[n:, n:] = noise.disturbance
            found.append(Known(mean[n : 2 * n], alone, mean[2 * n :], root))
        return found

    def _sizes(self) -> list[int]:
        """Return how many states each member has."""
        ends = [int(rows[0]) for rows in self.rows]
        return [b - a for a, b in zip(ends, [*ends[1:], len(self.told[0])], strict=True)]


@dataclass(frozen=True, slots=True, eq=False)
class _Chain:
    """The members as one system: η⁺ = free η + fresh; `rows` as in `FleetLearning`."""

    rows: tuple[Indices, ...]
    free: Matrix
    initial: Matrix
    fresh: Matrix


@lru_cache(maxsize=16)
def fleet_learning(vehicles: tuple[Shaken, ...], horizon: int) -> FleetLearning | None:
    """Return what the states of a fleet tell of what it shares; None where none is tied to others.

    States are measured exactly.

    Parameters
    ----------
    vehicles : tuple of Shaken
        All of a scenario.
    horizon : int
        Number of steps T.
    """
    members = tied([vehicle.noise for vehicle in vehicles])
    if not members:
        return None
    chosen = [vehicles[i] for i in members]
    chain = _chain_of(chosen)
    seen = sum(vehicle.system.num_states for vehicle in chosen)
    ahead = chain.initial
    gains, unknown, told = [], [], []
    for _ in range(horizon + 1):
        gain = ahead[:, :seen] @ _inverse(ahead[:seen, :seen])
        left = ahead - gain @ ahead[:seen]
        # To the last digit: rounding is not learned of.
        left[:seen] = left[:, :seen] = 0.0
        gains.append(gain)
        told.append(ahead[:seen, :seen])
        unknown.append(0.5 * (left + left.T))
        ahead = chain.free @ unknown[-1] @ chain.free.T + chain.fresh
        ahead = 0.5 * (ahead + ahead.T)
    return FleetLearning(members, chain.rows, tuple(gains), tuple(unknown), tuple(told))


def _chain_of(vehicles: Sequence[Shaken]) -> _Chain:
    """Return vehicles that share disturbances as one system."""
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
    return _Chain(tuple(rows), free, initial, fresh)


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
        known = vehicle.noise.known
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


def _inverse(covariance: Matrix) -> Matrix:
    """Return the inverse of a covariance where it has one, 0 along all other directions."""
    variances = np.diag(covariance)
    noisy = np.flatnonzero(variances > 0.0)
    found = np.zeros_like(covariance)
    if noisy.size:
        # In units of its own each coordinate counts alike, be it a place or a speed.
        units = np.sqrt(variances[noisy])
        values, vectors = np.linalg.eigh(covariance[np.ix_(noisy, noisy)] / np.outer(units, units))
        kept = values > _SINGULAR
        one = (vectors[:, kept] / values[kept]) @ vectors[:, kept].T
        found[np.ix_(noisy, noisy)] = one / np.outer(units, units)
    return found
