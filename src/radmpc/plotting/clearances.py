"""Clearances between hulls and obstacles over time. No matplotlib."""

from __future__ import annotations

from functools import cache
from itertools import combinations

import numpy as np
from scipy.spatial import cKDTree

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.geometry import Polytope, hull
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.relations.concerns import is_for
from radmpc.model.relations.keep import keep_pairs
from radmpc.plotting.canvas.letters import shortened
from radmpc.plotting.curves import mean_path, positions
from radmpc.plotting.deviations import Deviations, deviations
from radmpc.plotting.interpolation import moving_outline
from radmpc.plotting.near_obstacles import closest_of, least_shares
from radmpc.plotting.nearest import nearest
from radmpc.records import dataclass, replace

__all__ = ["Clearance", "closest_clearances", "distances_at_steps", "touches_sweep"]

_NEAR = 12.0
"""Standard deviations beyond which a pair is looked at only where others are as far apart."""

_FINENESS = 20
"""Points per step."""


@dataclass(frozen=True, slots=True, eq=False)
class Clearance:
    """One encounter over time.

    Attributes
    ----------
    form : str
        What becomes a name of the two.
    names : (str, str)
        Of the vehicle, and of what it keeps clear of.
    times : (p,) array
        When [s].
    distance : (p,) array
        Between the hulls on the mean paths, negative where they overlap; of a range that is kept,
        what is left of it [m].
    sigma : (p,) array
        Standard deviation of the distance along the line between the two [m].
    stride : int
        Points from one step to the next.
    """

    form: str
    names: tuple[str, str]
    times: Vector
    distance: Vector
    sigma: Vector
    stride: int

    @property
    def name(self) -> str:
        """Both names in full."""
        return self.form.format(*self.names)

    def name_within(self, letters: int) -> str:
        """Return the name, of which no part has more than some letters."""
        return self.form.format(*(shortened(name, letters) for name in self.names))

    def at_steps(self, values: Vector) -> Vector:
        """Return the values at the steps alone, (T+1,)."""
        return values[:: self.stride]

    def least(self, *, at_steps: bool) -> float:
        """Return the least distance in standard deviations [-]: what orders encounters."""
        shares = self.distance / np.maximum(self.sigma, 1e-9)
        return float(np.min(self.at_steps(shares) if at_steps else shares))


def closest_clearances(plan: Plan, most: int) -> tuple[Clearance, ...]:
    """Return the encounters that come closest, in standard deviations.

    Parameters
    ----------
    plan : Plan
        With trajectories.
    most : int
        How many at most.

    Returns
    -------
    tuple of Clearance
        The closest first. Of more than eight vehicles, pairs that stay far from each other are left
        out, unless they come closer than another of these.
    """
    scenario = plan.scenario
    count = _points_per_step(plan)
    paths = np.array([_fine_path(plan, i, count) for i in range(len(plan.trajectories))])
    strays = deviations(plan, count)
    times = np.linspace(0.0, scenario.dt * scenario.horizon, paths.shape[1])
    found = _of_obstacles(plan, paths, strays, times, most)
    names = [vehicle.name for vehicle in scenario.vehicles]
    for i, j, within in keep_pairs(scenario.keep, names):
        pair = _of_pair(plan, i, j, paths, strays, times)
        touching = scenario.vehicles[i].radius + scenario.vehicles[j].radius
        left = within - (pair.distance + touching)
        found.append(replace(pair, form=f"{pair.form}, range", distance=left))
    at_steps = scenario.avoidance == "steps"
    widest = max(strays.most_of_pairs, 1e-9)
    hulls = 2.0 * max(vehicle.radius for vehicle in scenario.vehicles)
    reach, pairs = _first_reach(plan, paths, strays), dict[tuple[int, int], Clearance]()
    while True:
        for i, j in _pairs_within(paths, reach):
            if (i, j) not in pairs:
                pairs[i, j] = _of_pair(plan, i, j, paths, strays, times)
        ordered = sorted([*found, *pairs.values()], key=lambda c: c.least(at_steps=at_steps))
        shown = ordered[:most]
        # Whoever is not within reach is at least this far apart, in standard deviations.
        beyond = (reach - hulls) / widest
        if not shown or shown[-1].least(at_steps=at_steps) <= beyond:
            return tuple(shown)
        reach *= 2.0


def _points_per_step(plan: Plan) -> int:
    """Return how finely all paths are cut: as their curves are, where any is curved."""
    longest = max(
        len(mean_path(v, t)) for v, t in zip(plan.scenario.vehicles, plan.trajectories, strict=True)
    )
    return max(_FINENESS, (longest - 1) // plan.scenario.horizon)


def _fine_path(plan: Plan, index: int, count: int) -> Matrix:
    """Return a mean path at ``count`` points per step, (p, d) [m]."""
    path = mean_path(plan.scenario.vehicles[index], plan.trajectories[index])
    fine = np.linspace(0.0, 1.0, count * plan.scenario.horizon + 1)
    known = np.linspace(0.0, 1.0, len(path))
    return np.column_stack([np.interp(fine, known, path[:, a]) for a in range(path.shape[1])])


def distances_at_steps(plan: Plan, i: int, obstacle: Obstacle) -> Vector:
    """Return the distances between a vehicle's hull and an obstacle at the steps, (T+1,) [m].

    Parameters
    ----------
    plan : Plan
        With trajectories.
    i : int
        Number of the vehicle.
    obstacle : Obstacle
        Of its scenario.
    """
    vehicle = plan.scenario.vehicles[i]
    places = positions(vehicle, plan.trajectories[i])
    found = [nearest(places[k : k + 1], obstacle.at(k))[0][0] for k in range(len(places))]
    return np.array(found) - vehicle.radius


def touches_sweep(plan: Plan, i: int, obstacle: Obstacle) -> bool:
    """Whether a vehicle's swept hull touches what a moving obstacle sweeps, at whatever times.

    Parameters
    ----------
    plan : Plan
        With trajectories.
    i : int
        Number of the vehicle.
    obstacle : Obstacle
        Of its scenario.
    """
    vehicle = plan.scenario.vehicles[i]
    path = mean_path(vehicle, plan.trajectories[i])
    # From faces alone: at corners a little early, for pictures near enough.
    return any(
        (path @ piece.normals.T - piece.offsets).max(axis=1).min() <= vehicle.radius
        for pieces in obstacle.steps
        for piece in pieces
    )


def _first_reach(plan: Plan, paths: Tensor, strays: Deviations) -> float:
    """Return the distance within which all pairs are looked at [m]: infinite in small fleets."""
    vehicles = plan.scenario.vehicles
    if len(vehicles) <= 8:
        return np.inf
    # Two may come together and part again within what both move from point to point.
    move = float(np.linalg.norm(np.diff(paths, axis=1), axis=2).max(initial=0.0))
    return 6.0 * max(v.radius for v in vehicles) + _NEAR * strays.most + 2.0 * move


def _pairs_within(paths: Tensor, reach: float) -> list[tuple[int, int]]:
    """Return the pairs of paths that come within reach of each other at any point."""
    if np.isinf(reach):
        return list(combinations(range(len(paths)), 2))
    found: set[tuple[int, int]] = set()
    for k in range(paths.shape[1]):
        found |= cKDTree(paths[:, k]).query_pairs(reach)
    return sorted(found)


def _of_pair(
    plan: Plan, i: int, j: int, paths: Tensor, strays: Deviations, times: Vector
) -> Clearance:
    """Return the distance between two vehicles' hulls."""
    one, two = plan.scenario.vehicles[i], plan.scenario.vehicles[j]
    between = paths[j] - paths[i]
    centers = np.linalg.norm(between, axis=1)
    along = between / np.maximum(centers, 1e-12)[:, None]
    variance = np.einsum("pa,pab,pb->p", along, strays.of_pair(i, j), along)
    stride = (len(times) - 1) // plan.scenario.horizon
    distance = centers - one.radius - two.radius
    names = one.name, two.name
    return Clearance("{} – {}", names, times, distance, np.sqrt(variance), stride)


def _of_obstacles(
    plan: Plan, paths: Tensor, strays: Deviations, times: Vector, most: int
) -> list[Clearance]:
    """Return the distances to obstacles that may be among the closest."""
    scenario, stride = plan.scenario, (len(times) - 1) // plan.scenario.horizon
    radii = np.array([vehicle.radius for vehicle in scenario.vehicles])
    met, bounds = list[tuple[int, int]](), list[float]()
    for number, obstacle in enumerate(scenario.obstacles):
        shares = least_shares(obstacle, paths, strays.between, radii, stride)
        for i, vehicle in enumerate(scenario.vehicles):
            if is_for(obstacle, vehicle.name):
                met.append((number, i))
                bounds.append(float(shares[i]))
    shapes = cache(lambda number: _shapes(scenario.obstacles[number], len(times), stride))

    def measured(k: int) -> Clearance:
        number, i = met[k]
        seen = paths[i], strays.between[i], times
        return _of_obstacle(plan, i, scenario.obstacles[number], shapes(number), seen)

    at_steps = scenario.avoidance == "steps"
    return closest_of(bounds, measured, lambda one: one.least(at_steps=at_steps), most)


def _shapes(obstacle: Obstacle, count: int, stride: int) -> tuple[Polytope, ...]:
    """Return the pieces of an obstacle that stands still, or where one that moves is at points."""
    if not obstacle.is_moving:
        return obstacle.at(0)
    shares = (np.arange(count) / stride).tolist()
    return tuple(hull(moving_outline(obstacle, share)) for share in shares)


def _of_obstacle(
    plan: Plan,
    i: int,
    obstacle: Obstacle,
    shapes: tuple[Polytope, ...],
    seen: tuple[Matrix, Tensor, Vector],
) -> Clearance:
    """Return the distance between a vehicle's hull and an obstacle."""
    vehicle, (path, noise, times) = plan.scenario.vehicles[i], seen
    stride = (len(times) - 1) // plan.scenario.horizon
    if obstacle.is_moving:
        at_steps = [nearest(path[k : k + 1], (shape,)) for k, shape in enumerate(shapes)]
        distance = np.concatenate([found[0] for found in at_steps])
        along = np.concatenate([found[1] for found in at_steps])
    else:
        distance, along = nearest(path, shapes)
    if obstacle.spread is not None:
        steps = np.minimum(np.arange(len(path)) // stride, plan.scenario.horizon - 1)
        noise = noise + obstacle.spread.between(steps, np.arange(len(path)) / stride - steps)
    variance = np.einsum("pa,pab,pb->p", along, noise, along)
    names, left = (vehicle.name, obstacle.name), distance - vehicle.radius
    return Clearance("{}, {}", names, times, left, np.sqrt(variance), stride)
