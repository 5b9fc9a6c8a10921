"""Starts and goals that risk too much: what of moving them, less noise or a larger Δ is enough."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import product
from math import floor, log10

import numpy as np

from radmpc.arrays import Vector
from radmpc.errors import ScenarioError
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.planners.cures.variants import MOST_RISK, with_noise
from radmpc.planners.endpoints.floors import EndpointHazard, floor_of, floors
from radmpc.program.build import condensed_models
from radmpc.program.condensed import CondensedModel
from radmpc.records import dataclass, replace
from radmpc.rounding import rounded_down, rounded_up

__all__ = ["SMALL_SHARE", "endpoint_cures"]

SMALL_SHARE = 0.1
"""Share of Δ that starts and goals may risk before it is a concern [-]."""

_FAR = (0.125, 0.25, 0.5, 1.0, 2.0, 4.0)
"""Distances by which a place is moved, one after the other [radii and standard deviations]."""

_HALVINGS = 3
"""Bisections between a distance that is too little and one that is enough [-]."""

_NEIGHBORS = 12
"""Vehicles, the nearest, against which a moved one is looked at [-]: more would take long."""

_QUIETEST = 0.05
"""Factor of standard deviations below which noise is not reduced by any means [-]."""

_HALF = 0.5
"""Share of Δ that starts and goals may take where no sensible one makes that small [-]."""

_RISKS = (1.25, 2.0, 4.0)
"""Multiples of what is risked at least that are tried as Δ where plans are made of it [-]."""

Accepts = Callable[[Scenario], bool]
"""Whether a scenario that was changed is good enough in other respects, too."""


def endpoint_cures(
    scenario: Scenario,
    hazards: Sequence[EndpointHazard],
    accepts: Accepts | None = None,
) -> tuple[str, ...]:
    """Return what makes starts and goals risk little of Δ: each was tried.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    hazards : sequence of EndpointHazard
        What is wrong, one or more, the greatest first.
    accepts : callable or None
        Asked of the scenario of the vehicles concerned, with what would do; None accepts all.

    Returns
    -------
    tuple of str
        In the imperative: a place moved, noise, a larger bound; empty where nothing did.
    """
    members = tuple(sorted({i for hazard in hazards for i in hazard.members}))
    part = scenario.subset(members, scenario.risk_bound)
    found = list(_moved(scenario, hazards[0], members, accepts))
    found += _quieter(part, accepts, is_start=all(not hazard.at_goal for hazard in hazards))
    return (*found, *_bolder(part, accepts))


def _total(scenario: Scenario) -> float:
    """Return what starts and goals of a fleet risk at least."""
    return floors(scenario, condensed_models(scenario)).total


def _is_little(scenario: Scenario) -> bool:
    """Whether that is little of Δ."""
    return _total(scenario) <= SMALL_SHARE * scenario.risk_bound


@dataclass(frozen=True, slots=True, eq=False)
class _Place:
    """A start or a goal that may be moved, among those of others.

    Attributes
    ----------
    scenario : Scenario
        The vehicle first, those next to it after it.
    models : tuple of CondensedModel
        Of all of them.
    at_goal : bool
        Whether its goal is moved, rather than its start.
    """

    scenario: Scenario
    models: tuple[CondensedModel, ...]
    at_goal: bool

    @classmethod
    def of(cls, scenario: Scenario, i: int, *, at_goal: bool) -> _Place:
        """Take a vehicle and its nearest."""
        where = np.array([_where(vehicle, at_goal=at_goal) for vehicle in scenario.vehicles])
        order = np.argsort(np.linalg.norm(where - where[i], axis=1), kind="stable").tolist()
        others = [int(j) for j in order if j != i][: _NEIGHBORS - 1]
        near = scenario.subset((i, *others), scenario.risk_bound)
        return cls(near, tuple(condensed_models(near)), at_goal)

    @property
    def vehicle(self) -> Vehicle:
        """Whose place it is."""
        return self.scenario.vehicles[0]

    @property
    def unit(self) -> float:
        """A distance that matters: the radius and a standard deviation [m]."""
        covariance = self.models[0].position_covariances[-1 if self.at_goal else 0]
        return float(self.vehicle.radius + np.sqrt(np.linalg.eigvalsh(covariance)[-1]))

    def moved(self, offset: Vector) -> tuple[Vector, Scenario] | None:
        """Return where it is then, rounded, and the scenario; None where that is none."""
        digits = max(0, 2 - floor(log10(self.unit)))
        place = np.round(_where(self.vehicle, at_goal=self.at_goal) + offset, digits)
        try:
            candidate = _at(self.vehicle, place, at_goal=self.at_goal)
            fleet = (candidate, *self.scenario.vehicles[1:])
            return place, replace(self.scenario, vehicles=fleet)
        except ScenarioError:
            return None

    def risked(self, changed: Scenario) -> float:
        """Return what its start and goal risk, others included."""
        (model,) = condensed_models(changed.subset((0,), changed.risk_bound))
        return floor_of(changed, (model, *self.models[1:]), 0)

    def does(self, offset: Vector) -> bool:
        """Whether moving it is enough."""
        candidate = self.moved(offset)
        if candidate is None:
            return False
        return self.risked(candidate[1]) <= SMALL_SHARE * self.scenario.risk_bound


def _where(vehicle: Vehicle, *, at_goal: bool) -> Vector:
    """Return the middle of a goal, or a start [m]."""
    return vehicle.goal.center if at_goal else vehicle.start_position


def _at(vehicle: Vehicle, place: Vector, *, at_goal: bool) -> Vehicle:
    """Return a vehicle whose goal or start is elsewhere."""
    if at_goal:
        offset = place - vehicle.goal.center
        lower, upper = vehicle.goal.lower + offset, vehicle.goal.upper + offset
        return replace(vehicle, goal=replace(vehicle.goal, lower=lower, upper=upper))
    start = vehicle.start.copy()
    start[list(vehicle.system.position)] = place
    return replace(vehicle, start=start)


def _moved(
    scenario: Scenario,
    hazard: EndpointHazard,
    members: Sequence[int],
    accepts: Accepts | None,
) -> Iterator[str]:
    """Yield the nearest place found that does: of the vehicle, or of either of two."""
    kind = "goal" if hazard.at_goal else "start"
    for i in hazard.members:
        spot = _Place.of(scenario, i, at_goal=hazard.at_goal)
        offset = _least_offset(spot)
        candidate = None if offset is None else spot.moved(offset)
        if candidate is None:
            continue
        place, _ = candidate
        one = _at(scenario.vehicles[i], place, at_goal=hazard.at_goal)
        vehicles = [one if j == i else scenario.vehicles[j] for j in members]
        if accepts is not None and not accepts(scenario.with_vehicles(vehicles)):
            continue
        told = ", ".join(f"{x:g}" for x in place.tolist())
        yield f"move the {kind} of {scenario.vehicles[i].name!r} to ({told})"
        return


def _least_offset(spot: _Place) -> Vector | None:
    """Return the shortest way found to a place that does."""
    d = spot.scenario.dimension
    ways = [np.array(way, dtype=float) for way in product((-1, 0, 1), repeat=d) if any(way)]
    ways = [way / np.linalg.norm(way) for way in ways]
    less = 0.0
    for far in (factor * spot.unit for factor in _FAR):
        direction = next((way for way in ways if spot.does(far * way)), None)
        if direction is not None:
            return _shortest(spot, direction, less, far)
        less = far
    return None


def _shortest(spot: _Place, way: Vector, less: float, enough: float) -> Vector:
    """Return about the shortest way in a direction, between too little and enough."""
    for _ in range(_HALVINGS):
        middle = 0.5 * (less + enough)
        if spot.does(middle * way):
            enough = middle
        else:
            less = middle
    return enough * way


def _quieter(part: Scenario, accepts: Accepts | None, *, is_start: bool) -> Iterator[str]:
    """Yield how much less noise is enough; at starts alone that of what is known there."""
    change = _with_start_noise if is_start else with_noise
    factor = _largest_factor(partial(_does_quieter, part, change))
    if factor is None or (accepts is not None and not accepts(change(part, factor**2))):
        return
    what = "initial_covariance" if is_start else "the noise"
    yield f"reduce {what} to {factor:g} of its standard deviations"


def _does_quieter(
    part: Scenario, change: Callable[[Scenario, float], Scenario], factor: float
) -> bool:
    """Whether noise multiplied, in standard deviations, is little enough."""
    return _is_little(change(part, factor**2))


def _largest_factor(does: Callable[[float], bool]) -> float | None:
    """Return about the largest factor below 1 that does, of two digits; None where none does."""
    if not does(_QUIETEST):
        return None
    works, fails = _QUIETEST, 1.0
    for _ in range(2 * _HALVINGS):
        middle = 0.5 * (works + fails)
        works, fails = (middle, fails) if does(middle) else (works, middle)
    factor = rounded_down(works)
    return factor if does(factor) else _QUIETEST


def _with_start_noise(scenario: Scenario, factor: float) -> Scenario:
    """Return a scenario in which starts are known better, by a factor of variances."""
    known = (
        replace(vehicle, initial_covariance=factor * vehicle.initial_covariance)
        for vehicle in scenario.vehicles
    )
    return replace(scenario, vehicles=tuple(known))


def _bolder(part: Scenario, accepts: Accepts | None) -> Iterator[str]:
    """Yield a bound of which starts and goals take little, or with which there is a plan."""
    total = _total(part)
    if accepts is None and rounded_up(total / SMALL_SHARE, 3) > MOST_RISK:
        # No sensible bound makes it little; one that leaves a way half of itself often has a plan.
        half = rounded_up(total / _HALF, 3)
        if part.risk_bound < half <= MOST_RISK:
            yield f"raise risk_bound to {half:g}, of which starts and goals take half"
        return
    tried = [total / SMALL_SHARE] if accepts is None else [factor * total for factor in _RISKS]
    for bound in (rounded_up(value, 3) for value in tried if value > 0.0):
        if not part.risk_bound < bound <= MOST_RISK:
            continue
        bolder = replace(part, risk_bound=bound)
        if _is_little(bolder) if accepts is None else accepts(bolder):
            yield f"raise risk_bound to {bound:g}"
            return
