"""Several plans of one scenario side by side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import overload

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.patches import Polygon
from matplotlib.text import Annotation
from mpl_toolkits.mplot3d import Axes3D

from radmpc.arrays import Matrix
from radmpc.model.given import check_plan
from radmpc.model.plan import Plan
from radmpc.plotting.canvas.extent import plan_extent
from radmpc.plotting.canvas.figure import check_figure, new_figure, settle_axes
from radmpc.plotting.canvas.headline import PLAIN
from radmpc.plotting.canvas.style import TITLE_SIZE, vehicle_colors
from radmpc.plotting.canvas.title import num_title_lines
from radmpc.plotting.plan import plot_plan
from radmpc.records import dataclass

__all__ = ["Panel", "plot_panels"]

_WIDTH = 3.0
"""Width of a panel [in]."""

_LINE = 0.135
"""Height of a line of text [in]."""

_MOST_COLUMNS = 3
"""Panels side by side."""


@dataclass(frozen=True, slots=True, eq=False)
class Panel:
    """One plan of several.

    Attributes
    ----------
    title : str
        Its headline.
    plan : Plan
        What to draw.
    outlines : sequence of (str, sequence of (p, 2) array)
        Of each vehicle's temporal obstacle, step by step [m]; drawn in its color.
    """

    title: str
    plan: Plan
    outlines: Sequence[tuple[str, Sequence[Matrix]]] = ()

    def __post_init__(self) -> None:
        """Refuse what is no plan."""
        check_plan(self.plan)


@overload
def plot_panels(panels: Sequence[Panel], figure: None = None) -> Figure: ...
@overload
def plot_panels(panels: Sequence[Panel], figure: Figure | SubFigure) -> Figure | SubFigure: ...
@rc_context(PLAIN)
def plot_panels(
    panels: Sequence[Panel], figure: Figure | SubFigure | None = None
) -> Figure | SubFigure:
    """Draw plans side by side at the same scale, at most three in a row.

    Parameters
    ----------
    panels : sequence of Panel
        At least one; all of one dimension.
    figure : Figure, SubFigure or None
        Where, beside whatever it holds already. None makes one that belongs to no window.

    Returns
    -------
    Figure or SubFigure
        The figure drawn on; nothing is shown and nothing saved.
    """
    check_figure(figure)
    extents = [plan_extent(panel.plan) for panel in panels]
    extent = np.stack([np.min(extents, axis=0)[0], np.max(extents, axis=0)[1]])
    columns = 2 if len(panels) == 4 else min(len(panels), _MOST_COLUMNS)
    rows = -(-len(panels) // columns)
    is_flat = extent.shape[1] == 2
    width, height = (extent[1] - extent[0])[:2]
    ratio = float(np.clip(height / width, 0.3, 1.6)) if is_flat else 0.8
    lines = max(num_title_lines(panel.plan) for panel in panels)
    inches = rows * ((_WIDTH - 0.3) * ratio + 0.35 + _LINE * lines)
    if figure is None:
        figure = new_figure(columns * _WIDTH, inches)
    with rc_context({"grid.color": "#D0D0D0", "grid.linewidth": 0.4}):
        all_axes = [
            figure.add_subplot(rows, columns, i + 1, projection=None if is_flat else "3d")
            for i in range(len(panels))
        ]
    if not is_flat:
        # Drawing one panel lays out all of them, by the limits that each was drawn with before.
        for axes, own in zip(all_axes, extents, strict=True):
            settle_axes(axes, own)
    for axes, panel in zip(all_axes, panels, strict=True):
        plot_plan(panel.plan, axes, title=panel.title)
        _draw_outlines(axes, panel)
        if isinstance(axes, Axes3D):
            _leave_out_of_layout(axes)
        if is_flat:
            axes.set_xlim(*extent[:, 0])
            axes.set_ylim(*extent[:, 1])
    for axes, panel in zip(all_axes, panels, strict=True):
        # Headlines of a row stand at one height, however many lines stand below them.
        missing = lines - num_title_lines(panel.plan)
        text = axes.get_title(loc="left") + "\n" * missing
        axes.set_title(text, loc="left", fontsize=TITLE_SIZE, fontweight="bold", pad=3.0)
    return figure


def _leave_out_of_layout(ax: Axes3D) -> None:
    """Let a layout measure the frame alone: contents in space have a place once they are drawn."""
    for artist in (*ax.lines, *ax.collections, *ax.patches, *ax.texts):
        if not isinstance(artist, Annotation):
            artist.set_in_layout(False)


def _draw_outlines(ax: Axes, panel: Panel) -> None:
    """Draw the temporal obstacles."""
    colors = vehicle_colors([v.name for v in panel.plan.scenario.vehicles], panel.plan.sets)
    for name, outlines in panel.outlines:
        for step, outline in enumerate(outlines):
            ax.add_patch(
                Polygon(
                    outline,
                    facecolor=(*colors[name], 0.06),
                    edgecolor=(*colors[name], 0.55),
                    linewidth=0.4,
                    zorder=2.2,
                    gid=f"temporal:{name}:{step}",
                )
            )
