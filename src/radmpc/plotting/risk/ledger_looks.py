"""What both parts of a ledger's picture share: figure, ticks, texts."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text
from matplotlib.transforms import ScaledTranslation

from radmpc.model.plan import Plan
from radmpc.plotting.canvas.columns import columns_within, legend_width
from radmpc.plotting.canvas.figure import DPI, numbers_of
from radmpc.plotting.canvas.style import COLUMN_WIDTH, LABEL_SIZE, MUTED, TICK_SIZE

__all__ = [
    "LINE",
    "ROW",
    "draw_key",
    "has_layout",
    "key_width",
    "new_column",
    "percent",
    "say_nothing",
    "settle_part",
    "write_beside",
]

_DROP = 0.30
"""Distance of a legend from the axes' lower edge, past ticks and label [in]."""

_LOOKS = {"frameon": False, "handlelength": 1.8, "columnspacing": 1.2, "borderaxespad": 0.0}

LINE = 0.12
"""Height of a line of a legend [in]."""

ROW = 0.125
"""Height of a row of the map, and of a bar [in]."""


def new_column(height: float) -> Figure:
    """Return a figure of one column that belongs to no window and no list of figures."""
    figure = Figure(figsize=(COLUMN_WIDTH, height), dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def settle_part(ax: Axes, heading: str, xlabel: str) -> Text:
    """Set heading, label and looks that both parts share; return the heading.

    Parameters
    ----------
    ax : Axes
        One part of the figure.
    heading : str
        Above it.
    xlabel : str
        Below it.
    """
    title = ax.set_title(heading, loc="left", fontsize=LABEL_SIZE, pad=3.0)
    ax.set_xlabel(xlabel, fontsize=LABEL_SIZE, labelpad=1.0)
    with numbers_of(ax):
        ax.tick_params(axis="x", labelsize=TICK_SIZE, length=2.0, width=0.5, pad=1.5)
    ax.tick_params(axis="y", labelsize=TICK_SIZE, length=0.0, width=0.5, pad=1.5)
    for axis in (ax.xaxis, ax.yaxis):
        # What large numbers have in common, matplotlib writes large.
        axis.get_offset_text().set_fontsize(TICK_SIZE)
    for side, spine in ax.spines.items():
        spine.set_linewidth(0.5)
        spine.set_visible(side in {"left", "bottom"})
    return title


def say_nothing(ax: Axes, plan: Plan) -> Axes:
    """Write why there is nothing to draw.

    Parameters
    ----------
    ax : Axes
        Axes to draw on.
    plan : Plan
        Without risk, certificate or trajectories.
    """
    text = "no plan" if not plan.trajectories else "no risk at all"
    if plan.trajectories and plan.risk.certified is None:
        text = "no certificate"
    ax.text(0.5, 0.5, text, transform=ax.transAxes, ha="center", va="center", fontsize=LABEL_SIZE)
    ax.set_xticks([])
    ax.set_yticks([])
    return ax


def has_layout(ax: Axes) -> bool:
    """Whether something makes room for what stands around the axes."""
    figure = ax.get_figure(root=True)
    return figure is not None and figure.get_layout_engine() is not None


def draw_key(ax: Axes, columns: int) -> int:
    """Say what lines and bars mean: below the axes, or within where nothing makes room there.

    Returns how many lines that takes.

    Parameters
    ----------
    ax : Axes
        With labeled lines and bars.
    columns : int
        Entries side by side, unless they are wider than the axes.
    """
    figure = ax.get_figure(root=True)
    handles, labels = ax.get_legend_handles_labels()
    if figure is None or not has_layout(ax):
        ax.legend(fontsize=TICK_SIZE, loc="upper right", frameon=True, framealpha=0.85)
        return len(handles)
    entries = dict(zip(labels, handles, strict=True))
    # Before the layout axes are a little narrower than they will be.
    width = float(ax.get_window_extent().width / figure.dpi)
    columns = columns_within(entries, width, _LOOKS, most=columns)
    ax.legend(
        handles, labels, loc="upper center", bbox_to_anchor=(0.5, 0.0), fontsize=TICK_SIZE,
        bbox_transform=ax.transAxes + ScaledTranslation(0.0, -_DROP, figure.dpi_scale_trans),
        ncols=columns, **_LOOKS,
    )  # fmt: skip
    return -(-len(handles) // columns)


def key_width(labels: Sequence[str]) -> float:
    """Return the width of a key of lines below axes, one entry beneath the other [in].

    Parameters
    ----------
    labels : sequence of str
        What the key says.
    """
    handles = [Line2D([], []) for _ in labels]
    return legend_width(handles, labels, 1, _LOOKS)


def write_beside(ax: Axes, row: float, text: str, gid: str) -> None:
    """Write a few letters at the right of a row.

    Parameters
    ----------
    ax : Axes
        With a row per unit of y.
    row : float
        Number of the row.
    text : str
        A few letters.
    gid : str
        Name of the artist, for tests and SVG.
    """
    ax.annotate(
        text,
        (1.0, row),
        xycoords=("axes fraction", "data"),
        xytext=(3.0, 0.0),
        textcoords="offset points",
        fontsize=TICK_SIZE,
        color=MUTED,
        va="center",
        annotation_clip=False,
        gid=gid,
    )


def percent(share: float) -> str:
    """Return a share in percent; what rounds to nothing but is something says so."""
    if 0.0 < share < 0.0005:
        return "< 0.1 %"
    return f"{100.0 * share:.1f} %" if share < 10.0 else f"{100.0 * share:.0f} %"
