"""Two who keep a range, and a planner that stakes all of the wealth on losing it at once."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import beta

import radmpc
from radmpc.flying.leg import Leg, leg_of
from radmpc.flying.mission import Mission
from radmpc.flying.model import Model
from radmpc.model.dynamics import LinearSystem
from radmpc.model.plan import Plan
from radmpc.model.relations.keep import Keep
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle

SIGMA, WITHIN, BOUND, STEPS = 0.1, 4.0, 0.05, 3


def tethered() -> Scenario:
    """Return two without inertia, far from the end of their range."""
    eye = np.eye(2)
    fleet = [
        Vehicle(
            name=name, system=LinearSystem(eye, eye, (0, 1), None), start=[x, 0.0],
            goal=Goal.at([0.0, 0.0], 1e3, None), radius=0.1, control_limit=1e3,
            initial_covariance=0.0, disturbance_covariance=SIGMA**2 / 2.0,
        )
        for name, x in (("a", 0.0), ("b", 1.0))
    ]  # fmt: skip
    keep = [Keep(["a", "b"], WITHIN)]
    return Scenario("tether", 1.0, STEPS, BOUND, fleet, avoidance="steps", keep=keep)


def away(scenario: Scenario, apart: float, wasted: float) -> Leg:
    """Return the leg that is so far apart after its first step, and near again after the second."""
    one, two = (v.start for v in scenario.vehicles)
    path = np.repeat([np.add(one, [1.0, 0.0])], scenario.horizon, axis=0)
    path[0] = np.add(one, [apart, 0.0])
    controls = np.diff(np.vstack([[two], path]), axis=0)
    # Effort is wasted by both together.
    together = np.zeros_like(controls)
    together[-1, 1] = wasted
    return leg_of(scenario, [together, controls + together], 0)


def staking(scenario: Scenario, seconds: float | None = None) -> Plan:
    """Return a plan that runs all it may in its first step; of less effort at every tick."""
    del seconds
    near, far, most = 1.0, WITHIN, scenario.risk_bound * (1.0 - 1e-6)
    for _ in range(12):
        middle = 0.5 * (near + far)
        if away(scenario, middle, 0.0).price <= most:
            near = middle
        else:
            far = middle
    # What is left of a plan must look worse than the next one: its last step wastes effort.
    return away(scenario, near, 0.5 * (scenario.horizon - 1)).plan


def staked(missions: int) -> tuple[int, float]:
    """Return how many missions lose the range, and what they were charged."""
    lost, charged = 0, 0.0
    for seed in range(missions):
        scenario = tethered()
        first = away(scenario, 1.0, 50.0).plan
        mission = Mission(first, planner=staking, share=1.0, clock=lambda: 0.0)
        flight = radmpc.fly(mission, Model(scenario, seed))
        assert {contact.cause for contact in flight.contacts} <= {"range"}
        lost += flight.has_collided
        steps = [tick.next_step for tick in flight.ticks if tick.segments]
        charged += sum(step for step in steps if step is not None) / missions
        assert any(entry.what == "adopted" for entry in flight.account)
    return lost, charged


@pytest.mark.slow
def test_who_stakes_all_on_a_range_is_charged_all_of_the_bound_and_no_more() -> None:
    _, charged = staked(2)
    assert 0.9 * BOUND < charged <= BOUND * (1.0 + 1e-9)


@pytest.mark.nightly
def test_what_is_charged_bounds_how_often_a_range_is_lost() -> None:
    missions = 400
    lost, charged = staked(missions)
    assert charged <= BOUND * (1.0 + 1e-9)
    assert float(beta.ppf(1e-3, lost, missions - lost + 1)) <= BOUND
    # On a polygon within the disc more is charged than is lost, and yet some is.
    assert lost > 0
