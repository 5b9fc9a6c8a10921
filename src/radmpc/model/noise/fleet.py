r"""What the measurements of a whole fleet tell of disturbances that vehicles have in common.

What one vehicle measures tells of a disturbance that lasts, and so of all that meet it. Deviations
of the vehicles that share, their own disturbances that last, and the shared ones that do, are
together the state η of one linear system under noise that is new at every step; of that one Kalman
filter sees what all of them measure.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.model.noise.belief import Belief
from radmpc.model.noise.filtering import Learning, learning_of
from radmpc.model.noise.fleet_chain import Shaken, fleet_chain
from radmpc.model.noise.shared import lasting_parts
from radmpc.model.noise.spread import Noise
from radmpc.model.noise.unlearned import surprised, unlearned
from radmpc.records import dataclass

__all__ = ["FleetLearning", "fleet_learning", "tied"]

_SINGULAR = 1e-12
"""Eigenvalue of the correlations of what is measured up to which there is nothing to learn [-]."""


def tied(noises: Sequence[Noise]) -> tuple[int, ...]:
    """Return the vehicles of which each one's measurements tell of the others' disturbances.

    Parameters
    ----------
    noises : sequence of Noise
        Of all vehicles.

    Returns
    -------
    tuple of int
        All that share a disturbance, if anything of theirs lasts, or one does not know its state
        exactly; else none.
    """
    sharing = [i for i, noise in enumerate(noises) if noise.shared]
    for noise in (noises[i] for i in sharing):
        if noise.correlation > 0.0 or noise.measurement is not None or lasting_parts(noise.shared):
            return tuple(sharing)
    return ()


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
        What the filter makes of the difference between what is told and what was expected.
    unknown : tuple of (q, q) array
        Covariance of η, once measured.
    innovations : tuple of (p, p) array
        Covariance of what is told about what was expected: of states that are known exactly, and of
        what a vehicle's own filter makes of its measurement.
    """

    members: tuple[int, ...]
    rows: tuple[Indices, ...]
    gains: tuple[Matrix, ...]
    unknown: tuple[Matrix, ...]
    innovations: tuple[Matrix, ...]

    def learned(self, step: int, moved: Sequence[Vector]) -> list[Vector]:
        """Return by how much what is known of members changes, (2 n + s,) each.

        Parameters
        ----------
        step : int
            0..T.
        moved : sequence of (n,) array
            By how much each one's state differs from what was expected; of who measures with noise,
            what its own filter's gain makes of how much its measurement does.
        """
        change = self.gains[step] @ np.concatenate(moved)
        return [np.where(rows < 0, 0.0, change[rows]) for rows in self.rows]

    def known_parts_of(self, step: int) -> list[Matrix]:
        """Return that covariance of each one alone, (n, n) each."""
        found, start = [], 0
        for size in self._sizes():
            block = slice(start, start + size)
            found.append(self.innovations[step][block, block])
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

    def beliefs(
        self, step: int, noises: Sequence[Noise], means: Sequence[Vector]
    ) -> list[Belief | None]:
        """Return what is known of members at a step, for plans that begin there; None is the state.

        Parameters
        ----------
        step : int
            0..T.
        noises : sequence of Noise
            Of the members.
        means : sequence of (n,) or (2 n + s,) array
            What is known of each.
        """
        found: list[Belief | None] = []
        for noise, mean, root in zip(noises, means, self.root(step), strict=True):
            n = len(noise.initial)
            if mean.size == n:
                found.append(None)
                continue
            alone = np.zeros((2 * n, 2 * n))
            if noise.correlation == 0.0:
                alone[n:, n:] = noise.disturbance
            found.append(Belief(mean[n : 2 * n], alone, mean[2 * n :], root))
        return found

    def _sizes(self) -> list[int]:
        """Return how many states each member has."""
        ends = [int(rows[0]) for rows in self.rows]
        return [b - a for a, b in zip(ends, [*ends[1:], len(self.innovations[0])], strict=True)]


@lru_cache(maxsize=4)
def fleet_learning(vehicles: tuple[Shaken, ...], horizon: int) -> FleetLearning | None:
    """Return what measurements tell of a fleet that shares; None where none is tied to others.

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
    chain, own = fleet_chain(chosen), [_own_filter(vehicle, horizon) for vehicle in chosen]
    sizes = [vehicle.system.num_states for vehicle in chosen]
    seen = sum(sizes)
    exact = np.repeat([learning is None for learning in own], sizes).nonzero()[0]
    ahead = chain.initial
    gains, unknown, innovations = [], [], []
    for k in range(horizon + 1):
        sees, errors = _told(chosen, own, k)
        crossed = ahead[:, :seen] @ sees.T
        innovations.append(surprised(sees, ahead[:seen, :seen], errors))
        gain = crossed @ _inverse(innovations[-1])
        left = unlearned(ahead, gain @ crossed.T)
        # To the last digit: rounding is not learned of.
        left[exact] = left[:, exact] = 0.0
        gains.append(gain)
        unknown.append(left)
        ahead = chain.free @ unknown[-1] @ chain.free.T + chain.fresh
        ahead = 0.5 * (ahead + ahead.T)
    return FleetLearning(members, chain.rows, tuple(gains), tuple(unknown), tuple(innovations))


def _own_filter(vehicle: Shaken, horizon: int) -> Learning | None:
    """Return what a vehicle's own measurements tell it; None where it knows its state."""
    if vehicle.noise.measurement is None:
        return None
    return learning_of(vehicle.system, vehicle.noise, horizon)


def _told(
    vehicles: Sequence[Shaken], own: Sequence[Learning | None], step: int
) -> tuple[Matrix, Matrix]:
    """Return what is told of all states at a step, and the covariance of what is wrong with it."""
    ends = np.cumsum([0, *(vehicle.system.num_states for vehicle in vehicles)])
    sees, errors = np.eye(ends[-1]), np.zeros((ends[-1], ends[-1]))
    for vehicle, learning, start, end in zip(vehicles, own, ends[:-1], ends[1:], strict=True):
        sensor = vehicle.noise.measurement
        if learning is not None and sensor is not None:
            mine, gain = slice(start, end), learning.gains[step][: end - start]
            sees[mine, mine] = gain @ sensor.matrix
            errors[mine, mine] = gain @ sensor.covariance @ gain.T
    return sees, errors


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
