"""Pictures as files."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from radmpc.arguments import check_kind, check_path
from radmpc.errors import FileFormatError
from radmpc.model.plan import Plan
from radmpc.plotting.canvas.figure import DPI
from radmpc.plotting.chart import Chart, plot_chart
from radmpc.plotting.panels import Panel, plot_panels
from radmpc.plotting.plan import plot_plan
from radmpc.plotting.risk.ledger_picture import plot_ledger
from radmpc.system.atomic import write_bytes

__all__ = [
    "FIGURE_SUFFIXES",
    "beside",
    "check_figure_path",
    "save_axes",
    "save_chart",
    "save_figure",
    "save_ledger",
    "save_panels",
]

FIGURE_SUFFIXES = (".png", ".pdf", ".svg")


def check_figure_path(path: Path) -> None:
    """Refuse a figure file of an unknown kind.

    Parameters
    ----------
    path : Path
        Where the figure is to go.

    Raises
    ------
    FileFormatError
        If the name ends in none of `FIGURE_SUFFIXES`.
    """
    if path.suffix.lower() not in FIGURE_SUFFIXES:
        known = ", ".join(FIGURE_SUFFIXES)
        raise FileFormatError(f"{path}: a figure must end in {known}")


def save_axes(axes: Axes, path: str | os.PathLike[str]) -> None:
    """Write the figure that axes stand in, in the manner of `save_figure`.

    Parameters
    ----------
    axes : Axes
        What any of the functions here returned.
    path : path
        Ends in ``.png``, ``.pdf`` or ``.svg``.

    Raises
    ------
    FileFormatError
        If the name ends otherwise.
    """
    check_path(path)
    target = Path(path)
    check_figure_path(target)
    _write(_figure_of(axes), target)


def save_figure(plan: Plan, path: str | os.PathLike[str]) -> None:
    """Write the picture of a plan; an interrupted write leaves an old file as it was.

    Parameters
    ----------
    plan : Plan
        What to draw.
    path : path
        Ends in ``.png``, ``.pdf`` or ``.svg``.

    Raises
    ------
    FileFormatError
        If the name ends otherwise.

    Examples
    --------
    >>> import radmpc
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from radmpc.experiments.families import paper
    >>> plan = radmpc.plan(paper(2, seed=1), rng=0).require()
    >>> with TemporaryDirectory() as folder:
    ...     radmpc.save_figure(plan, Path(folder) / "plan.pdf")
    ...     [path.name for path in Path(folder).iterdir()]
    ['plan.pdf']
    """
    check_path(path)
    target = Path(path)
    check_figure_path(target)
    _write(_figure_of(plot_plan(plan)), target)


def save_ledger(plan: Plan, path: str | os.PathLike[str]) -> None:
    """Write the picture of a plan's risk ledger, in the manner of `save_figure`.

    Parameters
    ----------
    plan : Plan
        What to draw.
    path : path
        Ends in ``.png``, ``.pdf`` or ``.svg``.

    Raises
    ------
    FileFormatError
        If the name ends otherwise.
    """
    check_path(path)
    target = Path(path)
    check_figure_path(target)
    _write(plot_ledger(plan), target)


def save_panels(panels: Sequence[Panel], path: str | os.PathLike[str]) -> None:
    """Write plans side by side, in the manner of `save_figure`.

    Parameters
    ----------
    panels : sequence of Panel
        What to draw, at least one.
    path : path
        Ends in ``.png``, ``.pdf`` or ``.svg``.

    Raises
    ------
    FileFormatError
        If the name ends otherwise.
    """
    check_path(path)
    target = Path(path)
    check_figure_path(target)
    _write(plot_panels(panels), target)


def save_chart(chart: Chart, path: str | os.PathLike[str]) -> None:
    """Write a chart, in the manner of `save_figure`.

    Parameters
    ----------
    chart : Chart
        What to draw.
    path : path
        Ends in ``.png``, ``.pdf`` or ``.svg``.

    Raises
    ------
    FileFormatError
        If the name ends otherwise.
    """
    check_path(path)
    target = Path(path)
    check_figure_path(target)
    _write(_figure_of(plot_chart(chart)), target)


def _figure_of(axes: Axes) -> Figure:
    """Return the figure that axes stand in."""
    check_kind(axes, Axes, "axes", "one of matplotlib's Axes")
    figure = axes.get_figure(root=True)
    if figure is None:
        raise RuntimeError("axes without a figure cannot be saved")
    return figure


def _write(figure: Figure, target: Path) -> None:
    """Write a figure in one piece, through a link or into a pipe as well."""
    kind = target.suffix.lower()[1:]
    # Dates and random ids would make every file differ from the last.
    undated: dict[str, object] = {"png": {}, "pdf": {"CreationDate": None}, "svg": {"Date": None}}
    # Drawn in memory: of some formats matplotlib keeps a file open that it could not write.
    drawn = BytesIO()
    with rc_context({"svg.hashsalt": "radmpc"}):
        figure.savefig(drawn, format=kind, dpi=DPI, metadata=undated[kind])
    write_bytes(target, drawn.getvalue())


@contextmanager
def beside(target: Path) -> Iterator[str]:
    """Give the name of a file beside a place, and move it there once it is written."""
    suffix = target.suffix.lower()
    handle, name = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.", suffix=suffix)
    os.close(handle)
    try:
        yield name
        os.chmod(name, 0o666 & ~_umask())
        os.replace(name, target)
    finally:
        Path(name).unlink(missing_ok=True)


def _umask() -> int:
    """Return the process's file mode mask, which can only be read by setting it."""
    mask = os.umask(0o022)
    os.umask(mask)
    return mask
