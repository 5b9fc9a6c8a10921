"""Encounters near enough to be bounded one by one; all others are charged by distance alone."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.records import dataclass
from radmpc.referee.motion import FleetMotion
from radmpc.referee.tails import cutoff_of

__all__ = ["Balls", "far_from_boxes", "motion_balls", "near_pairs"]

_FEW = 64
"""Vehicles up to which every pair is looked at [-]: a tree is no quicker, and slow to load."""

_ALIKE = 1.5
"""Ratio of the largest ball to the median one up to which all are looked for as far as it [-]: in
one go, in half the time."""

_AT_ONCE = 1_000_000
"""Boxes times vehicles that are looked at in one go [-]."""


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
    from scipy.spatial import cKDTree  # noqa: PLC0415 - loads slowly; few vehicles do without

    largest = float(reaches.max())
    if largest <= _ALIKE * float(np.median(reaches)):
        found = cKDTree(centers).query_pairs(2.0 * largest, output_type="ndarray")
        return found[:, 0], found[:, 1]
    # The larger of two balls that meet reaches the other's center within twice its radius.
    lists = cKDTree(centers).query_ball_point(centers, 2.0 * reaches)
    i = np.repeat(np.arange(count), [len(near) for near in lists])
    j = np.concatenate([np.asarray(near, dtype=np.int64) for near in lists])
    return np.minimum(i, j), np.maximum(i, j)


def far_from_boxes(
    balls: Balls, boxes: Sequence[tuple[Matrix, Matrix]]
) -> Iterator[npt.NDArray[np.bool_]]:
    """Yield which vehicles' balls stay clear of each box in all windows, (N,) bool.

    An axis that separates ball and box is a half-space with as many standard deviations to spare.

    Parameters
    ----------
    balls : Balls
        Of all vehicles.
    boxes : sequence of tuple of (K, d) or (1, d) array
        Lower and upper corners of each box in each window, or in all of them [m].
    """
    if not boxes:
        return
    shape = balls.centers.shape[1:]
    lower, upper = np.empty((2, len(boxes), *shape))
    for number, (low, high) in enumerate(boxes):
        lower[number], upper[number] = low, high
    # Most vehicles never come near most boxes.
    far = _apart(balls, lower.min(axis=1), upper.max(axis=1))
    box, who = np.nonzero(~far)
    size = max(1, _AT_ONCE // math.prod(shape))
    for begin in range(0, box.size, size):
        b, i = box[begin : begin + size], who[begin : begin + size]
        centers, reaches = balls.centers[i], balls.reaches[i, :, None]
        beside = (centers - reaches >= upper[b]) | (centers + reaches <= lower[b])
        far[b, i] = np.all(np.any(beside, axis=2), axis=1)
    yield from far


def _apart(balls: Balls, lower: Matrix, upper: Matrix) -> npt.NDArray[np.bool_]:
    """Return which vehicles never come near which boxes, (B, N), by boxes around all balls."""
    reaches = balls.reaches[:, :, None]
    lowest = (balls.centers - reaches).min(axis=1)
    highest = (balls.centers + reaches).max(axis=1)
    found = np.zeros((len(lower), len(lowest)), dtype=bool)
    size = max(1, _AT_ONCE // max(len(lowest), 1))
    for begin in range(0, len(lower), size):
        some = slice(begin, begin + size)
        for axis in range(lower.shape[1]):
            found[some] |= lowest[:, axis] >= upper[some, axis, None]
            found[some] |= highest[:, axis] <= lower[some, axis, None]
    return found
