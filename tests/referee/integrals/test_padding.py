from __future__ import annotations

import numpy as np
import pytest

from radmpc.geometry import Polytope, hull
from radmpc.referee.contact import solid_of
from radmpc.referee.padding import padded_edges, padded_normals, padded_vertices


def pieces(dimension: int, steps: int) -> list[list[Polytope]]:
    """Return points, segments and bodies of few and of many corners, at some steps."""
    rng = np.random.default_rng(dimension)
    counts = (1, 2, 9, 4, 9, 30)
    return [[hull(rng.normal(size=(n, dimension))) for _ in range(steps)] for n in counts]


def is_padded(rows: np.ndarray, every: np.ndarray) -> bool:
    """Whether rows stand first, and only the first of all comes again."""
    count = len(rows)
    return np.array_equal(every[:count], rows) and bool(np.all(every[count:] == every[:1]))


@pytest.mark.parametrize("steps", [1, 3])
@pytest.mark.parametrize("dimension", [2, 3])
def test_each_piece_has_its_own_rows_and_the_first_again(dimension: int, steps: int) -> None:
    every = pieces(dimension, steps)
    corners, normals, edges = padded_vertices(every), padded_normals(every), padded_edges(every)
    axes = np.vstack([np.eye(dimension), -np.eye(dimension)])
    for k, shapes in enumerate(every):
        assert np.array_equal(normals[k, : len(axes)], axes)
        faces = {tuple(face.round(9)) for shape in shapes for face in shape.normals}
        faces |= {tuple(axis) for axis in axes}
        assert {tuple(face.round(9)) for face in normals[k]} == faces
        for step, shape in enumerate(shapes):
            assert is_padded(shape.vertices, corners[k, step])
            if dimension == 3:
                assert is_padded(solid_of(shape).edges, edges[k, step])
    assert edges.shape[2] == 0 or dimension == 3
