"""Arcs of a level curve: narrow ones between neighboring points, and wide ones made of these."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices
from radmpc.records import dataclass

__all__ = ["Arcs", "even_arcs", "face_arcs"]

_QUARTERS, _HALVES = 4, 8
"""Wide arcs around a hazard, and those that each wide one is made of first [-]."""

_MOST_SIDES = 5
"""Faces up to which the arcs around them are the widest [-]; around more, a quarter of them."""


@dataclass(frozen=True, slots=True, eq=False)
class Arcs:
    """Arcs from one point of a closed curve to another; each before the wider one it is part of.

    Attributes
    ----------
    firsts, lasts : (c,) int array
        The points at their ends, counted along the curve.
    parents : (c,) int array
        The wider arc that each is part of; -1 where there is none.
    """

    firsts: Indices
    lasts: Indices
    parents: Indices


def even_arcs(count: int) -> Arcs:
    """Return arcs between neighboring points, eighths of the curve, and quarters of it.

    Parameters
    ----------
    count : int
        Points.
    """
    halves = np.linspace(0, count, _HALVES + 1).round().astype(np.int64)
    quarters = halves[:: _HALVES // _QUARTERS]
    return Arcs(
        np.concatenate([np.arange(count), halves[:-1], quarters[:-1]]),
        np.concatenate([np.arange(count) + 1, halves[1:], quarters[1:]]) % count,
        np.concatenate(
            [
                count + np.searchsorted(halves, np.arange(count), side="right") - 1,
                count + _HALVES + np.arange(_HALVES) // (_HALVES // _QUARTERS),
                np.full(_QUARTERS, -1),
            ]
        ),
    )


def face_arcs(count: int, beside: int) -> Arcs:
    """Return arcs between neighboring points, halves of corners, and faces with both halves.

    A face with half a corner on either side is a wide arc. It is made of the face itself, where
    nothing is lost, and of the two halves; eighths of the curve would cut faces in two, and each
    of them would have to be parted once more.

    Parameters
    ----------
    count : int
        Points, two per direction: the middle of a corner, as many directions as are beside a face,
        the face, as many again, and so on.
    beside : int
        Directions between a face and the middle of a corner next to it.
    """
    at_face = 2 * (beside + 1)
    size = 2 * at_face
    points, begins = np.arange(count), np.arange(0, count, size)
    faces = begins.size
    face, place = points // size, points % size
    halves, wholes = count, count + 2 * faces
    firsts = [points, np.stack([begins, begins + at_face + 1], axis=1).ravel(), begins]
    lasts = [points + 1, np.stack([begins + at_face, begins + size], axis=1).ravel(), begins + size]
    parents = [
        np.where(place == at_face, wholes + face, halves + 2 * face + (place > at_face)),
        wholes + np.arange(2 * faces) // 2,
    ]
    if faces <= _MOST_SIDES:
        parents.append(np.full(faces, -1))
    else:
        groups = np.linspace(0, faces, _QUARTERS + 1).round().astype(np.int64)
        group = np.searchsorted(groups, np.arange(faces), side="right") - 1
        parents += [wholes + faces + group, np.full(_QUARTERS, -1)]
        firsts.append(size * groups[:-1])
        lasts.append(size * groups[1:])
    return Arcs(np.concatenate(firsts), np.concatenate(lasts) % count, np.concatenate(parents))
