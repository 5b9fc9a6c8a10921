"""Visits and arrivals that are still due under way: those that the leg in the air has not made."""

from __future__ import annotations

from dataclasses import replace

from radmpc.arrays import Matrix
from radmpc.flying.leg import Leg
from radmpc.flying.remainder import changed
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.model.visits import steps_visited
from radmpc.referee.claims.visits import arrival_step

__all__ = ["still_due", "still_to_do"]


def still_due(left: Scenario, leg: Leg, step: int) -> Scenario:
    """Return the steps that are left, with the visits and arrivals that are.

    Visits are made by means: what the nominal of the leg in the air has visited by now is done,
    wherever the vehicle was. A vehicle that has arrived may leave its goal by noise, and is to
    come back.

    Parameters
    ----------
    left : Scenario
        The steps that are left, its visits those that were due when any leg began.
    leg : Leg
        In the air.
    step : int
        Of the mission.
    """
    scenario = leg.plan.scenario
    if not (scenario.has_windows or left.has_windows):
        return left
    passed = step - leg.began
    vehicles = []
    for i, (vehicle, begun) in enumerate(zip(left.vehicles, scenario.vehicles, strict=True)):
        states = leg.witnesses.motion.states[i]
        vehicles.append(_with_rest(vehicle, begun, states, passed))
    return changed(left, vehicles=tuple(vehicles))


def still_to_do(leg: Leg, step: int) -> tuple[tuple[int, ...], tuple[bool, ...]]:
    """Return how many visits of a leg are left to each vehicle, and whether it has arrived.

    Parameters
    ----------
    leg : Leg
        In the air.
    step : int
        Of the mission.

    Returns
    -------
    tuple of int, tuple of bool
        Only a goal with a window counts as one to arrive at.
    """
    visits, arrivals = [], []
    for vehicle, states in zip(
        leg.plan.scenario.vehicles, leg.witnesses.motion.states, strict=True
    ):
        passed = step - leg.began
        visits.append(len(vehicle.via) - _num_made(vehicle, states, passed))
        is_timed = vehicle.goal.within is not None
        arrivals.append(is_timed and arrival_step(vehicle, states) <= passed)
    return tuple(visits), tuple(arrivals)


def _num_made(vehicle: Vehicle, states: Matrix, passed: int) -> int:
    """Return how many visits a vehicle's mean has made after some steps."""
    system = vehicle.system
    speeds = None if system.velocity is None else states[:, list(system.velocity)]
    made = steps_visited(vehicle.via, states[:, list(system.position)], speeds)
    return sum(each <= passed for each in made)


def _with_rest(vehicle: Vehicle, begun: Vehicle, states: Matrix, passed: int) -> Vehicle:
    """Return a vehicle with what its mean has not done of what was due when the leg began."""
    goal, done = begun.goal, _num_made(begun, states, passed)
    via = tuple(changed(visit, between=_later(visit.between, passed)) for visit in begun.via[done:])
    if goal.within is not None:
        has_arrived = arrival_step(begun, states) <= passed
        horizon = len(states) - 1 - passed
        within = (1, horizon) if has_arrived else _later(goal.within, passed)
        goal = replace(goal, within=within)
    return changed(vehicle, via=via, goal=goal)


def _later(window: tuple[int, int] | None, passed: int) -> tuple[int, int] | None:
    """Return a window of steps as it is some steps later."""
    return None if window is None else (max(window[0] - passed, 1), window[1] - passed)
