"""Small fleets of all kinds, flown by controls nobody planned."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from referee_scenes import make_plan
from scipy.spatial.transform import Rotation

from radmpc.model.dynamics import LinearSystem, double_integrator, lqr_gain, rollout
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Goal, Vehicle

PLENTY = 1e4


def permuted(dt: float, dimension: int, rng: np.random.Generator) -> LinearSystem:
    """Return a double integrator by its matrices, states and controls in any order."""
    base = double_integrator(dt, dimension)
    states, controls = rng.permutation(2 * dimension), rng.permutation(dimension)
    where = np.argsort(states)
    given = tuple(where[dimension:]) if rng.random() < 0.5 else None
    return LinearSystem(
        base.A[np.ix_(states, states)],
        base.B[np.ix_(states, controls)],
        tuple(where[:dimension]),
        given,
    )


def thrusters(dt: float, dimension: int, rng: np.random.Generator) -> LinearSystem:
    """Return a double integrator pushed by one thruster more than it has axes."""
    base = double_integrator(dt, dimension)
    mixing = np.hstack([np.eye(dimension), rng.normal(size=(dimension, 1))])
    return LinearSystem(base.A, base.B @ mixing, base.position, base.velocity)


def euler(dt: float, dimension: int, rng: np.random.Generator) -> LinearSystem:
    """Return a system whose controls move velocities alone, with some drag."""
    base = double_integrator(dt, dimension)
    pushes = np.vstack([np.zeros((dimension, dimension)), dt * np.eye(dimension)])
    drag = np.diag([1.0] * dimension + [rng.uniform(0.5, 1.0)] * dimension)
    return LinearSystem(drag @ base.A, pushes, base.position, base.velocity)


def stepper(dt: float, dimension: int, rng: np.random.Generator) -> LinearSystem:
    """Return a system that moves by its control, with some coupling of its axes."""
    coupling = np.eye(dimension) + 0.2 * rng.normal(size=(dimension, dimension))
    return LinearSystem(np.eye(dimension), dt * coupling, tuple(range(dimension)), None)


def plain(dt: float, dimension: int, _: np.random.Generator) -> LinearSystem:
    """Return the double integrator of scenario files."""
    return double_integrator(dt, dimension)


SYSTEMS = (plain, plain, permuted, thrusters, euler, stepper)


def feedback(system: LinearSystem, rng: np.random.Generator) -> np.ndarray | None:
    """Return no gain, or a soft one up to one that is all but dead-beat."""
    if rng.random() < 0.25:
        return None
    n, m = system.num_states, system.num_controls
    return lqr_gain(system, np.eye(n), 10.0 ** rng.uniform(-4.0, 2.0) * np.eye(m))


def covariance(size: int, deviation: float, rng: np.random.Generator) -> np.ndarray:
    """Return a covariance: of one axis, of one direction, of all axes, none, or a full one."""
    kind = rng.integers(5)
    if kind == 0:
        return np.zeros((size, size))
    if kind == 1:
        return deviation**2 * np.diag(np.eye(size)[rng.integers(size)])
    if kind == 2:
        direction = rng.normal(size=size)
        return deviation**2 * np.outer(direction, direction) / (direction @ direction)
    if kind == 3:
        return deviation**2 * np.diag(rng.uniform(0.0, 1.0, size))
    spread = rng.normal(size=(size, size))
    return deviation**2 * spread @ spread.T / size


def vehicle(name: str, horizon: int, dt: float, d: int, rng: np.random.Generator) -> Vehicle:
    """Return a vehicle of any dynamics, noise and feedback."""
    system = SYSTEMS[rng.integers(len(SYSTEMS))](dt, d, rng)
    n = system.num_states
    deviation = 10.0 ** rng.uniform(-1.5, -0.5)
    start = rng.normal(0.0, 1.0, n)
    start[list(system.position)] *= 3.0
    initial, fresh = covariance(n, deviation, rng), covariance(n, deviation, rng)
    if not initial.any() and not fresh.any():
        initial = deviation**2 * np.eye(n)
    return Vehicle(
        name=name,
        system=system,
        start=start,
        goal=Goal(np.full(d, -PLENTY), np.full(d, PLENTY), None),
        radius=rng.uniform(0.05, 0.5),
        control_limit=np.full(system.num_controls, PLENTY),
        initial_covariance=initial,
        disturbance_covariance=fresh,
        gain=feedback(system, rng),
    )


def shape(d: int, rng: np.random.Generator) -> np.ndarray:
    """Return corners around the origin."""
    size = rng.uniform(0.2, 1.5, d)
    if rng.random() < 0.4:
        corners = np.stack(np.meshgrid(*[[-1.0, 1.0]] * d, indexing="ij"), axis=-1)
        return corners.reshape(-1, d) * size
    return rng.normal(size=(int(rng.integers(d + 1, d + 4)), d)) * size


def obstacle(name: str, place: np.ndarray, horizon: int, rng: np.random.Generator) -> Obstacle:
    """Return something around a place: at rest, moving, turning, or changing its outline."""
    d = place.size
    corners = shape(d, rng)
    kind = rng.integers(4)
    if kind == 0:
        low, high = corners.min(axis=0), corners.max(axis=0)
        return Obstacle.box(name, place + low, place + high)
    step = rng.normal(0.0, 0.5, d)
    turn = rng.normal(0.0, 0.6, 3) if kind >= 2 else np.zeros(3)
    outlines = []
    for k in range(horizon + 1):
        turned = Rotation.from_rotvec(k * turn).as_matrix()
        if d == 2:
            turned = Rotation.from_rotvec([0.0, 0.0, k * turn[2]]).as_matrix()[:2, :2]
        outlines.append(place + k * step + corners @ turned.T)
        if kind == 3:
            corners = corners + 0.1 * rng.normal(size=corners.shape)
    return Obstacle.moving(name, outlines)


def random_plan(seed: int) -> Plan:
    """Return a fleet that comes close to things on its way."""
    rng = np.random.default_rng(seed)
    d, dt = int(rng.integers(2, 4)), float(rng.choice([0.3, 1.0, 2.0]))
    horizon, count = int(rng.integers(1, 7)), int(rng.integers(1, 4))
    fleet, controls, ways = [], [], []
    for i in range(count):
        one = vehicle(f"v{i}", horizon, dt, d, rng)
        push = rng.normal(0.0, 10.0 ** rng.uniform(-1.0, 0.5), (horizon, one.system.num_controls))
        if one.system.num_states == 2 * d:
            push /= max(1.0, dt**2)
        fleet.append(one)
        controls.append(push)
        ways.append(rollout(one.system, one.start, push)[:, list(one.system.position)])
    if count > 1 and rng.random() < 0.7:
        # The second one starts where it passes the first.
        k = int(rng.integers(horizon + 1))
        side = rng.normal(size=d)
        gap = fleet[0].radius + fleet[1].radius + rng.uniform(0.0, 0.6)
        shift = ways[0][k] - ways[1][k] + gap * side / np.linalg.norm(side)
        fleet[1], ways[1] = moved(fleet[1], shift), ways[1] + shift
    obstacles = []
    for i in range(int(rng.integers(0, 3))):
        k, side = int(rng.integers(horizon + 1)), rng.normal(size=d)
        who = int(rng.integers(count))
        place = ways[who][k] + side / np.linalg.norm(side) * rng.uniform(0.5, 3.0)
        obstacles.append(obstacle(f"o{i}", place, horizon, rng))
    workspace = None
    if rng.random() < 0.3:
        cloud = np.vstack(ways)
        room = rng.uniform(0.02, 1.0, (2, d))
        workspace = Workspace(cloud.min(axis=0) - room[0], cloud.max(axis=0) + room[1])
    scenario = Scenario(
        "random",
        dt,
        horizon,
        0.05,
        tuple(fleet),
        tuple(obstacles),
        avoidance="steps" if rng.random() < 0.15 else "intervals",
        workspace=workspace,
    )
    return make_plan(scenario, controls)


def moved(vehicle: Vehicle, shift: np.ndarray) -> Vehicle:
    """Return a vehicle that starts elsewhere."""
    start = vehicle.start.copy()
    start[list(vehicle.system.position)] += shift
    return replace(vehicle, start=start)
