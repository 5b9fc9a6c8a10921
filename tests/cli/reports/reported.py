"""A plan of nothing, and its report as plain text."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.console.output import show
from radmpc.console.reports.report import plan_report
from radmpc.experiments.families import circle
from radmpc.model.plan import Plan, Risk, Status, Trajectory
from radmpc.model.scenario import Scenario


def standing(scenario: Scenario) -> tuple[Trajectory, ...]:
    """Vehicles that stay where they start."""
    steps = scenario.horizon + 1
    return tuple(
        Trajectory(
            v.name, np.zeros((steps - 1, 2)), np.tile(v.start, (steps, 1)), v.covariances(steps - 1)
        )
        for v in scenario.vehicles
    )


def make_plan(**changes: object) -> Plan:
    """A plan of nothing, to report on."""
    fields: dict[str, object] = {
        "scenario": circle(3),
        "planner": "ira",
        "seed": 0,
        "status": Status.OPTIMAL,
        "cost": 10.0,
        "lower_bound": 9.9,
        "risk": Risk(0.05, 0.01),
        "sets": (("v1",), ("v2", "v3")),
        "seconds": {"radmpc": 0.5, "total": 1.0},
        "trajectories": standing(circle(3)),
    }
    return Plan(**(fields | changes))  # type: ignore[arg-type] # fields by name


def shown(capsys: pytest.CaptureFixture[str], plan: Plan) -> str:
    """The report as plain text."""
    show(*plan_report(plan))
    return capsys.readouterr().out
