"""Tangent half-spaces where the noise lies along one axis."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.referee.bound.search import best_directions
from radmpc.referee.bound.tangent import tangent_directions
from radmpc.referee.sites import Sites


@pytest.mark.parametrize("sideways", [0.0, 1e-160, 1e-155, 1e-120, 1e-14])
def test_a_mean_straight_across_the_noise_is_looked_at_straight(sideways):
    found = tangent_directions(
        means=np.array([[sideways, 2.0]]),
        covariances=np.array([[[1e-3, 0.0], [0.0, 0.0]]]),
        radii=np.array([0.5]),
        corners=np.zeros((1, 1, 2)),
        edges=np.zeros((1, 0, 2, 2)),
    )
    assert np.allclose(found, [[[0.0, 1.0]]], atol=1e-10)


@pytest.mark.parametrize("angle", [0.0, 0.3, 0.509, 2.1])
def test_noise_along_a_line_that_grazes_the_hull_is_held_by_that_line(angle):
    along, normal = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    radius = 0.9
    sites = Sites(
        means=(0.4 * along + (radius + 1e-8) * normal)[None, None],
        covariances=0.08 * np.outer(along, along)[None, None],
        is_near=(False,),
        sagittas=np.zeros((1, 2)),
        radii=np.array([radius]),
        vertices=np.zeros((1, 1, 1, 2)),
        blends=np.ones((1, 1)),
        edges=np.zeros((1, 1, 0, 2, 2)),
    )
    direction, risk = best_directions(sites, np.eye(2)[None], 1)
    assert direction[0] == pytest.approx(normal, abs=1e-6)
    assert risk[0] < 1e-12
