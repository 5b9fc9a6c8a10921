"""Moves from place to place of a route, by the levels of speed at both of their ends.

A move from place p between levels a and b ends at p + a + b: what stands at its end, or is known by
its length, is a view of that, several times as fast as by index.
"""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector

__all__ = ["at_ends", "beyond", "by_lengths", "displacement_costs"]


def beyond(values: Tensor, count: int) -> Tensor:
    """Return values, (..., n), that go on as the last ones do, (..., n + count).

    Parameters
    ----------
    values : (..., n) array
        By places.
    count : int
        Places past the end.
    """
    return np.concatenate([values, np.repeat(values[..., -1:], count, axis=-1)], axis=-1)


def at_ends(values: Matrix, shape: tuple[int, ...]) -> Tensor:
    """Return what is at the places where moves end, by the levels there, as a view, (v, v, n).

    Parameters
    ----------
    values : (v, n + 2v) array
        By levels and places.
    shape : tuple of int
        (v, v, n).
    """
    level, place = values.strides
    return np.lib.stride_tricks.as_strided(
        values, shape, (place, level + place, place), writeable=False
    )


def by_lengths(near: Matrix, shape: tuple[int, ...]) -> Tensor:
    """Return what is known of moves by their length, sums of two levels, as a view, (v, v, n).

    Parameters
    ----------
    near : (2v - 1, n) array
        By lengths and places.
    shape : tuple of int
        (v, v, n).
    """
    length, place = near.strides
    return np.lib.stride_tricks.as_strided(near, shape, (length, length, place), writeable=False)


def displacement_costs(
    places: Matrix, speeds: Tensor, gust: Vector, priced: tuple[float, float]
) -> tuple[Tensor, list[Tensor]]:
    """Return what moves cost but for room, (v, v, n), and changes of speed along each axis [m/s].

    Parameters
    ----------
    places : (n, 2) array
        Places on the route [m].
    speeds : (v, n, 2) array
        Speeds there, level by level [m/s].
    gust : (2,) array
        What a step adds to the speed without any control [m/s].
    priced : tuple of float
        Half a step [s], and what a meter costs by which no speed leads from place to place.
    """
    half, price = priced
    num_levels, count, d = speeds.shape
    shape, most = (num_levels, num_levels, count), 2 * num_levels
    squares, changes = np.zeros(shape), []
    for a in range(d):
        # Contiguous along places, and views for the rest: several times as fast as by index.
        here, begin = np.ascontiguousarray(speeds[..., a])[:, None], places[:, a]
        there = at_ends(beyond(here[:, 0], most), shape)
        changes.append(np.abs(there - here - gust[a]))
        past = np.lib.stride_tricks.sliding_window_view(beyond(begin, most), count)
        moved = past[: most - 1] - begin
        squares += np.square(by_lengths(moved, shape) - half * (there + here))
    return sum(changes, np.zeros(shape)) + price * np.sqrt(squares), changes
