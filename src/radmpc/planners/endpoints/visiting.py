"""Visits that cost too much risk wherever in their boxes, and whenever, they are made."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cache, partial

import numpy as np

from radmpc.model.scenario import Scenario
from radmpc.model.visits import steps_of_visits
from radmpc.planners.endpoints.boxes import Box, Shapes
from radmpc.planners.endpoints.charges import charges, far_of
from radmpc.planners.endpoints.looks import EndpointHazard, look_in, risks_of
from radmpc.program.condensed import CondensedModel
from radmpc.records import dataclass

__all__ = ["RiskyVisit", "risky_visits"]

_CELLS = 6
"""Cells per axis at whose corners a box is looked at for a place that is harmless [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class RiskyVisit:
    """A visit that alone risks more than a bound, at every step at which it may be made.

    Attributes
    ----------
    vehicle, visit : int
        Whose it is, and which of its visits.
    steps : tuple of (int, int)
        First and last step at which it may be made.
    risk : float
        What it risks at least at the best of them [-].
    hazards : tuple of EndpointHazard
        Of that step, the greatest first.
    within : str or None
        The obstacle, grown by the vehicle's radius, that holds all of the box at every step.
    """

    vehicle: int
    visit: int
    steps: tuple[int, int]
    risk: float
    hazards: tuple[EndpointHazard, ...]
    within: str | None


def risky_visits(
    scenario: Scenario, models: Sequence[CondensedModel], bound: float
) -> Iterator[RiskyVisit]:
    """Yield the visits that no plan makes within a bound.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    models : sequence of CondensedModel
        Its vehicles over the whole horizon.
    bound : float
        What a visit may risk [-].

    Yields
    ------
    RiskyVisit
        The mean is in the box at some step, and the referee charges of obstacles and borders no
        less than the probability at that one step, as `floors` has it of goals.
    """
    shapes_at = cache(partial(Shapes.of, scenario))
    for i, model in enumerate(models):
        for j, steps in enumerate(steps_of_visits(model.vehicle.via, model.horizon)):
            found = _risky(scenario, model, (i, j), steps, bound, shapes_at)
            if found is not None:
                yield found


def _risky(
    scenario: Scenario,
    model: CondensedModel,
    numbers: tuple[int, int],
    steps: tuple[int, int],
    bound: float,
    shapes_at: Callable[[int], Shapes],
) -> RiskyVisit | None:
    """Return a visit, if it is above a bound at every step at which it can be made."""
    i, j = numbers
    best: tuple[float, list[EndpointHazard]] | None = None
    holding: set[str | None] | None = None
    for step in range(steps[0], steps[1] + 1):
        box = Box.at_visit(model, model.vehicle.via[j], step)
        if box is None:
            continue
        shapes = shapes_at(step)
        if _is_harmless(scenario, box, shapes, model.vehicle.radius):
            return None
        hazards, least = _risks_in(scenario, i, box, shapes)
        if least <= bound:
            return None
        inside = {one.other for one in hazards if one.distance < model.vehicle.radius}
        holding = inside if holding is None else holding & inside
        if best is None or least < best[0]:
            best = least, hazards
    if best is None:
        return None  # it is out of reach, and that is the reason
    hazards = sorted(best[1], key=lambda hazard: -hazard.risk)
    within = next(
        (one.other for one in hazards if one.other in (holding or ()) and one.other), None
    )
    return RiskyVisit(i, j, steps, best[0], tuple(hazards), within)


def _is_harmless(scenario: Scenario, box: Box, shapes: Shapes, radius: float) -> bool:
    """Whether some place in a box is far from the boxes around all obstacles, and from borders."""
    points, far = box.corners(_CELLS), far_of(scenario)
    strays = [np.sqrt(np.trace(covariance)) for covariance in shapes.covariances.values()]
    reach = radius + far * (box.spread + max(strays, default=0.0)) + 1e-6
    # Obstacles may be many: only those that are near the box at all.
    near = np.all((shapes.lower <= box.upper + reach) & (shapes.upper >= box.lower - reach), axis=1)
    gaps = np.maximum(shapes.lower[near] - points[:, None], points[:, None] - shapes.upper[near])
    apart = np.linalg.norm(np.maximum(gaps, 0.0), axis=2).min(axis=1, initial=np.inf)
    if scenario.workspace is not None:
        slack = np.minimum(points - scenario.workspace.lower, scenario.workspace.upper - points)
        apart = np.minimum(apart, slack.min(axis=1) + radius)
    return bool(np.any(apart >= reach))


def _risks_in(
    scenario: Scenario, i: int, box: Box, shapes: Shapes
) -> tuple[list[EndpointHazard], float]:
    """Return what a vehicle risks at least in a box."""
    look = look_in(scenario, i, box, shapes, at_goal=True)
    asked = [place for places in look.places.values() for place in places]
    return risks_of(scenario, look, iter(charges(scenario, asked)), at_goal=True)
