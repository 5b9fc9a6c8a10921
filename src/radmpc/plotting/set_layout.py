"""Where the vehicles of a coupling graph stand: sets as circles, packed in rows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix
from radmpc.records import dataclass, field

__all__ = ["SetLayout", "laid_out"]

_APART = 1.0
"""Distance between two vehicles of a set, the unit of the diagram."""

_GAP = 0.8
"""Distance between two sets, one above the other, in that unit."""

_NAMES = 1.4
"""Distance between two sets side by side, of which names stand in between, in that unit."""

_ALONE = 0.6
"""Distance between two vehicles planned alone, in that unit."""

_LEAST = 4.0
"""Width of the diagram at least, in that unit."""

_WIDER = 1.25
"""How much wider than that, or than the widest set, it may be where sets fill it [-]."""

_WIDTHS = 8
"""Widths that are tried [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class SetLayout:
    """Places of all vehicles, set after set.

    Attributes
    ----------
    places : (n, 2) array
        Of the vehicles; y is negative.
    outward : (n, 2) array
        Unit vectors away from the middle of a vehicle's set, down for vehicles of small sets.
    width, height : float
        Of what they take.
    """

    places: Matrix
    outward: Matrix
    width: float
    height: float


@dataclass(slots=True)
class _Packing:
    """Boxes in rows of columns; within a column lower ones stand below, and beside, each other."""

    width: float
    corners: list[list[float]] = field(default_factory=list)
    row_top: float = 0.0
    row_height: float = 0.0
    column: list[float] = field(default_factory=lambda: [0.0, 0.0])
    level: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    members: list[int] = field(default_factory=list)

    def add(self, width: float, height: float) -> None:
        """Place the next box, which may be as high as the row at most."""
        x, top, high = self.level
        left, wide = self.column
        if self.members and x + width > left + wide + 1e-9:
            x, top, high = left, top + high, 0.0
        if not self.members or top + max(high, height) > self.row_height + 1e-9:
            self._next_column(width, height)
            x, top, high = self.column[0], 0.0, 0.0
        self.corners.append([x, self.row_top + top])
        self.members.append(len(self.corners) - 1)
        self.level = [x + width, top, max(high, height)]

    def close(self) -> float:
        """Center the last column in its row; return the height of all rows."""
        self._center()
        return self.row_top + self.row_height

    def _next_column(self, width: float, height: float) -> None:
        """Begin a column, in a row of its own where this one is full."""
        self._center()
        left = sum(self.column)
        if not self.corners or left + width > self.width + 1e-9:
            self.row_top += self.row_height
            left, self.row_height = 0.0, height
        self.column, self.members = [left, width], []

    def _center(self) -> None:
        """Move the boxes of the column to the middle of the row's height."""
        _, top, high = self.level
        for i in self.members:
            self.corners[i][1] += 0.5 * (self.row_height - top - high)


def laid_out(sizes: Sequence[int]) -> SetLayout:
    """Place sets where they leave the least room.

    Parameters
    ----------
    sizes : sequence of int
        Vehicles of each set, the largest first.
    """
    radii = [0.0 if n < 2 else 0.5 * _APART / float(np.sin(np.pi / n)) for n in sizes]
    boxes = [_box(n, r) for n, r in zip(sizes, radii, strict=True)]
    least = max([_LEAST, *(wide for wide, _ in boxes)])
    area = sum(wide * high for wide, high in boxes)
    most = max(_WIDER * least, float(np.sqrt(1.6 * area)))
    packed = [_packed(boxes, float(width)) for width in np.linspace(least, most, _WIDTHS)]
    width, height, corners = min(packed, key=lambda one: (round(one[0] * one[1], 6), one[0]))
    places, outward = [np.zeros((0, 2))], [np.zeros((0, 2))]
    for n, r, (wide, high), corner in zip(sizes, radii, boxes, corners, strict=True):
        turned = 0.5 * np.pi if n == 2 else 0.0
        angles = 0.5 * np.pi + turned + 2.0 * np.pi * np.arange(n) / n
        directions = np.column_stack([np.cos(angles), np.sin(angles)])
        center = np.array([corner[0] + 0.5 * wide, -corner[1] - 0.5 * high])
        places.append(center + r * directions)
        outward.append(directions if n > 2 else np.tile([0.0, -1.0], (n, 1)))
    return SetLayout(np.vstack(places), np.vstack(outward), width, max(height, _ALONE))


def _box(count: int, radius: float) -> tuple[float, float]:
    """Return the width and height of a set: two lie flat, and need the height of one alone."""
    if count == 1:
        return _ALONE, _ALONE
    return 2.0 * radius + (
        _GAP if count == 2 else _NAMES
    ), _ALONE if count == 2 else 2.0 * radius + _GAP


def _packed(
    boxes: Sequence[tuple[float, float]], width: float
) -> tuple[float, float, list[list[float]]]:
    """Return width, height and the corners of boxes that are packed within a width."""
    packing = _Packing(width)
    for wide, high in boxes:
        packing.add(wide, high)
    rights = [corner[0] + wide for corner, (wide, _) in zip(packing.corners, boxes, strict=True)]
    return max([_LEAST, *rights]), packing.close(), packing.corners
