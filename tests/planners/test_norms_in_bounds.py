"""Programs keep to polytopes within limits of norms; bounds on any certified plan do not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from scipy.optimize import linprog

import radmpc
from radmpc.experiments.families import circle, paper
from radmpc.model.plan import Plan, Risk, Status, Trajectory
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.state.bounds import bound_of_programs, reported_bound
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.state.task import Task
from radmpc.planners.certified.turned.turning import Turning
from radmpc.planners.verdict import Verdict
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.referee.propagation import propagate
from radmpc.solvers.solution import Limits

CORNER = [np.cos(np.pi / 8), np.sin(np.pi / 8)]
"""Where a polygon of 16 sides whose middles are on the axes touches the disc around it."""


def flown(
    limit: str,
    direction: Sequence[float],
    pushes: Sequence[float],
    avoidance: str = "steps",
    speeds: Sequence[float] = (),
) -> tuple[radmpc.Scenario, Plan]:
    """A vehicle pushed along a line to its goal, at a norm of 2 at most, and its certified plan."""
    unit = np.array(direction) / np.linalg.norm(direction)
    controls, d = np.outer(pushes, unit), unit.size
    double = radmpc.double_integrator(1.0, d)
    start = [*[0.0] * d, *(speeds or [0.0] * d)]
    state = np.array(start)
    for control in controls:
        state = double.A @ state + double.B @ control
    ends = np.abs(state[d:]).round(9).tolist()
    vehicle = {
        "name": "a",
        "start": start,
        "goal": {"center": state[:d].tolist(), "half_width": 0.0, "speed": ends},
        "radius": 0.3,
        "control_limit": 100.0,
        limit: {"norm": 2.0},
    }
    content = {
        "format": "radmpc/scenario/1",
        "name": "norm",
        "dt": 1.0,
        "horizon": len(controls),
        "risk_bound": 0.05,
        "avoidance": avoidance,
        "vehicles": [vehicle],
    }
    scenario = radmpc.from_dict(content)
    motion = propagate(scenario, [controls])
    trajectory = Trajectory("a", controls, motion.states[0], motion.covariances[0])
    cost = float(np.abs(controls).sum())
    parts = {"cost": cost, "lower_bound": None, "risk": Risk(0.05, None, ())}
    plan = Plan(scenario, "own", 0, Status.FEASIBLE, sets=(("a",),), **parts,
                trajectories=(trajectory,))  # fmt: skip
    assert radmpc.certify(plan).holds
    return scenario, plan


def least_within_norms(scenario: radmpc.Scenario, directions: np.ndarray) -> float:
    """What its vehicle needs if controls along many directions keep the norm, by SciPy."""
    vehicle, last = scenario.vehicles[0], scenario.horizon
    d = vehicle.system.dimension
    states = [np.linalg.matrix_power(vehicle.system.A, last - 1 - k) @ vehicle.system.B
              for k in range(last)]  # fmt: skip
    to_goal = np.hstack(states)
    coasting = np.linalg.matrix_power(vehicle.system.A, last) @ vehicle.start
    goal = np.concatenate([vehicle.goal.lower, np.zeros(d)]) - coasting
    keeps = np.kron(np.eye(last), directions)
    answer = linprog(
        np.ones(2 * last * d),
        A_ub=np.hstack([keeps, -keeps]),
        b_ub=np.full(len(keeps), vehicle.control_norm),
        A_eq=np.hstack([to_goal, -to_goal]),
        b_eq=goal,
    )
    return float(answer.fun)


def all_around(dimension: int) -> tuple[np.ndarray, float]:
    """Many unit vectors, and the cosine of the angle from which one of them is always near."""
    if dimension == 2:
        angles = 2.0 * np.pi * np.arange(720) / 720
        return np.column_stack([np.cos(angles), np.sin(angles)]), float(np.cos(np.pi / 720))
    # Points of a cube's faces, a thirtieth of a unit apart.
    grid = np.linspace(-1.0, 1.0, 31)
    every = np.array([p for p in product(grid, repeat=3) if max(map(abs, p)) == 1.0])
    return every / np.linalg.norm(every, axis=1)[:, None], float(np.cos(np.sqrt(2.0) / 30.0))


PUSHES = [
    (CORNER, [2.0, 0.125, 0.0, 0.0, -0.125, -2.0]),
    ([1.0, 0.5, 0.3], [2.0, 1.9, 0.0, 0.0, -1.9, -2.0]),
]


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
@pytest.mark.parametrize(("direction", "pushes"), PUSHES)
def test_a_plan_uses_all_of_a_norm_and_no_bound_is_above_that(
    direction: list[float], pushes: list[float], avoidance: str
) -> None:
    scenario, own = flown("control_limit", direction, pushes, avoidance)
    result = radmpc.plan(scenario, rng=0).require()
    assert radmpc.certify(result).holds
    directions, near = all_around(len(direction))
    # Within directions scaled by that cosine the norm is kept; within all as they are it is not.
    least = least_within_norms(scenario, directions)
    most = least_within_norms(scenario, directions / near)
    assert least * (1.0 - 1e-6) <= result.cost <= min(most, own.cost) * (1.0 + 1e-4)
    assert 0.999 * result.cost <= result.certified_lower_bound <= result.lower_bound <= most


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_plans_by_faces_are_bounded_within_norms_too(avoidance: str) -> None:
    scenario, own = flown("control_limit", CORNER, [2.0, 0.125, 0.0, 0.0, -0.125, -2.0], avoidance)
    content = radmpc.to_dict(scenario)
    middle = own.trajectories[0].means[3, :2]
    content["obstacles"] = [
        {"name": "box", "min": (middle - [0.2, 0.9]).tolist(), "max": (middle + 0.2).tolist()}
    ]
    result = radmpc.plan(radmpc.from_dict(content), rng=0).require()
    assert radmpc.certify(result).holds
    finer = radmpc.plan(radmpc.from_dict(content), rng=1, time_limit=20.0).require()
    assert result.lower_bound <= finer.cost * (1.0 + 1e-9)
    assert result.certified_lower_bound <= result.lower_bound <= result.cost


HARD_PUSHES = [
    ("control_limit", [1.99, 1.99, -1.99, -1.99]),
    ("speed_limit", [1.99, 0.0, 0.0, 0.0, 0.0, -1.99]),
]


@pytest.mark.parametrize(("limit", "pushes"), HARD_PUSHES)
@pytest.mark.parametrize("direction", [CORNER, [1.0, 0.0], [1.0, 0.5, 0.3]])
def test_what_only_the_whole_norm_reaches_is_planned(
    limit: str, pushes: list[float], direction: list[float]
) -> None:
    scenario, _ = flown(limit, direction, pushes)
    assert radmpc.certify(radmpc.plan(scenario, rng=0).require()).holds


def test_what_only_the_whole_norm_reaches_aside_of_the_goal_is_planned() -> None:
    aside = flown("control_limit", CORNER, [1.99, 1.99, -1.99, -1.99], speeds=[0.0, 0.3])[0]
    assert radmpc.certify(radmpc.plan(aside, rng=0).require()).holds


@pytest.mark.parametrize("within", [[4, 4], [2, 4]])
def test_what_only_the_whole_norm_reaches_within_a_window_is_planned(within: list[int]) -> None:
    aside = flown("control_limit", CORNER, [1.99, 1.99, -1.99, -1.99], speeds=[0.0, 0.3])[0]
    content = radmpc.to_dict(aside)
    content["vehicles"][0]["goal"]["within"] = within
    assert radmpc.certify(radmpc.plan(radmpc.from_dict(content), rng=0).require()).holds


def test_where_only_the_polytope_is_too_small_that_is_said_and_rules_nothing_out() -> None:
    scenario, _ = flown("control_limit", CORNER, [1.99, 1.99, -1.99, -1.99], speeds=[0.0, 0.3])
    content = radmpc.to_dict(scenario)
    # Polytopes are not turned to plans that visit something at a step to be chosen.
    content["vehicles"][0]["via"] = [{"center": [0, 0], "half_width": 99.0, "between": [1, 2]}]
    result = radmpc.plan(radmpc.from_dict(content))
    assert "of whose norms plans keep to a polytope within" in result.explanation
    assert result.status is Status.LIMIT


def test_where_the_norm_itself_is_too_small_nothing_is_said_of_polytopes() -> None:
    scenario, _ = flown("control_limit", CORNER, [1.99, 1.99, -1.99, -1.99])
    content = radmpc.to_dict(scenario)
    content["vehicles"][0]["goal"] = {"center": [9.0, 9.0], "half_width": 0.0, "speed": 0.0}
    explanation = radmpc.plan(radmpc.from_dict(content)).explanation
    assert "under its control and speed limits, obstacles aside" in explanation


def normed(scenario: radmpc.Scenario) -> radmpc.Scenario:
    """The same with norms of control and speed in place of limits of their axes."""
    vehicles = tuple(
        replace(
            vehicle,
            control_limit=None,
            speed_limit=None,
            control_norm=float(np.max(vehicle.control_limit)),
            speed_norm=float(np.max(vehicle.speed_limit)),
        )
        for vehicle in scenario.vehicles
    )
    return replace(scenario, vehicles=vehicles)


def test_what_the_norms_themselves_rule_out_is_infeasible() -> None:
    pushes = [1.99, 1.99, 0.0, -1.99, -1.99]
    scenario, own = flown("control_limit", [1.0, 0.0], pushes, "intervals")
    content = radmpc.to_dict(scenario)
    middle = 0.5 * own.trajectories[0].means[-1, 0]
    wall = {"name": "wall", "min": [middle - 0.5, -99.0], "max": [middle + 0.5, 9.0]}
    result = radmpc.plan(radmpc.from_dict(content | {"obstacles": [wall]}), time_limit=20.0)
    # The way around is free, but much too far in five steps.
    assert result.status is Status.INFEASIBLE
    assert "polytope" not in result.explanation


def test_what_programs_within_norms_prove_ends_searches_and_is_told_nowhere() -> None:
    for scenario, is_told in ((paper(2, 0), True), (normed(paper(2, 0)), False)):
        fleet = Fleet.of(scenario, 1e-3, Limits())
        incumbent = FleetIncumbent((), 10.0, ((0,), (1,)))
        left = scenario.risk_bound
        state = replace(SearchState.of(fleet), incumbent=incumbent, budget_bounds=((left, 9.9),))
        assert bound_of_programs(fleet, state, 1e-3) == 9.9
        assert (reported_bound(fleet, state, 1e-3) == 9.9) == is_told
        around = replace(state, outside_bounds=((left, 9.5),))
        assert reported_bound(fleet, around, 1e-3) == (9.9 if is_told else 9.5)


def test_half_spaces_are_turned_to_the_sides_of_the_relaxation() -> None:
    planned = radmpc.plan(normed(paper(8, 4)), rng=0, time_limit=60.0).require()
    # 16.96 on the sides of the first plan.
    assert planned.cost < 16.80
    assert planned.certified_lower_bound > 0.99 * planned.cost
    assert radmpc.certify(planned).problems == ()


def test_three_that_cross_within_norms_are_proven_optimal() -> None:
    planned = radmpc.plan(normed(circle(3)), rng=0, time_limit=60.0).require()
    assert planned.status is Status.OPTIMAL
    assert planned.certified_lower_bound > 0.98 * planned.cost
    assert radmpc.certify(planned).problems == ()


@pytest.mark.parametrize("share", [1.0, 1.001])
def test_paths_beyond_the_limits_of_programs_are_no_plan(share: float) -> None:
    scenario = normed(circle(2))
    hazards = Hazards.of(scenario, condensed_models(scenario))
    alone = [radmpc.plan(scenario, rng=0).require().trajectories[i].controls for i in (0, 1)]
    task = Task(hazards, lambda controls: Verdict(0.01, ()), Limits(), 1e-3, 0.05)
    nothing = FleetIncumbent((), float("inf"), ((0,), (1,)))
    turning = Turning(task, nothing, ((0,), (1,)), 5.0, is_outside=True)
    turning.successive.begin([share * controls for controls in alone])
    # Nobody moves: one stayed where it began, as where its linear program has no solution.
    turning._take()
    assert bool(turning.incumbent.controls) == (share == 1.0)
