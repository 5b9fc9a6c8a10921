"""The picture of a plan."""

from __future__ import annotations

from types import NoneType
from typing import overload

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from radmpc.arguments import check_kind
from radmpc.errors import ArgumentError
from radmpc.model.given import check_plan
from radmpc.model.plan import Plan
from radmpc.plotting.artists.legend import (
    draw_legend,
    draw_views_legend,
    num_legend_lines,
    num_views_legend_lines,
)
from radmpc.plotting.canvas.extent import plan_extent
from radmpc.plotting.canvas.figure import (
    check_axes,
    check_figure,
    new_axes,
    settle_axes,
    settle_layout,
)
from radmpc.plotting.canvas.headline import PLAIN
from radmpc.plotting.canvas.title import draw_headlines, draw_title, num_title_lines
from radmpc.plotting.contents import draw_contents
from radmpc.plotting.views import VIEWS_WIDTH, Views, new_views, settle_views

__all__ = ["plot_plan", "plot_views"]


@rc_context(PLAIN)
def plot_plan(
    plan: Plan, ax: Axes | None = None, *, details: bool = True, title: str | None = None
) -> Axes:
    """Draw a plan in its scenario: mean paths, 3σ ellipses, hulls, one hue per set.

    Some steps have their numbers: paths that cross at other times do not meet. Where a vehicle
    crosses the way of a moving obstacle, both are drawn at the step at which they are nearest.
    Where the certificate exceeds the bound, red rings show the steps that risk the most.

    Parameters
    ----------
    plan : Plan
        What to draw; without trajectories the scenario alone, and why.
    ax : Axes or None
        Where; three-dimensional for a scenario in space. None makes a figure of one column, or in
        space what `radmpc.plotting.plot_views` draws. Names are placed for the size that the axes
        have now: in a figure of several axes draw the plan last.
    details : bool
        Whether run time and planner are told.
    title : str or None
        Headline; None is the scenario's name.

    Returns
    -------
    Axes
        The axes drawn on, of several the oblique ones; nothing is shown and nothing saved.

    Examples
    --------
    >>> import radmpc
    >>> from radmpc.experiments.families import paper
    >>> plan = radmpc.plan(paper(2, seed=1), rng=0).require()
    >>> radmpc.plot_plan(plan, title="mine").get_xlabel()
    'x [m]'
    """
    check_plan(plan)
    check_axes(ax, plan.scenario.dimension)
    check_kind(title, (str, NoneType), "title", "text or None")
    if ax is None and plan.scenario.dimension == 3:
        oblique: Axes = _draw_views(plan, None, details=details, title=title).oblique
        return oblique
    extent = plan_extent(plan)
    lines = num_title_lines(plan, details=details) + num_legend_lines(plan)
    axes = new_axes(extent, lines) if ax is None else ax
    settle_axes(axes, extent)
    draw_title(axes, plan, details=details, headline=title)
    if ax is None:
        draw_legend(axes, plan)
    settle_layout(axes)
    draw_contents(axes, plan)
    return axes


@overload
def plot_views(plan: Plan, figure: None = None) -> Figure: ...
@overload
def plot_views(plan: Plan, figure: Figure | SubFigure) -> Figure | SubFigure: ...
@rc_context(PLAIN)
def plot_views(plan: Plan, figure: Figure | SubFigure | None = None) -> Figure | SubFigure:
    """Draw a plan in space in three panels: from above, from the side (x and z), and oblique.

    Parameters
    ----------
    plan : Plan
        In space.
    figure : Figure, SubFigure or None
        Where, beside whatever it holds already. None makes a figure of two columns.

    Returns
    -------
    Figure or SubFigure
        The figure drawn on; nothing is shown and nothing saved.

    Raises
    ------
    ArgumentError
        If the plan is flat.
    """
    check_plan(plan)
    check_figure(figure)
    if plan.scenario.dimension != 3:
        raise ArgumentError(f"plan must be in 3-D, got {plan.scenario.dimension}-D: use plot_plan")
    return _draw_views(plan, figure).figure


def _draw_views(
    plan: Plan, figure: Figure | SubFigure | None, *, details: bool = True, title: str | None = None
) -> Views:
    """Draw three panels."""
    lines = num_title_lines(plan, details=details) + num_views_legend_lines(plan, VIEWS_WIDTH)
    views = new_views(plan_extent(plan), lines, figure)
    draw_headlines(views.figure, plan, details=details, headline=title)
    draw_views_legend(views.figure, plan)
    settle_views(views)
    for axes, plane in views.panels:
        draw_contents(axes, plan, plane)
    return views
