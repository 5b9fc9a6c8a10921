"""Small random problems with everything in them that makes the program hard."""

from __future__ import annotations

import numpy as np

from radmpc.model.dynamics import double_integrator
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle


def random_problem(seed: int) -> Scenario:
    """One to three vehicles that cross, zero to two obstacles, steps or intervals."""
    rng = np.random.default_rng(seed)
    num_vehicles = 1 + seed % 3
    obstacles = []
    for o in range(int(rng.integers(0, 3)) if num_vehicles > 1 else 1 + seed % 2):
        center = rng.uniform(3.0, 7.0, 2)
        points = center + rng.uniform(0.4, 1.2) * np.array(
            [
                [np.cos(t), np.sin(t)]
                for t in 2 * np.pi * (np.arange(3 + o) + rng.random()) / (3 + o)
            ]
        )
        obstacles.append(Obstacle.polygon(f"o{o}", points))
    noise = float(10.0 ** rng.uniform(-4.0, -1.7))
    vehicles = tuple(
        _vehicle(f"v{i}", rng, 2.0 * np.pi * (i + rng.uniform(-0.2, 0.2)) / num_vehicles, noise)
        for i in range(num_vehicles)
    )
    return Scenario(
        name=f"random-{seed}",
        dt=1.0,
        horizon=int(rng.integers(5, 7)),
        risk_bound=float(10.0 ** rng.uniform(-4.0, -0.5)),
        vehicles=vehicles,
        obstacles=tuple(obstacles),
        avoidance="steps" if seed % 2 else "intervals",
    )


def _vehicle(name: str, rng: np.random.Generator, angle: float, noise: float) -> Vehicle:
    toward = 4.0 * np.array([np.cos(angle), np.sin(angle)])
    goal = 5.0 - toward + rng.uniform(-0.3, 0.3, 2)
    return Vehicle(
        name=name,
        system=double_integrator(1.0, 2),
        start=np.concatenate([5.0 + toward, [0.0, 0.0]]),
        goal=Goal(goal - 0.1, goal + 0.1, np.full(2, 0.05)),
        radius=float(rng.uniform(0.2, 0.5)),
        control_limit=np.full(2, 2.0),
        speed_limit=np.full(2, 3.0),
        initial_covariance=np.diag([noise, noise, noise / 10, noise / 10]),
        disturbance_covariance=np.diag([noise, 2 * noise, noise / 10, noise / 10]),
        cost_weight=float(rng.uniform(0.5, 2.0)),
    )
