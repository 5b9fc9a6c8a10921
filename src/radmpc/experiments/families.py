"""The benchmark families: random problems, each a function of its size and seed alone."""

from __future__ import annotations

import numpy as np
import shapely

from radmpc.arguments import check_integer
from radmpc.arrays import Matrix
from radmpc.experiments.scatter import Arena
from radmpc.io.ranges import MOST_VEHICLES
from radmpc.model.dynamics import double_integrator
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle

__all__ = ["circle", "clutter", "fleet", "paper", "paper_vehicle", "regular_polygon"]


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
    _check_size(num_vehicles, seed)
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


def fleet(num_vehicles: int, seed: int) -> Scenario:
    """Return the paper's density without end: a square of side 20·√(N/8) m.

    Three obstacles for every eight vehicles, their centers at least 6 m apart; goals within 14 m
    per axis of their starts; all else as in `paper`.

    Parameters
    ----------
    num_vehicles : int
        Fleet size N, 8 to 1,000 and more.
    seed : int
        Seed of the draw.

    Returns
    -------
    Scenario
        T = 10, dt = 1 s, Δ = 0.05, avoidance at the steps.
    """
    _check_size(num_vehicles, seed)
    rng = np.random.default_rng(seed)
    side = 20.0 * np.sqrt(num_vehicles / 8.0)
    low, high = np.zeros(2), np.full(2, side)
    centers = Arena(low + 3.0, high - 3.0, apart=6.0).scatter(rng, round(3 * num_vehicles / 8))
    obstacles = tuple(
        Obstacle.polygon(f"o{i + 1}", regular_polygon((6, 5, 4)[i % 3], (x, y), 1.8))
        for i, (x, y) in enumerate(centers)
    )
    outlines = tuple(shapely.Polygon(o.at(0)[0].vertices) for o in obstacles)
    room = Arena(low + 1.0, high - 1.0, outlines, clearance=1.2, apart=3.0)
    starts = room.scatter(rng, num_vehicles)
    near = Arena(low + 1.0, high - 1.0, outlines, clearance=1.2, apart=3.0, around=(starts, 14.0))
    return Scenario(
        name=f"fleet-{num_vehicles}-{seed}",
        dt=1.0,
        horizon=10,
        risk_bound=0.05,
        avoidance="steps",
        pair_faces=4,
        obstacles=obstacles,
        vehicles=tuple(
            paper_vehicle(f"v{i + 1}", start, goal)
            for i, (start, goal) in enumerate(
                zip(starts, near.scatter(rng, num_vehicles), strict=True)
            )
        ),
    )


def clutter(num_vehicles: int, num_boxes: int, seed: int) -> Scenario:
    """Return small vehicles among unit boxes, over a long horizon under feedback.

    32 m × 32 m; boxes on distinct grid cells; starts and goals 2 m apart and 0.5 m clear of boxes,
    goals 12 to 22 m away in the larger axis.

    Parameters
    ----------
    num_vehicles : int
        Fleet size N.
    num_boxes : int
        Boxes m.
    seed : int
        Seed of the draw.

    Returns
    -------
    Scenario
        T = 30, dt = 1 s, Δ = 0.05, avoidance along intervals.
    """
    _check_size(num_vehicles, seed)
    check_integer(num_boxes, "num_boxes", 0, 32 * 32)
    rng = np.random.default_rng(seed)
    cells = rng.choice(32 * 32, num_boxes, replace=False)
    corners = np.column_stack([cells % 32, cells // 32]).astype(float)
    obstacles = tuple(
        Obstacle.box(f"b{i + 1}", corner, corner + 1.0) for i, corner in enumerate(corners)
    )
    outlines = tuple(shapely.box(*corner, *(corner + 1.0)) for corner in corners)
    room = Arena(np.full(2, 0.5), np.full(2, 31.5), outlines, clearance=0.5, apart=2.0)
    starts = room.scatter(rng, num_vehicles)
    goals = room.scatter(
        rng, num_vehicles, lambda i, p: 12.0 <= float(np.abs(p - starts[i]).max()) <= 22.0
    )
    return Scenario(
        name=f"clutter-{num_vehicles}-{num_boxes}-{seed}",
        dt=1.0,
        horizon=30,
        risk_bound=0.05,
        obstacles=obstacles,
        vehicles=tuple(
            _small_vehicle(f"v{i + 1}", start, goal)
            for i, (start, goal) in enumerate(zip(starts, goals, strict=True))
        ),
    )


def _small_vehicle(name: str, start: Matrix, goal: Matrix) -> Vehicle:
    """Return a vehicle of the clutter family."""
    noise = np.diag([0.005, 0.005, 0.0005, 0.0005])
    return Vehicle(
        name=name,
        system=double_integrator(1.0, 2),
        start=np.concatenate([start, [0.0, 0.0]]),
        goal=Goal(goal - 0.2, goal + 0.2, np.full(2, 0.05)),
        radius=0.18,
        control_limit=np.ones(2),
        speed_limit=np.ones(2),
        initial_covariance=noise,
        disturbance_covariance=noise,
        gain=np.array([[-0.3, 0.0, -0.9, 0.0], [0.0, -0.3, 0.0, -0.9]]),
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
    _check_size(num_vehicles)
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


def _check_size(num_vehicles: object, seed: object = 0) -> None:
    """Refuse numbers that make no problem, or none that a file may hold."""
    check_integer(num_vehicles, "num_vehicles", 1, MOST_VEHICLES)
    check_integer(seed, "seed", 0)


def paper_vehicle(name: str, start: Matrix, goal: Matrix) -> Vehicle:
    """Return the double integrator that all of the paper's problems use.

    Parameters
    ----------
    name : str
        Unique within its scenario.
    start : (2,) array
        Where it starts, at rest [m].
    goal : (2,) array
        Center of its goal [m].
    """
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
    """Return the corners of a regular polygon, the first straight right of the center [m].

    Parameters
    ----------
    sides : int
        Number of corners, >= 3.
    center : (float, float)
        Its center [m].
    circumradius : float
        From the center to the corners [m].
    """
    angles = 2.0 * np.pi * np.arange(sides) / sides
    return np.asarray(center) + circumradius * np.column_stack([np.cos(angles), np.sin(angles)])


def _scattered(
    rng: np.random.Generator, count: int, obstacles: tuple[Obstacle, ...], starts: Matrix | None
) -> Matrix:
    """Draw the paper's starts, or goals in reach of them."""
    outlines = tuple(shapely.Polygon(o.at(0)[0].vertices) for o in obstacles)
    room = Arena(np.full(2, 1.0), np.full(2, 19.0), outlines, clearance=1.2, apart=3.0)
    if starts is None:
        return room.scatter(rng, count)
    return room.scatter(rng, count, lambda i, p: bool(np.all(np.abs(p - starts[i]) <= 16.0)))
