"""The planners as a table and as JSON."""

from __future__ import annotations

from rich.table import Table

from radmpc.planners.presets import DEFAULT, PRESETS

__all__ = ["planner_table", "planners_json"]


def planner_table() -> Table:
    """Return the named planners, the three choices of each and what it is."""
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for column in ("planner", "policy", "solver", "decomposition"):
        table.add_column(column, no_wrap=True)
    table.add_column("what it is")
    for preset in PRESETS.values():
        record = preset.planner
        name = f"{preset.name} (default)" if preset.name == DEFAULT else preset.name
        choices = (str(record.policy), str(record.solver), str(record.decomposition))
        table.add_row(name, *choices, preset.summary)
    return table


def planners_json() -> dict[str, object]:
    """Return the same as plain values."""
    return {
        "default": DEFAULT,
        "planners": [
            {
                "name": preset.name,
                "policy": str(preset.planner.policy),
                "solver": str(preset.planner.solver),
                "decomposition": str(preset.planner.decomposition),
                "summary": preset.summary,
            }
            for preset in PRESETS.values()
        ],
    }
