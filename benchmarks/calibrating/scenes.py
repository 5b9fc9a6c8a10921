"""Random scenarios and planners for the calibration: small, crowded, noisy, each from a seed.

What is drawn is meant to be hard on a certificate, not to be typical: noise so large that the risk
bound binds, vehicles of unequal size, walls, obstacles that are not convex or move, workspaces,
feedback, correlated noise, other dynamics, planes and space.
"""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.experiments.families import regular_polygon
from radmpc.model.dynamics import LinearSystem, double_integrator
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planners import Centralized, Couplings, Ira, Planner, Sigmas, Uniform
from radmpc.planners.presets import PRESETS
from radmpc.solvers.branch.branch import Branch
from radmpc.solvers.milp.big_m import BigM

__all__ = ["random_planner", "random_scenario"]

_MAX_DRAWS = 2_000
_MAX_BINARIES = 2  # fleets up to this size may be planned by the presets built on a MILP


def random_planner(rng: np.random.Generator, num_vehicles: int) -> tuple[str, Planner]:
    """Return a planner and its name: safe ones, heuristic ones, and some that are not safe."""
    choices = {
        name: preset.planner
        for name, preset in PRESETS.items()
        if num_vehicles <= _MAX_BINARIES or not _is_slow(preset.planner)
    }
    choices |= {
        "sigmas": Planner(Sigmas(float(rng.uniform(0.5, 3.0))), Branch(), Centralized()),
        "uniform-branch": Planner(Uniform(), Branch(), Centralized()),
        "ira-branch": Planner(Ira(), Branch(), Centralized()),
        "uncoupled": Planner(Ira(), Branch(), Couplings(1.0)),
    }
    name = str(rng.choice(list(choices)))
    return name, choices[name]


def _is_slow(planner: Planner) -> bool:
    """Whether a planner solves mixed-integer programs, which takes seconds."""
    return isinstance(planner.solver, BigM)


def random_scenario(rng: np.random.Generator, name: str) -> Scenario:
    """Return a small crowded scenario.

    Parameters
    ----------
    rng : Generator
        Decides everything.
    name : str
        For the scenario.

    Returns
    -------
    Scenario
        With 1 to 8 vehicles in the plane or, one time in five, in space.
    """
    dimension = 3 if rng.random() < 0.2 else 2
    count = int(rng.integers(1, 9))
    horizon = int(rng.integers(4, 9))
    side = float(rng.uniform(5.0, 7.0) + 0.5 * count)
    dt = float(rng.choice([0.8, 1.0, 1.25]))
    num_obstacles = int(rng.integers(0, 4))
    obstacles = tuple(
        _obstacle(rng, f"o{i}", side, dimension, horizon) for i in range(num_obstacles)
    )
    radii = rng.uniform(0.2, 0.5, count)
    starts = _scattered(rng, side, radii, obstacles, 0, dimension)
    goals = _scattered(rng, side, radii, obstacles, horizon, dimension)
    count = min(len(starts), len(goals))
    vehicles = tuple(
        _vehicle(rng, f"v{i}", starts[i], goals[i], float(radii[i]), dt) for i in range(count)
    )
    margin = float(rng.uniform(0.2, 1.0))
    return Scenario(
        name=name,
        dt=dt,
        horizon=horizon,
        risk_bound=float(np.exp(rng.uniform(np.log(0.003), np.log(0.4)))),
        vehicles=vehicles,
        obstacles=obstacles,
        avoidance="steps" if rng.random() < 0.5 else "intervals",
        pair_faces=int(rng.choice([6, 8, 12])) if rng.random() < 0.5 else None,
        workspace=_workspace(side, margin, dimension) if rng.random() < 0.4 else None,
    )


def _workspace(side: float, margin: float, dimension: int) -> Workspace:
    """Return a box a little larger than where starts and goals lie."""
    return Workspace(np.full(dimension, -margin), np.full(dimension, side + margin))


def _vehicle(
    rng: np.random.Generator, name: str, start: Vector, goal: Vector, radius: float, dt: float
) -> Vehicle:
    """Return a double integrator or, now and then, a vehicle without inertia."""
    d = start.size
    is_walker = rng.random() < 0.15
    system = _walker(dt, d) if is_walker else double_integrator(dt, d)
    gain = None
    if not is_walker and rng.random() < 0.4:
        gain = np.hstack([-0.3 * np.eye(d), -0.9 * np.eye(d)])
    half = float(rng.uniform(0.1, 0.3))
    rest = np.zeros(system.num_states - d)
    return Vehicle(
        name=name,
        system=system,
        start=np.concatenate([start, rest]),
        goal=Goal(goal - half, goal + half, None if is_walker else np.full(d, 0.1)),
        radius=radius,
        control_limit=np.full(d, 3.0),
        initial_covariance=_covariance(rng, system.num_states, d),
        disturbance_covariance=_covariance(rng, system.num_states, d),
        gain=gain,
    )


def _walker(dt: float, dimension: int) -> LinearSystem:
    """Return the system whose position moves by its control."""
    eye = np.eye(dimension)
    return LinearSystem(eye, dt * eye, tuple(range(dimension)), None)


def _covariance(rng: np.random.Generator, num_states: int, dimension: int) -> Matrix:
    """Return noise of 3 to 16 cm, slower in speed; one time in three correlated."""
    deviation = float(np.exp(rng.uniform(np.log(0.03), np.log(0.16))))
    scales = np.full(num_states, 0.3 * deviation)
    scales[:dimension] = deviation
    if rng.random() < 2.0 / 3.0:
        return np.diag(scales**2)
    mixing = rng.standard_normal((num_states, num_states)) / np.sqrt(num_states)
    return np.asarray(scales[:, None] * (mixing @ mixing.T) * scales)


def _obstacle(
    rng: np.random.Generator, name: str, side: float, dimension: int, horizon: int
) -> Obstacle:
    """Return a box, a thin wall, a polygon, a hook or a box that moves."""
    center = rng.uniform(0.2 * side, 0.8 * side, dimension)
    half = rng.uniform(0.3, 0.9, dimension)
    kind = str(rng.choice(["box", "wall", "moving", "polygon", "hook"]))
    if kind == "moving":
        corners = _corners(half)
        drift = rng.uniform(-0.4, 0.4, dimension)
        return Obstacle.moving(name, [center + corners + k * drift for k in range(horizon + 1)])
    if kind == "wall":
        half[int(rng.integers(dimension))] = 0.05
    if dimension == 2 and kind == "polygon":
        sides = int(rng.integers(3, 7))
        return Obstacle.polygon(name, regular_polygon(sides, (center[0], center[1]), half[0] + 0.3))
    if dimension == 2 and kind == "hook":
        outline = np.array([[-1, -1], [1, -1], [1, 1], [0.6, 1], [0.6, -0.6], [-1, -0.6]])
        return Obstacle.polygon(name, center + outline * half)
    return Obstacle.box(name, center - half, center + half)


def _corners(half: Vector) -> Matrix:
    """Return the corners of a box around the origin."""
    signs = np.array(np.meshgrid(*[[-1.0, 1.0]] * half.size, indexing="ij")).reshape(half.size, -1)
    return np.asarray(signs.T * half)


def _scattered(
    rng: np.random.Generator,
    side: float,
    radii: Vector,
    obstacles: tuple[Obstacle, ...],
    step: int,
    dimension: int,
) -> list[Vector]:
    """Return a place per vehicle, clear of others and of obstacles at a step; fewer if crowded."""
    solids = [piece for obstacle in obstacles for piece in obstacle.at(step)]
    places: list[Vector] = []
    for _ in range(_MAX_DRAWS):
        if len(places) == len(radii):
            break
        place, radius = rng.uniform(0.0, side, dimension), radii[len(places)]
        gaps = [
            float(np.linalg.norm(place - other)) - radii[i] - radius
            for i, other in enumerate(places)
        ]
        # The largest face value never exceeds the distance: what passes is clear.
        gaps += [float((solid.normals @ place - solid.offsets).max()) - radius for solid in solids]
        if all(gap >= 0.4 for gap in gaps):
            places.append(place)
    return places
