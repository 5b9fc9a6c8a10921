"""Blocked cells of a grid, joined into few rectangles."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.model.obstacle import Obstacle

__all__ = ["Rectangle", "cell_obstacles", "rectangles"]

Cells = npt.NDArray[np.bool_]
Rectangle = tuple[int, int, int, int]
"""First column and row, and the ones after the last: x0, y0, x1, y1."""


def cell_obstacles(blocked: Cells) -> tuple[Obstacle, ...]:
    """Return obstacles r1, r2, … that cover the blocked cells exactly.

    Parameters
    ----------
    blocked : (width, height) array of bool
        By column x and row y; a cell is the square [x, x + 1] × [y, y + 1] [m].
    """
    return tuple(
        Obstacle.box(f"r{i + 1}", [x0, y0], [x1, y1])
        for i, (x0, y0, x1, y1) in enumerate(rectangles(blocked))
    )


def rectangles(blocked: Cells) -> list[Rectangle]:
    """Return rectangles without overlap whose union is the blocked cells.

    Taken greedily: from the first cell left the largest rectangle, once by rows and once by
    columns; the shorter list counts.

    Parameters
    ----------
    blocked : (width, height) array of bool
        By column x and row y.
    """
    by_columns = _greedy(blocked)
    by_rows = [(x0, y0, x1, y1) for y0, x0, y1, x1 in _greedy(blocked.T)]
    return by_columns if len(by_columns) <= len(by_rows) else by_rows


def _greedy(blocked: Cells) -> list[Rectangle]:
    """Return rectangles, each the largest that starts at the first cell not covered yet."""
    left = blocked.copy()
    found = []
    for x, y in np.argwhere(blocked).tolist():
        if left[x, y]:
            x1, y1 = _largest_from(left, x, y)
            left[x:x1, y:y1] = False
            found.append((x, y, x1, y1))
    return found


def _largest_from(left: Cells, x: int, y: int) -> tuple[int, int]:
    """Return the ends of the largest rectangle of cells that starts at a cell."""
    width, height = left.shape
    best, ends = 0, (x, y)
    reach = height
    for x1 in range(x, width):
        if not left[x1, y]:
            break
        column = left[x1, y:reach]
        if not column.all():
            reach = y + int(column.argmin())
        if (area := (x1 + 1 - x) * (reach - y)) > best:
            best, ends = area, (x1 + 1, reach)
    return ends
