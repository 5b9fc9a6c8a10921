"""Routes through a lane, in haste and at leisure, and past a wall."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from lanes import UNIT, lane, path_of, problem_of

from radmpc.experiments.families import clutter
from radmpc.model.obstacle import Obstacle
from radmpc.planners.certified.lattice.half_planes import gap_middles, half_planes_of
from radmpc.planners.certified.lattice.passage import Passage
from radmpc.planners.certified.lattice.search import PathSearch
from radmpc.planners.certified.problem import SetProblem
from radmpc.program.build import condensed_models
from radmpc.solvers.priced.neighborhood import Neighborhood
from radmpc.solvers.solution import Limits


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
    assert path_of(problem_of(replace(scenario, obstacles=(shut,))), 5.0) is None
    through = path_of(problem_of(replace(scenario, obstacles=ajar)), 5.0)
    inside = through[np.abs(through[:, 0] - middle[0]) < 0.6]
    assert np.all(np.abs(inside[:, 1] - middle[1]) < 2.0)


@pytest.mark.parametrize("middle", [0.31, 0.62, 1.27])
def test_a_way_is_found_through_a_gap_between_the_lattices_lines(middle):
    problem = problem_of(lane(gap=(middle - 0.75, middle + 0.75)))
    path = path_of(problem, 10.0)
    assert path is not None
    inside = (path[:, 0] > 8.0) & (path[:, 0] < 22.0)
    assert np.abs(path[inside, 1] - middle).max() <= 0.25


def test_the_earliest_plan_leaves_the_lane_early_and_one_at_its_own_pace_does_not():
    scenario = lane()
    problem, vehicles = problem_of(scenario), scenario.vehicles
    free = problem_of(scenario.with_vehicles([replace(v, cost_weight=0.0) for v in vehicles]))
    found = [one.passage.earliest_plan(Limits()) for one in (problem, free)]
    found.append(problem.passage.plan(1.0, 1.0, Limits(), None))
    paths = [problem.means(one.z)[0] for one in found]
    early, early_for_free, own = (np.flatnonzero(path[:, 0] < 22.5).max() for path in paths)
    assert max(early, early_for_free) <= 10  # at full speed it is 7
    assert own >= early + 5
    # Where effort counts for nothing, earliness and risk are still weighed against each other.
    assert max(one.risk for one in found) < 0.05


@pytest.mark.slow
def test_vehicles_placed_greedily_take_turns_where_none_can_pass():
    scenario = lane()
    models = condensed_models(scenario)
    problem = SetProblem.of(scenario, (0, 1), models, UNIT)

    def seek(rater, block, is_earliest):
        assert is_earliest
        first = block * models[block].drift_position.size
        path_search = PathSearch(rater.program, models[block], UNIT, first, is_coarse_only=True)
        return Passage(path_search, rater).earliest_plan(Limits())

    around = Neighborhood(problem.program, UNIT, 1.0, 1.0, Limits(), 3.0, [0.0, 0.0], seek)
    z = around.place_greedily(np.zeros(problem.program.num_columns), [0, 1])
    east, west = problem.means(z)
    in_lane = [np.flatnonzero((path[:, 0] > 7.5) & (path[:, 0] < 22.5)) for path in (east, west)]
    assert max(in_lane[0]) < min(in_lane[1]) or max(in_lane[1]) < min(in_lane[0])
    assert problem.rater.rate(z).risk < 0.05


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_gaps_are_seen_at_steps_and_along_intervals(avoidance):
    scenario = replace(lane(gap=(-0.7, 0.8)), avoidance=avoidance)
    problem = problem_of(scenario)
    avoidances = half_planes_of(
        problem.program, scenario.horizon, problem.passage.path_search.output_slice
    )
    assert gap_middles(avoidances, 1, 3.0) == [pytest.approx(0.05)]


def test_half_planes_of_what_stands_still_are_held_once_for_all_windows():
    scenario = lane()
    problem = problem_of(scenario)
    avoidances = half_planes_of(
        problem.program, scenario.horizon, problem.passage.path_search.output_slice
    )
    every = [avoidance for at in avoidances for avoidance in at]
    assert len({id(avoidance.here) for avoidance in every}) == len({each.key for each in every})
    assert len({each.key for each in every}) < len(every)


def test_a_search_that_is_stopped_is_not_taken_for_one_without_a_way():
    problem, asked = problem_of(lane()), []
    stopping = Limits(is_stopped=lambda: bool(asked.append(None)) or len(asked) > 5)
    assert problem.passage.path_search.path(10.0, stopping) is None
    assert len(asked) < 10
    assert path_of(problem, 10.0) is not None
