"""Drones in a box, as dense as other groups' hardest: a function of size and seed alone."""

from __future__ import annotations

import numpy as np

from radmpc.arguments import check_integer
from radmpc.arrays import Matrix
from radmpc.errors import ScenarioError
from radmpc.experiments.scatter import Arena
from radmpc.io.ranges import MOST_VEHICLES
from radmpc.model.dynamics import double_integrator
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.records import replace

__all__ = ["swarm"]

_VOLUME = 0.9
"""Volume per drone [m³]: 20 in 3 m × 3 m × 2 m, as in the problems `empty_20agents` of the LSC
planner (Park, Kim, Oh, Kim, ICRA 2022)."""

_FEW = range(3, 8)
"""Drones that may leave each other no room [-], however often the last one is drawn."""

_DRAWS_OF_FEW = 500
"""Draws of one of few drones before all are drawn anew [-]: 20,000 take half a second."""

_DRAWS = 100
"""How often all points are drawn anew at most [-]: of four drones every second draw leaves room."""

_DT = 0.5
"""Length of a step [s]."""


def swarm(num_vehicles: int, seed: int) -> Scenario:
    """Return drones that cross a box, each from anywhere to anywhere in it.

    The box has sides as 3 : 3 : 2 and 0.9 m³ for every drone. Starts and goals are uniform, 0.5 m
    apart and from the faces.

    Parameters
    ----------
    num_vehicles : int
        Fleet size N.
    seed : int
        Seed of the draw.

    Returns
    -------
    Scenario
        In space, T as long as the longest way takes and two steps more, Δ = 0.05, avoidance along
        intervals.
    """
    check_integer(num_vehicles, "num_vehicles", 1, MOST_VEHICLES)
    check_integer(seed, "seed", 0)
    rng = np.random.default_rng(seed)
    # Three drones at least, so that there is room for starts 0.5 m from the faces.
    size = np.cbrt(_VOLUME * max(num_vehicles, 3) / 18.0) * np.array([3.0, 3.0, 2.0])
    room = Arena(np.full(3, 0.5), size - 0.5, apart=0.5)
    if num_vehicles in _FEW:
        room = replace(room, draws_each=_DRAWS_OF_FEW)
    starts, goals = (_scattered(room, rng, num_vehicles) for _ in range(2))
    # At 1 m/s along every axis, a second to get there and one to stop.
    longest = float(np.abs(goals - starts).max()) + 1.0
    noise = np.diag([2e-5, 2e-5, 2e-5, 7e-6, 7e-6, 7e-6])
    system = double_integrator(_DT, 3)
    return Scenario(
        name=f"swarm-{num_vehicles}-{seed}",
        dt=_DT,
        horizon=int(np.ceil(longest / _DT)) + 2,
        risk_bound=0.05,
        workspace=Workspace(np.zeros(3), size),
        vehicles=tuple(
            Vehicle(
                name=f"d{i + 1}",
                system=system,
                start=np.concatenate([start, np.zeros(3)]),
                goal=Goal(goal - 0.05, goal + 0.05, np.full(3, 0.1)),
                radius=0.15,
                control_limit=np.ones(3),
                speed_limit=np.ones(3),
                initial_covariance=noise,
                disturbance_covariance=noise,
            )
            for i, (start, goal) in enumerate(zip(starts, goals, strict=True))
        ),
    )


def _scattered(room: Arena, rng: np.random.Generator, count: int) -> Matrix:
    """Draw points, all anew where the first ones leave no room for the last, as few drones' may."""
    for _ in range(_DRAWS - 1):
        try:
            return room.scatter(rng, count)
        except ScenarioError:
            continue
    return room.scatter(rng, count)
