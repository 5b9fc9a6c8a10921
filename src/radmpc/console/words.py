"""What a scenario asks, in words: a line that needs no table, and so no rich to load."""

from __future__ import annotations

from collections.abc import Sequence

from radmpc.model.scenario import Scenario
from radmpc.wording import count_text

__all__ = ["first_of", "scenario_line"]


def first_of(problems: Sequence[str]) -> str:
    """Return the first of some problems, and how many others there are, in one line."""
    more = len(problems) - 1
    return f"{problems[0]} (and {more} more)" if more else problems[0]


def scenario_line(scenario: Scenario) -> str:
    """Return what a scenario asks, in one line."""
    parts = [
        count_text(scenario.num_vehicles, "vehicle"),
        count_text(len(scenario.obstacles), "obstacle"),
        f"{count_text(scenario.horizon, 'step')} of {scenario.dt:g} s",
        f"risk bound {scenario.risk_bound:g}",
        "avoidance " + ("at steps" if scenario.avoidance == "steps" else "along intervals"),
    ]
    return f"{scenario.name}: {', '.join(parts)}"
