"""A sweep for people: a line per scenario, and why there is no plan where there is none."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table
from rich.text import Text

from radmpc.experiments.sweep_table import SweepRow
from radmpc.solvers.solution import relative_gap
from radmpc.wording import percent, short_cost

__all__ = ["sweep_report"]

_NONE = "–"


def sweep_report(axes: Sequence[str], rows: Sequence[SweepRow]) -> list[Table | Text]:
    """Return a table of the rows, and their problems.

    Parameters
    ----------
    axes : sequence of str
        Keys.
    rows : sequence of SweepRow
        What planning made of each scenario.
    """
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for key in axes:
        table.add_column(key, justify="right", overflow="fold")
    table.add_column("status", no_wrap=True)
    for name in ("cost", "gap", "certificate", "seconds"):
        table.add_column(name, no_wrap=True, justify="right")
    for row in rows:
        table.add_row(*row.values, *_cells(row))
    problems = [
        Text(f"{_place(axes, row)}: {row.problem}", style="red") for row in rows if row.problem
    ]
    return [table, *problems]


def _cells(row: SweepRow) -> list[Text | str]:
    """Return status and numbers."""
    seconds = f"{row.seconds:.2f}"
    if row.cost is None:
        return [Text(row.status, style="red"), _NONE, _NONE, _NONE, seconds]
    style = "green" if row.within else "red"
    gap = _NONE
    if row.lower_bound is not None:
        gap = percent(relative_gap(row.cost, row.lower_bound))
    certified = _NONE if row.certified is None else f"{min(row.certified, 1.0):.4g}"
    return [row.status, short_cost(row.cost, 5), gap, Text(certified, style=style), seconds]


def _place(axes: Sequence[str], row: SweepRow) -> str:
    """Return which scenario it is."""
    return ", ".join(f"{key}={word}" for key, word in zip(axes, row.values, strict=True))
