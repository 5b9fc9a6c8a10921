"""Every vehicle with everything it could hit, in batches."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from radmpc.arrays import Indices, Tensor, Vector
from radmpc.referee.halfspace import Sites

__all__ = ["Encounters", "blocks", "instant_sites", "interval_sites"]

# Numbers in the largest temporary array of one block.
_BLOCK = 2_000_000


@dataclass(frozen=True, slots=True, eq=False)
class Encounters:
    """A batch of vehicles (or relative motions) against convex sets.

    Attributes
    ----------
    first, other : (B,) int array
        Numbers of the vehicle, and of the obstacle or other vehicle.
    piece : (B,) int array
        Which convex piece of the obstacle; 0 for pairs.
    means : (B, T+1, d) array
        Mean (relative) positions [m].
    covariances : (B, T+1, d, d) array
        Their covariances [m²].
    bows : (B, T, d) array
        ``a dt²/8`` of the (relative) acceleration in each interval [m].
    radii : (B,) array
        Radius that grows the set [m].
    vertices : (B, 1 or T+1, V, d) array
        Corners of the set, per step where it moves; the origin for pairs [m].
    directions : (B, G, d) array
        Unit normals worth trying at every step: faces and axes [-].
    edges : (B, 1 or T+1, R, 2, d) array
        Ends of the set's edges in space; R = 0 in the plane and for pairs [m].
    """

    first: Indices
    other: Indices
    piece: Indices
    means: Tensor
    covariances: Tensor
    bows: Tensor
    radii: Vector
    vertices: Tensor
    directions: Tensor
    edges: Tensor

    def block(self, start: int, stop: int) -> Encounters:
        """Return consecutive encounters of the batch."""
        return Encounters(
            self.first[start:stop],
            self.other[start:stop],
            self.piece[start:stop],
            self.means[start:stop],
            self.covariances[start:stop],
            self.bows[start:stop],
            self.radii[start:stop],
            self.vertices[start:stop],
            self.directions[start:stop],
            self.edges[start:stop],
        )


def blocks(encounters: Encounters) -> Iterator[Encounters]:
    """Yield the batch in blocks whose temporary arrays stay small."""
    count, steps = encounters.means.shape[:2]
    corners = encounters.vertices.shape[2]
    tried = encounters.directions.shape[1] + steps + 2 * corners + 8 * encounters.edges.shape[2]
    size = max(1, _BLOCK // (steps * tried * (corners + 4)))
    for start in range(0, count, size):
        yield encounters.block(start, start + size)


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
        np.zeros((count * steps, d)),
        np.repeat(encounters.radii, steps),
        vertices,
        edges,
    )


def interval_sites(encounters: Encounters) -> Sites:
    """Return one site with two ends per encounter and interval."""
    count, num_intervals, d = encounters.bows.shape
    vertices, edges = (
        np.repeat(shape, num_intervals, axis=0)
        if shape.shape[1] == 1
        else np.stack([shape[:, :-1], shape[:, 1:]], axis=2).reshape(
            count * num_intervals, 2, *shape.shape[2:]
        )
        for shape in (encounters.vertices, encounters.edges)
    )
    means, covariances = encounters.means, encounters.covariances
    return Sites(
        np.stack([means[:, :-1], means[:, 1:]], axis=2).reshape(-1, 2, d),
        np.stack([covariances[:, :-1], covariances[:, 1:]], axis=2).reshape(-1, 2, d, d),
        encounters.bows.reshape(-1, d),
        np.repeat(encounters.radii, num_intervals),
        vertices,
        edges,
    )
