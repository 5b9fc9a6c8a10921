"""The benchmark families: random problems, each a function of its size and seed alone."""

from __future__ import annotations

import numpy as np
import shapely

from radmpc.arrays import Matrix
from radmpc.errors import ScenarioError
from radmpc.model.dynamics import double_integrator
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle

__all__ = ["circle", "paper", "regular_polygon"]

_MAX_DRAWS = 100_000


def paper(num_vehicles: int, seed: int) -> Scenario:
    """Return a problem of the paper's kind (section Results).

    20 m × 20 m with three regular obstacles; starts and goals uniform in [1, 19]², 3 m apart,
    1.2 m clear of obstacles, each goal within 16 m per axis of its start.

    Parameters
    ----------
    num_vehicles : int
        Fleet size N.
    seed : int
        Seed of the draw.

    Returns
    -------
    Scenario
        T = 10, dt = 1 s, Δ = 0.05, avoidance at the steps.
    """
    rng = np.random.default_rng(seed)
    obstacles = (
        Obstacle.polygon("hexagon", regular_polygon(6, (6.0, 6.0), 1.8)),
        Obstacle.polygon("pentagon", regular_polygon(5, (14.0, 7.0), 1.8)),
        Obstacle.polygon("square", regular_polygon(4, (10.0, 14.0), 1.8)),
    )
    starts = _scattered(rng, num_vehicles, obstacles, None)
    goals = _scattered(rng, num_vehicles, obstacles, starts)
    return Scenario(
        name=f"paper-{num_vehicles}-{seed}",
        dt=1.0,
        horizon=10,
        risk_bound=0.05,
        avoidance="steps",
        pair_faces=4,
        obstacles=obstacles,
        vehicles=tuple(
            paper_vehicle(f"v{i + 1}", start, goal)
            for i, (start, goal) in enumerate(zip(starts, goals, strict=True))
        ),
    )


def circle(num_vehicles: int) -> Scenario:
    """Return vehicles on a circle of radius 8 m, each bound for the opposite point.

    Parameters
    ----------
    num_vehicles : int
        Fleet size N.

    Returns
    -------
    Scenario
        T = 10, dt = 1 s, Δ = 0.05, avoidance at the steps, no obstacles.
    """
    angles = 2.0 * np.pi * np.arange(num_vehicles) / num_vehicles
    starts = 10.0 + 8.0 * np.column_stack([np.cos(angles), np.sin(angles)])
    return Scenario(
        name=f"circle-{num_vehicles}",
        dt=1.0,
        horizon=10,
        risk_bound=0.05,
        avoidance="steps",
        pair_faces=4,
        vehicles=tuple(
            paper_vehicle(f"v{i + 1}", start, 20.0 - start) for i, start in enumerate(starts)
        ),
    )


def paper_vehicle(name: str, start: Matrix, goal: Matrix) -> Vehicle:
    """Return the double integrator that all of the paper's problems use."""
    noise = np.diag([0.001, 0.001, 0.0001, 0.0001])
    return Vehicle(
        name=name,
        system=double_integrator(1.0, 2),
        start=np.concatenate([start, [0.0, 0.0]]),
        goal=Goal(goal - 0.2, goal + 0.2, np.full(2, 0.05)),
        radius=0.4,
        control_limit=np.full(2, 2.0),
        speed_limit=np.full(2, 3.0),
        initial_covariance=noise,
        disturbance_covariance=noise,
    )


def regular_polygon(sides: int, center: tuple[float, float], circumradius: float) -> Matrix:
    """Return the corners of a regular polygon, the first straight right of the center [m]."""
    angles = 2.0 * np.pi * np.arange(sides) / sides
    return np.asarray(center) + circumradius * np.column_stack([np.cos(angles), np.sin(angles)])


def _scattered(
    rng: np.random.Generator, count: int, obstacles: tuple[Obstacle, ...], starts: Matrix | None
) -> Matrix:
    """Draw points one by one until each is clear of obstacles, of one another and in reach."""
    outlines = [shapely.Polygon(o.at(0)[0].vertices) for o in obstacles]
    points: list[Matrix] = []
    for _ in range(_MAX_DRAWS):
        if len(points) == count:
            return np.array(points)
        point = rng.uniform(1.0, 19.0, 2)
        clear = all(outline.distance(shapely.Point(point)) >= 1.2 for outline in outlines)
        apart = all(np.linalg.norm(point - other) >= 3.0 for other in points)
        in_reach = starts is None or bool(np.all(np.abs(point - starts[len(points)]) <= 16.0))
        if clear and apart and in_reach:
            points.append(point)
    raise ScenarioError(f"no room for {count} vehicles 3 m apart in 20 m x 20 m")
