"""What starts and goals risk by themselves: risk that no plan can avoid, as the referee counts it.

At a start the mean is fixed, in a goal it lies in a box. The probability that a Gaussian around a
mean hits a convex set grown by a radius is a log-concave function of the mean, and so is the risk
of its best half-space's clearance quasi-concave: over a box either is least at a corner. The least
over the corners of small boxes, summed over hazards, is therefore a bound that no plan is below.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.model.plan import Cause
from radmpc.model.relations.concerns import met_by
from radmpc.model.scenario import Scenario
from radmpc.nearby import near_pairs
from radmpc.planners.endpoints.boxes import Box, Shapes
from radmpc.planners.endpoints.charges import Place, border_charges, charges, distances, far_of
from radmpc.program.condensed import CondensedModel
from radmpc.program.relative import relative_covariances
from radmpc.records import dataclass

__all__ = ["EndpointHazard", "Floors", "floor_of", "floors", "start_hazards"]

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
class Floors:
    """Risk that no plan can avoid.

    Attributes
    ----------
    starts, goals : tuple of EndpointHazard
        Whatever is not nothing, the greatest first.
    vehicles : (N, 2) array
        What each vehicle risks at least at its start and in its goal, other vehicles aside [-].
    total : float
        What the fleet risks at least [-].
    """

    starts: tuple[EndpointHazard, ...]
    goals: tuple[EndpointHazard, ...]
    vehicles: Matrix
    total: float


def floors(scenario: Scenario, models: Sequence[CondensedModel]) -> Floors:
    """Return what starts and goals risk at least, whatever the plan.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    models : sequence of CondensedModel
        Its vehicles over the whole horizon.

    Returns
    -------
    Floors
        Valid for every plan that the referee may certify: it sums over vehicles, pairs and
        obstacles, and of each charges no less than the probability at any one step.
    """
    starts, at_start = _hazards(scenario, models, at_goal=False)
    goals, in_goal = _hazards(scenario, models, at_goal=True)
    vehicles = np.stack([at_start, in_goal], axis=1)
    pairs: dict[tuple[int, ...], float] = defaultdict(float)
    for hazard in (*starts, *goals):
        if hazard.cause == "pair":
            pairs[hazard.members] = max(pairs[hazard.members], hazard.risk)
    total = float(vehicles.max(axis=1).sum()) + sum(pairs.values())
    return Floors(starts, goals, vehicles, total)


def floor_of(scenario: Scenario, models: Sequence[CondensedModel], i: int) -> float:
    """Return what one vehicle's start and goal risk at least, its pairs with others included.

    Parameters
    ----------
    scenario, models
        As in `floors`.
    i : int
        Its number.

    Returns
    -------
    float
        Sum over all that `floors` names for it [-].
    """
    return sum(
        hazard.risk
        for at_goal in (False, True)
        for hazard in _hazards(scenario, models, at_goal=at_goal, only=i)[0]
    )


def start_hazards(
    scenario: Scenario, models: Sequence[CondensedModel]
) -> tuple[EndpointHazard, ...]:
    """Return what the starts risk: no less than any plan runs there.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    models : sequence of CondensedModel
        Its vehicles over the whole horizon.

    Returns
    -------
    tuple of EndpointHazard
        The greatest first.
    """
    return _hazards(scenario, models, at_goal=False)[0]


def _hazards(
    scenario: Scenario, models: Sequence[CondensedModel], *, at_goal: bool, only: int | None = None
) -> tuple[tuple[EndpointHazard, ...], Vector]:
    """Return what starts or goals risk, of all or of one, and of each, other vehicles aside."""
    boxes = [Box.at_endpoint(model, at_goal=at_goal) for model in models]
    shapes = Shapes.of(scenario, scenario.horizon if at_goal else 0)
    looks = [
        _look(scenario, i, boxes[i], shapes, at_goal=at_goal)
        for i in (range(len(boxes)) if only is None else (only,))
    ]
    asked = [place for look in looks for places in look.places.values() for place in places]
    risks = iter(charges(scenario, asked))
    found: list[EndpointHazard] = []
    least = np.zeros(len(boxes))
    for look in looks:
        hazards, least[look.vehicle] = _of_vehicle(scenario, look, risks, at_goal=at_goal)
        found += hazards
    found += _of_pairs(scenario, models, boxes, at_goal=at_goal, only=only)
    return tuple(sorted(found, key=lambda hazard: -hazard.risk)), least


@dataclass(frozen=True, slots=True, eq=False)
class _Look:
    """What one vehicle is near at an endpoint.

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


def _look(scenario: Scenario, i: int, box: Box, shapes: Shapes, *, at_goal: bool) -> _Look:
    """Return what one vehicle is near at an endpoint."""
    vehicle = scenario.vehicles[i]
    close = shapes.near(box, vehicle.radius, far_of(scenario))
    if not close and scenario.workspace is None:
        # As of most vehicles in a large fleet.
        return _Look(i, box, 1, np.zeros((0, scenario.dimension)), {})
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
    return _Look(i, box, cells, points, places)


def _of_vehicle(
    scenario: Scenario, look: _Look, risks: Iterator[Vector], *, at_goal: bool
) -> tuple[list[EndpointHazard], float]:
    """Return what one vehicle risks at an endpoint, hazard by hazard and in all."""
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


def _of_pairs(
    scenario: Scenario,
    models: Sequence[CondensedModel],
    boxes: Sequence[Box],
    *,
    at_goal: bool,
    only: int | None,
) -> list[EndpointHazard]:
    """Return what pairs risk at their endpoints: all of them, or those of one vehicle."""
    if len(boxes) < 2:
        return []
    radii = np.array([v.radius for v in scenario.vehicles])
    centers = np.array([0.5 * (box.lower + box.upper) for box in boxes])
    halves = np.array([0.5 * np.linalg.norm(box.upper - box.lower) for box in boxes])
    spreads = np.array([box.spread for box in boxes])
    far = far_of(scenario)
    near = 2.0 * (radii.max() + halves.max() + far * spreads.max()) + 1e-6
    asked, pairs = list[Place](), list[tuple[int, int, float]]()
    for i, j in near_pairs(centers, float(near)).tolist():
        if only is not None and only not in (i, j):
            continue
        one, two = boxes[i], boxes[j]
        covariance = relative_covariances(models[i], models[j])[-1 if at_goal else 0]
        box = Box(one.lower - two.upper, one.upper - two.lower, covariance)
        points = box.corners(1)
        most = float(np.linalg.norm(points, axis=1).max())
        if most >= radii[i] + radii[j] + far * box.spread + 1e-6:
            continue
        radius = float(radii[i] + radii[j])
        asked.append(Place(points, box.covariance, radius, None))
        pairs.append((i, j, most))
    found = []
    for (i, j, most), risks in zip(pairs, charges(scenario, asked), strict=True):
        if risks.min() > 0.0:
            found.append(EndpointHazard("pair", (i, j), None, at_goal, float(risks.min()), most))
    return found


def _cells(values: Vector, cells: int) -> Vector:
    """Return the least value at the corners of every cell of a grid."""
    if cells == 1:
        return np.array([values.min()])
    dimension = round(np.log(values.size) / np.log(cells + 1))
    grid = values.reshape((cells + 1,) * dimension)
    for axis in range(dimension):
        grid = np.minimum(grid.take(range(cells), axis), grid.take(range(1, cells + 1), axis))
    return np.asarray(grid.ravel())
