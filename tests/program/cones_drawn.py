"""Cones around outlines, what they let through, and how likely an outline is hit."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import shapely
from scipy.stats import norm

from radmpc.program.relaxed.cones import Cones

Array = npt.NDArray[np.float64]


def normals_of(vertices: Array) -> Array:
    """Outward normals of a polygon given counter-clockwise."""
    edges = np.roll(vertices, -1, axis=0) - vertices
    across = np.stack([edges[:, 1], -edges[:, 0]], axis=1)
    return np.asarray(across / np.linalg.norm(across, axis=1)[:, None])


def probability_within(mean: Array, covariance: Array, shape: shapely.Geometry) -> float:
    """Of a Gaussian point in a convex shape, by chords parallel to its first axis."""
    values, vectors = np.linalg.eigh(covariance)
    outline = (np.array(shape.exterior.coords) - mean) @ vectors / np.sqrt(values)
    standard = shapely.Polygon(outline)
    low, high = max(outline[:, 1].min(), -9.0), min(outline[:, 1].max(), 9.0)
    if low >= high:
        return 0.0
    nodes, weights = np.polynomial.legendre.leggauss(120)
    heights = 0.5 * (low + high) + 0.5 * (high - low) * nodes
    lines = shapely.linestrings([[(-99.0, y), (99.0, y)] for y in heights])
    bounds = shapely.bounds(shapely.intersection(standard, lines))
    inside = np.nan_to_num(norm.sf(bounds[:, 0]) - norm.sf(bounds[:, 2]))
    return float(0.5 * (high - low) * (weights * norm.pdf(heights)) @ inside)


def directions(count: int) -> Array:
    angles = 2.0 * np.pi * np.arange(count) / count
    return np.stack([np.cos(angles), np.sin(angles)], axis=1)[None]


def clearances_of(cones: Cones, mean: Array) -> Array:
    """By every cone at the first instant; -inf where there is none."""
    is_there = np.isfinite(cones.offsets[0])
    slack = cones.normals[0] @ mean - np.where(is_there, cones.offsets[0], 0.0)
    return np.where(is_there, slack / np.where(is_there, cones.deviations[0], 1.0), -np.inf)


def chains(cones: Cones) -> list[list[int]]:
    """Every narrow cone at the first instant with the wider ones around it that are there."""
    is_there = np.isfinite(cones.offsets[0])
    found = []
    for cone in np.flatnonzero(is_there & ~np.isin(np.arange(is_there.size), cones.parents)):
        chain = [int(cone)]
        while cones.parents[chain[-1]] >= 0:
            chain.append(int(cones.parents[chain[-1]]))
        found.append([c for c in chain if is_there[c]])
    return found
