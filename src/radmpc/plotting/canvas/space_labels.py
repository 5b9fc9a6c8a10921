"""Names in a picture in space, placed where they are seen."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.patheffects import withStroke
from matplotlib.transforms import ScaledTranslation
from mpl_toolkits.mplot3d import Axes3D, proj3d

from radmpc.arrays import Matrix, Vector
from radmpc.plotting.canvas.figure import cell_of
from radmpc.plotting.canvas.labels import LETTER, LabelBoard
from radmpc.plotting.canvas.places import Around, best_place
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
        """
        scale = self.axes.get_figure(root=True).dpi / 72.0
        half = 0.5 * np.array([LETTER[0] * len(text), LETTER[1]]) * size * scale
        center = self._seen(place[None, :])[0]
        mark = np.full(2, _HALF_MARK * scale * size / LABEL_SIZE)
        found = best_place(center, mark, half, self._around())
        self.boxes.append(np.concatenate([found - half, found + half]))
        right, up = (found - center) / (72.0 * scale)
        beside = ScaledTranslation(right, up, self.axes.get_figure(root=True).dpi_scale_trans)
        self.axes.text(
            *(float(value) for value in place), text,
            transform=self.axes.transData + beside, color=to_rgba(color), fontsize=size,  # type: ignore[arg-type] # any color matplotlib knows
            ha="center", va="center", zorder=56, gid=gid or f"label:{text}",
            path_effects=[withStroke(linewidth=1.4, foreground="white")],
        )  # fmt: skip

    def _around(self) -> Around:
        """Return what is around texts [px]."""
        window = cell_of(self.axes)
        points = np.vstack(self.points) if self.points else np.empty((0, 2))
        frame = np.array([window.x0, window.y0, window.x1, window.y1])
        return Around(points, self.boxes, frame)

    def _seen(self, points: Matrix) -> Matrix:
        """Return where points in space are seen, (p, 2) [px]."""
        x, y, _ = proj3d.proj_transform(*points.T, self.axes.get_proj())
        return np.asarray(self.axes.transData.transform(np.column_stack([x, y])))


Board = LabelBoard | SpaceBoard


def show_all(axes: Axes) -> None:
    """Show also what reaches out of the square that matplotlib clips pictures in space to."""
    if isinstance(axes, Axes3D):
        for artist in (*axes.lines, *axes.collections, *axes.texts):
            artist.set_clip_on(False)


def board_of(axes: Axes) -> Board:
    """Return a board for axes whose limits and size are final, flat or in space."""
    return SpaceBoard(axes) if isinstance(axes, Axes3D) else LabelBoard(axes)
