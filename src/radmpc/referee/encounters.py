"""Encounters of vehicles with each other, obstacles and the workspace, in batches."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from radmpc.arrays import Indices, Tensor, Vector
from radmpc.model.plan import Cause
from radmpc.records import dataclass, replace
from radmpc.referee.sites import Sites, joined_rows

__all__ = [
    "Encounters",
    "around",
    "blocks",
    "instant_sites",
    "interval_sites",
    "sites_at",
    "together",
]

_BLOCK = 1_000_000
"""Numbers in the largest temporary array of one block [-]: twice as many take 20 MB more and are
3 % faster for 200 drones in a box, half as many are 7 % slower."""


@dataclass(frozen=True, slots=True, eq=False)
class Encounters:
    """A batch of vehicles (or relative motions) against convex sets.

    Attributes
    ----------
    kind : {'pair', 'obstacle', 'workspace', 'range'}
        What ``other`` counts.
    first, other : (B,) int array
        Numbers of the vehicle, and of the obstacle or other vehicle.
    piece : (B,) int array
        Which convex piece of the obstacle; 0 for pairs.
    partner, track : (B,) int array
        Number of the vehicle that it is relative to, and place among the obstacles that are not
        known exactly; −1 for none.
    means : (B, T+1, d) array
        Mean (relative) positions [m].
    covariances : (B, T+1, d, d) array
        Their covariances [m²].
    bent_covariances : (B, T, d, d) array or None
        Covariance of what feedback held over an interval makes of the deviation at its start [m²];
        None where that bends no path.
    sagittas : (B, T, d) array
        ``a dt²/8`` of the (relative) acceleration in each interval [m].
    radii : (B,) array
        Radius that grows the set [m].
    vertices : (B, 1 or T+1, V, d) array
        Corners of the set, per step where it moves; the origin for pairs [m].
    directions : (B, G, d) array
        Unit normals worth trying at every step: faces and axes [-].
    edges : (B, 1 or T+1, R, 2, d) array
        Ends of the set's edges in space; R = 0 in the plane and for pairs [m].
    samples : int or None
        Independent steps that covariances were estimated from; None is that they are known.
    begins : (B,) int array or None
        Step of the motion that is the first here, see `during`; None is the first of all.
    """

    kind: Cause
    first: Indices
    other: Indices
    piece: Indices
    partner: Indices
    track: Indices
    means: Tensor
    covariances: Tensor
    bent_covariances: Tensor | None
    sagittas: Tensor
    radii: Vector
    vertices: Tensor
    directions: Tensor
    edges: Tensor
    samples: int | None = None
    begins: Indices | None = None

    @property
    def is_pair(self) -> bool:
        """Whether these are relative motions of two vehicles each."""
        return self.kind in {"pair", "range"}

    def summed(self, values: Vector) -> Vector:
        """Return the sum over all of its kind for each: pairs, obstacles on tracks, all others.

        Parameters
        ----------
        values : (B,) array
            Of each encounter.
        """
        kinds = 2 * (self.partner >= 0) + (self.track >= 0)
        return np.asarray(np.bincount(kinds, values)[kinds])

    def against(self, corners: Tensor, directions: Tensor) -> Encounters:
        """Return the same motions against other sets that stand still.

        Parameters
        ----------
        corners : (B, 1, V, d) array
            Of each set [m].
        directions : (B, G, d) array
            Unit normals worth trying.
        """
        return replace(self, vertices=corners, directions=directions)

    def take(self, chosen: slice | Indices) -> Encounters:
        """Return some encounters of the batch."""
        bent = self.bent_covariances
        return Encounters(
            self.kind,
            self.first[chosen],
            self.other[chosen],
            self.piece[chosen],
            self.partner[chosen],
            self.track[chosen],
            self.means[chosen],
            self.covariances[chosen],
            None if bent is None else bent[chosen],
            self.sagittas[chosen],
            self.radii[chosen],
            self.vertices[chosen],
            self.directions[chosen],
            self.edges[chosen],
            self.samples,
            None if self.begins is None else self.begins[chosen],
        )

    def during(self, begins: Indices, length: int) -> Encounters:
        """Return the same encounters during some intervals of each.

        Parameters
        ----------
        begins : (B,) int array
            The first interval of each.
        length : int
            How many.
        """
        rows = np.arange(begins.size)[:, None]
        intervals = begins[:, None] + np.arange(length)
        steps = begins[:, None] + np.arange(length + 1)

        def moving(shape: Tensor) -> Tensor:
            return shape if shape.shape[1] == 1 else shape[rows, steps]

        bent = self.bent_covariances
        return replace(
            self,
            means=self.means[rows, steps],
            covariances=self.covariances[rows, steps],
            bent_covariances=None if bent is None else bent[rows, intervals],
            sagittas=self.sagittas[rows, intervals],
            vertices=moving(self.vertices),
            edges=moving(self.edges),
            begins=begins,
        )


def together(every: Sequence[Encounters]) -> Encounters:
    """Return the encounters of several batches in one; it is told to be of the kind of the first.

    Parameters
    ----------
    every : sequence of Encounters
        In the plane, of one motion, against sets that move in all or in none.
    """
    if len(every) == 1:
        return every[0]
    first = every[0]
    bent = [one.bent_covariances for one in every if one.bent_covariances is not None]
    return Encounters(
        first.kind,
        np.concatenate([one.first for one in every]),
        np.concatenate([one.other for one in every]),
        np.concatenate([one.piece for one in every]),
        np.concatenate([one.partner for one in every]),
        np.concatenate([one.track for one in every]),
        np.concatenate([one.means for one in every]),
        np.concatenate([one.covariances for one in every]),
        np.concatenate(bent) if bent else None,
        np.concatenate([one.sagittas for one in every]),
        np.concatenate([one.radii for one in every]),
        joined_rows([one.vertices for one in every], axis=2),
        joined_rows([one.directions for one in every]),
        np.concatenate([one.edges for one in every]),
        first.samples,
    )


def blocks(encounters: Encounters) -> Iterator[Encounters]:
    """Yield the batch in blocks whose temporary arrays stay small."""
    count, steps = encounters.means.shape[:2]
    corners = encounters.vertices.shape[2]
    tried = encounters.directions.shape[1] + steps + 2 * corners + 8 * encounters.edges.shape[2]
    size = max(1, _BLOCK // (steps * tried * (corners + 4)))
    for start in range(0, count, size):
        yield encounters.take(slice(start, start + size))


def instant_sites(encounters: Encounters) -> Sites:
    """Return one site with one end per encounter and step."""
    count, steps, d = encounters.means.shape
    vertices, edges = (
        np.broadcast_to(shape, (count, steps, *shape.shape[2:])).reshape(
            count * steps, 1, *shape.shape[2:]
        )
        for shape in (encounters.vertices, encounters.edges)
    )
    return Sites(
        encounters.means.reshape(-1, 1, d),
        encounters.covariances.reshape(-1, 1, d, d),
        (True,),
        np.zeros((count * steps, d)),
        np.repeat(encounters.radii, steps),
        vertices,
        np.zeros((count * steps, 1)),
        edges,
        encounters.samples,
    )


def sites_at(encounters: Encounters, rows: Indices, steps: Indices) -> Sites:
    """Return one site with one end for some encounters, each at one step.

    Parameters
    ----------
    encounters : Encounters
        B of them.
    rows, steps : (S,) int array
        Which, and when.
    """
    d = encounters.means.shape[2]
    at = steps if encounters.vertices.shape[1] > 1 else np.zeros_like(steps)
    return Sites(
        encounters.means[rows, steps][:, None],
        encounters.covariances[rows, steps][:, None],
        (True,),
        np.zeros((rows.size, d)),
        encounters.radii[rows],
        encounters.vertices[rows, at][:, None],
        np.zeros((rows.size, 1)),
        encounters.edges[rows, at][:, None],
        encounters.samples,
    )


def interval_sites(encounters: Encounters) -> Sites:
    """Return one site per encounter and interval: near end, bent near end if any, far end."""
    count, num_intervals, d = encounters.sagittas.shape
    means, covariances = encounters.means, encounters.covariances
    positions = [means[:, :-1], means[:, 1:]]
    spreads = [covariances[:, :-1], covariances[:, 1:]]
    is_near = [True, False]
    if encounters.bent_covariances is not None:
        positions.insert(1, means[:, :-1])
        spreads.insert(1, encounters.bent_covariances)
        is_near.insert(1, True)
    ends = len(positions)
    return Sites(
        np.stack(positions, axis=2).reshape(-1, ends, d),
        np.stack(spreads, axis=2).reshape(-1, ends, d, d),
        tuple(is_near),
        encounters.sagittas.reshape(-1, d),
        np.repeat(encounters.radii, num_intervals),
        around(encounters.vertices, num_intervals),
        np.tile([0.0 if near else 1.0 for near in is_near], (count * num_intervals, 1)),
        around(encounters.edges, num_intervals),
        encounters.samples,
    )


def around(shape: Tensor, num_intervals: int, parts: int = 1) -> Tensor:
    """Return corners or edges at the steps around each part of each interval, (B·K·M, 1 or 2, …).

    Parameters
    ----------
    shape : (B, 1 or T+1, …) array
        Per encounter, and per step where it moves.
    num_intervals : int
        K = T.
    parts : int
        M, parts of each interval.
    """
    if shape.shape[1] == 1:
        return np.repeat(shape, num_intervals * parts, axis=0)
    pairs = np.stack([shape[:, :-1], shape[:, 1:]], axis=2)
    count = len(shape) * num_intervals * parts
    return np.repeat(pairs, parts, axis=1).reshape(count, 2, *shape.shape[2:])
