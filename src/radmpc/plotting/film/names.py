"""Names that move with vehicles, and keep apart where vehicles meet."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke
from mpl_toolkits.mplot3d import Axes3D, proj3d

from radmpc.arrays import Vector
from radmpc.plotting.artists.flat import Color
from radmpc.plotting.canvas.labels import LabelBoard
from radmpc.plotting.canvas.letters import shortened, text_size
from radmpc.plotting.canvas.style import LABEL_SIZE

__all__ = ["FlatName", "MovingName", "NamesApart", "SolidName"]

_ABOVE = 7.0
"""Middle of a name above or below the middle of its vehicle in the plane [pt]."""

_BESIDE = 6.0
"""End of a name beside it [pt]."""

_EDGING = 1.4
"""Width of the white line around letters [pt]."""


_EVERYWHERE = np.array([-np.inf, -np.inf, np.inf, np.inf])
"""Where nothing is free: instead of a place out of the axes [pt]."""


class MovingName(Protocol):
    """A name that can be written on either side of what it names."""

    def boxes(self) -> Sequence[Vector]:
        """Return where it may stand in the figure, the best first: x0, y0, x1, y1 [pt]."""

    def put(self, place: int | None) -> None:
        """Write it at one of these places; None leaves it out."""


class NamesApart:
    """The names of vehicles, each at the best of its places that those before it have left."""

    def __init__(self, names: Sequence[MovingName]) -> None:
        self._names = names

    def show(self, frame: int, time: float) -> None:
        """Show them at a frame, once vehicles are where they are at it.

        Parameters
        ----------
        frame, time : int and float
            Of the film; names go by vehicles alone.
        """
        del frame, time
        taken: list[Vector] = []
        for name in self._names:
            boxes = name.boxes()
            free = (k for k, box in enumerate(boxes) if all(_are_apart(box, one) for one in taken))
            place = next(free, None)
            name.put(place)
            if place is not None:
                taken.append(boxes[place])


class FlatName:
    """A name in the plane: above a vehicle, else below, beside or farther above or below it."""

    def __init__(self, ax: Axes, name: str, color: Color) -> None:
        board = LabelBoard(ax)
        written = shortened(name, board.most_letters())
        left, right = ax.get_xlim()
        half = 0.5 * float(board.size(written)[0])
        self._axes = ax
        self._reach = left + half, right - half  # of a name's middle, so that all can be read
        self._half = 0.5 * text_size(written, LABEL_SIZE)
        beside = self._half[0] + _BESIDE
        farther = _ABOVE + 2.0 * self._half[1]
        self._offsets = [
            (0.0, _ABOVE), (0.0, -_ABOVE), (beside, 0.0), (-beside, 0.0),
            (0.0, farther), (0.0, -farther),
        ]  # fmt: skip
        self._text = ax.annotate(
            written, (0.0, 0.0), fontsize=LABEL_SIZE, color=color, ha="center", va="center",
            zorder=10, xytext=self._offsets[0], textcoords="offset points",
            path_effects=[withStroke(linewidth=_EDGING, foreground="white")],
        )  # fmt: skip

    def move(self, place: Vector) -> None:
        """Take it to where its vehicle is, (2,) [m]."""
        self._text.xy = (float(np.clip(place[0], *self._reach)), float(place[1]))

    def boxes(self) -> Sequence[Vector]:
        """Return where it may stand; only the first may leave the axes."""
        points = 72.0 / self._axes.figure.dpi
        middle = points * self._axes.transData.transform(self._text.xy)
        frame = points * np.asarray(self._axes.get_window_extent().extents)
        boxes = [_box(middle + offset, self._half) for offset in self._offsets]
        return [boxes[0], *(box if _is_within(box, frame) else _EVERYWHERE for box in boxes[1:])]

    def put(self, place: int | None) -> None:
        """Write it at one of its places."""
        self._text.set_visible(place is not None)
        self._text.set_position(self._offsets[place or 0])


class SolidName:
    """A name in space: above a vehicle, else below it."""

    def __init__(self, ax: Axes3D, name: str, color: Color) -> None:
        self._axes, self._size = ax, text_size(name, LABEL_SIZE)
        self._text = ax.text(
            0.0, 0.0, 0.0, name, fontsize=LABEL_SIZE, color=color, zorder=56, ha="center",
            path_effects=[withStroke(linewidth=_EDGING, foreground="white")],
        )  # fmt: skip

    def move(self, place: Vector) -> None:
        """Take it to where its vehicle is, (3,) [m]."""
        self._text.set_position_3d(place)

    def boxes(self) -> Sequence[Vector]:
        """Return where it may stand, as space is seen."""
        x, y, _ = proj3d.proj_transform(*self._text.get_position_3d(), self._axes.get_proj())
        middle = 72.0 / self._axes.figure.dpi * self._axes.transData.transform((x, y))
        half = 0.5 * self._size
        up = np.array([0.0, half[1]])
        return [_box(middle + up, half), _box(middle - up, half)]

    def put(self, place: int | None) -> None:
        """Write it at one of its places."""
        self._text.set_visible(place is not None)
        self._text.set_verticalalignment("top" if place else "bottom")


def _box(middle: Vector, half: Vector) -> Vector:
    """Return a box by its middle, (4,)."""
    return np.concatenate([middle - half, middle + half])


def _are_apart(first: Vector, second: Vector) -> bool:
    """Whether two boxes share no area."""
    return bool(np.any(first[:2] >= second[2:]) or np.any(second[:2] >= first[2:]))


def _is_within(box: Vector, frame: Vector) -> bool:
    """Whether a box lies in another."""
    return bool(np.all(box[:2] >= frame[:2]) and np.all(box[2:] <= frame[2:]))
