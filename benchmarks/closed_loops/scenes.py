"""What `closed_loop.py` flies: scenes, and the plans with which missions begin."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from closed_loops.adversary import waiting, wall
from radmpc.arrays import Matrix
from radmpc.errors import NoPlanError
from radmpc.experiments.families import circle, fleet, paper
from radmpc.io.native.plan_file import load_plan, save_plan
from radmpc.model.dynamics import LinearSystem, lqr_gain
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planning import plan

__all__ = ["SCENES", "first_plan"]

SECONDS = 60.0
"""What the first plan may take [s]."""


def slalom(risk_bound: float = 0.1) -> Scenario:
    """Return a vehicle without inertia between blocks on both sides, under dead-beat feedback."""
    eye = np.eye(2)
    gates = []
    for number in range(3):
        x = 1.5 + 2.0 * number
        low, high = (-40.0, 0.25) if number % 2 == 0 else (-0.25, 40.0)
        gates.append(Obstacle.box(f"g{number}", [x - 0.6, low], [x + 0.6, high]))
    vehicle = Vehicle(
        name="skier",
        system=LinearSystem(eye, eye, (0, 1), None),
        start=[0.0, 0.0],
        goal=Goal.at([7.0, 0.0], 0.05, None),
        radius=0.2,
        control_limit=1.6,
        initial_covariance=0.0,
        disturbance_covariance=0.12**2,
        gain=-eye,
        control_sigmas=2.0,
    )
    return Scenario("slalom", 1.0, 8, risk_bound, (vehicle,), tuple(gates), avoidance="steps")


def louder(scenario: Scenario, gain: Matrix | None = None, factor: float = 4.0) -> Scenario:
    """Return a problem with so many times its deviations, Δ = 0.1, and feedback if asked for."""
    vehicles = tuple(
        replace(
            v,
            initial_covariance=factor**2 * v.initial_covariance,
            disturbance_covariance=factor**2 * v.disturbance_covariance,
            gain=gain,
        )
        for v in scenario.vehicles
    )
    return replace(scenario, vehicles=vehicles, risk_bound=0.1)


def fed(scenario: Scenario) -> Scenario:
    """Return such a problem under a soft linear-quadratic feedback."""
    gain = lqr_gain(scenario.vehicles[0].system, np.diag([1.0, 1.0, 1.0, 1.0]), 4.0 * np.eye(2))
    return louder(scenario, gain)


SCENES = {
    "slalom": slalom,
    "wall": wall,
    "paper": lambda: louder(paper(3, 3)),
    "paper4": lambda: louder(paper(4, 3)),
    "paper4-feedback": lambda: fed(paper(4, 3)),
    "paper5": lambda: louder(paper(5, 3)),
    "paper5-feedback": lambda: fed(paper(5, 3)),
    "paper6": lambda: louder(paper(6, 3)),
    "paper6-feedback": lambda: fed(paper(6, 3)),
    "paper7": lambda: louder(paper(7, 3)),
    "paper7-feedback": lambda: fed(paper(7, 3)),
    "paper8": lambda: louder(paper(8, 3)),
    "paper8-feedback": lambda: fed(paper(8, 3)),
    "circle4": lambda: louder(circle(4)),
    "circle4-feedback": lambda: fed(circle(4)),
    "fleet16": lambda: louder(fleet(16, 0), factor=2.0),
    "fleet16-feedback": lambda: fed(fleet(16, 0)),
    "circle8": lambda: circle(8),
    "circle16": lambda: circle(16),
    "fleet64": lambda: fleet(64, 0),
}


def first_plan(scene: str, record: Path | None) -> Plan:
    """Return what missions of a scene begin with: the plan beside a record, or one made now."""
    kept = None if record is None else record.with_suffix(f".{scene}.plan.json")
    if kept is not None and kept.exists():
        return load_plan(kept)
    scenario = SCENES[scene]()
    found = waiting(scenario) if scene == "wall" else _planned(scenario)
    if kept is not None:
        save_plan(found, kept)
    return found


def _planned(scenario: Scenario) -> Plan:
    """Return a plan."""
    result = plan(scenario, rng=0, time_limit=SECONDS)
    if result.plan is None:
        raise NoPlanError(result.explanation)
    return result.plan
