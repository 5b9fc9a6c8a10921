"""Means at which a polygon is hit with a probability, and what lies outside their hull."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from cones_drawn import Array, directions, normals_of, probability_within
from scipy.stats import norm

from radmpc.program.relaxed.cones import cones_around
from radmpc.program.relaxed.level_curves import Outline
from radmpc.program.relaxed.level_sets import level_points
from radmpc.program.relaxed.normals import chosen_normals, roots_of
from radmpc.program.relaxed.tails import DiscTails


def supported(corners: Array, normals: Array, radius: float) -> tuple[Array, Array]:
    """The first and the last point of a grown polygon that normals support."""
    heights = normals @ corners.T
    along = np.stack([-normals[:, 1], normals[:, 0]], axis=1) @ corners.T
    is_top = heights >= heights.max(axis=1, keepdims=True) - 1e-9
    first = corners[np.where(is_top, along, np.inf).argmin(axis=1)]
    last = corners[np.where(is_top, along, -np.inf).argmax(axis=1)]
    return (first + radius * normals)[None], (last + radius * normals)[None]


@pytest.mark.sampled(3)
@pytest.mark.parametrize("seed", range(8))
def test_level_points_are_hit_with_the_probability_of_their_level_and_hardly_more(
    seed: int,
) -> None:
    rng = np.random.default_rng(seed)
    risk_bound, radius = float(rng.choice([1e-3, 0.05])), 0.3
    corners = rng.normal(size=(6, 2)) * [3.0, 1.0]
    body = shapely.MultiPoint(corners).convex_hull
    corners = np.array(shapely.geometry.polygon.orient(body).exterior.coords)[:-1]
    root = np.diag(rng.uniform(0.2, 0.5, 2)) + 0.1 * rng.normal(size=(2, 2))
    covariance = (root @ root.T)[None]
    chosen = chosen_normals(
        normals_of(corners)[None], roots_of(*np.linalg.eigh(covariance)), directions(24)
    )
    support = supported(corners, chosen.normals[0], radius)
    level = float(norm.isf(risk_bound))
    means, is_reached = level_points(
        support, chosen.normals, roots_of(*np.linalg.eigh(covariance)), level
    )
    assert is_reached[0]
    grown = body.buffer(radius, quad_segs=200)
    risks = np.array([probability_within(mean, covariance[0], grown) for mean in means[0]])
    assert np.all(risks >= risk_bound)
    assert np.all(risks <= 1.4 * risk_bound)


def test_of_a_polygon_that_is_hardly_ever_hit_no_level_is_known() -> None:
    corners = np.array([[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]])
    outline = Outline(corners[None], normals_of(corners)[None], 0.01)
    cones = cones_around(outline, 4.0 * np.eye(2)[None], DiscTails.of(0.05), directions(16))
    assert cones.is_void[0]
