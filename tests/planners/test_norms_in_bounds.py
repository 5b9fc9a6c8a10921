"""Programs keep to polytopes within limits of norms; bounds on any certified plan do not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

import radmpc
from radmpc.experiments.families import circle, paper
from radmpc.model.plan import Plan, Risk, Status, Trajectory
from radmpc.planners.certified.state.incumbent import FleetIncumbent
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
    limit: str, direction: Sequence[float], pushes: Sequence[float], avoidance: str = "steps"
) -> tuple[radmpc.Scenario, Plan]:
    """A vehicle pushed along a line to its goal, at a norm of 2 at most, and its certified plan."""
    unit = np.array(direction) / np.linalg.norm(direction)
    controls, d = np.outer(pushes, unit), unit.size
    double = radmpc.double_integrator(1.0, d)
    state = np.zeros(2 * d)
    for control in controls:
        state = double.A @ state + double.B @ control
    vehicle = {
        "name": "a",
        "start": [0] * d,
        "goal": {"center": state[:d].tolist(), "half_width": 0.0, "speed": 0.0},
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


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
@pytest.mark.parametrize(
    ("direction", "pushes"),
    [
        (CORNER, [2.0, 0.125, 0.0, 0.0, -0.125, -2.0]),
        ([1.0, 0.5, 0.3], [2.0, 1.9, 0.0, 0.0, -1.9, -2.0]),
    ],
)
def test_no_certified_plan_costs_less_than_the_bound(
    direction: list[float], pushes: list[float], avoidance: str
) -> None:
    scenario, own = flown("control_limit", direction, pushes, avoidance)
    result = radmpc.plan(scenario, rng=0)
    assert result.is_certified
    # The plan that programs find is dearer, since it keeps to the polytope.
    assert result.certified_lower_bound <= own.cost < result.cost
    assert result.certified_lower_bound > 0.9 * own.cost


@pytest.mark.parametrize(
    ("limit", "pushes"),
    [
        ("control_limit", [1.99, 1.99, -1.99, -1.99]),
        ("speed_limit", [1.99, 0.0, 0.0, 0.0, 0.0, -1.99]),
    ],
)
def test_where_only_the_polytope_is_too_small_that_is_said(limit: str, pushes: list[float]) -> None:
    scenario, _ = flown(limit, CORNER, pushes)
    assert "of whose norms plans keep to a polytope within" in radmpc.plan(scenario).explanation


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
