"""What a scenario asks, in words: a line that needs no table, and so no rich to load."""

from __future__ import annotations

from radmpc.model.scenario import Scenario
from radmpc.wording import count_text

__all__ = ["scenario_line"]


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
