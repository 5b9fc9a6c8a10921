"""Small random scenes that are likely to break something, each from a seed and an index.

What is drawn lies where formulas change: starts and goals at contact, along diagonals and in rows,
feedback that cancels a deviation in a step, controls that hardly suffice, walls without thickness,
noise that is singular or not there, risk bounds from 1e-9 to almost one half.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from hunting.flight import solid_distances
from hunting.obstacles import random_obstacle
from hunting.vehicles import random_vehicle
from radmpc.arrays import Matrix, Vector
from radmpc.errors import ScenarioError
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario, Workspace

__all__ = ["draw_scene"]

_MAX_DRAWS = 500
_GAPS = (-1e-10, 0.0, 1e-12, 1e-9, 1e-6, 1e-3)
"""Distances between hulls at the start [m]: about where contact begins, by any tolerance."""

_HAIR = 1e-8
"""Overlap that is let pass [m]."""


def draw_scene(seed: int, index: int) -> Scenario:
    """Return a scene.

    Parameters
    ----------
    seed, index : int
        Decide everything.

    Returns
    -------
    Scenario
        1 to 4 vehicles over 1 to 8 steps, in the plane or, one time in four, in space.
    """
    rng = np.random.default_rng([seed, index])
    for _ in range(_MAX_DRAWS):
        try:
            return _scene(rng, f"hunt-{seed}-{index}")
        except ScenarioError:
            # What the door refuses, such as a goal outside the workspace, is drawn again.
            continue
    raise ScenarioError(f"seed {seed} and index {index} give no scene in {_MAX_DRAWS} draws")


def _scene(rng: np.random.Generator, name: str) -> Scenario:
    """Return a scene, or have it refused."""
    dimension = 3 if rng.random() < 0.25 else 2
    count = int(rng.choice([1, 2, 3, 4], p=[0.25, 0.4, 0.25, 0.1]))
    horizon, dt = int(rng.integers(1, 9)), float(rng.choice([0.5, 1.0, 1.3]))
    radii = np.full(count, rng.uniform(0.2, 0.5))
    if rng.random() < 0.4:
        radii = rng.uniform(0.1, 0.6, count)
    starts, is_close = _places(rng, radii, dimension)
    goals = _goals(rng, starts, radii)
    number = int(rng.choice([0, 1, 2], p=[0.4, 0.4, 0.2]))
    obstacles: list[Obstacle] = []
    for i in range(number):
        made, is_beside = _obstacle(rng, f"o{i}", (starts, goals, radii), horizon)
        obstacles.append(made)
        is_close = is_close or is_beside
    if rng.random() < 0.95:
        _check_free(starts, radii, tuple(obstacles), 0)
        _check_free(goals, radii, tuple(obstacles), horizon)
    vehicles = tuple(
        random_vehicle(
            rng,
            f"v{i}",
            (starts[i], goals[i]),
            float(radii[i]),
            (dt, horizon),
            is_close=is_close,
        )
        for i in range(count)
    )
    faces = rng.random()
    return Scenario(
        name=name,
        dt=dt,
        horizon=horizon,
        risk_bound=_log_uniform(rng, 1e-9, 0.49),
        vehicles=vehicles,
        obstacles=tuple(obstacles),
        avoidance="steps" if rng.random() < 0.4 else "intervals",
        pair_faces=None if faces < 0.6 else 8 if faces < 0.95 else 12,
        workspace=_workspace(rng, np.vstack([starts, goals])) if rng.random() < 0.35 else None,
    )


def _check_free(places: Matrix, radii: Vector, obstacles: tuple[Obstacle, ...], step: int) -> None:
    """Refuse places that overlap by more than a hair: what is wrong with those is told at once."""
    for (i, here), (j, there) in combinations(enumerate(places), 2):
        if np.linalg.norm(here - there) < radii[i] + radii[j] - _HAIR:
            raise ScenarioError(f"vehicles {i} and {j} overlap")
    for obstacle in obstacles:
        for piece in obstacle.at(step):
            if np.any(solid_distances(piece, places) < radii - _HAIR):
                raise ScenarioError(f"obstacle {obstacle.name!r} covers a place")


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Return a number whose logarithm is uniform."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _gap(rng: np.random.Generator) -> float:
    """Return a distance between hulls, from a hair's overlap to some centimeters [m]."""
    return float(rng.choice(_GAPS)) if rng.random() < 0.6 else _log_uniform(rng, 1e-4, 0.06)


def _direction(rng: np.random.Generator, dimension: int) -> Vector:
    """Return a unit vector: an axis, a diagonal or any."""
    kind = rng.random()
    if kind < 0.35:
        return np.asarray(np.eye(dimension)[rng.integers(dimension)])
    given = rng.choice([-1.0, 1.0], dimension) if kind < 0.75 else rng.normal(size=dimension)
    return np.asarray(given / np.linalg.norm(given))


def _places(rng: np.random.Generator, radii: Vector, dimension: int) -> tuple[Matrix, bool]:
    """Return a place per vehicle, a row or scattered with room, and whether they nearly touch."""
    begin = rng.uniform(-1.0, 1.0, dimension) * (rng.random() < 0.5)
    if rng.random() < 0.55:
        along, gap = _direction(rng, dimension), _gap(rng)
        steps = np.concatenate([[0.0], radii[1:] + radii[:-1] + gap])
        return np.asarray(begin + np.cumsum(steps)[:, None] * along), len(radii) > 1
    side = 1.2 * len(radii) + 0.5
    return np.asarray(begin + rng.uniform(0.0, side, (len(radii), dimension))), False


def _goals(rng: np.random.Generator, starts: Matrix, radii: Vector) -> Matrix:
    """Return the goals: where others start, the row carried elsewhere, a row, or the start."""
    dimension = starts.shape[1]
    kind = rng.random()
    if kind < 0.15:
        return np.asarray(np.roll(starts, 1, axis=0))
    if kind < 0.45:
        return np.asarray(starts + rng.uniform(0.3, 4.0) * _direction(rng, dimension))
    if kind < 0.5:
        return starts.copy()
    if kind < 0.75:
        side = 1.5 * len(radii) + 1.0
        return np.asarray(starts[0] + rng.uniform(-side, side, starts.shape))
    away = rng.uniform(0.5, 4.0) * _direction(rng, dimension)
    return np.asarray(starts[0] + away + _places(rng, radii, dimension)[0])


def _obstacle(
    rng: np.random.Generator, name: str, ways: tuple[Matrix, Matrix, Vector], horizon: int
) -> tuple[Obstacle, bool]:
    """Return an obstacle across a way, or beside a start or goal, and whether beside a start."""
    starts, goals, radii = ways
    chosen = int(rng.integers(len(starts)))
    dimension = starts.shape[1]
    if rng.random() < 0.6:
        place = starts[chosen] + rng.uniform(0.3, 0.7) * (goals[chosen] - starts[chosen])
        made = random_obstacle(rng, name, place + rng.normal(0.0, 0.3, dimension), horizon)
        return made, False
    at_start = bool(rng.random() < 0.6)
    place = (starts if at_start else goals)[chosen]
    away = _direction(rng, dimension)
    distance = float(radii[chosen]) + _gap(rng)
    return random_obstacle(rng, name, place, horizon, beside=(away, distance)), at_start


def _workspace(rng: np.random.Generator, places: Matrix) -> Workspace:
    """Return a box around all starts and goals, often just around them."""
    margin = float(
        rng.choice([0.0, 1e-9, 1e-3, 0.05, 0.3, 1.5], p=[0.05, 0.1, 0.1, 0.2, 0.3, 0.25])
    )
    return Workspace(places.min(axis=0) - margin, places.max(axis=0) + margin)
