"""Covariances of places as ellipses and ellipsoids."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Tensor
from radmpc.serving.protocol import Ellipse

__all__ = ["ellipses_of"]

_DIGITS = 4
"""Digits of half axes [-]."""


def ellipses_of(covariances: Tensor) -> list[Ellipse]:
    """Return one standard deviation of places, the longest axis first.

    Parameters
    ----------
    covariances : (k, d, d) array
        In the plane or in space [m²].
    """
    values, vectors = np.linalg.eigh(covariances)
    axes = np.sqrt(values.clip(min=0.0))[:, ::-1]
    vectors = vectors[:, :, ::-1]
    told = [[float(f"{x:.{_DIGITS}g}") for x in row] for row in axes]
    if covariances.shape[1] == 2:
        angles = np.round(np.arctan2(vectors[:, 1, 0], vectors[:, 0, 0]), 4).tolist()
        return [
            {"axes": axis, "angle": angle, "rotation": None}
            for axis, angle in zip(told, angles, strict=True)
        ]
    # A rotation, not a reflection.
    vectors = vectors * np.where(np.linalg.det(vectors) < 0.0, -1.0, 1.0)[:, None, None]
    rotations = np.round(vectors.reshape(len(vectors), -1), 4).tolist()
    return [
        {"axes": axis, "angle": 0.0, "rotation": rotation}
        for axis, rotation in zip(told, rotations, strict=True)
    ]
