"""What vehicles do alone in the bound by faces makes the plan at hand cheaper."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from radmpc.experiments.families import paper
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.planners import Branch, Centralized, Certified, Ira, Optimal, Planner
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.phases.by_faces import bound_faces_of_each
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.outcome.record import Certifying
from radmpc.planning import plan
from radmpc.solvers.solution import Limits

BOX = Obstacle.box("box", [4.5, -3.0], [5.5, 0.8])
"""The way over it is the shorter one."""

WALL = Obstacle.box("wall", [4.5, 0.8], [5.5, 9.0])
"""Shuts that way."""


def one_vehicle(*obstacles: Obstacle) -> Scenario:
    """A vehicle on its way past obstacles."""
    (vehicle,) = paper(1, 1).vehicles
    goal = replace(vehicle.goal, lower=np.array([9.5, -0.5]), upper=np.array([10.5, 0.5]))
    vehicle = replace(vehicle, start=np.zeros(4), goal=goal)
    return replace(paper(1, 1), vehicles=(vehicle,), obstacles=obstacles, workspace=None)


def test_a_plan_on_the_dearer_side_is_turned_to_the_side_that_the_vehicle_alone_takes() -> None:
    shut = plan(one_vehicle(BOX, WALL), Planner(Ira(), Branch(), Centralized())).require()
    scenario = one_vehicle(BOX)
    controls = tuple(t.controls for t in shut.trajectories)
    assert shut.cost is not None
    incumbent = FleetIncumbent(controls, shut.cost, ((0,),), certified=0.01, turned_price=2.0)
    problem = Fleet.of(scenario, 1e-3, Limits())
    state = replace(SearchState.of(problem), incumbent=incumbent)
    judge = Certifying(scenario, Planner(Optimal(), Branch(), Certified())).verdict
    assert judge(controls).certified <= scenario.risk_bound
    turned = bound_faces_of_each(problem, state, 4000.0, judge).incumbent
    assert turned.cost < 0.95 * shut.cost
    assert judge(turned.controls).certified <= scenario.risk_bound
    assert bound_faces_of_each(problem, state, 4000.0).incumbent is incumbent
