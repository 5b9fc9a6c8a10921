"""Per vehicle, what planning is going to meet: time, noise, control, and places that are narrow."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from radmpc.arrays import Matrix, Tensor
from radmpc.model.given import check_scenario
from radmpc.model.relations.concerns import met_by
from radmpc.model.relations.subset import kept_and_met
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.planners.reaching.around import Late, WaysAround
from radmpc.planners.reaching.enclosed import BarriersOfAll, Closed
from radmpc.preflight.cures import largest_deviation
from radmpc.preflight.endpoints import least_risks
from radmpc.preflight.narrowest import narrowest_place
from radmpc.preflight.pace import Pace
from radmpc.preflight.places import Narrowest, Passage, Traveler, closed_place
from radmpc.preflight.reserve import Reserve, expected_saturation, reserve_of
from radmpc.records import dataclass, replace

if TYPE_CHECKING:
    from radmpc.planners.endpoints.floors import EndpointHazard, Floors
    from radmpc.planners.endpoints.ranges import LostRange

__all__ = ["MOST_TIMES", "Outlook", "VehicleOutlook", "outlook_of"]

MOST_TIMES = 8
"""Multiple of the horizon up to which the least time is looked for [-]."""

_WORK, _WORK_OF_ALL = 4e6, 8e7
"""Cells times ticks spent on the narrowest place of a vehicle, and of a fleet [-]: 2e7 take about a
second."""


@dataclass(frozen=True, slots=True, eq=False)
class VehicleOutlook:
    """What one vehicle is going to meet.

    Attributes
    ----------
    name : str
        The vehicle.
    least_steps : int or None
        Fewest steps to its goal through empty space with its whole control limit, noise aside; None
        where eight times the horizon is not enough.
    least_steps_with_feedback : int or None
        The same with what its feedback leaves of the limit: what a plan takes at least.
    end_deviation : float
        Largest standard deviation of its position at the horizon, in any direction [m].
    reserve : Reserve
        What its feedback keeps back of the control limit.
    saturation : float or None
        How likely its feedback asks for more control than the cheapest way through empty space
        leaves [-]; None where it cannot get there in time.
    start_risk, goal_risk : float
        Sum of what its start and its goal risk at least, whatever the plan: against obstacles, the
        border, other vehicles' starts or goals, and ranges that it keeps [-].
    narrowest : Narrowest or Passage
        The narrowest place that it must pass; unknown, too, where it cannot get there in time.
    visits : tuple of (int or None)
        Earliest step of each of its visits and of its arrival after them, through empty space with
        what feedback leaves; None from the first that is too late on. Empty without visits, and of
        dynamics that are no double integrator.
    closed : Closed or None
        A way to a visit or the goal that is closed for it at all times, where that is known.
    late : Late or None
        What it is late for at full speed around obstacles, where that is known.
    """

    name: str
    least_steps: int | None
    least_steps_with_feedback: int | None
    end_deviation: float
    reserve: Reserve
    saturation: float | None
    start_risk: float
    goal_risk: float
    narrowest: Narrowest | Passage
    visits: tuple[int | None, ...] = ()
    closed: Closed | None = None
    late: Late | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Outlook:
    """What a fleet is going to meet.

    Attributes
    ----------
    scenario : Scenario
        The fleet; goals that it shares are those near by, as long as nobody is late for that.
    vehicles : tuple of VehicleOutlook
        Its vehicles, in its order.
    endpoints : Floors or None
        Risk that no plan can avoid; None where nothing is near any start or goal.
    ranges : tuple of LostRange
        Ranges that starts or goals risk to lose, whatever the plan, starts first.
    """

    scenario: Scenario
    vehicles: tuple[VehicleOutlook, ...]
    endpoints: Floors | None
    ranges: tuple[LostRange, ...] = ()

    @property
    def least_risk(self) -> float:
        """What starts and goals of the whole fleet risk at least [-]."""
        near = 0.0 if self.endpoints is None else self.endpoints.total
        lost: dict[tuple[int, ...], float] = {}
        for one in self.ranges:
            # A range that is lost at both ends is one event.
            lost[one.members] = max(lost.get(one.members, 0.0), one.risk)
        return near + sum(lost.values())

    @property
    def hazards(self) -> tuple[EndpointHazard, ...]:
        """The parts of that risk, starts before goals, the greatest of either first."""
        near = () if self.endpoints is None else (*self.endpoints.starts, *self.endpoints.goals)
        found = [*near, *(one.hazard for one in self.ranges)]
        return tuple(sorted(found, key=lambda hazard: (hazard.at_goal, -hazard.risk)))


def outlook_of(
    scenario: Scenario, progress: Callable[[str, int, int | None], None] | None = None
) -> Outlook:
    """Look at a scenario without planning it.

    Parameters
    ----------
    scenario : Scenario
        Any.
    progress : callable or None
        Called with what is looked at, the number of vehicles done, and of all; or None.

    Returns
    -------
    Outlook
        In time that grows with vehicles, steps and obstacles, but not with ways around them.

    Raises
    ------
    ArgumentTypeError
        If it is no scenario.
    """
    check_scenario(scenario)
    if scenario.goals:
        from radmpc.preflight.goals import with_near_goals  # noqa: PLC0415 - few share goals

        scenario = with_near_goals(scenario)
    covariances = [vehicle.covariances(scenario.horizon) for vehicle in scenario.vehicles]
    places = []
    for vehicle, tensor in zip(scenario.vehicles, covariances, strict=True):
        axes = list(vehicle.system.position)
        places.append(tensor[:, axes][:, :, axes])
    endpoints, ranges = least_risks(scenario, places)
    risks = _risks(endpoints, ranges, scenario.num_vehicles)
    work = min(_WORK, _WORK_OF_ALL / scenario.num_vehicles)
    barriers, ways = BarriersOfAll(scenario), WaysAround(scenario)
    vehicles = []
    for i in range(scenario.num_vehicles):
        if progress is not None:
            progress("looking at vehicles", i, scenario.num_vehicles)
        closed = barriers.closed(scenario.vehicles[i])
        one = _vehicle(scenario, i, (covariances[i], places[i]), risks[i], closed, work)
        late = ways.late(scenario.vehicles[i], scenario.vehicles[i].control_bounds(covariances[i]))
        vehicles.append(one if late is None else replace(one, late=late))
    return Outlook(scenario, tuple(vehicles), endpoints, ranges)


def _risks(
    endpoints: Floors | None, ranges: Sequence[LostRange], count: int
) -> list[tuple[float, float]]:
    """Return what each vehicle's start and goal risk, pairs and ranges included."""
    found = np.zeros((count, 2))
    hazards: list[EndpointHazard | LostRange] = [*ranges]
    if endpoints is not None:
        found += endpoints.vehicles
        near = (*endpoints.starts, *endpoints.goals)
        hazards += [hazard for hazard in near if hazard.cause == "pair"]
    for hazard in hazards:
        found[list(hazard.members), int(hazard.at_goal)] += hazard.risk
    return [(start, goal) for start, goal in found.tolist()]


def _vehicle(
    scenario: Scenario,
    i: int,
    spreads: tuple[Tensor, Tensor],
    risks: tuple[float, float],
    closed: Closed | None,
    work: float,
) -> VehicleOutlook:
    """Look at one vehicle, given the covariances of its state and of its position."""
    vehicle, (covariances, places) = scenario.vehicles[i], spreads
    bounds = vehicle.control_bounds(covariances)
    pace = Pace.of(vehicle)
    if pace is None:
        least, least_kept, controls, reach = _by_programs(scenario, vehicle)
    else:
        least, least_kept = _least_times(scenario, vehicle, pace, bounds)
        left = np.maximum(bounds, 0.0)
        controls, reach = pace.cheapest(left), pace.reach(left)
    visits: tuple[int | None, ...] = ()
    if vehicle.via and pace is not None:
        from radmpc.preflight.visits import earliest_visits  # noqa: PLC0415 - few visit anything

        visits = earliest_visits(vehicle, pace, np.maximum(bounds, 0.0))
    narrowest: Narrowest | Passage = Passage.UNKNOWN
    saturation = None
    if controls is not None and np.all(bounds >= 0.0):
        samples = scenario.covariance_samples
        saturation = expected_saturation(vehicle, covariances, controls, samples)
        if closed is None:
            goal = (vehicle.goal.lower, vehicle.goal.upper)
            mine, start = _met_by(scenario, vehicle), vehicle.start_position
            traveler = Traveler(mine, vehicle.radius, start, goal, places, reach)
            narrowest = narrowest_place(traveler, work)
    if closed is not None:
        narrowest = closed_place(closed, vehicle.radius, places[-1])
    return VehicleOutlook(
        name=vehicle.name,
        least_steps=least,
        least_steps_with_feedback=least_kept,
        end_deviation=largest_deviation(vehicle, covariances),
        reserve=reserve_of(vehicle, bounds),
        saturation=saturation,
        start_risk=risks[0],
        goal_risk=risks[1],
        narrowest=narrowest,
        visits=visits,
        closed=closed,
    )


def _met_by(scenario: Scenario, vehicle: Vehicle) -> Scenario:
    """Return a scenario with what concerns a vehicle; nothing made anew checks a whole fleet."""
    met = met_by(scenario.obstacles, vehicle.name)
    if len(met) == len(scenario.obstacles):
        return scenario
    _, mine = kept_and_met((vehicle,), (), met)
    return replace(scenario, vehicles=(vehicle,), obstacles=mine, keep=(), goals=())


def _least_times(
    scenario: Scenario, vehicle: Vehicle, pace: Pace, bounds: Matrix
) -> tuple[int | None, int | None]:
    """Return the fewest steps with the whole control limit, and with what feedback leaves."""
    most = MOST_TIMES * scenario.horizon
    whole = np.tile(vehicle.control_limit, (most, 1))
    is_resting = not pace.speed.any()
    least = _least(lambda steps: pace.arrives(whole[:steps]), scenario.horizon, is_resting)
    if vehicle.gain is None or least is None:
        return least, least
    # By the horizon the deviations under feedback are steady: what is left stays as it is.
    later = np.repeat(bounds[-1:], most - len(bounds), axis=0)
    left = np.maximum(np.vstack([bounds, later]), 0.0)
    return least, _least(lambda steps: pace.arrives(left[:steps]), scenario.horizon, is_resting)


def _by_programs(
    scenario: Scenario, vehicle: Vehicle
) -> tuple[int | None, int | None, Matrix | None, tuple[Matrix, Matrix]]:
    """Return the same of other dynamics: least times, cheapest controls, reach."""
    from radmpc.preflight import general  # noqa: PLC0415 - a solver; integrators do without

    horizon = scenario.horizon
    # Windows of visits and of the arrival are looked at by themselves.
    straight = replace(vehicle, via=(), goal=replace(vehicle.goal, within=None))
    kept = _least(lambda steps: general.arrives(scenario, straight, steps), horizon, True)
    least = kept
    if vehicle.gain is not None:
        bare = replace(straight, gain=None)
        least = _least(lambda steps: general.arrives(scenario, bare, steps), horizon, True)
    return least, kept, general.cheapest(scenario, vehicle), general.reach(scenario, vehicle)


def _least(arrives: Callable[[int], bool], horizon: int, is_resting: bool) -> int | None:
    """Return the least number of steps that is enough.

    One that starts at rest may wait: what is enough stays enough. Others are tried step by step up
    to the horizon, since they may pass their goal and have to come back.
    """
    if not is_resting:
        for steps in range(1, horizon + 1):
            if arrives(steps):
                return steps
    failed, works = 0, horizon
    while not arrives(works):
        failed, works = works, 2 * works
        if works > MOST_TIMES * horizon:
            return None
    between = range(failed + 1, works)
    return between.start + bisect_left(between, True, key=arrives)
