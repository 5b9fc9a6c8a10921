"""The problem in numbers, straight from `docs/problem.md`: what every peer's model starts from.

Written from the statement alone; nothing of how radmpc builds or solves its program is used.
Risk is spread as users do by hand: Δ, less what is already present at k = 0, divided evenly over
all avoidances (vehicle × obstacle × step, pair × step), also those that nobody can come near.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import numpy.typing as npt
from scipy.stats import norm

from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle

__all__ = ["Array", "Danger", "NotModeledError", "Statement", "state"]

Array = npt.NDArray[np.float64]


class NotModeledError(Exception):
    """The scenario asks for something that the peers' models do not have."""


@dataclass(frozen=True, slots=True, eq=False)
class Danger:
    """One convex set to stay out of, at every step k = 0..T.

    Outside means ``normals[k, f] @ q >= offsets[k, f] + gap`` for at least one face f, where q is
    the position of ``one`` or, for a pair, that position relative to the ``other``'s.

    Attributes
    ----------
    one : int
        A vehicle.
    other : int or None
        The other vehicle of a pair.
    normals : (T+1, f, d) array
        Outward unit normals.
    offsets : (T+1, f) array
        Offsets of the faces [m].
    gap : float
        Distance to keep from the set [m].
    covariances : (T+1, d, d) array
        Covariances of q.
    """

    one: int
    other: int | None
    normals: Array
    offsets: Array
    gap: float
    covariances: Array

    @property
    def deviations(self) -> Array:
        """Standard deviation of q along every normal, (T+1, f)."""
        squares = np.einsum("kfa,kab,kfb->kf", self.normals, self.covariances, self.normals)
        return np.sqrt(np.maximum(squares, 0.0))


@dataclass(frozen=True, slots=True, eq=False)
class Statement:
    """A scenario in numbers.

    Attributes
    ----------
    scenario : Scenario
        The question.
    dangers : tuple of Danger
        Everything to stay out of.
    control_bounds : tuple of (T, m) array
        Largest nominal |u| per vehicle.
    share : float
        Risk of each avoidance; not above 0 where the risk at k = 0 is all that Δ grants.
    """

    scenario: Scenario
    dangers: tuple[Danger, ...]
    control_bounds: tuple[Array, ...]
    share: float

    @property
    def sigmas(self) -> float:
        """Standard deviations that every avoidance keeps."""
        return float(norm.isf(self.share))

    def needs(self, danger: Danger) -> Array:
        """Return what ``normals @ q`` must reach at each face, (T+1, f) [m]."""
        return danger.offsets + danger.gap + self.sigmas * danger.deviations

    def reach(self) -> tuple[Array, Array]:
        """Return boxes that hold every vehicle's mean positions, (N, T+1, d) each [m].

        Outside the limits on controls nothing can be; with a speed limit a double integrator
        comes no further than the limit carries it from its start, or back from its goal.
        """
        lows, highs = [], []
        for vehicle, bounds in zip(self.scenario.vehicles, self.control_bounds, strict=True):
            low, high = _control_reach(vehicle, bounds)
            if vehicle.system.is_double_integrator and vehicle.speed_limit is not None:
                steps = np.arange(len(low))[:, None]
                fastest = np.maximum(vehicle.speed_limit, np.abs(_velocity(vehicle)))
                out = steps * fastest * self.scenario.dt
                low = np.maximum(low, vehicle.start_position - out)
                high = np.minimum(high, vehicle.start_position + out)
                low = np.maximum(low, vehicle.goal.lower - out[::-1])
                high = np.minimum(high, vehicle.goal.upper + out[::-1])
            lows.append(low)
            highs.append(high)
        return np.array(lows), np.array(highs)

    def big_m(self, danger: Danger, reach: tuple[Array, Array]) -> Array:
        """Return by how much each face's row can be missed at most, (T+1, f) [m], >= 0."""
        low, high = reach[0][danger.one], reach[1][danger.one]
        if danger.other is not None:
            low, high = low - reach[1][danger.other], high - reach[0][danger.other]
        least = np.minimum(danger.normals * low[:, None, :], danger.normals * high[:, None, :])
        return np.maximum(self.needs(danger) - least.sum(axis=2), 0.0)


def state(scenario: Scenario) -> Statement:
    """Return a scenario in numbers.

    Raises
    ------
    NotModeledError
        If collisions count between steps, or a pair in space has other faces than the axes.
    """
    if scenario.avoidance != "steps":
        raise NotModeledError(f"avoidance {scenario.avoidance!r}")
    if scenario.dimension == 3 and scenario.num_pair_faces != 6:
        raise NotModeledError(f"{scenario.num_pair_faces} pair faces in space")
    states = [v.covariances(scenario.horizon) for v in scenario.vehicles]
    positions = [
        sigma[:, v.system.position][:, :, v.system.position]
        for v, sigma in zip(scenario.vehicles, states, strict=True)
    ]
    dangers = (*_obstacles(scenario, positions), *_pairs(scenario, positions))
    dangers = (*dangers, *_walls(scenario, positions))
    present = sum(_start_risk(scenario, danger) for danger in dangers)
    count = max(len(dangers) * scenario.horizon, 1)
    bounds = tuple(v.control_bounds(s) for v, s in zip(scenario.vehicles, states, strict=True))
    return Statement(scenario, dangers, bounds, (scenario.risk_bound - present) / count)


def _obstacles(scenario: Scenario, covariances: list[Array]) -> Iterator[Danger]:
    """Yield every convex piece of every obstacle, for every vehicle."""
    for obstacle in scenario.obstacles:
        at_steps = [obstacle.at(k) for k in range(scenario.horizon + 1)]
        for pieces in zip(*at_steps, strict=True):
            # Steps with fewer faces repeat their last one: the same alternative twice.
            most = max(len(p.offsets) for p in pieces)
            pick = [np.minimum(np.arange(most), len(p.offsets) - 1) for p in pieces]
            normals = np.stack([p.normals[i] for p, i in zip(pieces, pick, strict=True)])
            offsets = np.stack([p.offsets[i] for p, i in zip(pieces, pick, strict=True)])
            for i, vehicle in enumerate(scenario.vehicles):
                yield Danger(i, None, normals, offsets, vehicle.radius, covariances[i])


def _pairs(scenario: Scenario, covariances: list[Array]) -> Iterator[Danger]:
    """Yield every pair: the set is a point, the faces around it are the scenario's."""
    count, d = scenario.num_pair_faces, scenario.dimension
    angles = 2.0 * np.pi * np.arange(count) / count
    faces = np.column_stack([np.cos(angles), np.sin(angles)])
    if count == 2 * d:
        faces = np.concatenate([np.eye(d), -np.eye(d)])
    normals = np.tile(faces, (scenario.horizon + 1, 1, 1))
    for i, j in combinations(range(scenario.num_vehicles), 2):
        gap = scenario.vehicles[i].radius + scenario.vehicles[j].radius
        both = covariances[i] + covariances[j]
        yield Danger(i, j, normals, np.zeros(normals.shape[:2]), gap, both)


def _walls(scenario: Scenario, covariances: list[Array]) -> Iterator[Danger]:
    """Yield what lies beyond each side of the workspace, for every vehicle's center."""
    if scenario.workspace is None:
        return
    identity = np.eye(scenario.dimension)
    sides = np.concatenate([-identity, identity])
    levels = np.concatenate([-scenario.workspace.upper, scenario.workspace.lower])
    steps = scenario.horizon + 1
    for i in range(scenario.num_vehicles):
        for side, level in zip(sides, levels, strict=True):
            normals = np.tile(side, (steps, 1, 1))
            yield Danger(i, None, normals, np.full((steps, 1), level), 0.0, covariances[i])


def _start_risk(scenario: Scenario, danger: Danger) -> float:
    """Return the risk of a danger at k = 0 by its best face."""
    q = scenario.vehicles[danger.one].start_position
    if danger.other is not None:
        q = q - scenario.vehicles[danger.other].start_position
    slack = danger.normals[0] @ q - danger.offsets[0] - danger.gap
    deviations = np.maximum(danger.deviations[0], 1e-12)
    return float(norm.sf(slack / deviations).min())


def _control_reach(vehicle: Vehicle, bounds: Array) -> tuple[Array, Array]:
    """Return the box of mean positions within the control limits, (T+1, d) each [m]."""
    system = vehicle.system
    rows = list(system.position)
    state = np.asarray(vehicle.start)
    effects: list[Array] = []
    middle, spread = [state[rows]], [np.zeros(len(rows))]
    for _ in bounds:
        state = system.A @ state
        effects = [system.A @ effect for effect in effects] + [system.B]
        used = bounds[: len(effects)]
        radius = sum(np.abs(e[rows]) @ b for e, b in zip(effects, used, strict=True))
        middle.append(state[rows])
        spread.append(np.asarray(radius))
    return np.array(middle) - np.array(spread), np.array(middle) + np.array(spread)


def _velocity(vehicle: Vehicle) -> Array:
    """Return the mean velocity at k = 0 [m/s]."""
    indices = vehicle.system.velocity
    return np.asarray(vehicle.start)[list(indices)]
