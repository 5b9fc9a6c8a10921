"""Ways on a lattice, and the plans made of them: a heuristic, held to what it says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ndtr

from radmpc.experiments.families import clutter, paper
from radmpc.model.obstacle import Obstacle
from radmpc.planners.certified.problem import SetProblem
from radmpc.program.build import whole_subjects
from radmpc.solvers.risk_around import search_around
from radmpc.solvers.risk_tree import RiskTree
from radmpc.solvers.solution import Limits

UNIT = 0.49


def problem_of(scenario, number=0):
    scenario = replace(scenario, vehicles=(scenario.vehicles[number],))
    return SetProblem.of(scenario, (0,), whole_subjects(scenario), UNIT)


def rows_at(problem, way):
    """Return every row's clearance along a way without bow."""
    program = problem.program
    outputs = np.zeros(program.constant.size)
    outputs[: way.size] = way.ravel()
    return (program.rows.offsets - program.rows.normals @ outputs) / program.rows.deviations


def risks_along(problem, way):
    """Return the risk of each avoidance's best side, its rows' worst."""
    clearances = rows_at(problem, way)
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


@pytest.mark.parametrize("seed", range(5))
def test_a_way_leads_from_start_to_goal_past_everything(seed):
    problem = problem_of(clutter(1, 80, seed))
    way = problem.passage.walk.way(5.0)
    subject = problem.subjects[0]
    assert way.shape == (31, 2)
    assert way[0] == pytest.approx(subject.drift_position[0])
    assert np.all(np.abs(way[-1] - subject.vehicle.goal.center) <= 0.5)
    assert np.abs(np.diff(way, axis=0)).max() <= subject.reach_upper[-1].max()
    # The lattice rounds to a sixty-fourth of a deviation, and rates rows at their own.
    assert risks_along(problem, way).max() <= UNIT + 0.01


def test_dearer_risk_buys_safer_ways():
    problem = problem_of(clutter(10, 100, 0), 6)
    risks = [risks_along(problem, problem.passage.walk.way(p)).sum() for p in (0.1, 3.0, 100.0)]
    assert risks[0] > risks[1] > risks[2]


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
    assert problem_of(replace(scenario, obstacles=(shut,))).passage.walk.way(5.0) is None
    through = problem_of(replace(scenario, obstacles=ajar)).passage.walk.way(5.0)
    inside = through[np.abs(through[:, 0] - middle[0]) < 0.6]
    assert np.all(np.abs(inside[:, 1] - middle[1]) < 2.0)


@pytest.mark.parametrize(("seed", "number"), [(2, 1), (2, 9), (0, 6)])
def test_passages_are_found_where_branching_takes_long(seed, number):
    problem = problem_of(clutter(10, 100, seed), number)
    price = 15.0
    tree = RiskTree(
        problem.program, UNIT, price, gap=5e-3, scale=price, limits=Limits(), rater=problem.rater
    )
    tree.run(150)
    found = problem.passage.found(price, price, Limits(), tree.best)
    assert found.cost + price * found.risk / UNIT < 0.95 * tree.value
    rated = problem.rater.rate(found.z)
    assert rated.risk == pytest.approx(found.risk)
    assert found.cost == pytest.approx(float(problem.program.cost @ found.z))


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
    assert problem.passage.walk.way(1.0).shape == (11, 2)
