"""What vehicles do alone among obstacles makes the plan at hand cheaper."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from radmpc.arrays import Matrix
from radmpc.experiments.families import clutter, paper
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.planners import Branch, Centralized, Certified, Ira, Optimal, Planner
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.phases.by_faces import bound_faces_of_each
from radmpc.planners.certified.phases.sides_alone import on_sides_alone, turned_to_alone
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.outcome.record import Certifying
from radmpc.planners.verdict import Judge
from radmpc.planning import plan
from radmpc.solvers.solution import Limits

BOX = Obstacle.box("box", [4.5, -3.0], [5.5, 0.8])
"""The way over it is the shorter one."""

WALL = Obstacle.box("wall", [4.5, 0.8], [5.5, 9.0])
"""Shuts that way."""


def one_vehicle(*obstacles: Obstacle) -> Scenario:
    """A vehicle on its way past obstacles."""
    return replace(paper(1, 1), vehicles=(going(),), obstacles=obstacles, workspace=None)


def going(name: str = "v0", below: float = 0.0) -> Vehicle:
    """A vehicle on its way from left to right, so far below the others [m]."""
    (vehicle,) = paper(1, 1).vehicles
    lower, upper = np.array([9.5, -0.5 - below]), np.array([10.5, 0.5 - below])
    start = np.array([0.0, -below, 0.0, 0.0])
    return replace(
        vehicle, name=name, start=start, goal=replace(vehicle.goal, lower=lower, upper=upper)
    )


def planned(scenario: Scenario) -> Plan:
    return plan(scenario, Planner(Ira(), Branch(), Centralized())).require()


def controls_of(made: Plan) -> tuple[Matrix, ...]:
    return tuple(t.controls for t in made.trajectories)


def judge_of(scenario: Scenario) -> Judge:
    return Certifying(scenario, Planner(Optimal(), Branch(), Certified())).verdict


def test_a_plan_on_the_dearer_side_is_turned_to_the_side_that_the_vehicle_alone_takes() -> None:
    shut, scenario = planned(one_vehicle(BOX, WALL)), one_vehicle(BOX)
    controls = controls_of(shut)
    assert shut.cost is not None
    incumbent = FleetIncumbent(controls, shut.cost, ((0,),), certified=0.01, turned_price=2.0)
    problem, judge = Fleet.of(scenario, 1e-3, Limits()), judge_of(scenario)
    state = replace(SearchState.of(problem), incumbent=incumbent)
    assert judge(controls).certified <= scenario.risk_bound
    turned = bound_faces_of_each(problem, state, 4000.0, judge).incumbent
    assert turned.cost < 0.95 * shut.cost
    assert judge(turned.controls).certified <= scenario.risk_bound
    assert bound_faces_of_each(problem, state, 4000.0).incumbent is incumbent
    # As before the search.
    first = on_sides_alone(problem, incumbent, judge)
    assert first.cost < 0.95 * shut.cost
    assert judge(first.controls).certified <= scenario.risk_bound


def test_who_is_dearer_alone_stays_where_it_is() -> None:
    low = Obstacle.box("low", [4.5, -33.0], [5.5, -29.2])
    both = (going(), going("v1", below=30.0))
    scenario = replace(one_vehicle(BOX, low), vehicles=both)
    (dear,), (cheap,) = (controls_of(planned(one_vehicle(*b))) for b in ((BOX, WALL), (BOX,)))
    controls, alone = (dear, cheap), (cheap, dear)
    problem, judge = Fleet.of(scenario, 1e-3, Limits()), judge_of(scenario)
    cost = sum(float(np.abs(u).sum()) for u in controls)
    incumbent = FleetIncumbent(controls, cost, ((0,), (1,)), certified=0.01, turned_price=2.0)
    state = replace(SearchState.of(problem), incumbent=incumbent)
    turned = turned_to_alone(problem, state, alone, 2.0, judge).incumbent
    # Both on the shorter way.
    assert turned.cost < 1.01 * 2.0 * float(np.abs(cheap).sum())


def test_who_stays_where_it_is_stays_there_whatever_others_do() -> None:
    (dear,), (cheap,) = (controls_of(planned(one_vehicle(*b))) for b in ((BOX, WALL), (BOX,)))
    at_goal = going("v1", below=30.0)
    at_goal = replace(at_goal, start=np.array([10.0, -30.0, 0.0, 0.0]))
    scenario = replace(one_vehicle(BOX), vehicles=(going(), at_goal))
    problem, judge = Fleet.of(scenario, 1e-3, Limits()), judge_of(scenario)
    still, cost = np.zeros_like(dear), float(np.abs(dear).sum())
    incumbent = FleetIncumbent((dear, still), cost, ((0,), (1,)), certified=0.01, turned_price=2.0)
    state = replace(SearchState.of(problem), incumbent=incumbent)
    turned = turned_to_alone(problem, state, (cheap, still), 2.0, judge).incumbent
    assert turned.cost < 1.01 * float(np.abs(cheap).sum())
    assert np.abs(turned.controls[1]).max() < 1e-6


def test_plans_that_are_told_never_become_dearer() -> None:
    told: list[float] = []
    plan(
        clutter(6, 20, 2),
        Planner(Optimal(), Branch(), Certified()),
        rng=0,
        time_limit=60.0,
        found=lambda cost, _: told.append(cost),
    )
    assert told == sorted(told, reverse=True)
    assert told[-1] < 0.99 * told[0]
