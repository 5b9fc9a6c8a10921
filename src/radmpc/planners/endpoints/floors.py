"""What starts and goals risk by themselves: risk that no plan can avoid, as the referee counts it.

At a start the mean is fixed, in a goal it lies in a box. The probability that a Gaussian around a
mean hits a convex set grown by a radius is a log-concave function of the mean, and so is the risk
of its best half-space's clearance quasi-concave: over a box either is least at a corner. The least
over the corners of small boxes, summed over hazards, is therefore a bound that no plan is below.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.model.scenario import Scenario
from radmpc.nearby import near_pairs
from radmpc.planners.endpoints.boxes import Box, Shapes
from radmpc.planners.endpoints.charges import Place, charges, far_of
from radmpc.planners.endpoints.looks import EndpointHazard, look_in, risks_of
from radmpc.program.condensed import CondensedModel
from radmpc.program.relative import relative_covariances
from radmpc.records import dataclass

__all__ = ["EndpointHazard", "Floors", "floor_of", "floors", "start_hazards"]


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
        Of its start and of its goal, each at its best point for all that it is near, and of its
        pairs with others [-].
    """
    risked = 0.0
    for at_goal in (False, True):
        hazards, least = _hazards(scenario, models, at_goal=at_goal, only=i)
        # Between two walls each has a best point of its own: the sum of both is at neither.
        risked += float(least[i]) + sum(h.risk for h in hazards if h.cause == "pair")
    return risked


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
        look_in(scenario, i, boxes[i], shapes, at_goal=at_goal)
        for i in (range(len(boxes)) if only is None else (only,))
    ]
    asked = [place for look in looks for places in look.places.values() for place in places]
    risks = iter(charges(scenario, asked))
    found: list[EndpointHazard] = []
    least = np.zeros(len(boxes))
    for look in looks:
        hazards, least[look.vehicle] = risks_of(scenario, look, risks, at_goal=at_goal)
        found += hazards
    found += _of_pairs(scenario, models, boxes, at_goal=at_goal, only=only)
    return tuple(sorted(found, key=lambda hazard: -hazard.risk)), least


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
