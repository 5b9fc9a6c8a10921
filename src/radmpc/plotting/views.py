"""Three panels of a scenario in space: from above, from the side, and oblique."""

from __future__ import annotations

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from mpl_toolkits.mplot3d import Axes3D

from radmpc.arrays import Matrix
from radmpc.plotting.canvas.figure import (
    ZOOM,
    cell_of,
    drawn_box,
    fill,
    new_figure,
    ratio_in_space,
    run_layout,
    settle_axes,
    zoom_to,
)
from radmpc.plotting.canvas.style import COLUMN_WIDTH, LABEL_SIZE
from radmpc.plotting.curves import ABOVE, SIDE, Plane
from radmpc.records import dataclass

__all__ = ["VIEWS_WIDTH", "Views", "new_views", "settle_views"]

VIEWS_WIDTH = 2.0 * COLUMN_WIDTH
"""Width of a figure of its own, of two columns [in]."""

_BESIDE = 0.45
"""Width of ticks and label of the y axis, and of the gap between the columns [in]."""

_BELOW = 0.56
"""Height of heading, ticks and label of a flat panel [in]."""

_LINE = 0.135
"""Height of a line of text [in]."""

_EDGES = 0.40
"""Empty space above the first line and below the last [in]."""

_LEAST, _MOST = 0.25, 0.62
"""Least and largest share of the width that the flat panels get [-]."""


_OBLIQUE = "oblique"
"""Heading of the panel in space."""


@dataclass(frozen=True, slots=True, eq=False)
class Views:
    """A figure with three panels.

    Attributes
    ----------
    figure : Figure or SubFigure
        What holds them.
    top, side : Axes
        Flat: x and y, x and z.
    oblique : Axes3D
        In space.
    """

    figure: Figure | SubFigure
    top: Axes
    side: Axes
    oblique: Axes3D

    @property
    def panels(self) -> tuple[tuple[Axes, Plane], ...]:
        """The panels and what flat ones show."""
        return (self.top, ABOVE), (self.side, SIDE), (self.oblique, ABOVE)


def new_views(extent: Matrix, num_lines: int, figure: Figure | SubFigure | None = None) -> Views:
    """Return three panels, with limits and headings, in shapes that fill the figure.

    Parameters
    ----------
    extent : (2, 3) array
        Corners of what will be shown [m].
    num_lines : int
        Lines of text above and below the panels.
    figure : Figure, SubFigure or None
        Where; None makes one of two columns, as high as the extent asks.
    """
    x, y, z = extent[1] - extent[0]
    flat, oblique = (y + z) / x, ratio_in_space(extent)
    # Both columns end at the same height where flat * w + 2 * below = oblique * (rest - w).
    room = VIEWS_WIDTH - _BESIDE
    share = (oblique * room - 2.0 * _BELOW) / ((flat + oblique) * room)
    width = float(np.clip(share, _LEAST, _MOST)) * room
    panels = max(flat * width + 2.0 * _BELOW, oblique * (room - width))
    if figure is None:
        figure = new_figure(VIEWS_WIDTH, panels + _LINE * num_lines + _EDGES)
    grid = figure.add_gridspec(
        2, 2, width_ratios=[width + _BESIDE, room - width],
        height_ratios=[y / x * width + _BELOW, z / x * width + _BELOW],
    )  # fmt: skip
    # Axes in space read the grid's looks only when they are made.
    with rc_context({"grid.color": "#D0D0D0", "grid.linewidth": 0.4}):
        views = Views(
            figure,
            figure.add_subplot(grid[0, 0]),
            figure.add_subplot(grid[1, 0]),
            figure.add_subplot(grid[:, 1], projection="3d"),
        )
    views.oblique.patch.set_visible(False)  # it reaches below the flat panels
    for (axes, plane), heading in zip(views.panels, ("top", "side", _OBLIQUE), strict=True):
        settle_axes(axes, extent, plane)
        axes.set_title(heading, loc="left", fontsize=LABEL_SIZE, pad=2.0)
    return views


def settle_views(views: Views) -> None:
    """Fix where the panels end up and fill them, so that names can be placed."""
    root = views.figure.get_figure(root=True)
    if root is None:
        return
    run_layout(root)
    if not isinstance(views.figure, Figure):
        # Other panels of the user's figure may still move it, but its room is its own.
        fill(views.oblique, cell_of(views.oblique))
        views.oblique.set_in_layout(False)
        _head(views.oblique)
        return
    # Laid out once: from here on the oblique panel is moved by hand.
    root.set_layout_engine("none")
    _center(views.oblique)
    _head(views.oblique)


def _head(ax: Axes3D) -> None:
    """Move the heading of axes in space to what is drawn: the axes reach beyond it."""
    drawn = drawn_box(ax)
    x, y = ax.transAxes.inverted().transform((drawn.x0, drawn.y1))
    title = ax.set_title(_OBLIQUE, loc="left", fontsize=LABEL_SIZE, pad=2.0, y=float(y))
    title.set_x(float(x))


def _center(ax: Axes3D) -> None:
    """Zoom and move axes in space until what is drawn fills the room they had."""
    room, zoom = cell_of(ax), ZOOM
    root = ax.get_figure(root=True)
    others = [artist for artist in root.get_children() if artist is not ax and artist.get_visible()]
    for artist in others:  # what is drawn beside takes the time, and says nothing
        artist.set_visible(False)
    for _ in range(3):  # texts keep their size, so that one step does not do
        run_layout(root)  # which places the labels
        drawn = drawn_box(ax)
        zoom *= min(room.width / drawn.width, room.height / drawn.height)
        zoom_to(ax, zoom)
        run_layout(root)
        drawn, where = drawn_box(ax), ax.bbox
        right = 0.5 * (room.x0 + room.x1 - drawn.x0 - drawn.x1)
        up = 0.5 * (room.y0 + room.y1 - drawn.y0 - drawn.y1)
        moved = where.translated(right, up)
        ax.set_position(moved.transformed(root.transFigure.inverted()))
    for artist in others:
        artist.set_visible(True)
