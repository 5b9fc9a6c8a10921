"""Every vehicle with everything it could hit, and the risk of each at each step."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.referee.chain import cheapest_chain
from radmpc.referee.halfspace import Sites, end_margins, end_risks, refine, unit
from radmpc.referee.planar import grown_polygon_risks
from radmpc.referee.tangent import tangent_directions

__all__ = ["NEGLIGIBLE", "Encounters", "WindowHalfspaces", "step_risks", "window_halfspaces"]

# Half-spaces below this risk are charged as they are, without looking for a better one.
NEGLIGIBLE = 1e-15
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


def step_risks(encounters: Encounters, *, intervals: bool) -> Vector:
    """Return an upper bound on the probability of each encounter's collision, step by step.

    Parameters
    ----------
    encounters : Encounters
        B of them.
    intervals : bool
        Whether the path between the steps counts.

    Returns
    -------
    (B, T+1) array
        Sums over steps bound the probability that the encounter collides at all.
    """
    parts = [
        _interval_risks(block) if intervals else _instant_risks(block)
        for block in _blocks(encounters)
    ]
    return np.concatenate(parts)


@dataclass(frozen=True, slots=True, eq=False)
class WindowHalfspaces:
    """The best half-space of each encounter in each window, on its own.

    Attributes
    ----------
    normals : (B, K, d) array
        Away from what is avoided [-].
    margins : (B, K, E) array
        A collision needs a deviation along −normal that exceeds this at one of the ends [m].
    risks : (B, K) array
        Upper bound on the probability of a collision in the window [-].
    """

    normals: Tensor
    margins: Tensor
    risks: Vector


def window_halfspaces(encounters: Encounters, *, intervals: bool) -> WindowHalfspaces:
    """Return the best half-spaces of all windows: the T intervals, or the T+1 steps."""
    parts: list[tuple[Tensor, Tensor, Vector]] = []
    for block in _blocks(encounters):
        sites = _interval_sites(block) if intervals else _instant_sites(block)
        count, d = len(block.means), block.means.shape[2]
        num_windows = len(sites.means) // count
        best, risks = _best_directions(sites, block.directions, num_windows)
        margins = end_margins(sites, best[:, None])
        parts.append(
            (
                best.reshape(count, num_windows, d),
                margins.reshape(count, num_windows, -1),
                risks.reshape(count, num_windows),
            )
        )
    normals, bounds, chances = (np.concatenate(p) for p in zip(*parts, strict=True))
    return WindowHalfspaces(normals, bounds, chances)


def _blocks(encounters: Encounters) -> Iterator[Encounters]:
    """Yield the batch in blocks whose temporary arrays stay small."""
    count, steps = encounters.means.shape[:2]
    corners = encounters.vertices.shape[2]
    tried = encounters.directions.shape[1] + steps + 2 * corners + 8 * encounters.edges.shape[2]
    size = max(1, _BLOCK // (steps * tried * (corners + 4)))
    for start in range(0, count, size):
        yield encounters.block(start, start + size)


def _instant_sites(encounters: Encounters) -> Sites:
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


def _instant_risks(encounters: Encounters) -> Vector:
    """Return the smaller of the best half-space and, in the plane, the exact probability."""
    count, steps, d = encounters.means.shape
    sites = _instant_sites(encounters)
    best, risks = _best_directions(sites, encounters.directions, steps)
    worth = np.flatnonzero(risks > NEGLIGIBLE)
    if d == 2 and worth.size:
        risks[worth] = grown_polygon_risks(
            sites.means[worth, 0],
            sites.covariances[worth, 0],
            sites.vertices[worth, 0],
            sites.radii[worth],
            best[worth],
            risks[worth],
        )
    return risks.reshape(count, steps)


def _interval_risks(encounters: Encounters) -> Vector:
    """Return the best chain of half-spaces, each held over a whole interval."""
    sites = _interval_sites(encounters)
    count, num_intervals, d = encounters.bows.shape
    best, risks = _best_directions(sites, encounters.directions, num_intervals)
    best = best.reshape(count, num_intervals, d)
    ends = end_risks(sites, best.reshape(-1, 1, d)).reshape(count, num_intervals, 2)
    charged = np.zeros((count, num_intervals + 1))
    charged[:, :-1] += ends[:, :, 0]
    charged[:, 1:] += ends[:, :, 1]
    # Sharing at most halves the sum: not worth a look where there is nothing to halve.
    worth = np.flatnonzero(risks.reshape(count, -1).sum(axis=1) > NEGLIGIBLE)
    if worth.size:
        tried = np.concatenate([encounters.directions[worth], best[worth]], axis=1)
        chosen = (worth[:, None] * num_intervals + np.arange(num_intervals)).ravel()
        everywhere = end_risks(sites.take(chosen), np.repeat(tried, num_intervals, axis=0))
        everywhere = everywhere.reshape(len(worth), num_intervals, -1, 2)
        charged[worth] = cheapest_chain(everywhere[..., 0], everywhere[..., 1])
    return charged


def _interval_sites(encounters: Encounters) -> Sites:
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


def _best_directions(sites: Sites, common: Tensor, repeats: int) -> tuple[Matrix, Vector]:
    """Return the best direction found for each site and its risk, summed over ends.

    At one end the tangents are the best there is. At two ends the search goes on from them.
    """
    gaps = sites.means.mean(axis=1)[:, None] - sites.vertices.mean(axis=1)
    tried = np.concatenate(
        [np.repeat(common, repeats, axis=0), unit(gaps.mean(axis=1, keepdims=True))], axis=1
    )
    best, risks = _cheapest(sites, tried)
    worth = np.flatnonzero(risks > NEGLIGIBLE)
    if not worth.size:
        return best, risks
    close = sites.take(worth)
    tangents, found = _cheapest(close, np.concatenate([best[worth, None], _tangents(close)], 1))
    if sites.means.shape[1] > 1:
        tangents, found = refine(close, tangents, found)
    best[worth], risks[worth] = tangents, found
    return best, risks


def _cheapest(sites: Sites, tried: Tensor) -> tuple[Matrix, Vector]:
    """Return the best of some directions for each site, and its risk."""
    rows = np.arange(len(tried))
    found = end_risks(sites, tried).sum(axis=2)
    choice = found.argmin(axis=1)
    return tried[rows, choice], found[rows, choice]


def _tangents(sites: Sites) -> Tensor:
    """Return the best directions at each end, (S, E (V + R), d)."""
    per_end = []
    for end in range(sites.means.shape[1]):
        shape = min(end, sites.vertices.shape[1] - 1)
        per_end.append(
            tangent_directions(
                sites.means[:, end],
                sites.covariances[:, end],
                sites.radii,
                sites.vertices[:, shape],
                sites.edges[:, shape],
            )
        )
    return np.concatenate(per_end, axis=1)
