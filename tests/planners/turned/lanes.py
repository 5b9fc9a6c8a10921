"""A lane between two rooms, and programs of single vehicles to seek routes in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from radmpc.model.dynamics import double_integrator
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planners.certified.problem import SetProblem
from radmpc.program.build import condensed_models
from radmpc.solvers.solution import Limits

UNIT = 0.49


def path_of(problem, price):
    return problem.passage.path_search.path(price, Limits())


def problem_of(scenario, number=0):
    scenario = replace(scenario, vehicles=(scenario.vehicles[number],))
    return SetProblem.of(scenario, (0,), condensed_models(scenario), UNIT)


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
