"""Rows of visits: none is dropped, also where no step is left for it."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.model.dynamics import double_integrator
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.model.visits import Visit
from radmpc.planners.least_effort import least_effort
from radmpc.program.build import condensed_models
from radmpc.program.condensed import CondensedModel
from radmpc.program.limits.hard import keeps_hard_rows
from radmpc.program.visits.rows import fixed_visit_rows
from radmpc.program.visits.steps import at_steps

ANYWHERE = Visit([-50.0, -50.0], [50.0, 50.0])


def model() -> CondensedModel:
    """A vehicle that stands still, which makes both visits at any step."""
    vehicle = Vehicle(
        name="a",
        system=double_integrator(1.0, 2),
        start=np.zeros(4),
        goal=Goal.at([0, 0], 1.0),
        radius=0.3,
        control_limit=np.ones(2),
        initial_covariance=1e-4,
        disturbance_covariance=1e-4,
        via=(ANYWHERE, ANYWHERE),
    )
    return condensed_models(Scenario("visits", 1.0, 8, 0.05, (vehicle,)))[0]


@pytest.mark.parametrize("steps", [(3, 5), (1, 2), (6, 7)])
def test_visits_at_rising_steps_are_rows_that_can_be_kept(steps: tuple[int, int]) -> None:
    fixed = at_steps(model(), steps)
    assert len(fixed_visit_rows(fixed)[0]) == 4
    assert keeps_hard_rows(fixed, np.zeros((8, 2)))
    assert not least_effort(fixed).is_out_of_reach


@pytest.mark.parametrize("steps", [(5, 3), (4, 4), (7, 1)])
def test_visits_at_steps_that_do_not_rise_are_a_contradiction(steps: tuple[int, int]) -> None:
    fixed = at_steps(model(), steps)
    rows, lower, upper = fixed_visit_rows(fixed)
    assert rows.shape[1] == 16
    assert lower.shape == upper.shape == (len(rows),)
    assert not keeps_hard_rows(fixed, np.zeros((8, 2)))
    assert least_effort(fixed).is_out_of_reach


@pytest.mark.parametrize("steps", [(), (3,), (3, 4, 5)])
def test_steps_of_fewer_or_more_visits_are_refused(steps: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match="zip"):
        at_steps(model(), steps)
