"""Planners side by side: a line each where the terminal is wide enough, else a few lines each."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console
from rich.measure import Measurement
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from radmpc.experiments.comparing import Comparison

__all__ = ["comparison_table"]

_NONE = "–"
_NAMES = ("cost", "above least", "certificate", "collide (95 %)", "sets", "largest", "seconds")


def comparison_table(comparisons: Sequence[Comparison], width: int) -> Table:
    """Return status, cost, certificate, simulation, sets and seconds of every planner.

    Parameters
    ----------
    comparisons : sequence of Comparison
        What each planner made.
    width : int
        Letters of a line. Where a line per planner does not fit, nothing is cut off: each gets
        several.

    Returns
    -------
    Table
        What is not within the bound is red.
    """
    costs = [one.result.cost for one in comparisons if one.is_within and one.result is not None]
    least = min((cost for cost in costs if cost is not None), default=None)
    rows = [_cells(one, least) for one in comparisons]
    table = _wide(comparisons, rows)
    console = Console(width=10 * width)
    needed = Measurement.get(console, console.options, table).maximum
    return table if needed <= width else _narrow(comparisons, rows)


def _wide(comparisons: Sequence[Comparison], rows: Sequence[Sequence[Text | str]]) -> Table:
    """Return a line per planner."""
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    table.add_column("planner", no_wrap=True)
    table.add_column("status", no_wrap=True)
    for name in _NAMES:
        table.add_column(name, no_wrap=True, justify="right")
    for one, cells in zip(comparisons, rows, strict=True):
        table.add_row(one.planner, *cells)
    return table


def _narrow(comparisons: Sequence[Comparison], rows: Sequence[Sequence[Text | str]]) -> Table:
    """Return a paragraph per planner: its name, and all there is to tell with what it is."""
    table = Table.grid(padding=(0, 0))
    table.add_column(overflow="fold")
    for one, (status, *cells) in zip(comparisons, rows, strict=True):
        told = [
            Text.assemble(f"{name} ", cell)
            for name, cell in zip(_NAMES, cells, strict=False)
            if str(cell) != _NONE
        ]
        table.add_row(Text.assemble((one.planner, "bold"), ": ", status))
        if told:
            table.add_row(Padding(Text(", ").join(told), (0, 0, 0, 2)))
    return table


def _cells(one: Comparison, least: float | None) -> list[Text | str]:
    """Return one planner's status and numbers."""
    result, flown = one.result, one.simulation
    if result is None:
        return [Text("failed", style="red")]
    seconds = f"{result.seconds['total']:.2f}"
    if result.plan is None or result.cost is None or result.certificate is None:
        return [Text(result.status.value, style="red"), *[_NONE] * 6, seconds]
    style = "green" if one.is_within else "red"
    certified = result.certificate.certified
    sizes = [len(members) for members in result.sets]
    above = _NONE if not least else f"{100.0 * (result.cost / least - 1.0):+.2f} %"
    rate = _NONE
    if flown is not None:
        rate = f"{flown.rate:.4g} ({flown.rate_low:.2g}–{flown.rate_high:.2g})"
    return [
        result.status.value,
        f"{result.cost:.4g}",
        above,
        Text(f"{certified:.4g}" if certified <= 1.0 else "1", style=style),
        rate,
        str(len(sizes)),
        str(max(sizes)),
        seconds,
    ]
