"""Rows as tables: one line per peer and problem, and a summary per fleet size and peer."""

from __future__ import annotations

import statistics
from collections.abc import Sequence

from rich.table import Table

from peers.harness import ABSENT, Row

__all__ = ["REFERENCE", "cells_of", "more_than", "row_table", "summary_cells", "summary_table"]

REFERENCE = "certified"
"""Whose costs others are compared with."""

Key = tuple[str, int, int]


def key_of(row: Row) -> Key:
    """Return what names a problem."""
    return (row.family, row.size, row.seed)


def references(rows: Sequence[Row]) -> dict[Key, Row]:
    """Return the reference's valid plans, by problem."""
    return {key_of(r): r for r in rows if r.peer == REFERENCE and r.is_within}


def more_than(row: Row, reference: Row | None) -> float | None:
    """Return how much more a plan costs than the reference's [%]; None if there is nothing."""
    if reference is None or not row.is_solved or row.cost is None or not reference.cost:
        return None
    return 100.0 * (row.cost / reference.cost - 1.0)


def cells_of(row: Row, reference: Row | None) -> list[str]:
    """Return one row of the first table."""
    more = more_than(row, reference)
    return [
        str(row.size),
        str(row.seed),
        row.peer,
        row.status,
        "-" if row.cost is None else f"{row.cost:.4f}",
        "-" if more is None else f"{more:+.2f}",
        "-" if row.certified is None else f"{row.certified:.5f}",
        "-" if row.cost is None else "yes" if row.is_within else "NO",
        "-" if row.seconds is None else f"{row.seconds:.3f}",
        row.note,
    ]


def row_table(rows: Sequence[Row]) -> Table:
    """Return the table of all rows, problem by problem."""
    table = Table(
        "N", "seed", "peer", "status", "cost", "more [%]", "certificate", "within Δ", r"\[s]"
    )
    table.add_column("note", overflow="fold")
    bests = references(rows)
    before = None
    for row in rows:
        if before is not None and key_of(row) != before:
            table.add_section()
        before = key_of(row)
        table.add_row(*cells_of(row, bests.get(before)))
    return table


def summary_cells(rows: Sequence[Row], bests: dict[Key, Row]) -> list[str]:
    """Return one peer's summary at one fleet size.

    Seconds are over all problems attempted, unsolved ones as long as they took; costs over those
    where both this plan and the reference's are within Δ.
    """
    tried = [r for r in rows if r.status not in ABSENT]
    seconds = [r.seconds for r in tried if r.seconds is not None]
    found = [more_than(r, bests.get(key_of(r))) for r in tried if r.is_within]
    ratios = [1.0 + more / 100.0 for more in found if more is not None]
    return [
        f"{sum(r.is_solved for r in tried)}/{len(tried)}" if tried else "-",
        f"{sum(r.is_within for r in tried)}/{len(tried)}" if tried else "-",
        f"{statistics.median(seconds):.3f}" if seconds else "-",
        f"{max(seconds):.3f}" if seconds else "-",
        f"{statistics.geometric_mean(ratios):.4f} ({len(ratios)})" if ratios else "-",
        *(str(sum(r.status == word for r in rows) or "-") for word in ABSENT),
    ]


def summary_table(rows: Sequence[Row]) -> Table:
    """Return the summary, one line per fleet size and peer."""
    titles = ("solved", "within Δ", r"median \[s]", r"worst \[s]", "cost ratio (of)")
    table = Table("N", "peer", *titles, *ABSENT)
    bests = references(rows)
    peers = list(dict.fromkeys(row.peer for row in rows))
    for size in sorted({row.size for row in rows}):
        for peer in peers:
            mine = [row for row in rows if (row.size, row.peer) == (size, peer)]
            table.add_row(str(size), peer, *summary_cells(mine, bests))
        table.add_section()
    return table
