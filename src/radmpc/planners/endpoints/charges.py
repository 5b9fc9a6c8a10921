"""What the referee charges for a mean at a start or in a goal, hazard by hazard."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.gaussian import Tail, clearance
from radmpc.geometry import Polytope
from radmpc.model.scenario import Scenario
from radmpc.planners.endpoints.boxes import Box
from radmpc.referee.bound.bounds import instant_risks
from radmpc.referee.contact import solid_distances, solid_of
from radmpc.referee.encounters import Encounters

__all__ = ["Place", "border_charges", "charges", "distances", "far_of"]

_FAR = 8.5
"""Clearance beyond which a hazard counts as nothing (1e-17) [standard deviations]."""

_LEAST = 1e-4
"""Share of Δ below which a hazard counts as nothing [-]: most of a large fleet's need no look."""

_MOST_POINTS = 400
"""Points of places that are looked at together [-]."""


def far_of(scenario: Scenario) -> float:
    """Return the standard deviations beyond which nothing is to be feared.

    Parameters
    ----------
    scenario : Scenario
        The fleet, for Δ and for how well covariances are known.

    Returns
    -------
    float
        Standard deviations [-].
    """
    tail = Tail(scenario.covariance_samples)
    return min(tail.beyond(_FAR), float(tail.clearance_for(_LEAST * scenario.risk_bound)))


class Place(NamedTuple):
    """Where a mean may be, and what it is to avoid there.

    Attributes
    ----------
    points : (n, d) array
        Means [m]: of a vehicle, or of how two are apart.
    covariance : (d, d) array
        Of them [m²].
    radius : float
        Of the vehicle, or the sum of both [m].
    piece : Polytope or None
        What is to be avoided; None for the origin, which pairs avoid.
    """

    points: Matrix
    covariance: Matrix
    radius: float
    piece: Polytope | None


def charges(scenario: Scenario, places: Sequence[Place]) -> list[Vector]:
    """Return what the referee says of a mean at every point of places.

    Parameters
    ----------
    scenario : Scenario
        The fleet, for how well covariances are known.
    places : sequence of Place
        The places.

    Returns
    -------
    list of (n,) array
        Probabilities [-], those of each place.
    """
    found: list[Vector] = []
    # As many at once as the referee looks at in one go: a single place takes nearly as long.
    waiting, num_points = list[Encounters](), 0
    for place in places:
        if waiting and num_points + len(place.points) > _MOST_POINTS:
            found += [risks[0] for risks in instant_risks(waiting)]
            waiting, num_points = [], 0
        waiting.append(_encounters_at(scenario, place))
        num_points += len(place.points)
    return found + [risks[0] for risks in instant_risks(waiting)]


def _encounters_at(scenario: Scenario, place: Place) -> Encounters:
    """Return one encounter, whose steps are the points of a place."""
    (count, d), piece = place.points.shape, place.piece
    axes = np.concatenate([np.eye(d), -np.eye(d)])
    vertices, normals = np.zeros((1, d)), axes
    edges = np.zeros((0, 2, d))
    if piece is not None:
        vertices, normals = piece.vertices, np.vstack([axes, piece.normals])
        edges = edges if d == 2 else solid_of(piece).edges
    none: Indices = np.zeros(1, dtype=np.int64)
    return Encounters(
        kind="pair" if piece is None else "obstacle",
        first=none,
        other=none,
        piece=none,
        partner=none - 1,
        track=none - 1,
        means=place.points[None],
        covariances=np.broadcast_to(place.covariance, (1, count, d, d)),
        bent_covariances=None,
        sagittas=np.zeros((1, count - 1, d)),
        radii=np.array([place.radius]),
        vertices=vertices[None, None],
        directions=normals[None],
        edges=edges[None, None],
        samples=scenario.covariance_samples,
    )


def distances(points: Matrix, piece: Polytope) -> Vector:
    """Return the distance of points from a piece.

    Parameters
    ----------
    points : (n, d) array
        Places [m].
    piece : Polytope
        Of an obstacle.

    Returns
    -------
    (n,) array
        Distances, 0 within it [m].
    """
    return solid_distances(points, points, solid_of(piece))


def border_charges(scenario: Scenario, box: Box, points: Matrix) -> Iterator[tuple[Vector, float]]:
    """Yield what points risk of leaving through each face of the workspace that is near.

    Parameters
    ----------
    scenario : Scenario
        The fleet, for its workspace.
    box : Box
        Where the mean may be, and its covariance.
    points : (n, d) array
        Places in it [m].

    Yields
    ------
    (n,) array
        Probabilities [-].
    float
        The largest distance of a point from the face [m].
    """
    workspace = scenario.workspace
    if workspace is None:
        return
    tail = Tail(scenario.covariance_samples)
    for axis in range(scenario.dimension):
        deviation = float(np.sqrt(max(box.covariance[axis, axis], 0.0)))
        places = points[:, axis]
        for slack in (places - workspace.lower[axis], workspace.upper[axis] - places):
            if slack.min() > far_of(scenario) * deviation:
                continue
            clearances = clearance(slack, np.full(slack.shape, deviation))
            yield np.asarray(tail.probability(clearances)), float(slack.max())
