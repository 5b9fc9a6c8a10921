"""Routes on a lattice, and the plans made of them: a heuristic, held to what it says."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from lanes import UNIT, path_of, problem_of
from scipy.special import ndtr

from radmpc.experiments.families import clutter, paper
from radmpc.model.dynamics import LinearSystem, double_integrator
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planners.certified.lattice.motion import Motion
from radmpc.program.build import condensed_models, controls_of
from radmpc.solvers.priced.around import search_around
from radmpc.solvers.priced.tree import RiskTree
from radmpc.solvers.solution import Limits


def rows_at(problem, path):
    """Return every row's clearance along a route without sagitta."""
    program = problem.program
    outputs = np.zeros(program.constant.size)
    outputs[: path.size] = path.ravel()
    return (program.rows.offsets - program.rows.normals @ outputs) / program.rows.deviations


def risks_along(problem, path):
    """Return the risk of each avoidance's best side, its rows' worst."""
    clearances = rows_at(problem, path)
    program = problem.program
    return np.array(
        [
            min(
                max(float(ndtr(-clearances[r])) for r in program.rows_of(side))
                for side in program.alternatives_of(avoidance)
            )
            for avoidance in range(program.num_avoidances)
        ]
    )


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", range(5))
def test_a_way_leads_from_start_to_goal_past_everything(seed):
    problem = problem_of(clutter(1, 80, seed))
    path = path_of(problem, 5.0)
    model = problem.models[0]
    assert path.shape == (31, 2)
    assert path[0] == pytest.approx(model.drift_position[0])
    assert np.all(np.abs(path[-1] - model.vehicle.goal.center) <= 0.5)
    assert np.abs(np.diff(path, axis=0)).max() <= model.reach_upper[-1].max()
    # The lattice rounds to a sixty-fourth of a deviation, and rates rows at their own.
    assert risks_along(problem, path).max() <= UNIT + 0.01


@pytest.mark.parametrize("decay", [0.0, 0.6, 1.0])
@pytest.mark.parametrize("drift", [[0.3, -0.2, 0.0, 0.0], [0.05, -0.1, 0.1, -0.05]])
def test_a_vehicle_that_lets_itself_be_carried_pays_nothing_on_the_lattice(decay, drift):
    system = double_integrator(1.0, 2)
    if decay < 1.0:
        A, B = system.A.copy(), system.B.copy()
        A[2:, 2:] *= decay
        A[:2, 2:] *= decay
        system = LinearSystem(A, B, (0, 1), (2, 3))
    start = [0.0, 0.0, 0.4, -0.1]
    vehicle = Vehicle(
        "a", system, start, Goal([-9.0, -9.0], [9.0, 9.0], None), 0.3, 1.0, 0.01, 0.01, drift=drift
    )
    model = condensed_models(Scenario("s", 1.0, 6, 0.05, (vehicle,)))[0]
    motion = Motion.of(model)
    carried = np.diff(model.drift_position, axis=0)
    assert carried[0] == pytest.approx(motion.first)
    for before, after in itertools.pairwise(carried):
        assert after == pytest.approx(motion.decay * before + motion.drift, abs=1e-9)
    fine = np.full(2, 1e-4)
    cells = np.round(carried / fine).astype(int)
    costs = motion.change_costs(cells[2], cells[3], fine, 0)
    assert all(
        float(cost[0, 0]) <= 1e-4 / gain for cost, gain in zip(costs, motion.gain, strict=True)
    )


@pytest.mark.slow
def test_dearer_risk_buys_safer_ways():
    problem = problem_of(clutter(10, 100, 0), 6)
    risks = [risks_along(problem, path_of(problem, p)).sum() for p in (0.1, 3.0, 100.0)]
    assert risks[0] > risks[1] > risks[2]


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize(("seed", "number"), [(2, 1), (2, 9), (0, 6)])
def test_passages_are_found_where_branching_takes_long(seed, number):
    problem = problem_of(clutter(10, 100, seed), number)
    price = 15.0
    tree = RiskTree(
        problem.program, UNIT, price, gap=5e-3, scale=price, limits=Limits(), rater=problem.rater
    )
    tree.run(150)
    found = problem.passage.plan(price, price, Limits(), tree.best)
    assert found.cost + price * found.risk / UNIT < 0.95 * tree.value
    rated = problem.rater.rate(found.z)
    assert rated.risk == pytest.approx(found.risk)
    assert found.cost == pytest.approx(float(problem.program.cost @ found.z))


@pytest.mark.slow
def test_a_search_around_a_plan_never_makes_it_worse():
    for seed in range(3):
        problem = problem_of(clutter(1, 80, seed))
        tree = RiskTree(problem.program, UNIT, 1.0, gap=5e-3, scale=1.0, limits=Limits())
        tree.run(30)
        before = tree.best
        after = search_around(
            problem.rater,
            problem.program.slacks(before.z),
            before,
            longest_step=1.0,
            unit=UNIT,
            price=1.0,
            scale=1.0,
            limits=Limits(),
            max_nodes=40,
        )
        assert after.cost + after.risk / UNIT <= before.cost + before.risk / UNIT


def test_a_way_past_steps_is_found_too():
    problem = problem_of(paper(4, 1))
    assert path_of(problem, 1.0).shape == (11, 2)


@pytest.mark.slow
def test_where_effort_is_free_a_passage_seeks_the_least_risk():
    scenario = clutter(10, 100, 0)
    scenario = replace(scenario, vehicles=scenario.vehicles[6:7])
    problem = problem_of(scenario)
    free = problem.without_cost()
    found = free.passage.plan(1.0, 1.0, Limits(), None)
    assert found.cost == 0.0
    assert found.risk <= problem.passage.plan(1.0, 1.0, Limits(), None).risk
    # Two thirds of it is what two events per interval leave, the rest what feedback does between.
    [controls] = controls_of(problem.models, found.z)
    by_hand = [least_of_way(scenario, controls, is_bent=bent) for bent in (False, True)]
    assert by_hand[0] <= 0.025
    assert by_hand[1] * (1.0 - 1e-6) <= found.risk <= 1.05 * by_hand[1]


def least_of_way(scenario, controls, *, is_bent):
    """Return the least risk of one vehicle's route past boxes, by faces held over intervals.

    From the scenario and the controls alone: dynamics, three events per interval (near end, near
    end as feedback bends it, far end), any of eleven shares of the reserve, and per box the
    cheapest sequence of faces, where an event that neighbors share is paid once.
    """
    [vehicle] = scenario.vehicles
    A = np.kron([[1.0, 1.0], [0.0, 1.0]], np.eye(2))
    B = np.kron([[0.5], [1.0]], np.eye(2))
    means, covariances = [vehicle.start], [vehicle.initial_covariance]
    F = A + B @ vehicle.gain
    for control in controls:
        means.append(A @ means[-1] + B @ control)
        covariances.append(F @ covariances[-1] @ F.T + vehicle.disturbance_covariance)
    means, covariances = np.array(means), np.array(covariances)
    bend = np.eye(4)[:2] - B[:2] @ vehicle.gain
    own = np.sqrt(covariances[:, 0, 0])  # the noise of both axes is the same
    bent = np.sqrt((bend @ covariances[:-1] @ bend.T)[:, 0, 0])
    shares = np.linspace(0.0, 1.0, 11)[:, None]
    total = 0.0
    for box in scenario.obstacles:
        corners = box.at(0)[0].vertices
        charged = []
        for axis, sign in itertools.product((0, 1), (1.0, -1.0)):
            margin = sign * means[:, axis] - (sign * corners[:, axis]).max() - vehicle.radius
            # Acceleration away makes the curve hang toward the box.
            hang = 0.5 * np.maximum(0.0, sign * controls[:, axis])
            near, far = margin[:-1] - hang * shares**2, margin[1:] - hang * (1.0 - shares) ** 2
            bends = ndtr(-near / bent) if is_bent else np.zeros(near.shape)
            ends = np.array([ndtr(-near / own[:-1]), bends, ndtr(-far / own[1:])])
            cheapest = ends.sum(axis=0).argmin(axis=0)
            charged.append(ends[:, cheapest, np.arange(len(controls))])
        near, bends, far = np.array(charged).transpose(1, 2, 0)
        value = near[0] + bends[0]
        for k in range(1, len(controls)):
            stays = value + np.maximum(far[k - 1], near[k])
            turns = (value + far[k - 1]).min() + near[k]
            value = np.minimum(stays, turns) + bends[k]
        total += (value + far[-1]).min()
    return total
