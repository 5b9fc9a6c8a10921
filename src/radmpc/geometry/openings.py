"""The widest opening between two places in the plane, exactly, however thin walls are.

Pieces that a disc does not fit between are joined by a curve that the disc cannot cross: within
both, and straight across the opening. Two places are apart for the disc exactly where a closed
curve of these goes around one of them alone, which a straight line between the two then crosses an
odd number of times. As the disc grows, the first such curve shows the widest opening.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.geometry.between import nearest_points, outlines_of_equal_length
from radmpc.geometry.polytope import Polytope
from radmpc.records import dataclass

__all__ = ["Barriers", "Opening"]

_MOST_PAIRS = 200_000
"""Pairs of pieces near each other up to which openings are looked at [-]."""

_BESIDE = 1e-9
"""Distance from a place within which a curve says nothing of it [m]."""

Box = tuple[Vector, Vector]
"""Its corners [m]."""


@dataclass(frozen=True, slots=True)
class Opening:
    """The widest opening between two places.

    Attributes
    ----------
    radius : float
        That of the largest disc that fits through [m]; 0 where there is no opening.
    between : pair of int
        The pieces beside it; the number of pieces is the border.
    position : tuple of float
        Its middle [m].
    around : tuple of int
        All pieces of the closed curve, those beside the opening included.
    """

    radius: float
    between: tuple[int, int]
    position: tuple[float, ...]
    around: tuple[int, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Barriers:
    """Curves between pieces that discs cannot cross.

    Attributes
    ----------
    count : int
        Number of pieces; as a piece it stands for all beyond the border.
    pairs : (e, 2) int array
        What each joins.
    radii : (e,) array
        Radius from which on a disc cannot cross it, ascending [m].
    curves : (e, 4, 2) array
        From inside one piece to inside the other, or to beyond the border [m].
    """

    count: int
    pairs: Indices
    radii: Vector
    curves: Tensor

    @classmethod
    def of(cls, pieces: Sequence[Polytope], border: Box | None, radius: float) -> Barriers | None:
        """Find them.

        Parameters
        ----------
        pieces : sequence of Polytope
            What the disc keeps clear of, in the plane.
        border : pair of (2,) array or None
            Corners of the box that its center keeps to [m].
        radius : float
            Radius beyond which no barrier matters [m].

        Returns
        -------
        Barriers or None
            None where there are too many.
        """
        if not pieces:
            return cls(0, np.zeros((0, 2), int), np.zeros(0), np.zeros((0, 4, 2)))
        outlines = outlines_of_equal_length(pieces)
        middles = np.stack([piece.vertices.mean(axis=0) for piece in pieces])
        pairs = _near_pairs(outlines, 2.0 * radius)
        if pairs is None:
            return None
        distances, first, second = nearest_points(outlines, pairs)
        curves = np.stack([middles[pairs[:, 0]], first, second, middles[pairs[:, 1]]], axis=1)
        radii = 0.5 * distances
        if border is not None:
            more = _to_border(outlines, middles, border)
            pairs, radii, curves = (
                np.concatenate(both) for both in zip((pairs, radii, curves), more, strict=True)
            )
        chosen = np.argsort(radii, kind="stable")[: int(np.count_nonzero(radii <= radius))]
        return cls(len(pieces), pairs[chosen], radii[chosen], curves[chosen])

    def opening(self, place: Vector, target: Box) -> Opening | None:
        """Return the widest opening on the way from a place to a box.

        Parameters
        ----------
        place : (2,) array
            Where the way begins [m]; within the border.
        target : pair of (2,) array
            Corners of the box, any place of which will do [m].

        Returns
        -------
        Opening or None
            None where a disc of the radius that barriers were found for gets through, or may.
        """
        end = np.clip(0.5 * (target[0] + target[1]), *target)
        line = end - place
        length = float(np.linalg.norm(line))
        if length <= _BESIDE:
            return None
        begins, ends = self.curves[:, :-1], self.curves[:, 1:]
        # One that touches the box may leave a part of it on either side.
        is_kept = ~(_meets(begins, ends, target) | _meets(begins, ends, (place, place))).any(axis=1)
        is_odd = _crossings(self.curves, place, line / length, length) % 2 == 1
        kept = np.flatnonzero(is_kept)
        if not is_odd[kept].any():
            return None
        joined = self.pairs[kept].tolist()
        found = _first_odd(joined, is_odd[kept].tolist())
        if found is None:
            return None
        last, around = found
        middle = 0.5 * (self.curves[kept[last], 1] + self.curves[kept[last], 2])
        between = (joined[last][0], joined[last][1])
        radius = float(self.radii[kept[last]])
        return Opening(radius, between, tuple(middle.tolist()), around)


def _near_pairs(outlines: Tensor, far: float) -> Indices | None:
    """Return pieces whose boxes are near each other; None where these are too many."""
    low, high = outlines.min(axis=1), outlines.max(axis=1)
    found: list[Indices] = []
    total = 0
    for i in range(len(outlines) - 1):
        gaps = np.maximum(low[i + 1 :] - high[i], low[i] - high[i + 1 :]).max(axis=1)
        others = np.flatnonzero(gaps <= far) + i + 1
        total += len(others)
        if total > _MOST_PAIRS:
            return None
        found.append(np.stack([np.full(len(others), i), others], axis=1))
    return np.concatenate([np.zeros((0, 2), dtype=np.int64), *found])


def _to_border(outlines: Tensor, middles: Matrix, border: Box) -> tuple[Indices, Vector, Tensor]:
    """Return what joins pieces with all that is beyond the border: pairs, radii and curves."""
    count = len(outlines)
    pairs, radii, curves = [], [], []
    extent = float((border[1] - border[0]).max())
    for axis, sign in ((0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)):
        side = border[1][axis] if sign > 0.0 else border[0][axis]
        which = (sign * outlines[:, :, axis]).argmax(axis=1)
        corners = outlines[np.arange(count), which]
        gaps = np.maximum(sign * (side - corners[:, axis]), 0.0)
        beyond = corners.copy()
        beyond[:, axis] += sign * (gaps + 1e-6 * extent)
        pairs.append(np.stack([np.arange(count), np.full(count, count)], axis=1))
        radii.append(gaps)
        curves.append(np.stack([middles, corners, beyond, beyond], axis=1))
    return np.concatenate(pairs), np.concatenate(radii), np.concatenate(curves)


def _meets(begins: Tensor, ends: Tensor, target: Box) -> npt.NDArray[np.bool_]:
    """Whether segments come to a box."""
    low, high = target[0] - _BESIDE, target[1] + _BESIDE
    along = ends - begins
    is_still = along == 0.0
    safe = np.where(is_still, 1.0, along)
    one, other = (low - begins) / safe, (high - begins) / safe
    is_beside = is_still & ((begins < low) | (begins > high))
    enters = np.where(is_still, -np.inf, np.minimum(one, other)).max(axis=-1)
    leaves = np.where(is_still, np.inf, np.maximum(one, other)).min(axis=-1)
    is_met = (np.maximum(enters, 0.0) <= np.minimum(leaves, 1.0)) & ~is_beside.any(axis=-1)
    return np.asarray(is_met)


def _crossings(curves: Tensor, place: Vector, along: Vector, length: float) -> Indices:
    """Return how often curves cross a straight line of some length."""
    far = (curves - place) @ along
    aside = (curves - place) @ np.array([-along[1], along[0]])
    is_left = aside > 0.0
    is_across = is_left[:, :-1] != is_left[:, 1:]
    rise = aside[:, 1:] - aside[:, :-1]
    share = -aside[:, :-1] / np.where(is_across, rise, 1.0)
    where = far[:, :-1] + share * (far[:, 1:] - far[:, :-1])
    is_on = is_across & (where > 0.0) & (where < length)
    return np.asarray(np.count_nonzero(is_on, axis=1))


def _first_odd(
    joined: Sequence[Sequence[int]], is_odd: Sequence[bool]
) -> tuple[int, tuple[int, ...]] | None:
    """Return the first curve that closes one of an odd number of crossings, and its pieces."""
    count = 1 + max((max(pair) for pair in joined), default=0)
    above, odd_above = list(range(count)), [False] * count
    tree: list[list[int]] = [[] for _ in range(count)]

    def root_of(i: int) -> tuple[int, bool]:
        is_odd_way = False
        while above[i] != i:
            is_odd_way ^= odd_above[i]
            i = above[i]
        return i, is_odd_way

    sizes = [1] * count
    for place, (i, j) in enumerate(joined):
        (one, odd_one), (other, odd_other) = root_of(i), root_of(j)
        is_odd_here = odd_one ^ odd_other ^ is_odd[place]
        if one == other:
            if is_odd_here:
                return place, _path(tree, i, j)
            continue
        if sizes[one] < sizes[other]:
            one, other = other, one
        above[other], odd_above[other] = one, is_odd_here
        sizes[one] += sizes[other]
        tree[i].append(j)
        tree[j].append(i)
    return None


def _path(tree: Sequence[Sequence[int]], begin: int, end: int) -> tuple[int, ...]:
    """Return what is on the way through a tree."""
    before = {begin: begin}
    waiting = [begin]
    while end not in before:
        waiting = [j for i in waiting for j in tree[i] if before.setdefault(j, i) == i]
    path = [end]
    while path[-1] != begin:
        path.append(before[path[-1]])
    return tuple(path)
