"""A plan as it is flown: hulls, 3σ regions and temporal obstacles that move."""

from __future__ import annotations

from collections.abc import Callable
from io import BytesIO

from matplotlib import rc_context
from matplotlib.animation import FuncAnimation
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text
from mpl_toolkits.mplot3d import Axes3D

from radmpc.arguments import check_integer
from radmpc.model.given import check_plan
from radmpc.model.plan import Plan
from radmpc.notebook import html_picture, lacking_signs
from radmpc.plotting.artists.legend import draw_film_legend, num_film_legend_lines
from radmpc.plotting.canvas.extent import plan_extent
from radmpc.plotting.canvas.figure import (
    cell_of,
    check_axes,
    fill,
    new_axes,
    settle_axes,
    settle_layout,
)
from radmpc.plotting.canvas.headline import PLAIN, cut_headline
from radmpc.plotting.canvas.space_labels import board_of
from radmpc.plotting.canvas.style import LABEL_SIZE, MUTED, vehicle_colors
from radmpc.plotting.canvas.title import draw_title, num_title_lines
from radmpc.plotting.film.actors import draw_actors
from radmpc.plotting.film.gif import write_gif
from radmpc.plotting.scenario import draw_surroundings, name_obstacles
from radmpc.records import dataclass

__all__ = [
    "FRAMES_PER_STEP",
    "SECONDS_PER_STEP",
    "Film",
    "PlanAnimation",
    "animate_plan",
    "make_film",
]

FRAMES_PER_STEP = 5
"""Frames of a film per step unless asked otherwise."""

SECONDS_PER_STEP = 0.5
"""Duration of a step in the film [s]."""

_MOST_FRAMES = 50
"""Frames of a film per step that may be asked for."""


@dataclass(frozen=True, slots=True, eq=False)
class Film:
    """A figure and how to set it to any of its frames.

    Attributes
    ----------
    figure : Figure
        What to draw.
    show : callable
        Sets it to a frame.
    num_frames : int
        How many there are, ≥ 1.
    """

    figure: Figure
    show: Callable[[int], list[Artist]]
    num_frames: int


class PlanAnimation(FuncAnimation):
    """A film in matplotlib's form that shows itself in notebooks.

    Parameters
    ----------
    film : Film
        What to show.
    milliseconds : int
        From frame to frame.
    name : str
        What it is called where it cannot be shown.
    lacking : set of str
        Letters that the font lacks, as far as the layout has told of them.
    """

    def __init__(self, film: Film, milliseconds: int, name: str, lacking: set[str]) -> None:
        super().__init__(
            film.figure, film.show, frames=film.num_frames, init_func=list, repeat_delay=1000,
            interval=milliseconds,
        )  # fmt: skip
        self._shown = film, milliseconds, name, lacking

    def _repr_html_(self) -> str:
        """Return the film as part of a page."""
        film, milliseconds, name, laid_out = self._shown
        self._draw_was_started = True  # else matplotlib warns that nobody has looked at it
        content, dpi = BytesIO(), film.figure.dpi
        with lacking_signs() as drawn:
            write_gif(film, content, milliseconds)
        film.figure.set_dpi(dpi)
        film.show(0)
        return html_picture(content.getvalue(), "gif", name, drawn | laid_out)


def animate_plan(
    plan: Plan, ax: Axes | None = None, *, frames_per_step: int = FRAMES_PER_STEP
) -> PlanAnimation:
    """Return a plan as a film: every hull, its 3σ region and its temporal obstacle as they move.

    Trails show where everyone has been; moving obstacles move. A step takes half a second.

    Parameters
    ----------
    plan : Plan
        With trajectories.
    ax : Axes or None
        Where; three-dimensional for a scenario in space. None makes a figure of one column.
    frames_per_step : int
        Frames from one step to the next, 1 to 50.

    Returns
    -------
    PlanAnimation
        Not started and not saved: `save_animation` writes files. A notebook shows it by itself,
        as a GIF, and with buttons after ``to_jshtml()``.

    Raises
    ------
    ArgumentError
        If the frames are not 1 to 50, or the axes do not fit the scenario.
    ArgumentTypeError
        If an argument is of another kind.

    Examples
    --------
    >>> import radmpc
    >>> from radmpc.experiments.families import paper
    >>> plan = radmpc.plan(paper(2, seed=1), "distance", rng=0).require()
    >>> "<script" in radmpc.animate_plan(plan, frames_per_step=1).to_jshtml()
    True
    """
    with lacking_signs() as lacking:
        film = make_film(plan, ax, frames_per_step)
    milliseconds = round(1000.0 * SECONDS_PER_STEP / frames_per_step)
    return PlanAnimation(film, milliseconds, plan.scenario.name, lacking)


@rc_context(PLAIN)
def make_film(plan: Plan, ax: Axes | None, frames_per_step: int) -> Film:
    """Return a plan as a figure that can be set to any frame; see `animate_plan`.

    Parameters
    ----------
    plan : Plan
        What is drawn.
    ax : Axes or None
        Where; None makes a figure.
    frames_per_step : int
        From 1 to 50.
    """
    check_plan(plan)
    check_axes(ax, plan.scenario.dimension)
    check_integer(frames_per_step, "frames_per_step", 1, _MOST_FRAMES)
    extent = plan_extent(plan)
    lines = num_title_lines(plan, details=False) + num_film_legend_lines(plan)
    axes = new_axes(extent, lines) if ax is None else ax
    figure = axes.get_figure(root=True)
    if figure is None:
        raise RuntimeError("axes without a figure cannot be animated")
    settle_axes(axes, extent)
    draw_title(axes, plan, details=False)
    if ax is None:
        draw_film_legend(axes, plan)
    settle_layout(axes)
    if ax is None:
        cut_headline(axes)
        # Laid out once: a layout per frame would take longer than the frames.
        figure.set_layout_engine("none")
        if isinstance(axes, Axes3D):
            # Nothing stands beside it: the scene takes all of its cell, not a square of it alone.
            fill(axes, cell_of(axes))
    scenario = plan.scenario
    colors = vehicle_colors([v.name for v in scenario.vehicles], plan.sets)
    board = board_of(axes)
    draw_surroundings(axes, scenario, board, colors, moving=False)
    name_obstacles(scenario, board, moving=False)
    actors = draw_actors(axes, plan, colors, frames_per_step)
    clock = _clock(axes)

    def show(frame: int) -> list[Artist]:
        time = frame / frames_per_step
        for actor in actors:
            actor.show(frame, time)
        clock.set_text(f"t = {time * scenario.dt:.1f} s")
        return []

    show(0)
    return Film(figure, show, scenario.horizon * frames_per_step + 1 if plan.trajectories else 1)


def _clock(ax: Axes) -> Text:
    """Return the text that tells the time, at the upper right above the axes."""
    write = ax.text2D if isinstance(ax, Axes3D) else ax.text
    clock: Text = write(
        1.0, 1.0, "", transform=ax.transAxes, fontsize=LABEL_SIZE, color=MUTED, ha="right",
        va="bottom", gid="clock",
    )  # fmt: skip
    return clock
