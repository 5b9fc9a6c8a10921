"""Plans built by hand: straight flights by least squares, no planner."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from radmpc.geometry import hull
from radmpc.model.dynamics import LinearSystem, double_integrator, rollout
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan, Risk, Status, Trajectory
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle


def walker(dimension: int = 2) -> LinearSystem:
    """Return the system whose position is its state and moves by its control."""
    eye = np.eye(dimension)
    return LinearSystem(eye, eye, tuple(range(dimension)), None)


def walk(
    name: str,
    points: npt.ArrayLike,
    *,
    radius: float = 0.4,
    sigma: float = 0.1,
    growth: float = 0.0,
    covariance: npt.ArrayLike | None = None,
) -> tuple[Vehicle, np.ndarray]:
    """Return a vehicle without inertia and the controls that take its mean through points."""
    path = np.asarray(points, dtype=float)
    d = path.shape[1]
    initial = sigma**2 * np.eye(d) if covariance is None else np.asarray(covariance)
    vehicle = Vehicle(
        name=name,
        system=walker(d),
        start=path[0],
        goal=Goal(path[-1] - 0.1, path[-1] + 0.1, None),
        radius=radius,
        control_limit=np.full(d, 1e6),
        initial_covariance=initial,
        disturbance_covariance=growth**2 * np.eye(d),
    )
    return vehicle, np.diff(path, axis=0)


def glider(
    name: str,
    start: npt.ArrayLike,
    goal: npt.ArrayLike,
    *,
    dt: float = 1.0,
    noise: float = 1e-3,
    **changes: object,
) -> Vehicle:
    """Return a double integrator at rest at its start."""
    begin, end = np.asarray(start, dtype=float), np.asarray(goal, dtype=float)
    d = begin.size
    diagonal = np.diag([noise] * d + [0.1 * noise] * d)
    vehicle = Vehicle(
        name=name,
        system=double_integrator(dt, d),
        start=np.concatenate([begin, np.zeros(d)]),
        goal=Goal(end - 0.2, end + 0.2, np.full(d, 0.05)),
        radius=0.4,
        control_limit=np.full(d, 2.0),
        speed_limit=np.full(d, 3.0),
        initial_covariance=diagonal,
        disturbance_covariance=diagonal,
    )
    return replace(vehicle, **changes)


def straight_controls(vehicle: Vehicle, horizon: int) -> np.ndarray:
    """Return the least-squares controls that end at rest in the middle of the goal."""
    system = vehicle.system
    n, m = system.num_states, system.num_controls
    prediction = np.zeros((n, horizon * m))
    power = np.eye(n)
    for k in range(horizon - 1, -1, -1):
        prediction[:, k * m : (k + 1) * m] = power @ system.B
        power = power @ system.A
    target = np.concatenate([vehicle.goal.center, np.zeros(n - system.dimension)])
    flat, *_ = np.linalg.lstsq(prediction, target - power @ vehicle.start, rcond=None)
    return flat.reshape(horizon, m)


def make_plan(scenario: Scenario, controls: list[np.ndarray]) -> Plan:
    """Return a plan whose numbers all agree with its controls."""
    trajectories = tuple(
        Trajectory(
            v.name,
            u,
            rollout(v.system, v.start, u, v.drift),
            v.covariances(scenario.horizon),
            v.gain,
        )
        for v, u in zip(scenario.vehicles, controls, strict=True)
    )
    cost = sum(
        v.cost_weight * np.abs(u).sum() for v, u in zip(scenario.vehicles, controls, strict=True)
    )
    return Plan(
        scenario=scenario,
        planner="by hand",
        seed=0,
        status=Status.FEASIBLE,
        cost=float(cost),
        lower_bound=None,
        risk=Risk(scenario.risk_bound),
        sets=tuple((v.name,) for v in scenario.vehicles),
        trajectories=trajectories,
    )


def straight_plan(scenario: Scenario) -> Plan:
    """Return everyone's straight flight."""
    return make_plan(scenario, [straight_controls(v, scenario.horizon) for v in scenario.vehicles])


def walk_plan(*walks: tuple[Vehicle, np.ndarray], **options: object) -> Plan:
    """Return the plan of vehicles without inertia."""
    vehicles = tuple(v for v, _ in walks)
    settings = {"name": "walk", "dt": 1.0, "risk_bound": 0.05, "avoidance": "steps", **options}
    scenario = Scenario(horizon=len(walks[0][1]), vehicles=vehicles, **settings)
    return make_plan(scenario, [u for _, u in walks])


def random_scene(seed: int, dimension: int = 2) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return a few walkers and convex obstacles that come close to one another."""
    rng = np.random.default_rng(seed)
    count, steps = int(rng.integers(2, 5)), int(rng.integers(2, 5))
    paths = rng.uniform(0.0, 6.0, (count, steps, dimension))
    spreads = 0.2 * rng.standard_normal((count, dimension, dimension))
    covariances = spreads @ spreads.transpose(0, 2, 1)
    clouds = rng.uniform(0.0, 1.5, (2, 6, dimension)) + rng.uniform(0, 5, (2, 1, dimension))
    return paths, covariances, clouds


def scene_plan(
    paths: np.ndarray,
    covariances: np.ndarray,
    clouds: np.ndarray,
    *,
    radius: float = 0.3,
    **options: object,
) -> Plan:
    """Return the walkers' plan through hulls of the clouds."""
    walks = [
        walk(f"v{i}", path, radius=radius, covariance=covariance, growth=0.05)
        for i, (path, covariance) in enumerate(zip(paths, covariances, strict=True))
    ]
    shapes = [hull(cloud) for cloud in clouds]
    hulls = [Obstacle.halfspaces(f"o{i}", s.normals, s.offsets) for i, s in enumerate(shapes)]
    return walk_plan(*walks, obstacles=tuple(hulls), **options)
