"""Every vehicle with everything it could hit, and the risk of each at each step."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.referee.chain import cheapest_chain
from radmpc.referee.halfspace import Sites, end_risks, refine, unit
from radmpc.referee.planar import grown_polygon_risks

__all__ = ["NEGLIGIBLE", "Encounters", "step_risks", "window_risks"]

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


def window_risks(encounters: Encounters, *, intervals: bool) -> Vector:
    """Return the risk of the best half-space of each window on its own.

    Parameters
    ----------
    encounters : Encounters
        B of them.
    intervals : bool
        Whether windows are the T intervals or the T+1 steps.

    Returns
    -------
    (B, T) or (B, T+1) array
        An upper bound on the probability of a collision in the window.
    """
    parts = []
    for block in _blocks(encounters):
        sites = _interval_sites(block) if intervals else _instant_sites(block)
        count = len(block.means)
        num_windows = len(sites.means) // count
        _, risks = _best_directions(sites, block.directions, num_windows)
        parts.append(risks.reshape(count, num_windows))
    return np.concatenate(parts)


def _blocks(encounters: Encounters) -> Iterator[Encounters]:
    """Yield the batch in blocks whose temporary arrays stay small."""
    count, steps = encounters.means.shape[:2]
    tried = encounters.directions.shape[1] + steps + 8
    size = max(1, _BLOCK // (steps * tried * (encounters.vertices.shape[2] + 4)))
    for start in range(0, count, size):
        yield encounters.block(start, start + size)


def _instant_sites(encounters: Encounters) -> Sites:
    """Return one site with one end per encounter and step."""
    count, steps, d = encounters.means.shape
    vertices = np.broadcast_to(encounters.vertices, (count, steps, *encounters.vertices.shape[2:]))
    return Sites(
        encounters.means.reshape(-1, 1, d),
        encounters.covariances.reshape(-1, 1, d, d),
        np.zeros((count * steps, d)),
        np.repeat(encounters.radii, steps),
        vertices.reshape(count * steps, 1, -1, d),
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
    vertices = encounters.vertices
    if vertices.shape[1] == 1:
        corners = np.repeat(vertices, num_intervals, axis=0)
    else:
        corners = np.stack([vertices[:, :-1], vertices[:, 1:]], axis=2)
        corners = corners.reshape(count * num_intervals, 2, -1, d)
    means, covariances = encounters.means, encounters.covariances
    return Sites(
        np.stack([means[:, :-1], means[:, 1:]], axis=2).reshape(-1, 2, d),
        np.stack([covariances[:, :-1], covariances[:, 1:]], axis=2).reshape(-1, 2, d, d),
        encounters.bows.reshape(-1, d),
        np.repeat(encounters.radii, num_intervals),
        corners,
    )


def _best_directions(sites: Sites, common: Tensor, repeats: int) -> tuple[Matrix, Vector]:
    """Return the best direction found for each site and its risk, summed over ends."""
    rows = np.arange(len(sites.means))
    tried = np.concatenate([np.repeat(common, repeats, axis=0), _local_directions(sites)], axis=1)
    found = end_risks(sites, tried).sum(axis=2)
    choice = found.argmin(axis=1)
    best, risks = tried[rows, choice], found[rows, choice]
    worth = np.flatnonzero(risks > NEGLIGIBLE)
    if worth.size:
        best[worth], risks[worth] = refine(sites.take(worth), best[worth], risks[worth])
    return best, risks


def _local_directions(sites: Sites) -> Tensor:
    """Return directions from the set towards the mean, as seen with and without the covariance."""
    means = sites.means.mean(axis=1)
    corners = sites.vertices.mean(axis=1)
    covariances = sites.covariances.mean(axis=1)
    gaps = means[:, None, :] - corners
    nearest = np.square(gaps).sum(axis=2).argmin(axis=1)
    outward = np.stack([gaps.mean(axis=1), gaps[np.arange(len(gaps)), nearest]], axis=1)
    # Half-spaces that leave a point at the largest clearance have normals Σ⁻¹ (mean - point).
    d = means.shape[1]
    scale = np.trace(covariances, axis1=1, axis2=2) / d
    floor = np.where(scale > 0.0, 1e-9 * scale, 1.0)[:, None, None] * np.eye(d)
    whitened = np.linalg.solve(covariances + floor, outward.transpose(0, 2, 1))
    return unit(np.concatenate([outward, whitened.transpose(0, 2, 1)], axis=1))
