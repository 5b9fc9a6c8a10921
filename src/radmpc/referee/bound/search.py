"""The best half-space at each site."""

from __future__ import annotations

from functools import reduce

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.referee.bound.halfspace import refine, shared_risks, unit
from radmpc.referee.bound.tangent import tangent_directions
from radmpc.referee.sites import Sites, over_ends

__all__ = ["NEGLIGIBLE", "away", "best_directions", "cheapest", "closest_directions"]

NEGLIGIBLE = 1e-15
"""Risk of a half-space below which no better one is searched for [-]."""

_TELLING = 1e-10
"""Risk above which directions across the chord are tried, too [-]: few sites, a tenth of the
time."""

_LINE = 1e-6
"""Determinant of a covariance, as a share of its trace squared, up to which noise counts as along a
line [-]: elsewhere tangents are the best there is, as 4,000 directions around each of 2,000 sites
say, and least noise was a twentieth of a certificate."""


def best_directions(sites: Sites, common: Tensor, repeats: int) -> tuple[Matrix, Vector]:
    """Return the best direction found for each site and its risk, summed over ends.

    At one end the tangents are the best there is. At two ends the search goes on from them.

    Parameters
    ----------
    sites : Sites
        S of E ends each, in order of encounters.
    common : (B, C, d) array
        Directions that are tried at all sites of an encounter.
    repeats : int
        Sites per encounter.
    """
    tried = np.concatenate([np.repeat(common, repeats, axis=0), away(sites)], axis=1)
    best, risks = cheapest(sites, tried)
    worth = np.flatnonzero(risks > NEGLIGIBLE)
    if not worth.size:
        return best, risks
    close = sites.take(worth)
    tangents, found = cheapest(close, np.concatenate([best[worth, None], _tangents(close)], 1))
    if sites.means.shape[1] > 1:
        tangents, found = _or_across(close, tangents, found)
        tangents, found = refine(close, tangents, over_ends)
    else:
        tangents, found = _or_along_least_noise(close, tangents, found)
    best[worth], risks[worth] = tangents, found
    return best, risks


def closest_directions(sites: Sites, common: Tensor, current: Matrix) -> Matrix:
    """Return the best of faces, tangents and the current direction for each site, without a search.

    Over a short part of an interval the tangents of its ends are close to the best there is.

    Parameters
    ----------
    sites : Sites
        S sites.
    common : (S, C, d) array
        Faces and axes.
    current : (S, d) array
        A direction found for a larger place; kept where its risk is negligible.

    Returns
    -------
    (S, d) array
        Directions.
    """
    _, risks = cheapest(sites, current[:, None])
    worth = np.flatnonzero(risks > NEGLIGIBLE)
    if not worth.size:
        return current
    close = sites.take(worth)
    tried = np.concatenate([current[worth, None], common[worth], _tangents(close)], axis=1)
    best = current.copy()
    best[worth], _ = _or_across(close, *cheapest(close, tried))
    return best


def _centers(vertices: Tensor) -> Tensor:
    """Return the mean of the distinct corners at each step around a site, (S, 1 or 2, d).

    Corners are padded by repeating the first. Which one that is, and how often it is repeated,
    depends on how outlines are written and on what else there is: neither may move the center.
    """
    if vertices.shape[2] == 1:
        return vertices[:, :, 0]
    differs = vertices != vertices[:, :, :1]
    # By columns, which is faster where there are few.
    is_new = reduce(np.logical_or, [differs[..., axis] for axis in range(vertices.shape[3])])
    is_new[:, :, 0] = True
    kept = np.einsum("skv,skvd->skd", is_new.astype(np.float64), vertices)
    return np.asarray(kept / is_new.sum(axis=2)[..., None])


def away(sites: Sites) -> Tensor:
    """Return the direction away from the middle of the set at each site, (S, 1, d).

    Parameters
    ----------
    sites : Sites
        S sites.
    """
    gaps = sites.means.mean(axis=1)[:, None] - _centers(sites.vertices)
    return unit(gaps.mean(axis=1, keepdims=True))


def cheapest(sites: Sites, tried: Tensor) -> tuple[Matrix, Vector]:
    """Return the best of some directions for each site, (S, d), and its risk, (S,).

    Parameters
    ----------
    sites : Sites
        S sites.
    tried : (S, C, d) array
        Directions.
    """
    rows = np.arange(len(tried))
    found = over_ends(shared_risks(sites, tried))
    choice = found.argmin(axis=1)
    return tried[rows, choice], found[rows, choice]


def _tangents(sites: Sites) -> Tensor:
    """Return the best directions at each end, (S, E (V + R), d)."""
    shapes = [0 if near else sites.vertices.shape[1] - 1 for near in sites.is_near]
    count, ends, d = sites.means.shape
    found = tangent_directions(
        sites.means.reshape(-1, d),
        sites.covariances.reshape(-1, d, d),
        np.repeat(sites.radii, ends),
        sites.vertices[:, shapes].reshape(count * ends, -1, d),
        sites.edges[:, shapes].reshape(count * ends, -1, 2, d),
    )
    return found.reshape(count, -1, d)


def _or_across(sites: Sites, best: Matrix, risks: Vector) -> tuple[Matrix, Vector]:
    """Return the best of given directions and, where these leave a risk, those across the chord."""
    telling = np.flatnonzero(risks > _TELLING)
    if telling.size:
        close = sites.take(telling)
        tried = np.concatenate([best[telling, None], _across(close)], axis=1)
        best[telling], risks[telling] = cheapest(close, tried)
    return best, risks


def _or_along_least_noise(sites: Sites, best: Matrix, risks: Vector) -> tuple[Matrix, Vector]:
    """Return the best of given directions and, where these leave a risk, those of least noise.

    Noise along a line that only grazes the set has no tangent but the one beside that line, whose
    multiplier is infinite.
    """
    telling = np.flatnonzero((risks > _TELLING) & _along_lines(sites.covariances[:, 0]))
    if telling.size:
        close = sites.take(telling)
        least = np.linalg.eigh(close.covariances[:, 0])[1][:, None, :, 0]
        tried = np.concatenate([best[telling, None], least, -least], axis=1)
        best[telling], risks[telling] = cheapest(close, tried)
    return best, risks


def _along_lines(covariances: Tensor) -> np.ndarray:
    """Return where noise is along a line, or nearly; in space everywhere it may be."""
    if covariances.shape[1] != 2:
        return np.ones(len(covariances), dtype=bool)
    (first, mixed), (_, last) = covariances.transpose(1, 2, 0)
    return np.asarray(first * last - mixed * mixed <= _LINE * np.square(first + last))


def _across(sites: Sites) -> Tensor:
    """Return the directions in which corners and edges are nearest to the chord itself, (S, …, d).

    Where a chord passes a corner so closely that only a few directions separate them, these are
    at right angles to it: a search in steps would pass over them.
    """
    begin = sites.means[:, :1] - sites.vertices[:, 0]
    end = sites.means[:, -1:] - sites.vertices[:, -1]
    along = unit(end - begin)
    across = [begin - (begin * along).sum(axis=2, keepdims=True) * along]
    if along.shape[2] == 3:
        edges = sites.edges[:, 0, :, 1] - sites.edges[:, 0, :, 0]
        normals = np.cross(along[:, :1], edges)
        across += [normals, -normals]
    return unit(np.concatenate(across, axis=1))
