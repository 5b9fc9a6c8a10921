"""Names in a picture in space, placed where they are seen."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backend_bases import RendererBase
from matplotlib.colors import to_rgba
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from matplotlib.transforms import IdentityTransform, ScaledTranslation
from mpl_toolkits.mplot3d import Axes3D, proj3d

from radmpc.arrays import Matrix, Vector
from radmpc.plotting.canvas.figure import cell_of
from radmpc.plotting.canvas.labels import LabelBoard
from radmpc.plotting.canvas.letters import text_size
from radmpc.plotting.canvas.places import (
    Around,
    best_name_place,
    best_place,
    is_on_text,
    nearest_in,
)
from radmpc.plotting.canvas.style import LABEL_SIZE
from radmpc.records import dataclass, field

__all__ = ["Board", "SpaceBoard", "board_of", "show_all"]

_HALF_MARK = 4.0
"""Half size of a start's circle, and what a text keeps from a step's dot, too [pt]."""


@dataclass(slots=True)
class SpaceBoard:
    """Places texts one after the other, away from what is seen at the same place.

    Attributes
    ----------
    axes : Axes3D
        Where to write; its limits, size and view must be final.
    points : list of (p, 2) array
        What a text should not cover [px].
    boxes : list of (4,) array
        Texts placed so far: x0, y0, x1, y1 [px].
    """

    axes: Axes3D
    points: list[Matrix] = field(default_factory=list)
    boxes: list[Vector] = field(default_factory=list)

    def avoid(self, *clouds: Matrix) -> None:
        """Keep later texts off these points, each (p, 3) [m]."""
        self.points.extend(self._seen(cloud) for cloud in clouds)

    def beside(
        self,
        text: str,
        place: Vector,
        color: object,
        *,
        size: float = LABEL_SIZE,
        gid: str | None = None,
        is_needed: bool = True,
    ) -> None:
        """Write a text next to a point in space, (3,) [m]; it stays there if the view is turned.

        Parameters
        ----------
        text : str
            One line.
        place : (3,) array
            The point [m].
        color : color
            Of the text.
        size : float
            Font size [pt].
        gid : str or None
            Name of the artist, for tests and SVG.
        is_needed : bool
            Whether it is written even where it lies on another text.
        """
        center, mark, half = self._sizes(text, place, size)
        around = self._around()
        found = best_place(center, mark, half, around)
        if is_needed or not is_on_text(np.concatenate([found - half, found + half]), around):
            self._put(text, place, found, half, color, size=size, gid=gid)

    def name(self, text: str, place: Vector, color: Any, rivals: Sequence[Vector]) -> None:
        """Write a vehicle's name beside its start as `LabelBoard.name` does.

        Parameters
        ----------
        text : str
            The name.
        place : (3,) array
            The start [m].
        color : color
            Of the vehicle.
        rivals : sequence of (3,) array
            Starts and goals of others [m].
        """
        center, mark, half = self._sizes(text, place, LABEL_SIZE)
        marks = [self._seen(rival[None, :])[0] for rival in rivals]
        boxes = [np.concatenate([seen - mark, seen + mark]) for seen in marks]
        found = best_name_place(center, mark, half, self._around(boxes))
        if found is None:
            return
        self._put(text, place, found[0], half, color)
        if found[1]:
            end = nearest_in(self.boxes[-1], center) - center
            begin = mark[0] * end / max(float(np.linalg.norm(end)), 1.0)
            offsets = np.stack([begin, end]) / self._scale
            self.axes.add_artist(_Leader(self.axes, place, offsets, color, f"leader:{text}"))
            share = np.linspace(0.0, 1.0, 12)[:, None]
            self.points.append(center + begin + share * (end - begin))

    @property
    def _scale(self) -> float:
        """Pixels per point."""
        return float(self.axes.get_figure(root=True).dpi / 72.0)

    def _sizes(self, text: str, place: Vector, size: float) -> tuple[Vector, Vector, Vector]:
        """Return where a place is seen, and half the sizes of its mark and of a text [px]."""
        half = 0.5 * text_size(text, size) * self._scale
        mark = np.full(2, _HALF_MARK * self._scale * size / LABEL_SIZE)
        return self._seen(place[None, :])[0], mark, half

    def _put(
        self,
        text: str,
        place: Vector,
        found: Vector,
        half: Vector,
        color: object,
        *,
        size: float = LABEL_SIZE,
        gid: str | None = None,
    ) -> None:
        """Write a text with its middle at a pixel, tied to a place in space."""
        center = self._seen(place[None, :])[0]
        self.boxes.append(np.concatenate([found - half, found + half]))
        right, up = (found - center) / (72.0 * self._scale)
        beside = ScaledTranslation(right, up, self.axes.get_figure(root=True).dpi_scale_trans)
        self.axes.text(
            *(float(value) for value in place), text,
            transform=self.axes.transData + beside, color=to_rgba(color), fontsize=size,  # type: ignore[arg-type] # any color matplotlib knows
            ha="center", va="center", zorder=56, gid=gid or f"label:{text}",
            path_effects=[withStroke(linewidth=1.4, foreground="white")],
        )  # fmt: skip

    def _around(self, rivals: Sequence[Vector] = ()) -> Around:
        """Return what is around texts [px]."""
        window = cell_of(self.axes)
        points = np.vstack(self.points) if self.points else np.empty((0, 2))
        frame = np.array([window.x0, window.y0, window.x1, window.y1])
        return Around(points, self.boxes, frame, rivals)

    def _seen(self, points: Matrix) -> Matrix:
        """Return where points in space are seen, (p, 2) [px]."""
        x, y, _ = proj3d.proj_transform(*points.T, self.axes.get_proj())
        return np.asarray(self.axes.transData.transform(np.column_stack([x, y])))


class _Leader(Line2D):
    """A line beside a point in space: like a text, it stays there if the view is turned."""

    def __init__(self, space: Axes3D, place: Vector, offsets: Matrix, color: Any, gid: str) -> None:
        super().__init__(
            [], [], color=color, linewidth=0.5, zorder=55.5, gid=gid,
            path_effects=[withStroke(linewidth=1.3, foreground="white")],
        )  # fmt: skip
        self.space, self.place, self.offsets = space, place, offsets
        self.set_in_layout(False)

    def draw(self, renderer: RendererBase) -> None:
        """Draw it from where the point is seen now."""
        x, y, _ = proj3d.proj_transform(*self.place, self.space.get_proj())
        center = np.asarray(self.space.transData.transform((x, y)))
        scale = np.asarray(renderer.points_to_pixels(1.0), dtype=float)
        self.set_transform(IdentityTransform())
        self.set_data(*(center + scale * self.offsets).T)
        super().draw(renderer)


Board = LabelBoard | SpaceBoard


def show_all(axes: Axes) -> None:
    """Show also what reaches out of the square that matplotlib clips pictures in space to."""
    if isinstance(axes, Axes3D):
        for artist in (*axes.lines, *axes.collections, *axes.texts):
            artist.set_clip_on(False)


def board_of(axes: Axes) -> Board:
    """Return a board for axes whose limits and size are final, flat or in space."""
    return SpaceBoard(axes) if isinstance(axes, Axes3D) else LabelBoard(axes)
