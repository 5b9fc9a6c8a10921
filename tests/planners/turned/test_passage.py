"""Ways on a lattice, and the plans made of them: a heuristic, held to what it says."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ndtr

from radmpc.experiments.families import clutter, paper
from radmpc.model.dynamics import LinearSystem, double_integrator
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planners.certified.lattice.half_planes import gap_middles, half_planes_of
from radmpc.planners.certified.lattice.motion import Motion
from radmpc.planners.certified.lattice.passage import Passage
from radmpc.planners.certified.lattice.search import PathSearch
from radmpc.planners.certified.problem import SetProblem
from radmpc.program.build import condensed_models, controls_of
from radmpc.solvers.priced.around import search_around
from radmpc.solvers.priced.neighborhood import Neighborhood
from radmpc.solvers.priced.tree import RiskTree
from radmpc.solvers.solution import Limits

UNIT = 0.49


def problem_of(scenario, number=0):
    scenario = replace(scenario, vehicles=(scenario.vehicles[number],))
    return SetProblem.of(scenario, (0,), condensed_models(scenario), UNIT)


def rows_at(problem, path):
    """Return every row's clearance along a way without sagitta."""
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
    path = problem.passage.path_search.path(5.0)
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
    risks = [
        risks_along(problem, problem.passage.path_search.path(p)).sum() for p in (0.1, 3.0, 100.0)
    ]
    assert risks[0] > risks[1] > risks[2]


@pytest.mark.slow
def test_where_a_wall_shuts_the_way_there_is_none():
    scenario = clutter(1, 1, 0)
    start = scenario.vehicles[0].start[:2]
    goal = scenario.vehicles[0].goal.center
    middle = 0.5 * (start + goal)
    shut = Obstacle.box("wall", (middle[0] - 0.6, -60.0), (middle[0] + 0.6, 90.0))
    ajar = (
        Obstacle.box("below", (middle[0] - 0.6, -60.0), (middle[0] + 0.6, middle[1] - 2.0)),
        Obstacle.box("above", (middle[0] - 0.6, middle[1] + 2.0), (middle[0] + 0.6, 90.0)),
    )
    assert abs(start[0] - goal[0]) > 4.0
    assert problem_of(replace(scenario, obstacles=(shut,))).passage.path_search.path(5.0) is None
    through = problem_of(replace(scenario, obstacles=ajar)).passage.path_search.path(5.0)
    inside = through[np.abs(through[:, 0] - middle[0]) < 0.6]
    assert np.all(np.abs(inside[:, 1] - middle[1]) < 2.0)


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
            move=1.0,
            unit=UNIT,
            price=1.0,
            scale=1.0,
            limits=Limits(),
            max_nodes=40,
        )
        assert after.cost + after.risk / UNIT <= before.cost + before.risk / UNIT


def test_a_way_past_steps_is_found_too():
    problem = problem_of(paper(4, 1))
    assert problem.passage.path_search.path(1.0).shape == (11, 2)


def lane(*, gap=(-1.2, 1.2), horizon=24):
    """Two rooms, a lane between them, and a vehicle in each that must go to the other."""
    dt, noise = 2.0, np.diag([1e-3, 1e-3, 1e-4, 1e-4])
    gain = np.kron([[-0.3 / dt**2, -0.9 / dt]], np.eye(2))

    def vehicle(name, start, goal):
        return Vehicle(
            name, double_integrator(dt, 2), start, Goal.at(goal, 0.3, 0.1), 0.5, 1.0,
            noise, noise, speed_limit=1.5, gain=gain,
        )  # fmt: skip

    walls = (
        Obstacle.box("north", [8.0, gap[1]], [22.0, 6.0]),
        Obstacle.box("south", [8.0, -6.0], [22.0, gap[0]]),
    )
    vehicles = (vehicle("east", [3.0, 0.0], [27.0, 0.0]), vehicle("west", [27.0, 0.0], [3.0, 0.0]))
    bounds = Workspace(np.array([0.0, -6.0]), np.array([30.0, 6.0]))
    return Scenario("lane", dt, horizon, 0.05, vehicles, walls, workspace=bounds)


@pytest.mark.parametrize("middle", [0.31, 0.62, 1.27])
def test_a_way_is_found_through_a_gap_between_the_lattices_lines(middle):
    problem = problem_of(lane(gap=(middle - 0.75, middle + 0.75)))
    path = problem.passage.path_search.path(10.0)
    assert path is not None
    inside = (path[:, 0] > 8.0) & (path[:, 0] < 22.0)
    assert np.abs(path[inside, 1] - middle).max() <= 0.25


def test_a_vehicle_in_haste_leaves_the_lane_early_and_one_at_its_own_pace_does_not():
    scenario = lane()
    problem = problem_of(scenario)
    east, west = scenario.vehicles
    free = problem_of(scenario.with_vehicles((replace(east, cost_weight=0.0), west)))
    limits = Limits(float("inf"), lambda: False)
    found = (
        problem.passage.earliest_plan(limits),
        free.passage.earliest_plan(limits),
        problem.passage.plan(1.0, 1.0, limits, None),
    )
    paths = [problem.means(one.z)[0] for one in found]
    in_haste, in_haste_for_free, own = (np.flatnonzero(path[:, 0] < 22.5).max() for path in paths)
    assert in_haste <= 10  # at full speed it is 7
    assert in_haste_for_free <= 10
    assert own >= in_haste + 5
    # Where effort counts for nothing, haste and risk are still weighed against each other.
    assert max(one.risk for one in found) < 0.05


@pytest.mark.slow
def test_vehicles_placed_in_haste_take_turns_where_none_can_pass():
    scenario = lane()
    models = condensed_models(scenario)
    problem = SetProblem.of(scenario, (0, 1), models, UNIT)
    limits = Limits(float("inf"), lambda: False)

    def seek(rater, block, is_earliest):
        assert is_earliest
        first = block * models[block].drift_position.size
        path_search = PathSearch(rater.program, models[block], UNIT, first, is_coarse_only=True)
        return Passage(path_search, rater).earliest_plan(limits)

    around = Neighborhood(problem.program, UNIT, 1.0, 1.0, limits, 3.0, [0.0, 0.0], seek)
    z = around.place_in_haste(np.zeros(problem.program.num_columns), [0, 1])
    east, west = problem.means(z)
    in_lane = [np.flatnonzero((path[:, 0] > 7.5) & (path[:, 0] < 22.5)) for path in (east, west)]
    assert max(in_lane[0]) < min(in_lane[1]) or max(in_lane[1]) < min(in_lane[0])
    assert problem.rater.rate(z).risk < 0.05


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_gaps_are_seen_at_steps_and_along_intervals(avoidance):
    scenario = replace(lane(gap=(-0.7, 0.8)), avoidance=avoidance)
    problem = problem_of(scenario)
    avoidances = half_planes_of(
        problem.program, scenario.horizon, problem.passage.path_search.places
    )
    assert gap_middles(avoidances, 1, 3.0) == [pytest.approx(0.05)]


@pytest.mark.slow
def test_where_effort_is_free_a_passage_seeks_the_least_risk():
    scenario = clutter(10, 100, 0)
    scenario = replace(scenario, vehicles=scenario.vehicles[6:7])
    problem = problem_of(scenario)
    limits = Limits(float("inf"), lambda: False)
    free = problem.without_cost()
    found = free.passage.plan(1.0, 1.0, limits, None)
    assert found.cost == 0.0
    assert found.risk <= problem.passage.plan(1.0, 1.0, limits, None).risk
    # Two thirds of it is what two events per interval leave, the rest what feedback does between.
    [controls] = controls_of(problem.models, found.z)
    by_hand = [least_of_way(scenario, controls, is_bent=bent) for bent in (False, True)]
    assert by_hand[0] <= 0.025
    assert by_hand[1] * (1.0 - 1e-6) <= found.risk <= 1.05 * by_hand[1]


def least_of_way(scenario, controls, *, is_bent):
    """Return the least risk of one vehicle's way past boxes, by faces held over intervals.

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
