"""Half-spaces turned to where they separate best along given paths, one for every window.

The faces of a program are a choice of directions made beforehand. Any other direction is as valid:
what a path keeps from a convex set along one unit normal, it keeps from the set. Turned to the path
at hand, half-spaces allow it at least as much as faces do, and paths nearby mostly more.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from radmpc.arrays import Indices, Tensor, Vector
from radmpc.geometry import sphere_directions
from radmpc.program.avoidance import Windows
from radmpc.program.condensed import CondensedModel, joint_bent_covariances
from radmpc.program.keepout import KeepOut
from radmpc.program.turned_tuning import TUNING

__all__ = ["Turned"]

_LEAST_DEVIATION = 1e-9
"""Least standard deviation assumed [m]: below it, directions are compared by their slack."""

Supports = Callable[[Tensor], tuple[Vector, Vector]]
"""Support function: from normals, (w, c, d), to how far what is avoided extends along them at both
ends of each window, (w, c) each [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class _Encounter:
    """A path past something, window by window.

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
    """

    ends: tuple[Tensor, ...]
    covariances: tuple[tuple[Tensor, ...], ...]
    sagittas: Tensor
    supports: Supports

    def clearances(self, normals: Tensor) -> Vector:
        """Return the least clearance of both ends along normals, at the best share, (w, c)."""
        return self._rated(normals)[0]

    def shares(self, normals: Tensor) -> Vector:
        """Return the share of the near end that is best along normals, (w, c)."""
        return self._rated(normals)[1]

    def _rated(self, normals: Tensor) -> tuple[Vector, Vector]:
        """Return least clearances along normals, and the shares that make them largest."""
        reaches = self.supports(normals)[-len(self.ends) :]
        margins, deviations = [], []
        for end, reach, events in zip(self.ends, reaches, self.covariances, strict=True):
            margins.append(np.einsum("wcd,wd->wc", normals, end) - reach)
            variances = [np.einsum("wca,wab,wcb->wc", normals, c, normals) for c in events]
            largest = np.sqrt(np.maximum(np.maximum.reduce(variances), 0.0))
            deviations.append(np.maximum(largest, _LEAST_DEVIATION))
        if len(self.ends) == 1:
            alone: Vector = margins[0] / deviations[0]
            return alone, np.full(alone.shape, 0.5)
        sagitta = 4.0 * np.maximum(np.einsum("wcd,wd->wc", normals, self.sagittas), 0.0)
        shares = _best_shares(margins, deviations, sagitta)
        near: Vector = (margins[0] - np.square(shares) * sagitta) / deviations[0]
        far: Vector = (margins[1] - np.square(1.0 - shares) * sagitta) / deviations[1]
        return np.minimum(near, far), shares

    def best_normals(self, tried: Tensor) -> Tensor:
        """Return the best normal of each window, (w, d), from those tried on, (w, c, d)."""
        count, _, dimension = tried.shape
        every = np.arange(count)
        scores = self.clearances(tried)
        best: Tensor = tried[every, scores.argmax(axis=1)]
        step = 0.5 * TUNING.spacing[dimension]
        for _ in range(TUNING.levels):
            around = _around(best, step)
            best = around[every, self.clearances(around).argmax(axis=1)]
            step /= 3.0
        return best


@dataclass(frozen=True, slots=True, eq=False)
class Turned:
    """Paths of some vehicles, from the first step on, that half-spaces are turned to.

    Attributes
    ----------
    models : tuple of CondensedModel
        The vehicles.
    means : (n, T+1, d) array
        Their mean positions [m].
    controls : tuple of (T, m) array
        Their nominal controls.
    intervals : bool
        Whether windows are intervals.
    """

    models: tuple[CondensedModel, ...]
    means: Tensor
    controls: Sequence[Tensor]
    intervals: bool

    def around(self, i: int, keepout: KeepOut) -> KeepOut:
        """Return a convex set with the best half-space at every window in place of its faces.

        Parameters
        ----------
        i : int
            Number of the vehicle.
        keepout : KeepOut
            What it keeps out of, with its shapes.
        """
        model, shapes = self.models[i], keepout.shapes
        count = len(keepout.near)
        radius = model.vehicle.radius

        def supports(normals: Tensor) -> tuple[Vector, Vector]:
            if len(shapes) == 1:
                flat = shapes[0].support(normals.reshape(-1, normals.shape[2]))
                both = flat.reshape(normals.shape[:2]) + radius
                return both, both
            first, last = (
                np.array([shapes[w + end].support(normals[w]) for w in range(count)]) + radius
                for end in (0, 1)
            )
            return first, last

        encounter = self._encounter(self.means[i], self._sagittas(i), (model,), supports)
        coarse = sphere_directions(TUNING.coarse[self.means.shape[2]], self.means.shape[2])
        tried = [np.broadcast_to(coarse, (count, *coarse.shape))]
        if np.isfinite(keepout.near).all():
            tried.append(keepout.normals)
        normals = encounter.best_normals(np.concatenate(tried, axis=1))[:, None, :]
        near, far = (reach - radius for reach in supports(normals))
        return replace(
            keepout,
            normals=normals,
            near=near if self.intervals else far,
            far=far,
            directions=_numbers(normals),
            shapes=(),
            shares=encounter.shares(normals),
        )

    def between(self, i: int, j: int) -> Windows:
        """Return the best half-space between two vehicles at every window.

        Parameters
        ----------
        i, j : int
            Numbers of the vehicles; the half-spaces are over i's position relative to j's.
        """
        one, two = self.models[i], self.models[j]
        distance = one.vehicle.radius + two.vehicle.radius

        def supports(normals: Tensor) -> tuple[Vector, Vector]:
            both = np.full(normals.shape[:2], distance)
            return both, both

        encounter = self._encounter(
            self.means[i] - self.means[j],
            self._sagittas(i) - self._sagittas(j),
            (one, two),
            supports,
        )
        coarse = sphere_directions(TUNING.coarse[self.means.shape[2]], self.means.shape[2])
        tried = np.broadcast_to(coarse, (self.means.shape[1] - 1, *coarse.shape))
        normals = encounter.best_normals(tried)[:, None, :]
        offsets = np.full((len(normals), 1), -distance)
        shares = encounter.shares(normals)
        return Windows(-normals, offsets, offsets, _numbers(normals), self.intervals, shares)

    def _sagittas(self, i: int) -> Tensor:
        """Return how far a vehicle's path hangs off its chords, (T, d) [m]."""
        return np.asarray(self.controls[i] @ self.models[i].vehicle.system.sagitta.T)

    def _encounter(
        self, path: Tensor, sagittas: Tensor, models: tuple[CondensedModel, ...], supports: Supports
    ) -> _Encounter:
        """Return a (relative) path with the noise of who is on it."""
        covariances = np.sum([s.position_covariances for s in models], axis=0)
        if not self.intervals:
            return _Encounter((path[1:],), ((covariances[1:],),), sagittas, supports)
        at_start: tuple[Tensor, ...] = (covariances[:-1],)
        bent = joint_bent_covariances(models)
        if bent is not None:
            at_start = (covariances[:-1], bent)
        return _Encounter((path[:-1], path[1:]), (at_start, (covariances[1:],)), sagittas, supports)


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
    """Return normals and others one and two angular steps around them, (w, c, d)."""
    dimension = normals.shape[1]
    if dimension == 2:
        tangents = np.stack([-normals[:, 1], normals[:, 0]], axis=1)[:, None, :]
        moves = np.array([[0.0], [-2.0], [-1.0], [1.0], [2.0]])
    else:
        axis = np.eye(3)[np.abs(normals).argmin(axis=1)]
        first = np.cross(normals, axis)
        first /= np.linalg.norm(first, axis=1, keepdims=True)
        tangents = np.stack([first, np.cross(normals, first)], axis=1)
        angles = 0.25 * np.pi * np.arange(8)
        circle = np.column_stack([np.cos(angles), np.sin(angles)])
        moves = np.vstack([np.zeros((1, 2)), circle, 2.0 * circle])
    moved = normals[:, None, :] + step * np.einsum("cm,wmd->wcd", moves, tangents)
    return np.asarray(moved / np.linalg.norm(moved, axis=2, keepdims=True))


def _numbers(normals: Tensor) -> Indices:
    """Return numbers of directions, equal where normals are, (w, 1)."""
    _, numbers = np.unique(normals[:, 0].round(9), axis=0, return_inverse=True)
    return np.asarray(numbers.reshape(-1, 1))
