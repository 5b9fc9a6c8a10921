"""Figures and axes without global state."""

from __future__ import annotations

from contextlib import AbstractContextManager

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure, SubFigure
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Bbox
from mpl_toolkits.mplot3d import Axes3D, proj3d

from radmpc.arguments import value_text
from radmpc.arrays import Matrix
from radmpc.errors import ArgumentError, ArgumentTypeError
from radmpc.plotting.canvas.style import COLUMN_WIDTH, LABEL_SIZE, TICK_SIZE
from radmpc.plotting.curves import ABOVE, Plane

__all__ = [
    "DPI",
    "ZOOM",
    "cell_of",
    "check_axes",
    "check_figure",
    "drawn_box",
    "fill",
    "new_axes",
    "new_figure",
    "numbers_of",
    "points_per_unit",
    "ratio_in_space",
    "run_layout",
    "settle_axes",
    "settle_layout",
    "zoom_to",
]

DPI = 300
"""Resolution of files and of the layout [dots/in]."""

_BESIDE_AXES = 0.32
"""Width of ticks and label of the y axis [in]."""

_BELOW_AXES = 0.30
"""Height of ticks and label of the x axis [in]."""

_LINE = 0.135
"""Height of a line of text [in]."""

_AZIMUTH, _ELEVATION = -60.0, 30.0
"""Directions of the view in space [°]: matplotlib's own."""

ZOOM = 0.95
"""Zoom of scenes in space before they are made to fill the axes [-]."""

_EDGES = 0.12
"""Empty space above the first line and below the last [in]."""


def new_axes(extent: Matrix, num_lines: int = 1) -> Axes:
    """Return axes in a figure of their own, one column wide, as high as the extent asks.

    The figure belongs to no window and to no list of figures: it goes when the axes go.

    Parameters
    ----------
    extent : (2, d) array
        Corners of what will be shown [m].
    num_lines : int
        Lines of text above and below the axes.

    Returns
    -------
    Axes
        Three-dimensional where the extent is.
    """
    width, height = (extent[1] - extent[0])[:2]
    is_flat = extent.shape[1] == 2
    ratio = float(np.clip(height / width, 0.3, 1.6)) if is_flat else ratio_in_space(extent)
    inches = (COLUMN_WIDTH - _BESIDE_AXES) * ratio + _BELOW_AXES + _LINE * num_lines + _EDGES
    figure = new_figure(COLUMN_WIDTH, inches)
    # Axes in space read the grid's looks only when they are made.
    with rc_context({"grid.color": "#D0D0D0", "grid.linewidth": 0.4}):
        return figure.add_subplot(projection=None if is_flat else "3d")


def new_figure(width: float, height: float) -> Figure:
    """Return a figure [in] that belongs to no window and to no list of figures.

    Parameters
    ----------
    width : float
        Across [in].
    height : float
        Up [in].
    """
    figure = Figure(figsize=(width, height), dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def check_axes(ax: object, dimension: int | None = None) -> None:
    """Refuse what cannot be drawn on.

    Parameters
    ----------
    ax : object
        The argument; None makes a figure.
    dimension : int or None
        Number of coordinates that the axes must have; None is any.

    Raises
    ------
    ArgumentTypeError
        If it is neither axes nor None.
    ArgumentError
        If the axes have another number of coordinates.
    """
    if ax is None:
        return
    if not isinstance(ax, Axes):
        raise ArgumentTypeError(
            f"ax must be one of matplotlib's Axes or None, got {value_text(ax)}"
        )
    if dimension is not None and isinstance(ax, Axes3D) != (dimension == 3):
        expected = "made with projection='3d'" if dimension == 3 else "flat"
        raise ArgumentError(f"ax must be {expected} for a scenario in {dimension}-D")


def check_figure(figure: object) -> None:
    """Refuse what holds no axes.

    Raises
    ------
    ArgumentTypeError
        If it is neither a figure, a part of one, nor None.
    """
    if figure is not None and not isinstance(figure, Figure | SubFigure):
        raise ArgumentTypeError(
            "figure must be one of matplotlib's Figure, SubFigure or None, "
            f"got {value_text(figure)}"
        )


def settle_axes(ax: Axes, extent: Matrix, plane: Plane = ABOVE) -> None:
    """Set limits, equal aspect and the axes' labels; flat axes show two coordinates.

    Parameters
    ----------
    ax : Axes
        Flat, or in space.
    extent : (2, d) array
        Least and largest coordinates [m].
    plane : (int, int)
        The two coordinates that flat axes show.
    """
    across, up = plane
    ax.set_xlim(*extent[:, across])
    ax.set_ylim(*extent[:, up])
    ax.set_xlabel(f"{'xyz'[across]} [m]", fontsize=LABEL_SIZE, labelpad=1.0)
    ax.set_ylabel(f"{'xyz'[up]} [m]", fontsize=LABEL_SIZE, labelpad=1.0)
    with numbers_of(ax):
        ax.tick_params(labelsize=TICK_SIZE, length=2.0, width=0.5, pad=1.5)
    in_space = [ax.zaxis] if isinstance(ax, Axes3D) else []
    for axis in (ax.xaxis, ax.yaxis, *in_space):
        # Far from the origin ticks have something in common, which matplotlib writes large.
        axis.get_offset_text().set_fontsize(TICK_SIZE)
    if isinstance(ax, Axes3D):
        ax.set_zlim(*extent[:, 2])
        sides = extent[1] - extent[0]
        # Short sides have room for few numbers.
        x, y, z = np.clip([14.0, 14.0, 9.0] * sides / sides.max(), 2, 9).astype(int).tolist()
        ax.xaxis.set_major_locator(MaxNLocator(x, steps=[1, 2, 2.5, 5, 10]))
        ax.yaxis.set_major_locator(MaxNLocator(y, steps=[1, 2, 2.5, 5, 10]))
        ax.zaxis.set_major_locator(MaxNLocator(z))
        ax.set_zlabel("z [m]", fontsize=LABEL_SIZE, labelpad=-8.0)
        ax.tick_params(pad=-2.0)
        ax.set_box_aspect(tuple(extent[1] - extent[0]), zoom=ZOOM)
        return
    # Left of the axes, above the highest number: above the axes stand facts.
    ax.yaxis.get_offset_text().set(x=-0.005, ha="right")
    ax.yaxis.OFFSETTEXTPAD = 5
    ax.set_aspect("equal", adjustable="box")
    for spine in ax.spines.values():
        spine.set_linewidth(0.5)


def points_per_unit(ax: Axes) -> float:
    """Return the length of a unit of flat axes in the figure, on the shorter axis [pt].

    Parameters
    ----------
    ax : Axes
        Its limits and size are final.
    """
    pixels = np.diff(ax.transData.transform([[0.0, 0.0], [1.0, 1.0]]), axis=0)
    figure = ax.get_figure(root=True)
    # Axes that were taken off their figure are drawn on none.
    return 0.0 if figure is None else float(pixels.min()) * 72.0 / figure.dpi


def settle_layout(ax: Axes) -> None:
    """Fix where the axes end up, so that sizes of texts can be told in meters."""
    figure = ax.get_figure(root=True)
    if figure is None:
        return
    run_layout(figure)
    if isinstance(ax, Axes3D):
        fill(ax)


def run_layout(figure: Figure) -> None:
    """Lay a figure out; numbers at its axes are formulas where its owner's are, as powers of ten.

    Parameters
    ----------
    figure : Figure
        Other panels of it may be a user's: labels are made while it is laid out, and stay.
    """
    with numbers_of(*figure.axes):
        figure.draw_without_rendering()


def numbers_of(*axes: Axes) -> AbstractContextManager[None]:
    """Return settings by which numbers are written as they are at axes, and not as names.

    Parameters
    ----------
    *axes : Axes
        Their own headlines, made with them, tell whether a dollar begins a formula.
    """
    parsed = any(ax.title.get_parse_math() for ax in axes)
    return rc_context({"text.parse_math": parsed})


def fill(ax: Axes3D, cell: Bbox | None = None) -> None:
    """Zoom until box, ticks and labels in space fill a cell [px] around the axes' middle.

    None is the square that the axes have themselves: what reaches beyond it, layouts count as the
    axes' own.

    Parameters
    ----------
    ax : Axes3D
        What is zoomed.
    cell : Bbox or None
        What the drawing may fill [px].
    """
    drawn = drawn_box(ax)
    cell = ax.bbox if cell is None else cell
    center = 0.5 * np.array([cell.x0 + cell.x1, cell.y0 + cell.y1])
    # Zooming keeps the center: what counts is how far the drawing reaches from it.
    reach = np.abs(np.array([drawn.x0, drawn.y0, drawn.x1, drawn.y1]) - np.tile(center, 2))
    half = 0.5 * np.array([cell.width, cell.height])
    zoom = float(np.min(np.tile(half, 2) / np.maximum(reach, 1.0)))
    zoom_to(ax, ZOOM * zoom)


def drawn_box(ax: Axes3D) -> Bbox:
    """Return what box, ticks and labels in space cover [px]."""
    boxes = [axis.get_tightbbox() for axis in (ax.xaxis, ax.yaxis, ax.zaxis)]
    corners = np.array(np.meshgrid(ax.get_xlim(), ax.get_ylim(), ax.get_zlim())).reshape(3, -1)
    x, y, _ = proj3d.proj_transform(*corners, ax.get_proj())
    pixels = ax.transData.transform(np.column_stack([x, y]))
    box = Bbox([pixels.min(axis=0), pixels.max(axis=0)])
    return Bbox.union([box, *(box for box in boxes if box is not None)])


def cell_of(ax: Axes3D) -> Bbox:
    """Return the cell that a layout gave to axes in space [px]; they use a square of it."""
    transform = ax.get_figure(root=True).transFigure
    return Bbox(transform.transform(ax.get_position(original=True).get_points()))


def zoom_to(ax: Axes3D, zoom: float) -> None:
    """Draw the box in space by a factor larger than matplotlib does, at equal scales.

    Parameters
    ----------
    ax : Axes3D
        What is zoomed.
    zoom : float
        Factor over matplotlib's own size [-].
    """
    limits = np.array([ax.get_xlim(), ax.get_ylim(), ax.get_zlim()])
    ax.set_box_aspect(tuple(np.ptp(limits, axis=1)), zoom=zoom)


def ratio_in_space(extent: Matrix) -> float:
    """Return height over width of a box as it is looked at."""
    azimuth, elevation = np.radians([_AZIMUTH, _ELEVATION])
    x, y, z = extent[1] - extent[0]
    across = abs(x * np.sin(azimuth)) + abs(y * np.cos(azimuth))
    deep = abs(x * np.cos(azimuth)) + abs(y * np.sin(azimuth))
    high = z * np.cos(elevation) + deep * np.sin(elevation)
    return float(np.clip(0.88 * high / across, 0.5, 1.2))  # its corners leave room at the top
