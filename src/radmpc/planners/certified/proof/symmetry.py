"""Sets of vehicles that turning or mirroring space maps onto each other cost the same.

Vehicles on a circle or a square that change places are how planners are compared. Of ``circle(8)``
four rotations and four reflections keep the scene, and its 56 sets of five are ten searches.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import permutations, product
from typing import TypeVar

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.geometry import sphere_directions
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.merging import Members
from radmpc.program.condensed import CondensedModel

__all__ = ["bound_of_image", "images_of", "symmetries", "with_images"]

_Value = TypeVar("_Value")

_SAME = 1e-12
"""Difference up to which two numbers are the same, relative to the largest in the scene [-]."""

_MARGIN = 1e-9
"""What a bound gives way for that where it is told of an image [-]."""


def symmetries(scenario: Scenario, models: Sequence[CondensedModel]) -> tuple[Members, ...]:
    """Return how turning and mirroring the axes exchanges vehicles that are alike.

    Parameters
    ----------
    scenario : Scenario
        The vehicles; with an obstacle, a range to keep or a shared disturbance there is none.
    models : sequence of CondensedModel
        Theirs.

    Returns
    -------
    tuple of tuple of int
        Where each vehicle goes, by places; with the identity, which is left out, a group.
    """
    if scenario.obstacles or scenario.keep or not all(map(_is_plain, models)):
        return ()
    faces = sphere_directions(scenario.num_pair_faces, scenario.dimension)
    if not _are_same_set(faces, -faces):
        return ()  # who comes first of a pair decides what its faces are
    center = np.mean([model.drift_position[0] for model in models], axis=0)
    found = set()
    for turn in _turns(scenario.dimension):
        keeps_scene = _keeps_workspace(scenario, turn, center) and _keeps_system(models, turn)
        if keeps_scene and _are_same_set(faces, faces @ turn.T):
            found.add(_permutation(models, turn, center))
    return tuple(sorted(found - {(), tuple(range(len(models)))}))


def images_of(members: Members, group: Sequence[Members]) -> list[Members]:
    """Return the sets that a set is mapped onto, itself first.

    Parameters
    ----------
    members : tuple of int
        The set, by places.
    group : sequence of tuple of int
        `symmetries`.
    """
    return [members, *(tuple(sorted(each[i] for i in members)) for each in group)]


def with_images(bounds: Mapping[Members, float], group: Sequence[Members]) -> dict[Members, float]:
    """Return bounds of sets and of those that they are mapped onto.

    Parameters
    ----------
    bounds : mapping of tuple of int to float
        What is proven of sets, by places.
    group : sequence of tuple of int
        `symmetries`.
    """
    found = dict(bounds)
    for members, bound in bounds.items() if group else ():
        for image in images_of(members, group):
            found[image] = max(found.get(image, 0.0), bound_of_image(bound))
    return found


def bound_of_image(bound: float) -> float:
    """Return what a bound of a set says of those that it is mapped onto.

    Parameters
    ----------
    bound : float
        The bound, >= 0.
    """
    return bound * (1.0 - _MARGIN)


def _is_plain(model: CondensedModel) -> bool:
    """Whether a vehicle is told by its arrays, with a control along each axis."""
    vehicle, shape = model.vehicle, model.control_bounds.shape
    is_free = vehicle.control_norm is None and vehicle.speed_norm is None
    is_simple = not (vehicle.via or vehicle.shared or vehicle.goal.within or vehicle.belief)
    return is_free and is_simple and shape[1] == model.drift_position.shape[1]


def _turns(dimension: int) -> Iterator[Matrix]:
    """Yield the rotations and reflections that map axes onto axes, (d, d)."""
    for order in permutations(range(dimension)):
        for signs in product((1.0, -1.0), repeat=dimension):
            yield np.array(signs)[:, None] * np.eye(dimension)[list(order)]


def _keeps_workspace(scenario: Scenario, turn: Matrix, center: Vector) -> bool:
    """Whether the workspace is mapped onto itself."""
    workspace = scenario.workspace
    if workspace is None:
        return True
    ends = np.stack([workspace.lower, workspace.upper]) - center
    turned = ends @ turn.T
    return _same(np.sort(turned, axis=0), ends)


def _are_same_set(directions: Matrix, others: Matrix) -> bool:
    """Whether unit vectors are those of another set, in whatever order."""
    cosines = directions @ others.T
    return bool(np.all(cosines.max(axis=0) >= 1.0 - _SAME))


def _keeps_system(models: Sequence[CondensedModel], turn: Matrix) -> bool:
    """Whether all vehicles are of one size and answer turned controls by turned paths."""
    first = models[0]
    if any(_traits(model) != _traits(first) for model in models):
        return False
    size = first.control_bounds.size
    back = np.kron(np.eye(size // len(turn)), turn.T)
    of_controls = [first.position] if first.velocity is None else [first.position, first.velocity]
    bends = first.vehicle.system.sagitta
    keeps = all(_same(turn @ each @ back, each) for each in of_controls)
    return keeps and _same(turn @ bends @ turn.T, bends)


def _traits(model: CondensedModel) -> tuple[object, ...]:
    """Return what has to be the same of all vehicles, whatever turns them."""
    vehicle = model.vehicle
    system = vehicle.system
    matrices = system.A.tobytes(), system.B.tobytes(), system.position, system.velocity
    speeds = vehicle.speed_limit is None, vehicle.goal.speed is None
    return (*matrices, *speeds, vehicle.radius, vehicle.cost_weight, model.time_cost)


def _permutation(models: Sequence[CondensedModel], turn: Matrix, center: Vector) -> Members:
    """Return where each vehicle goes; empty where one goes where none is, or as another."""
    there = np.stack([_marks(model, np.eye(len(turn)), center) for model in models])
    turned = np.stack([_marks(model, turn, center) for model in models])
    most = _SAME * (1.0 + np.abs(there).max())
    order = []
    for marks in turned:
        same = np.flatnonzero(np.abs(there - marks).max(axis=1) <= most)
        if len(same) != 1:
            return ()
        order.append(int(same[0]))
    return tuple(order) if len(set(order)) == len(order) else ()


def _marks(model: CondensedModel, turn: Matrix, center: Vector) -> Vector:
    """Return all numbers that tell a vehicle from others, turned about the center."""
    goal, limit = model.vehicle.goal, model.vehicle.speed_limit
    moved = [model.drift_position - center, 0.5 * (goal.lower + goal.upper)[None] - center]
    moved += [] if model.drift_velocity is None else [model.drift_velocity]
    sizes = [model.control_bounds, (goal.upper - goal.lower)[None]]
    sizes += [each[None] for each in (goal.speed, limit) if each is not None]
    spreads = [model.position_covariances]
    spreads += [] if model.bent_covariances is None else [model.bent_covariances]
    marks = [each @ turn.T for each in moved] + [each @ np.abs(turn).T for each in sizes]
    marks += [turn @ each @ turn.T for each in spreads]
    return np.concatenate([each.ravel() for each in marks])


def _same(one: Matrix, other: Matrix) -> bool:
    """Whether two arrays are the same but for rounding."""
    return bool(np.allclose(one, other, rtol=_SAME, atol=_SAME))
