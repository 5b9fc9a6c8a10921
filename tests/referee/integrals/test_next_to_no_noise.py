"""The exact integral where noise has no digits in the coordinates."""

import numpy as np
import pytest

from radmpc.referee.bound.planar import grown_polygon_risks

BOX = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


@pytest.mark.parametrize("vertices", [BOX, np.zeros((1, 2))], ids=["box", "disc"])
def test_a_mean_inside_a_set_is_hit_for_certain_however_little_it_strays(vertices):
    rng, count = np.random.default_rng(0), 40
    reach = 0.7 if len(vertices) > 1 else 0.2
    for exponent in np.arange(-3.0, -80.0, -0.5):
        means = reach * rng.uniform(-1.0, 1.0, (count, 2))
        turns, flatness = rng.uniform(0.0, np.pi, count), 10.0 ** rng.uniform(-3.0, 0.0, count)
        axes = np.stack([np.cos(turns), np.sin(turns)], axis=1)
        across = np.stack([-axes[:, 1], axes[:, 0]], axis=1)
        covariances = np.einsum("si,sj->sij", axes, axes)
        covariances += flatness[:, None, None] ** 2 * np.einsum("si,sj->sij", across, across)
        normals = rng.normal(size=(count, 2))
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        found = grown_polygon_risks(
            means,
            100.0**exponent * covariances,
            np.broadcast_to(vertices, (count, *vertices.shape)),
            np.full(count, 0.5),
            normals,
            np.ones(count),
        )
        assert np.all(found >= 1.0 - 1e-12), exponent
