"""Points that can be dragged, and which numbers of the document move with them.

Only numbers that stand in the document as they are have handles: not those of ``defaults``, which
are of all vehicles, nor what is computed from others.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
import numpy.typing as npt

from radmpc.serving.protocol import Content, Handle, Path
from radmpc.serving.views.numbers import Rounding

__all__ = ["box_handles", "corner_handles", "handle_of", "is_number", "value_at"]


def value_at(content: object, path: Path) -> object:
    """Return what stands at a path, None where nothing does.

    Parameters
    ----------
    content : object
        A document, or a part of one.
    path : sequence of str or int
        Keys and indices.
    """
    for key in path:
        if isinstance(content, dict) and isinstance(key, str):
            content = content.get(key)
        elif isinstance(content, list) and isinstance(key, int) and 0 <= key < len(content):
            content = content[key]
        else:
            return None
    return content


def is_number(value: object) -> bool:
    """Whether a value is a number of a document."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def handle_of(
    content: Content, at: npt.ArrayLike, vectors: Sequence[Path], rounding: Rounding
) -> Handle | None:
    """Return the handle of some vectors that move together; None unless all are there.

    Parameters
    ----------
    content : mapping
        The document.
    at : (d,) array_like
        Where it is drawn [m].
    vectors : sequence of path
        Of lists of coordinates, of which the first d move.
    rounding : Rounding
        Of the map.
    """
    place = rounding.point(at)
    axes: list[list[Path]] = [[], [], []]
    for vector in vectors:
        for axis in range(len(place)):
            path = [*vector, axis]
            if not is_number(value_at(content, path)):
                return None
            axes[axis].append(path)
    return {"at": place, "x": axes[0], "y": axes[1], "z": axes[2]} if vectors else None


def corner_handles(
    content: Content, points: npt.ArrayLike, vectors: Sequence[Path], rounding: Rounding
) -> list[Handle]:
    """Return the handle of a whole outline, then those of its corners.

    Parameters
    ----------
    content : mapping
        The document.
    points : (v, d) array_like
        Where the corners are drawn [m].
    vectors : sequence of path
        Of the corners, in the same order.
    rounding : Rounding
        Of the map.
    """
    corners = np.asarray(points, dtype=np.float64)
    whole = handle_of(content, 0.5 * (corners.min(axis=0) + corners.max(axis=0)), vectors, rounding)
    ones = [
        handle_of(content, at, [vector], rounding)
        for at, vector in zip(corners, vectors, strict=True)
    ]
    if whole is None:
        return []
    return [whole] if len(ones) < 2 else [whole, *(one for one in ones if one is not None)]


def box_handles(
    content: Content, lower: npt.ArrayLike, upper: npt.ArrayLike, path: Path, rounding: Rounding
) -> list[Handle]:
    """Return the handle of a whole box with ``min`` and ``max``, then those of its corners.

    Parameters
    ----------
    content : mapping
        The document.
    lower, upper : (d,) array_like
        The box [m].
    path : path
        Of the mapping that holds ``min`` and ``max``.
    rounding : Rounding
        Of the map.
    """
    low, high = np.asarray(lower), np.asarray(upper)
    ends = ([*path, "min"], [*path, "max"])
    whole = handle_of(content, 0.5 * (low + high), ends, rounding)
    if whole is None:
        return []
    found = [whole]
    for sides in product((0, 1), repeat=low.size):
        axes: list[list[Path]] = [[], [], []]
        for axis, side in enumerate(sides):
            axes[axis].append([*ends[side], axis])
        at = rounding.point(np.where(np.array(sides) == 1, high, low))
        found.append({"at": at, "x": axes[0], "y": axes[1], "z": axes[2]})
    return found
