"""Flights without the referee: its own propagation, clipping, geometry and moments of time.

Slow and plain. Paths are looked at in a few moments per step only, and contact begins a hair
inside of the hulls, so that what is counted is never more than what collides.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.errors import ScenarioError
from radmpc.geometry import Polytope, hull
from radmpc.model.plan import Plan
from radmpc.model.vehicle import Vehicle

__all__ = [
    "MOMENTS",
    "between",
    "hits_at",
    "places_of",
    "plain_collisions",
    "root_of",
    "solid_distances",
]

Flags = npt.NDArray[np.bool_]

MOMENTS = 8
"""Moments looked at per step, its end included."""

_INSIDE = 1e-6
"""Overlap from which on a contact counts [m]."""


def plain_collisions(plan: Plan, samples: int, seed: int) -> int:
    """Return in how many flights anything collides, with controls cut off at their limits.

    Parameters
    ----------
    plan : Plan
        Judged by its scenario and controls.
    samples : int
        Flights.
    seed : int
        Of all noise.

    Returns
    -------
    int
        At most what collides along continuous paths.
    """
    scenario = plan.scenario
    rng = np.random.default_rng(seed)
    noises = [(root_of(v.initial_covariance), root_of(v.disturbance_covariance))
              for v in scenario.vehicles]  # fmt: skip
    states = [
        v.start + rng.standard_normal((samples, v.start.size)) @ root.T
        for v, (root, _) in zip(scenario.vehicles, noises, strict=True)
    ]
    nominal = [np.array(v.start) for v in scenario.vehicles]
    hit = hits_at(
        plan, 0, 0.0, [places_of(v, x) for v, x in zip(scenario.vehicles, states, strict=True)]
    )
    for k in range(scenario.horizon):
        before, pushes = states, []
        states = []
        for i, vehicle in enumerate(scenario.vehicles):
            control = plan.trajectories[i].controls[k]
            asked = np.tile(control, (samples, 1))
            if vehicle.gain is not None:
                asked = asked + (before[i] - nominal[i]) @ vehicle.gain.T
                asked = np.clip(asked, -vehicle.control_limit, vehicle.control_limit)
                asked = shortened(asked, vehicle.control_norm)
            noise = rng.standard_normal((samples, vehicle.start.size)) @ noises[i][1].T
            A, B = vehicle.system.A, vehicle.system.B
            states.append(before[i] @ A.T + asked @ B.T + noise)
            nominal[i] = A @ nominal[i] + B @ control
            pushes.append(asked @ B[list(vehicle.system.position)].T)
        shares = [1.0]
        if scenario.avoidance == "intervals":
            shares = [(j + 1) / MOMENTS for j in range(MOMENTS)]
        for s in shares:
            places = []
            for vehicle, here, there, push in zip(
                scenario.vehicles, before, states, pushes, strict=True
            ):
                place = (1.0 - s) * places_of(vehicle, here) + s * places_of(vehicle, there)
                if vehicle.system.is_double_integrator:
                    place = place - s * (1.0 - s) * push
                places.append(place)
            hit |= hits_at(plan, k, s, places)
    return int(hit.sum())


def shortened(asked: Matrix, most: float | None) -> Matrix:
    """Return controls no longer than a norm, each in its direction."""
    if most is None:
        return asked
    lengths = np.hypot.reduce(asked, axis=1)
    return asked * np.minimum(1.0, most / np.maximum(lengths, most))[:, None]


def root_of(covariance: Matrix) -> Matrix:
    """Return a matrix whose product with its transpose is the covariance."""
    values, vectors = np.linalg.eigh(covariance)
    return np.asarray(vectors * np.sqrt(values.clip(min=0.0)))


def places_of(vehicle: Vehicle, states: Matrix) -> Matrix:
    """Return the positions that states hold."""
    return np.asarray(states[:, list(vehicle.system.position)])


def hits_at(
    plan: Plan,
    step: int,
    share: float,
    places: list[Matrix],
    strays: Sequence[Matrix | None] | None = None,
) -> Flags:
    """Return which flights have a collision at a moment.

    Parameters
    ----------
    plan : Plan
        Its scenario has radii, obstacles and workspace.
    step : int
        At which the interval begins.
    share : float
        Of the interval.
    places : list of (S, d) array
        Where each vehicle is [m].
    strays : sequence of ((S, d) array or None), or None
        How far each obstacle is from where it is expected [m]; None is not at all.
    """
    scenario = plan.scenario
    hit: Flags = np.zeros(len(places[0]), dtype=bool)
    for (i, here), (j, there) in combinations(enumerate(places), 2):
        reach = scenario.vehicles[i].radius + scenario.vehicles[j].radius
        hit |= np.linalg.norm(here - there, axis=1) < reach - _INSIDE
    box = scenario.workspace
    for vehicle, here in zip(scenario.vehicles, places, strict=True):
        if box is not None:
            hit |= np.any((here < box.lower - _INSIDE) | (here > box.upper + _INSIDE), axis=1)
        for which, obstacle in enumerate(scenario.obstacles):
            off = None if strays is None else strays[which]
            seen = here if off is None else here - off
            for number, piece in enumerate(obstacle.at(step)):
                solid = piece
                if obstacle.is_moving and share > 0.0:
                    solid = between(piece, obstacle.at(step + 1)[number], share)
                hit |= solid_distances(solid, seen) < vehicle.radius - _INSIDE
    return hit


def between(here: Polytope, there: Polytope, share: float) -> Polytope:
    """Return the Minkowski interpolation of two solids."""
    corners = (1.0 - share) * here.vertices[:, None] + share * there.vertices
    points = corners.reshape(-1, corners.shape[2])
    try:
        return hull(points)
    except ScenarioError:
        # Of points that cannot be wrapped, the points alone: less than the solid.
        d = points.shape[1]
        return Polytope(np.zeros((1, d)), np.full(1, -np.inf), points)


def solid_distances(solid: Polytope, points: Matrix) -> Vector:
    """Return the distances of points to a solid, 0 inside.

    The nearest point lies inside, on a face or on a segment between two corners; all segments
    between corners are part of the solid, whether they are edges or not.
    """
    values = points @ solid.normals.T - solid.offsets
    inside = (values <= 0.0).all(axis=1)
    best: Vector = np.where(inside, 0.0, np.linalg.norm(points - solid.vertices[0], axis=1))
    for one, two in combinations(solid.vertices, 2):
        best = np.minimum(best, _segment_distances(one, two - one, points))
    if points.shape[1] == 3:
        for face, normal in enumerate(solid.normals):
            if not normal.any():
                continue
            feet = points - values[:, face, None] * normal
            on_face = (feet @ solid.normals.T <= solid.offsets + 1e-12).all(axis=1)
            best = np.where(on_face, np.minimum(best, np.abs(values[:, face])), best)
    return best


def _segment_distances(begin: Vector, way: Vector, points: Matrix) -> Vector:
    """Return the distances of points to a segment."""
    relative: Tensor = points - begin
    length = float(way @ way)
    share = np.clip(relative @ way / length, 0.0, 1.0) if length > 0.0 else np.zeros(len(points))
    return np.asarray(np.linalg.norm(relative - share[:, None] * way, axis=1))
