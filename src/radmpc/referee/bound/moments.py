r"""Means and covariances of vehicles at moments between the steps.

Under a control held over a step, and with the disturbance entering linearly, the position of a
double integrator deviates at a share s of the step by

.. math:: y(s) = C(s)\,\zeta_k + s\,P \epsilon_k, \qquad C(s) = (1-s) P + s P F - s (1-s) G,

with P that picks positions, F the closed loop, ζ its state (the deviation, and a disturbance that
has a memory), ε the noise that is new, and ``G = B_p K``; for all other systems the path is the
straight segment, which is the same with G = 0. Within one of M equal parts, from s to s + 1/M,

.. math:: y = (1-\sigma)\,\bigl(y(s) - \sigma\,G\zeta_k/M^2\bigr) + \sigma\,y(s + 1/M),

so what holds for y at both ends of the part and for the *bent* near end ``y(s) − G ζ_k / M²`` holds
for the deviation in between.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from radmpc.arrays import Indices, Tensor, Vector
from radmpc.records import dataclass, replace
from radmpc.referee.bound.cross_covariances import CrossCovariances
from radmpc.referee.common import relative
from radmpc.referee.motion import FleetMotion, Group
from radmpc.referee.tracks import Tracks

__all__ = ["Moments", "moments_of", "moments_of_tracks"]


@dataclass(frozen=True, slots=True, eq=False)
class Moments:
    """Some vehicles at ``T M + 1`` moments, M parts to the step.

    Attributes
    ----------
    means : (V, T M + 1, d) array
        Mean positions on the curve [m].
    sagittas : (V, T M, d) array
        Deviation of the mean curve from the chord of each part in its middle [m].
    own : (V, T M + 1, d, d) array
        Covariance of the position [m²].
    bent : (V, T M, d, d) array
        Covariance of the bent near end of each part [m²].
    near_with_bent, bent_with_far : (V, T M, d, d) array
        Covariance of the near end with the bent one, and of that with the far end [m²].
    """

    means: Tensor
    sagittas: Tensor
    own: Tensor
    bent: Tensor
    near_with_bent: Tensor
    bent_with_far: Tensor

    def of(self, vehicles: Indices) -> Moments:
        """Return the moments of vehicles by their place, repeated ones allowed."""
        return Moments(
            self.means[vehicles],
            self.sagittas[vehicles],
            self.own[vehicles],
            self.bent[vehicles],
            self.near_with_bent[vehicles],
            self.bent_with_far[vehicles],
        )

    def during(self, vehicles: Indices, begins: Indices, length: int) -> Moments:
        """Return the moments of vehicles by their place, each during so many parts of its own.

        Parameters
        ----------
        vehicles : (B,) int array
            Their places.
        begins : (B,) int array
            The first part of each.
        length : int
            How many parts.
        """
        rows, parts = vehicles[:, None], begins[:, None] + np.arange(length)
        moments = begins[:, None] + np.arange(length + 1)
        return Moments(
            self.means[rows, moments],
            self.sagittas[rows, parts],
            self.own[rows, moments],
            self.bent[rows, parts],
            self.near_with_bent[rows, parts],
            self.bent_with_far[rows, parts],
        )

    def less(self, other: Moments, rows: Indices) -> Moments:
        """Return the moments of what is left of some positions less others, independent of them.

        Parameters
        ----------
        other : Moments
            Of as many vehicles.
        rows : (B,) int array
            From which they are taken, ascending.
        """
        return Moments(
            _put(self.means, rows, np.subtract, other.means),
            _put(self.sagittas, rows, np.subtract, other.sagittas),
            _put(self.own, rows, np.add, other.own),
            _put(self.bent, rows, np.add, other.bent),
            _put(self.near_with_bent, rows, np.add, other.near_with_bent),
            _put(self.bent_with_far, rows, np.add, other.bent_with_far),
        )

    def correlated(self, crossed: CrossCovariances, rows: Indices) -> Moments:
        """Return moments of differences whose positions are correlated, from their sums' ones.

        Parameters
        ----------
        crossed : CrossCovariances
            Of as many pairs.
        rows : (B,) int array
            Which they are, ascending.
        """
        return replace(
            self,
            own=_put(self.own, rows, relative, crossed.own),
            bent=_put(self.bent, rows, relative, crossed.bent),
            near_with_bent=_put(self.near_with_bent, rows, np.subtract, crossed.near_with_bent),
            bent_with_far=_put(self.bent_with_far, rows, np.subtract, crossed.bent_with_far),
        )


def _put(
    mine: Tensor, rows: Indices, made: Callable[[Tensor, Tensor], Tensor], others: Tensor
) -> Tensor:
    """Return an array whose rows are made of its own and of others."""
    if len(rows) == len(mine):
        return np.asarray(made(mine, others))
    found = mine.copy()
    found[rows] = made(mine[rows], others)
    return found


def moments_of(motion: FleetMotion, vehicles: Indices, parts: int) -> Moments:
    """Return the moments of some vehicles.

    Parameters
    ----------
    motion : FleetMotion
        Of the fleet.
    vehicles : (V,) int array
        Whose, by their number in the scenario.
    parts : int
        M, parts of each step, >= 1.

    Returns
    -------
    Moments
        In the order of the vehicles.
    """
    count = len(vehicles)
    horizon, d = motion.sagittas.shape[1:]
    width = horizon * parts
    shares = np.arange(parts + 1) / parts
    positions, sagittas = motion.positions[vehicles], motion.sagittas[vehicles]
    before, after = positions[:, :-1, None], positions[:, 1:, None]
    s = shares[:-1, None]
    curve = before + s * (after - before) - 4.0 * s * (1.0 - s) * sagittas[:, :, None]
    means = np.concatenate([curve.reshape(count, width, d), positions[:, -1:]], axis=1)
    own = np.empty((count, width + 1, d, d))
    pieces = [np.empty((count, horizon, parts, d, d)) for _ in range(3)]
    place = {int(v): at for at, v in enumerate(vehicles)}
    for group in motion.groups:
        chosen = np.flatnonzero(np.isin(group.members, vehicles))
        if not chosen.size:
            continue
        members = group.members[chosen]
        at = np.array([place[int(v)] for v in members])
        near, *crossed = _spreads(motion, group, chosen, shares)
        for piece, values in zip(pieces, crossed, strict=True):
            piece[at] = values
        own[at, :-1] = near.reshape(len(at), width, d, d)
        own[at, -1] = motion.position_covariances[members, -1]
    bent, near_with_bent, bent_with_far = (p.reshape(count, width, d, d) for p in pieces)
    return Moments(
        means,
        np.repeat(sagittas, parts, axis=1) / parts**2,
        own,
        bent,
        near_with_bent,
        bent_with_far,
    )


def moments_of_tracks(tracks: Tracks, places: Indices, parts: int) -> Moments:
    """Return the moments of how far obstacles are from where they are expected.

    Parameters
    ----------
    tracks : Tracks
        The obstacles.
    places : (V,) int array
        Whose, by their place among those.
    parts : int
        M, parts of each step, >= 1.

    Returns
    -------
    Moments
        In that order, of mean 0; they move straight from step to step.
    """
    d, horizon = tracks.dimension, tracks.states.shape[1] - 1
    count, width = len(places), horizon * parts
    own = np.empty((count, width + 1, d, d))
    crossed = np.empty((count, width, d, d))
    shares = np.arange(parts + 1) / parts
    for at, place in enumerate(places.tolist()):
        near, with_far = tracks.within(place, shares)
        own[at, :-1] = near.reshape(width, d, d)
        own[at, -1] = tracks.positions[place, -1]
        crossed[at] = with_far.reshape(width, d, d)
    still = np.zeros((count, width + 1, d))
    return Moments(still, still[:, :-1], own, own[:, :-1], own[:, :-1], crossed)


def _spreads(
    motion: FleetMotion, group: Group, chosen: Indices, shares: Vector
) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """Return own, bent, near-with-bent and bent-with-far covariances, (G, T, M, d, d) each [m²].

    Of a group's chosen members, each at the ends of parts that lie at these shares of a step.
    """
    members = group.members[chosen]
    axes = group.position[chosen]
    d, n = axes.shape[1], group.transitions.shape[-1]
    parts = len(shares) - 1
    picked = np.eye(n)[axes][:, None]
    bend = np.zeros((len(chosen), 1, d, n))
    for g, member in enumerate(members.tolist()):
        bend_of_one = motion.bends[member]
        bend[g, 0] = 0.0 if bend_of_one is None else bend_of_one
    column = shares[:, None, None]
    # At every step, or one for all of them: the second axis.
    C = (1.0 - column) * picked[:, None] + column * (
        picked[:, None] @ group.transitions[chosen][:, :, None]
    )
    C = C - column * (1.0 - column) * bend[:, None]
    noise = np.take_along_axis(group.disturbances[chosen], axes[:, None, :, None], axis=2)
    noise = np.take_along_axis(noise, axes[:, None, None, :], axis=3)[:, :, None]
    states = np.stack([motion.loops[v][:-1] for v in members.tolist()])[:, :, None]
    near, far = C[:, :, :-1], C[:, :, 1:]
    bent = near - bend[:, None] / parts**2
    fresh = column[:-1] ** 2 * noise
    spread = bent @ states
    return (
        near @ states @ _turned(near) + fresh,
        spread @ _turned(bent) + fresh,
        near @ states @ _turned(bent) + fresh,
        spread @ _turned(far) + column[:-1] * column[1:] * noise,
    )


def _turned(tensor: Tensor) -> Tensor:
    """Return transposes over the last two axes."""
    return np.swapaxes(tensor, -1, -2)
