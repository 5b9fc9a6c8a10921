"""A second simulator: vehicles moved through time in plain loops, sharing no code with the referee.

A mission is drawn whole. Over a step a double integrator flies ``p + v t + a t²/2`` under the
control it holds, ``clip(ū + K (x − x̄))`` under feedback, and the disturbance and the drift of the
step come in evenly. Who measures flies ``clip(ū + K (x̂ − x̄))``, each mission with its own filter;
all else goes straight from step to step. Every path is looked at 200 times per step. An obstacle
on a track is drawn once per mission, for all vehicles, and goes straight from step to step.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from physical_distances import Distance
from scipy.linalg import block_diag

from radmpc.model.obstacle import Obstacle, TrackShape
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle

LOOKS = 200
COARSE = 8


@dataclass(frozen=True)
class Flown:
    """How many of some missions collided, by what, and asked for more control than there is."""

    missions: int
    collisions: int
    pair_collisions: int
    obstacle_collisions: int
    workspace_exits: int
    saturated: int


@dataclass
class Path:
    """One step of one vehicle in all missions: ``begin + s way − s (1 − s) hang``, (S, d) each."""

    begin: np.ndarray
    way: np.ndarray
    hang: np.ndarray

    def at(self, share: float, who: np.ndarray | slice) -> np.ndarray:
        return self.begin[who] + share * self.way[who] - share * (1.0 - share) * self.hang[who]

    def drift(self, looks: int) -> np.ndarray:
        """How far the vehicle gets from the closest of some looks, at most."""
        fastest = np.linalg.norm(self.way, axis=1) + np.linalg.norm(self.hang, axis=1)
        return fastest / (2 * looks)

    def minus(self, other: Path) -> Path:
        return Path(self.begin - other.begin, self.way - other.way, self.hang - other.hang)


def fly(plan: Plan, missions: int, seed: int) -> Flown:
    """Fly a plan many times."""
    rng = np.random.default_rng(seed)
    scenario = plan.scenario
    saturated = np.zeros(missions, dtype=bool)
    gusts = _gusts(scenario, missions, rng)
    paths = [
        list(_paths(v, t.controls, scenario.dt, missions, rng, saturated, gusts))
        for v, t in zip(scenario.vehicles, plan.trajectories, strict=True)
    ]
    strays = [_strays(thing, scenario, missions, rng) for thing in scenario.obstacles]
    pair, obstacle, outside = (np.zeros(missions, dtype=bool) for _ in range(3))
    intervals = scenario.avoidance == "intervals"
    for k in range(scenario.horizon + (0 if intervals else 1)):
        here = [steps[k] if intervals else _moment(steps, k) for steps in paths]
        things = [Distance(thing, scenario.dt, k, intervals) for thing in scenario.obstacles]
        for i, vehicle in enumerate(scenario.vehicles):
            for j in range(i):
                reach = vehicle.radius + scenario.vehicles[j].radius
                pair |= _hits(here[i].minus(here[j]), reach, lambda _, x: _norm(x), intervals)
            for distance, stray in zip(things, strays, strict=True):
                seen = here[i] if stray is None else here[i].minus(_stray(stray, k, intervals))
                obstacle |= _hits(seen, vehicle.radius, distance, intervals)
            if scenario.workspace is not None:
                lower, upper = scenario.workspace.lower, scenario.workspace.upper

                def room(_: float, x: np.ndarray, low=lower, high=upper) -> np.ndarray:
                    return np.minimum(x - low, high - x).min(axis=1)

                outside |= _hits(here[i], 0.0, room, intervals)
    counts = (pair | obstacle | outside, pair, obstacle, outside, saturated)
    return Flown(missions, *(int(c.sum()) for c in counts))


def _strays(
    thing: Obstacle, scenario: Scenario, missions: int, rng: np.random.Generator
) -> np.ndarray | None:
    """Draw how far an obstacle is from where it is expected, (T + 1, S, d)."""
    if not isinstance(thing.shape, TrackShape):
        return None
    d = len(thing.shape.start) // 2
    none = np.zeros(2 * d)
    off = rng.multivariate_normal(none, thing.shape.covariance, missions, method="svd")
    found = [off[:, :d].copy()]
    for _ in range(scenario.horizon):
        off[:, :d] += scenario.dt * off[:, d:]
        jolt = thing.shape.disturbance_covariance
        off += rng.multivariate_normal(none, jolt, missions, method="svd")
        found.append(off[:, :d].copy())
    return np.array(found)


def _stray(stray: np.ndarray, k: int, moving: bool) -> Path:
    """Return how far an obstacle is off during a window, as a path."""
    way = stray[k + 1] - stray[k] if moving else np.zeros_like(stray[k])
    return Path(stray[k], way, np.zeros_like(way))


def _gusts(
    scenario: Scenario, missions: int, rng: np.random.Generator
) -> dict[str, list[np.ndarray]]:
    """Draw what vehicles share, once for all: by source and step, (S, r)."""
    sources = {part.name: part for vehicle in scenario.vehicles for part in vehicle.shared}
    found = {}
    for name, part in sources.items():
        zero, rho = np.zeros(part.size), part.correlation
        series = []
        for k in range(scenario.horizon):
            fresh = rng.multivariate_normal(zero, part.covariance, missions, method="svd")
            series.append(rho * series[-1] + np.sqrt(1.0 - rho**2) * fresh if k else fresh)
        found[name] = series
    return found


def _paths(
    vehicle: Vehicle,
    controls: np.ndarray,
    dt: float,
    missions: int,
    rng: np.random.Generator,
    saturated: np.ndarray,
    gusts: dict[str, list[np.ndarray]],
) -> Iterator[Path]:
    """Draw a vehicle's missions and yield each step's path."""
    A, B, axes = vehicle.system.A, vehicle.system.B, list(vehicle.system.position)
    n = len(A)
    mean = vehicle.start.copy()
    drift = np.zeros(n) if vehicle.drift is None else vehicle.drift
    state = mean + rng.multivariate_normal(
        np.zeros(n), vehicle.initial_covariance, missions, method="svd"
    )
    rho = vehicle.disturbance_correlation
    noise: np.ndarray | None = None
    watch = _Filter(vehicle, missions) if vehicle.measurement else None
    for k, planned in enumerate(controls):
        asked = np.tile(planned, (missions, 1))
        known = state if watch is None else watch.look(state, rng)
        if vehicle.gain is not None:
            asked = asked + (known - mean) @ vehicle.gain.T
        limit = vehicle.control_limit
        saturated |= np.any(np.abs(asked) > limit + 2e-6, axis=1)
        given = asked if vehicle.gain is None else np.clip(asked, -limit, limit)
        fresh = _disturbances(vehicle, missions, rng)
        noise = fresh if noise is None else rho * noise + np.sqrt(1.0 - rho**2) * fresh
        pushed = noise + sum(gusts[part.name][k] @ part.matrix.T for part in vehicle.shared)
        following = state @ A.T + given @ B.T + pushed + drift
        if is_pushed_point(A, B, axes, dt):
            velocity = ((state @ A.T - state) / dt)[:, axes]
            acceleration = (given @ B.T)[:, axes] * 2.0 / dt**2
            # p + v t + a t²/2 + (t/dt) (c + w), written in s = t/dt.
            way = velocity * dt + 0.5 * acceleration * dt**2 + (pushed + drift)[:, axes]
            yield Path(state[:, axes], way, 0.5 * acceleration * dt**2)
        else:
            begin = state[:, axes]
            yield Path(begin, following[:, axes] - begin, np.zeros_like(begin))
        mean = A @ mean + B @ planned + drift
        state = following
        if watch is not None:
            watch.move(given @ B.T + drift)


class _Filter:
    """What every mission makes of its own measurements: guesses of states and of disturbances."""

    def __init__(self, vehicle: Vehicle, missions: int) -> None:
        n = len(vehicle.start)
        self.vehicle, self.n = vehicle, n
        own = (np.eye(n), vehicle.disturbance_covariance, vehicle.disturbance_correlation)
        shared = [(part.matrix, part.covariance, part.correlation) for part in vehicle.shared]
        matrices, noises, lasting = zip(own, *shared, strict=True)
        rest = sum(map(len, noises))
        self.effect, self.noise = np.hstack(matrices), block_diag(*noises)
        self.lasting = np.repeat(lasting, [len(noise) for noise in noises])
        self.guess = np.hstack([np.tile(vehicle.start, (missions, 1)), np.zeros((missions, rest))])
        self.doubt = block_diag(vehicle.initial_covariance, self.noise)

    def look(self, state: np.ndarray, rng: np.random.Generator) -> np.ndarray:
        """Measure, and return the states as they are thought to be."""
        C, R = self.vehicle.measurement.matrix, self.vehicle.measurement.covariance
        wide = np.hstack([C, np.zeros((len(C), len(self.noise)))])
        noise = rng.multivariate_normal(np.zeros(len(R)), R, len(state), method="svd")
        surprise = state @ C.T + noise - self.guess @ wide.T
        gain = self.doubt @ wide.T @ np.linalg.pinv(wide @ self.doubt @ wide.T + R, 1e-10)
        self.guess = self.guess + surprise @ gain.T
        self.doubt = self.doubt - gain @ wide @ self.doubt
        return self.guess[:, : self.n]

    def move(self, pushed: np.ndarray) -> None:
        """Go on to the next step, as a push that is known moves the state."""
        n, rho = self.n, self.lasting
        step = block_diag(self.vehicle.system.A, np.diag(rho))
        step[:n, n:] = self.effect
        self.guess = self.guess @ step.T
        self.guess[:, :n] += pushed
        self.doubt = step @ self.doubt @ step.T
        self.doubt[n:, n:] += np.diag(1.0 - rho**2) @ self.noise


def _disturbances(vehicle: Vehicle, missions: int, rng: np.random.Generator) -> np.ndarray:
    """Draw one disturbance per mission."""
    covariance = vehicle.disturbance_covariance
    return rng.multivariate_normal(np.zeros(len(covariance)), covariance, missions, method="svd")


def is_pushed_point(A: np.ndarray, B: np.ndarray, axes: list[int], dt: float) -> bool:
    """Whether controls are held accelerations, velocities and positions their exact integrals."""
    d, n = len(axes), len(A)
    rest = [i for i in range(n) if i not in axes]
    carried = A - np.eye(n)
    link = carried[np.ix_(axes, rest)]
    only_carried = np.abs(carried).sum() - np.abs(link).sum() < 1e-9 * dt
    one_each = n == 2 * d and np.allclose(link @ link.T, dt**2 * np.eye(d), rtol=1e-9, atol=0.0)
    one_each = one_each and np.count_nonzero(link > 0.0) == d
    return one_each and only_carried and np.allclose(B[axes], 0.5 * link @ B[rest], rtol=1e-9)


def _moment(steps: list[Path], k: int) -> Path:
    """Return where a vehicle is at step k, as a path that stays there."""
    place = steps[k].begin if k < len(steps) else steps[-1].begin + steps[-1].way
    return Path(place, np.zeros_like(place), np.zeros_like(place))


def _norm(x: np.ndarray) -> np.ndarray:
    return np.linalg.norm(x, axis=1)


def _hits(path: Path, reach: float, distance, moving: bool) -> np.ndarray:
    """Whether a path ever comes closer than a reach; ``distance`` takes a share and places."""
    everyone = slice(None)
    if not moving:
        return distance(0.0, path.at(0.0, everyone)) < reach - 1e-9
    hit = np.zeros(len(path.begin), dtype=bool)
    close = hit.copy()
    drift = path.drift(COARSE) + getattr(distance, "travel", 0.0) / (2 * COARSE)
    for share in (np.arange(COARSE) + 0.5) / COARSE:
        gaps = _closer(distance, share, path.at(share, everyone), reach + drift)
        hit |= gaps < reach - 1e-9
        close |= gaps < reach + drift
    for share in np.linspace(0.0, 1.0, LOOKS + 1):
        left = np.flatnonzero(close & ~hit)
        if left.size:
            gaps = _closer(distance, share, path.at(share, left), np.full(left.size, reach))
            hit[left] = gaps < reach - 1e-9
    return hit


def _closer(distance, share: float, places: np.ndarray, limit: np.ndarray) -> np.ndarray:
    """Return distances that are exact where they are below a limit."""
    if not isinstance(distance, Distance):
        return distance(share, places)
    gaps = distance.at_least(share, places)
    near = np.flatnonzero(gaps < limit)
    gaps[near] = distance(share, places[near])
    return gaps
