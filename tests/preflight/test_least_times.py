"""Least times do not depend on windows, which are looked at by themselves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc import Goal, Scenario, Vehicle, Visit, double_integrator
from radmpc.preflight.outlook import outlook_of


def barge(name: str, drift: list[float] | None, **others: object) -> Vehicle:
    """One that has 20 m to go, in a current or not."""
    goal = Goal.at([20.0, 0.0], 1.0, within=others.pop("within", None))
    return Vehicle(
        name=name,
        system=double_integrator(2.0, 2),
        start=np.zeros(4),
        goal=goal,
        radius=0.4,
        control_limit=1.0,
        initial_covariance=0.0,
        disturbance_covariance=1e-4,
        drift=drift,
        **others,
    )


@pytest.mark.parametrize("drift", [None, [0.2, -0.1, 0.0, 0.0]])
@pytest.mark.parametrize("horizon", [10, 20, 40])
def test_windows_of_arrivals_and_visits_do_not_change_the_least_time(
    drift: list[float] | None, horizon: int
) -> None:
    plain = barge("plain", drift)
    late = barge("late", drift, within=[horizon - 2, horizon])
    box = Visit(np.array([9.0, 2.0]), np.array([11.0, 4.0]), (horizon // 2, horizon - 1))
    visiting = barge("visiting", drift, via=(box,))
    scenario = Scenario("current", 2.0, horizon, 0.05, (plain, late, visiting))
    assert [seen.least_steps for seen in outlook_of(scenario).vehicles] == [5, 5, 5]
    alone = replace(scenario, horizon=100, vehicles=(plain,))
    assert outlook_of(alone).vehicles[0].least_steps == 5
