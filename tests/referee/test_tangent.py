"""Tangent half-spaces where the noise lies along one axis."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.referee.bound.tangent import tangent_directions


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
