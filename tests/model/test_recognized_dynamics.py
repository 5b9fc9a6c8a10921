"""A double integrator is one however it is written, and nothing else is."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import permutations

import numpy as np
import pytest

from radmpc.errors import ScenarioError
from radmpc.experiments.families import paper
from radmpc.model.dynamics import LinearSystem, double_integrator, lqr_gain
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan, Trajectory
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planning import plan
from radmpc.referee import certify, simulate


def reordered(
    system: LinearSystem, states: tuple[int, ...], controls: tuple[int, ...], *, named: bool
) -> LinearSystem:
    """Return the same system with states and controls in another order."""
    where = np.argsort(states)
    d = system.dimension
    return LinearSystem(
        system.A[np.ix_(states, states)],
        system.B[np.ix_(states, controls)],
        tuple(where[:d]),
        tuple(where[d:]) if named else None,
    )


ORDERS = [
    pytest.param((0, 1, 2, 3), (0, 1), True, id="as-it-is"),
    pytest.param((0, 1, 2, 3), (0, 1), False, id="velocities-not-named"),
    pytest.param((2, 0, 3, 1), (0, 1), True, id="velocity-before-position"),
    pytest.param((0, 2, 1, 3), (0, 1), False, id="axis-by-axis"),
    pytest.param((3, 1, 0, 2), (1, 0), True, id="controls-swapped"),
    pytest.param((1, 3, 2, 0), (1, 0), False, id="all-at-once"),
]


def crossing(feedback: bool) -> Scenario:
    """A vehicle that passes close by a box and stops."""
    system = double_integrator(1.0, 2)
    box = Obstacle.box("box", [3.0, -0.4], [5.0, 3.0])
    vehicle = Vehicle(
        name="a",
        system=system,
        start=np.zeros(4),
        goal=Goal(np.array([7.8, -0.2]), np.array([8.2, 0.2]), None),
        radius=0.3,
        control_limit=np.full(2, 2.0),
        initial_covariance=np.diag([0.01, 0.02, 0.001, 0.002]),
        disturbance_covariance=np.diag([0.003, 0.001, 0.004, 0.002]),
        gain=lqr_gain(system, np.eye(4), np.diag([0.5, 1.0])) if feedback else None,
    )
    return Scenario("crossing", 1.0, 6, 0.05, (vehicle,), (box,))


@cache
def usual_flight(feedback: bool) -> tuple[Plan, float, float]:
    """Return the plan in the usual order, the risk certified, and the rate of 20,000 flights."""
    usual = plan(crossing(feedback), rng=0).require()
    return usual, certify(usual).certified, simulate(usual, 20_000, rng=2).rate


def rewritten(scenario: Scenario, states, controls, *, named: bool) -> Scenario:
    """Return the scenario with its vehicle's states and controls in another order."""
    states, controls = list(states), list(controls)
    vehicle = scenario.vehicles[0]
    turned = replace(
        vehicle,
        system=reordered(vehicle.system, tuple(states), tuple(controls), named=named),
        start=vehicle.start[states],
        control_limit=vehicle.control_limit[controls],
        initial_covariance=vehicle.initial_covariance[np.ix_(states, states)],
        disturbance_covariance=vehicle.disturbance_covariance[np.ix_(states, states)],
        gain=None if vehicle.gain is None else vehicle.gain[np.ix_(controls, states)],
    )
    return replace(scenario, vehicles=(turned,))


@pytest.mark.sampled(1)
@pytest.mark.slow
@pytest.mark.parametrize("feedback", [False, True])
@pytest.mark.parametrize(("states", "controls", "named"), ORDERS)
def test_the_order_of_states_and_controls_changes_no_plan(states, controls, named, feedback):
    usual, certified, rate = usual_flight(feedback)
    scenario = usual.scenario
    other_scenario = rewritten(scenario, states, controls, named=named)
    other = plan(other_scenario, rng=0).require()
    assert other.cost == pytest.approx(usual.cost, rel=2e-3)
    # The very same flight, written the other way, is judged the same.
    [flight] = usual.trajectories
    same = Trajectory(
        flight.name,
        flight.controls[:, list(controls)],
        flight.means[:, list(states)],
        other_scenario.vehicles[0].covariances(scenario.horizon),
        other_scenario.vehicles[0].gain,
    )
    judged = replace(usual, scenario=other_scenario, trajectories=(same,))
    assert certify(judged).certified == pytest.approx(certified, rel=1e-9)
    assert certify(judged).problems == ()
    assert simulate(judged, 20_000, rng=1).rate == pytest.approx(rate, abs=0.006)


@pytest.mark.parametrize("states", list(permutations(range(4)))[::5])
def test_every_order_of_the_states_is_recognized(states):
    system = reordered(double_integrator(0.5, 2), states, (0, 1), named=False)
    assert system.is_double_integrator
    velocities, step = system.rates
    assert step == 0.5
    assert np.all(system.A[list(system.position), list(velocities)] == 0.5)
    np.testing.assert_allclose(system.sagitta, 0.25 * system.B[list(system.position)])


def test_nobody_hides_a_double_integrator():
    base = double_integrator(1.0, 3)
    hidden = LinearSystem(base.A, base.B, base.position, None, is_double_integrator=False)
    assert hidden.is_double_integrator
    assert replace(base, is_double_integrator=False).is_double_integrator


@pytest.mark.parametrize(
    "change",
    [
        pytest.param(lambda A, B: (A, np.vstack([0 * B[:2], B[2:]])), id="controls-after-the-step"),
        pytest.param(lambda A, B: (A * np.array([1, 1, 0.9, 0.9])[:, None], B), id="drag"),
        pytest.param(lambda A, B: (A, B * np.array([1.01, 1, 1, 1])[:, None]), id="one-axis-off"),
        pytest.param(lambda A, B: (A - 1e-3 * np.eye(4)[[2, 3, 0, 1]], B), id="spring"),
    ],
)
def test_what_is_no_double_integrator_may_not_claim_to_be(change):
    base = double_integrator(1.0, 2)
    A, B = change(base.A, base.B)
    assert not LinearSystem(A, B, (0, 1), (2, 3)).is_double_integrator
    with pytest.raises(ScenarioError, match="not those of a double integrator"):
        LinearSystem(A, B, (0, 1), (2, 3), is_double_integrator=True)


def test_a_double_integrator_of_another_step_is_refused():
    scenario = paper(1, 0)
    other = double_integrator(2.0 * scenario.dt, 2)
    given = LinearSystem(other.A, other.B, (0, 1), None)
    goal = Goal.at([1.0, 1.0], 0.1, None)
    vehicle = replace(scenario.vehicles[0], system=given, goal=goal, speed_limit=None)
    with pytest.raises(ScenarioError, match="double integrator of step"):
        replace(scenario, vehicles=(vehicle,))
