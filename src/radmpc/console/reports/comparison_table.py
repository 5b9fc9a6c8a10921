"""Planners side by side: a line each where the terminal is wide enough, else a few lines each."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console
from rich.measure import Measurement
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from radmpc.experiments.comparing import Comparison
from radmpc.planners.wording import rounded
from radmpc.result import Result
from radmpc.wording import short_cost

__all__ = ["comparison_line", "comparison_table", "rate_text"]

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
        What is not within the bound is red, and says so.
    """
    costs = [one.result.cost for one in comparisons if one.is_within and one.result is not None]
    least = min((cost for cost in costs if cost is not None), default=None)
    rows = [_cells(one, least) for one in comparisons]
    table = _wide(comparisons, rows)
    console = Console(width=10 * width)
    needed = Measurement.get(console, console.options, table).maximum
    return table if needed <= width else _narrow(comparisons, rows)


def comparison_line(one: Comparison) -> Text:
    """Return what a planner made, before what others make is known.

    Parameters
    ----------
    one : Comparison
        Its answer.
    """
    status, *cells = _cells(one, None)
    return Text(", ").join([Text.assemble((one.planner, "bold"), ": ", status), *_facts(cells)])


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
        told = _facts(cells)
        table.add_row(Text.assemble((one.planner, "bold"), ": ", status))
        if told:
            table.add_row(Padding(Text(", ").join(told), (0, 0, 0, 2)))
    return table


def _facts(cells: Sequence[Text | str]) -> list[Text]:
    """Return each number there is with what it is."""
    return [
        Text.assemble(f"{name} ", cell)
        for name, cell in zip(_NAMES, cells, strict=False)
        if str(cell) != _NONE
    ]


def _cells(one: Comparison, least: float | None) -> list[Text | str]:
    """Return one planner's status and numbers."""
    result, flown = one.result, one.simulation
    if result is None:
        return [Text("failed", style="red")]
    seconds = f"{result.seconds['total']:.2f}"
    status = _status(result)
    if result.plan is None or result.cost is None or result.certificate is None:
        return [Text(status, style="red"), *[_NONE] * 6, seconds]
    bound, certified = result.record.scenario.risk_bound, result.certificate.certified
    risk = Text(f"{min(certified, 1.0):.4g}", style="green")
    if not one.is_within:
        exact = min(certified, 1.0)
        text = f"{exact:.4g}" if float(f"{exact:.4g}") > bound else rounded(exact, bound)
        risk = Text(f"{text} > {bound:g}", style="red")
    sizes = [len(members) for members in result.sets]
    above = _NONE if not least else f"{100.0 * (result.cost / least - 1.0):+.2f} %"
    return [
        status,
        short_cost(result.cost, 4),
        above,
        risk,
        _NONE if flown is None else rate_text(flown.rate, flown.rate_low, flown.rate_high),
        str(len(sizes)),
        str(max(sizes)),
        seconds,
    ]


def _status(result: Result) -> str:
    """Return how planning ended, and whether a limit cut it off."""
    if result.record.stopped_by is None:
        return result.status.value
    is_timed = "time limit" in result.record.stopped_by
    return f"{result.status.value}, {'time limit' if is_timed else 'stopped'}"


def rate_text(rate: float, low: float, high: float) -> str:
    """Return a rate with its interval, in as many digits as it takes to hold the rate.

    Parameters
    ----------
    rate : float
        Share of samples [-].
    low, high : float
        Ends of its interval [-].

    Returns
    -------
    str
        Such as ``0.9976 (0.997–0.998)``.
    """
    for digits in range(2, 17):
        ends = f"{low:.{digits}g}", f"{high:.{digits}g}"
        told = f"{rate:.{max(digits, 4)}g}"
        holds = float(ends[0]) <= float(told) <= float(ends[1])
        if holds and (ends[0] != ends[1] or low == high):
            break
    return f"{told} ({ends[0]}–{ends[1]})"
