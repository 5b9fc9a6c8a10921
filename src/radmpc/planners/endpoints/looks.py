"""What one vehicle is near while its mean is somewhere in a box, and what it risks there."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.model.plan import Cause
from radmpc.model.relations.concerns import met_by
from radmpc.model.scenario import Scenario
from radmpc.planners.endpoints.boxes import Box, Shapes
from radmpc.planners.endpoints.charges import Place, border_charges, distances, far_of
from radmpc.records import dataclass

__all__ = ["EndpointHazard", "Look", "look_in", "risks_of"]

_CELLS = {2: 6, 3: 2}
"""Cells per axis into which a goal is cut, by dimension [-]: hazards on opposite sides of it are
least at different corners, and the fewer cells, the further is the sum of those from the least
sum."""


@dataclass(frozen=True, slots=True)
class EndpointHazard:
    """What a start or a goal risks of one kind.

    Attributes
    ----------
    cause : {'obstacle', 'pair', 'workspace', 'range'}
        What may happen.
    members : tuple of int
        The vehicle, or the two, by their numbers in the scenario.
    other : str or None
        The obstacle.
    at_goal : bool
        At the goal rather than at the start.
    risk : float
        Least probability [-].
    distance : float
        Largest distance of the mean, or of the two means, from what is to be avoided [m];
        negative outside the workspace. Of a range the least distance of the two means.
    """

    cause: Cause
    members: tuple[int, ...]
    other: str | None
    at_goal: bool
    risk: float
    distance: float


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """What one vehicle is near in a box.

    Attributes
    ----------
    vehicle : int
        Its number.
    box : Box
        Where its mean may be.
    cells : int
        Cells per axis into which that is cut.
    points : (n, d) array
        Their corners [m]; none where nothing is near.
    places : dict of str to list of Place
        Pieces of obstacles that it is near, by obstacle.
    """

    vehicle: int
    box: Box
    cells: int
    points: Matrix
    places: dict[str, list[Place]]


def look_in(scenario: Scenario, i: int, box: Box, shapes: Shapes, *, at_goal: bool) -> Look:
    """Return what one vehicle is near while its mean is in a box.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    i : int
        The vehicle.
    box : Box
        Where its mean may be.
    shapes : Shapes
        The obstacles by then.
    at_goal : bool
        Whether the box has an extent: then it is cut into cells.

    Returns
    -------
    Look
        With places for `charges`.
    """
    vehicle = scenario.vehicles[i]
    close = shapes.near(box, vehicle.radius, far_of(scenario))
    if not close and scenario.workspace is None:
        # As of most vehicles in a large fleet.
        return Look(i, box, 1, np.zeros((0, scenario.dimension)), {})
    cells = _CELLS[scenario.dimension] if at_goal else 1
    points = box.corners(cells)
    mine = {obstacle.name for obstacle in met_by(scenario.obstacles, vehicle.name)}
    places = {
        name: [
            Place(points, shapes.covariance(name, box), vehicle.radius, piece) for piece in pieces
        ]
        for name, pieces in close.items()
        if name in mine
    }
    return Look(i, box, cells, points, places)


def risks_of(
    scenario: Scenario, look: Look, risks: Iterator[Vector], *, at_goal: bool
) -> tuple[list[EndpointHazard], float]:
    """Return what one vehicle risks at least in a box, hazard by hazard and in all.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    look : Look
        What it is near.
    risks : iterator of (n,) array
        What `charges` says of its places, one after the other.
    at_goal : bool
        What the hazards are to say of themselves.

    Returns
    -------
    list of EndpointHazard
        Whatever is not nothing.
    float
        Of all of them together at the best place [-].
    """
    i, cells, points = look.vehicle, look.cells, look.points
    if not points.size:
        return [], 0.0
    hazards: list[EndpointHazard] = []
    fields: list[Vector] = []
    for name, places in look.places.items():
        # Pieces of one obstacle are one hazard: the worst of them is a bound on their union.
        field = np.maximum.reduce([_cells(next(risks), cells) for _ in places])
        pieces = (place.piece for place in places if place.piece is not None)
        distance = min(float(distances(points, piece).max()) for piece in pieces)
        fields.append(field)
        hazards.append(
            EndpointHazard("obstacle", (i,), name, at_goal, float(field.min()), distance)
        )
    borders = list(border_charges(scenario, look.box, points))
    if borders:
        # Opposite faces exclude each other, and the referee adds up all of them. Each is least at a
        # corner of a cell; their sum may be least in between.
        field = np.sum([_cells(leaving, cells) for leaving, _ in borders], axis=0)
        fields.append(field)
        distance = min(most for _, most in borders)
        hazards.append(
            EndpointHazard("workspace", (i,), None, at_goal, float(field.min()), distance)
        )
    least = float(np.sum(fields, axis=0).min()) if fields else 0.0
    return [hazard for hazard in hazards if hazard.risk > 0.0], least


def _cells(values: Vector, cells: int) -> Vector:
    """Return the least value at the corners of every cell of a grid."""
    if cells == 1:
        return np.array([values.min()])
    dimension = round(np.log(values.size) / np.log(cells + 1))
    grid = values.reshape((cells + 1,) * dimension)
    for axis in range(dimension):
        grid = np.minimum(grid.take(range(cells), axis), grid.take(range(1, cells + 1), axis))
    return np.asarray(grid.ravel())
