"""Encounters near enough to be bounded one by one; all others are charged by distance alone."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.records import dataclass
from radmpc.referee.motion import FleetMotion
from radmpc.referee.tails import cutoff_of

__all__ = ["Balls", "far_from_box", "flight_boxes", "motion_balls", "near_pairs"]

_FEW = 64
"""Vehicles up to which every pair is looked at [-]: a tree is no quicker, and slow to load."""


@dataclass(frozen=True, slots=True, eq=False)
class Balls:
    """Where each vehicle is during each window (a step, or an interval), generously.

    Attributes
    ----------
    centers : (N, K, d) array
        Middle of the mean positions [m].
    reaches : (N, K) array
        Half the chord, the sagitta, the radius and the standard deviations from which anything is
        far together [m].
    """

    centers: Tensor
    reaches: Matrix


def motion_balls(motion: FleetMotion, *, intervals: bool) -> Balls:
    """Return the balls of all vehicles.

    Two vehicles whose balls do not meet in a window are separated there by the half-space across
    the line of centers, with that many standard deviations to spare at every end:
    ``|cᵢ − cⱼ| >= Rᵢ + Rⱼ`` and ``sqrt(a + b) <= sqrt(a) + sqrt(b)``.

    Parameters
    ----------
    motion : FleetMotion
        Of the fleet.
    intervals : bool
        Whether windows are intervals, or steps.
    """
    deviations = np.sqrt(np.linalg.eigvalsh(motion.position_covariances)[..., -1].clip(min=0.0))
    radii = motion.radii[:, None]
    cutoff, _ = cutoff_of(motion.samples)
    if not intervals:
        return Balls(motion.positions, radii + cutoff * deviations)
    before, after = motion.positions[:, :-1], motion.positions[:, 1:]
    half_chord = 0.5 * np.linalg.norm(after - before, axis=2)
    sagitta = np.linalg.norm(motion.sagittas, axis=2)
    deviations = np.maximum(deviations[:, :-1], deviations[:, 1:])
    if motion.is_bent:
        bent = np.linalg.eigvalsh(motion.bent_covariances)[..., -1].clip(min=0.0)
        deviations = np.maximum(deviations, np.sqrt(bent))
    return Balls(0.5 * (before + after), radii + half_chord + sagitta + cutoff * deviations)


def near_pairs(balls: Balls) -> Indices:
    """Return the pairs whose balls meet in some window.

    Returns
    -------
    (P, 2) int array
        First below second, sorted.
    """
    count = len(balls.centers)
    found: list[Indices] = []
    for k in range(balls.centers.shape[1]):
        centers, reaches = balls.centers[:, k], balls.reaches[:, k]
        low, high = _candidates(centers, reaches)
        gap = np.linalg.norm(centers[low] - centers[high], axis=1)
        meet = (low < high) & (gap <= reaches[low] + reaches[high])
        found.append(np.unique(low[meet] * count + high[meet]))
    keys = np.unique(np.concatenate(found))
    return np.column_stack([keys // count, keys % count])


def _candidates(centers: Matrix, reaches: Vector) -> tuple[Indices, Indices]:
    """Return pairs among which are all whose balls meet, some of them twice or with themselves."""
    count = len(centers)
    if count <= _FEW:
        low, high = np.triu_indices(count, 1)
        return low, high
    from scipy.spatial import cKDTree  # noqa: PLC0415 - see `_FEW`

    # The larger of two balls that meet reaches the other's center within twice its radius.
    lists = cKDTree(centers).query_ball_point(centers, 2.0 * reaches)
    i = np.repeat(np.arange(count), [len(near) for near in lists])
    j = np.concatenate([np.asarray(near, dtype=np.int64) for near in lists])
    return np.minimum(i, j), np.maximum(i, j)


def flight_boxes(balls: Balls) -> tuple[Matrix, Matrix]:
    """Return the corners of the boxes around all that each vehicle's balls hold, (N, d) each.

    Parameters
    ----------
    balls : Balls
        Of all vehicles.
    """
    reaches = balls.reaches[:, :, None]
    return (balls.centers - reaches).min(axis=1), (balls.centers + reaches).max(axis=1)


def far_from_box(
    balls: Balls, flights: tuple[Matrix, Matrix], lower: Matrix, upper: Matrix
) -> npt.NDArray[np.bool_]:
    """Return which vehicles' balls stay clear of a box in all windows, (N,) bool.

    An axis that separates ball and box is a half-space with as many standard deviations to spare.

    Parameters
    ----------
    balls : Balls
        Of all vehicles.
    flights : (N, d) array and (N, d) array
        The boxes around them: most vehicles never come near.
    lower, upper : (K, d) array
        Corners of the box in each window [m].
    """
    lowest, highest = flights
    far: npt.NDArray[np.bool_] = np.any(
        (lowest >= upper.max(axis=0)) | (highest <= lower.min(axis=0)), axis=1
    )
    some = np.flatnonzero(~far)
    if some.size:
        centers, reaches = balls.centers[some], balls.reaches[some, :, None]
        beside = (centers - reaches >= upper) | (centers + reaches <= lower)
        far[some] = np.all(np.any(beside, axis=2), axis=1)
    return far
