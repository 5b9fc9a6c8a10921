"""A path past something, window by window, and the half-space that separates the two best."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.program.hazards import Hazards
from radmpc.records import dataclass

__all__ = [
    "LEAST_DEVIATION",
    "Encounter",
    "Supports",
    "ends_of",
    "furthest",
    "noise_of",
    "tangents_of",
]

_STEPS = {2: 0.0325 / 4.0 ** np.arange(4.0), 3: 0.14 / 3.0 ** np.arange(5.0)}
"""Angular steps of the refinements around the best direction, by dimension [rad]: in the plane four
of them to either side, as far as the next one that was tried before, in space two all around."""

_BESIDE = np.array([[0.0], [-4.0], [-3.0], [-2.0], [-1.0], [1.0], [2.0], [3.0], [4.0]])
"""Steps aside in the plane [-]; the direction itself comes first."""

LEAST_DEVIATION = 1e-9
"""Least standard deviation assumed [m]: below it, directions are compared by their slack."""

Supports = Callable[[Tensor], tuple[Vector, Vector]]
"""Support function: from normals, (w, c, d), to how far what is avoided extends along them at both
ends of each window, (w, c) each [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Encounter:
    """A path past something at w windows.

    Attributes
    ----------
    ends : tuple of (w, d) array
        Mean (relative) position at the windows' ends; one where steps alone count [m].
    covariances : tuple of tuple of (w, d, d) array
        What the position deviates by at each end; two of them where feedback bends the path [m²].
    sagittas : (w, d) array
        How far the mean path hangs off its chord at mid-step [m].
    supports : callable
        Of what is avoided, grown by the vehicle's radius.
    is_isotropic : bool
        Whether the position deviates alike in all directions.
    """

    ends: tuple[Tensor, ...]
    covariances: tuple[tuple[Tensor, ...], ...]
    sagittas: Tensor
    supports: Supports
    is_isotropic: bool = False

    def clearances(self, normals: Tensor) -> Vector:
        """Return the least clearance of both ends along normals, at the best share, (w, c)."""
        return self._rated(normals, self.supports(normals), self.deviations(normals))[0]

    def along(self, normals: Matrix) -> tuple[Matrix, Matrix, Vector]:
        """Return what there is along one normal each, (w, d).

        Returns
        -------
        (w, 2) array, (w, 2) array, (w,) array
            How far what is avoided extends, and the largest standard deviations, at both ends of
            each window [m]; the share of the near end that is best [-].
        """
        tried = normals[:, None]
        reaches, deviations = self.supports(tried), self.deviations(tried)
        shares = np.full(len(normals), 0.5)
        if len(self.ends) == 2:
            shares = self._rated(tried, reaches, deviations)[1][:, 0]
        both = np.concatenate([deviations[0], deviations[-1]], axis=1)
        return np.concatenate(reaches, axis=1), both, shares

    def deviations(self, normals: Tensor) -> list[Vector]:
        """Return the largest standard deviation along normals at each end, (w, c) each [m]."""
        found = []
        for events in self.covariances:
            if self.is_isotropic:
                variances = [each[:, 0, :1] for each in events]
            else:
                variances = [_variances(normals, each) for each in events]
            deviations = np.sqrt(np.maximum(np.maximum.reduce(variances), 0.0))
            found.append(np.broadcast_to(deviations, normals.shape[:2]))
        return found

    def _rated(
        self, normals: Tensor, supports: tuple[Vector, ...], along: Sequence[Vector]
    ) -> tuple[Vector, Vector]:
        """Return least clearances along normals, and the shares that make them largest."""
        reaches = supports[-len(self.ends) :]
        margins = [
            np.einsum("wcd,wd->wc", normals, end) - reach
            for end, reach in zip(self.ends, reaches, strict=True)
        ]
        deviations = [np.maximum(d, LEAST_DEVIATION) for d in along]
        if len(self.ends) == 1:
            alone: Vector = margins[0] / deviations[0]
            return alone, np.full(alone.shape, 0.5)
        sagitta = 4.0 * np.maximum(np.einsum("wcd,wd->wc", normals, self.sagittas), 0.0)
        shares = _best_shares(margins, deviations, sagitta)
        near: Vector = (margins[0] - np.square(shares) * sagitta) / deviations[0]
        far: Vector = (margins[1] - np.square(1.0 - shares) * sagitta) / deviations[1]
        return np.minimum(near, far), shares

    def best_of(self, tried: Tensor) -> Tensor:
        """Return the best of the normals that are tried, as `best_normals` without a search."""
        scores = np.where(tried.any(axis=2), self.clearances(tried), -np.inf)
        best: Tensor = tried[np.arange(len(tried)), scores.argmax(axis=1)]
        return best

    def best_normals(self, tried: Tensor) -> Tensor:
        """Return the best normal of each window, (w, d), from those tried on, (w, c, d).

        Zeros among those tried stand for no direction.
        """
        count, _, dimension = tried.shape
        best, every = self.best_of(tried), np.arange(count)
        for step in _STEPS[dimension].tolist():
            around = _around(best, step)
            best = around[every, self.clearances(around).argmax(axis=1)]
        return best


def _variances(normals: Tensor, covariances: Tensor) -> Matrix:
    """Return variances along normals, (w, c) [m²]; in the plane term by term, in half the time."""
    if normals.shape[2] > 2:
        return np.asarray(np.einsum("wca,wab,wcb->wc", normals, covariances, normals))
    east, north = normals[..., 0], normals[..., 1]
    (first, mixed), (other, last) = covariances.transpose(1, 2, 0)[..., None]
    total: Matrix = east * first * east
    total += east * mixed * north
    total += north * other * east
    total += north * last * north
    return total


def _best_shares(
    margins: Sequence[Vector], deviations: Sequence[Vector], sagitta: Vector
) -> Vector:
    """Return the shares of the near end at which both ends are as clear, (w, c).

    With margins m and deviations σ, the clearances (m₀ − b θ²)/σ₀ and (m₁ − b (1 − θ)²)/σ₁ fall
    and rise with θ: the least of them is largest where they meet, a root of a quadratic.
    """
    near, far = sagitta / deviations[0], sagitta / deviations[1]
    gap: Vector = margins[0] / deviations[0] - margins[1] / deviations[1]
    ahead = far + gap
    root = far + np.sqrt(np.maximum(np.square(far) + (near - far) * ahead, 0.0))
    curved = root > 0.0
    shares: Vector = np.clip(np.where(curved, ahead, 0.5) / np.where(curved, root, 1.0), 0.0, 1.0)
    return np.where(gap >= near, 1.0, np.where(gap <= -far, 0.0, shares))


def _around(normals: Tensor, step: float) -> Tensor:
    """Return normals and others some angular steps around them, (w, c, d)."""
    tangents = tangents_of(normals)
    if normals.shape[1] == 2:
        # Of the same length each, whatever the normal.
        moves = step * _BESIDE
        length = np.sqrt(1.0 + np.square(moves))
        return np.asarray(normals[:, None] / length + tangents * (moves / length), dtype=np.float64)
    angles = 0.25 * np.pi * np.arange(8)
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    moves = np.vstack([np.zeros((1, 2)), circle, 2.0 * circle])
    moved = normals[:, None, :] + step * np.einsum("cm,wmd->wcd", moves, tangents)
    return np.asarray(moved / np.linalg.norm(moved, axis=2, keepdims=True))


def tangents_of(normals: Matrix) -> Tensor:
    """Return unit vectors across normals, each across the others, (w, d - 1, d).

    Parameters
    ----------
    normals : (w, d) array
        Unit vectors.
    """
    if normals.shape[1] == 2:
        return np.stack([-normals[:, 1], normals[:, 0]], axis=1)[:, None]
    axis = np.eye(3)[np.abs(normals).argmin(axis=1)]
    first = np.cross(normals, axis)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([first, np.cross(normals, first)], axis=1)


def ends_of(hazards: Hazards, start: Tensor, end: Tensor) -> tuple[Tensor, ...]:
    """Return what there is at the ends of windows that count: at both, or at the later one.

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    start, end : (w, …) array
        (Relative) positions or corners at both ends of each window [m].
    """
    return (start, end) if hazards.intervals else (end,)


def noise_of(
    hazards: Hazards,
    window: Indices,
    first: Indices,
    second: Indices | None,
    piece: Indices | None = None,
) -> tuple[tuple[Tensor, ...], ...]:
    """Return the covariances at the windows' ends, those of bent paths beside them.

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    window : (w,) int array
        The windows.
    first, second : (w,) int array, second or None
        Vehicles; None is no second one.
    piece : (w,) int array or None
        The pieces of obstacles that they meet; None is none.
    """
    of_pieces = hazards.shapes.covariances

    def seen(added: Tensor, steps: Indices) -> Tensor:
        return added if piece is None or of_pieces is None else added + of_pieces[piece, steps]

    end = (seen(hazards.joint(window + 1, first, second), window + 1),)
    if not hazards.intervals:
        return (end,)
    start = [hazards.joint(window, first, second)]
    bent = hazards.joint_bent(window, first, second)
    start += [] if bent is None else [bent]
    return (tuple(seen(found, window) for found in start), end)


def furthest(directions: Tensor, corners: Tensor) -> Matrix:
    """Return how far corners extend along directions, window by window, (w, c).

    Axis by axis and corner by corner, which takes a fifth of the time of one product of all.

    Parameters
    ----------
    directions : (w, c, d) array
        Unit vectors.
    corners : (w, v, d) array
        Points, one at least [m].
    """
    most = np.full(directions.shape[:2], -np.inf)
    for corner in corners.transpose(1, 0, 2):
        along = directions[..., 0] * corner[:, 0, None]
        for axis in range(1, corner.shape[1]):
            along += directions[..., axis] * corner[:, axis, None]
        np.maximum(most, along, out=most)
    return most
