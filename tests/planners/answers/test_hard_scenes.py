"""Small scenes at the edge of numbers or of sense: each ends in an answer, within its time."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from radmpc import load_scenario
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Status
from radmpc.planners.certified.pricing import next_price
from radmpc.planning import plan
from radmpc.program.build import build_program, condensed_models
from radmpc.program.restrict import avoidance_blocks, restrict_around
from radmpc.solvers.priced.around import search_around
from radmpc.solvers.priced.neighborhood import Neighborhood
from radmpc.solvers.priced.rating import Rater
from radmpc.solvers.priced.tree import RiskTree
from radmpc.solvers.solution import Limits
from running import first_plan

SCENES = Path(__file__).parents[2] / "data" / "scenes"


def scene(name):
    return load_scenario(SCENES / name)


def answered(name, seconds):
    """Return the answer, in time and with a certificate where it is a plan."""
    # On a busy machine the clock runs on; of the processor it takes no more than was granted.
    began = time.process_time()
    result = plan(scene(name), "certified", time_limit=seconds)
    assert time.process_time() - began <= seconds + 3.0
    assert result.plan is None or result.is_certified
    return result


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    "name", ["starts-clash.yaml", "crash-sketch.json", "infeasible-considered.yaml"]
)
def test_vehicles_that_no_side_keeps_apart_get_an_answer(name):
    result = answered(name, 3.0)
    assert result.is_certified or result.explanation


@pytest.mark.parametrize("name", ["budget-complex.json", "start-risk-above-bound.yaml"])
def test_starts_that_risk_more_than_is_granted_are_named(name):
    result = answered(name, 5.0)
    assert result.status is Status.INFEASIBLE
    assert "start" in result.explanation


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", ["crash-highs-unknown.json", "highs-unknown-tiny-bound.yaml"])
def test_programs_that_highs_gives_up_on_twice_are_planned(name):
    assert first_plan(scene(name), time_limit=20.0).is_certified


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", ["tiny-risk-bound.json", "price-without-end.json"])
def test_a_risk_bound_of_one_in_a_trillion_is_planned_to_its_optimum(name):
    found = [
        plan(replace(scene(name), risk_bound=bound), "certified", time_limit=10.0)
        for bound in (1e-8, 1e-12)
    ]
    for result in found:
        assert result.status is Status.OPTIMAL
        assert result.is_certified
        assert result.lower_bound <= result.cost <= result.lower_bound * (1.0 + 1.1e-3)
    costs = [result.cost for result in found]
    assert costs == sorted(costs)


def test_a_risk_that_no_price_moves_does_not_drive_the_price_without_end():
    tried = [(0.02, 1e-3)]
    for _ in range(60):
        tried.append((next_price(tried, 1e-5), 1e-3))
    assert tried[-1][0] == tried[-2][0] <= 0.02 * 1e7


def contradictory():
    """Return a program with a vehicle's avoidance that no side keeps, and its blocks."""
    clash = scene("starts-clash.yaml")
    program = build_program(clash, condensed_models(clash), risk_bound=clash.risk_bound)
    empty = np.flatnonzero(np.diff(program.avoidance_starts) == 0)
    assert empty.size
    return program


def test_an_avoidance_without_sides_is_not_taken_for_settled():
    # The vehicle starts inside a box that its limits never let it leave.
    covered = scene("budget-complex.json")
    start = covered.vehicles[0].start[:2]
    box = Obstacle.box("around", start - 500.0, start + 500.0)
    covered = replace(covered, obstacles=(box,))
    program = build_program(covered, condensed_models(covered), risk_bound=covered.risk_bound)
    assert np.all(np.diff(program.avoidance_starts) == 0)
    part = restrict_around(
        program,
        np.array([0]),
        np.zeros(0, dtype=np.int64),
        np.zeros(program.num_columns),
        avoidance_blocks(program),
    )
    assert part.program.num_avoidances == program.num_avoidances > 0


def test_a_point_that_breaks_an_avoidance_without_sides_risks_everything():
    program = contradictory()
    rater = Rater(program, 0.49)
    rating = rater.rate(np.zeros(program.num_columns))
    assert rater.is_infeasible
    assert rating.risk == rating.largest == np.inf


@pytest.mark.slow
def test_no_search_makes_a_plan_of_a_contradiction():
    program = contradictory()
    rater, z = Rater(program, 0.49), np.zeros(program.num_columns)
    options = {"gap": 1e-3, "scale": 1.0, "limits": Limits(), "rater": rater}
    tree = RiskTree(program, 0.49, 1.0, **options)
    tree.resume(((0.0, ()),), 1.0, None)
    tree.consider(z)
    tree.run(10)
    assert tree.best is None
    assert tree.bound == np.inf
    options = {"longest_step": 1.0, "unit": 0.49, "price": 1.0, "scale": 1.0, "limits": Limits()}
    assert search_around(rater, program.slacks(z), None, max_nodes=10, **options) is None
    around = Neighborhood(program, 0.49, 1.0, 1.0, Limits(), 1.0, [0.0] * 3)
    assert around.place(z, [0, 1, 2]) is None
