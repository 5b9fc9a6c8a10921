"""What vehicles of a long mission are to have done by the ends of windows."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from radmpc.arrays import Vector
from radmpc.errors import ScenarioError
from radmpc.flying.receding.guide import CoarsePlan, coarse_plan
from radmpc.flying.remainder import changed
from radmpc.model.goal import Goal
from radmpc.model.obstacle import MovingShape, Obstacle
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.model.visits import Visit, steps_of_visits, steps_visited
from radmpc.records import dataclass

__all__ = ["Guide", "Itinerary", "Progress"]

Guide = Callable[[int], Sequence[Goal]]
"""From a step of the mission to where every vehicle is to be by then."""

_EASE = 1.05
"""What a window may be faster than the guide at its end [-]: paths deviate from it."""


@dataclass(frozen=True, slots=True)
class Progress:
    """How far vehicles are with what they are to do.

    Attributes
    ----------
    visits : tuple of int
        Visits of each, from its first one on.
    arrived : tuple of bool
        Whether each is at its goal to stay, where it was to arrive within a window of steps.
    """

    visits: tuple[int, ...]
    arrived: tuple[bool, ...]

    @classmethod
    def none(cls, num_vehicles: int) -> Progress:
        """Return that of a fleet which has done nothing."""
        return cls((0,) * num_vehicles, (False,) * num_vehicles)

    def less(self, visits: Sequence[int], arrived: Sequence[bool]) -> Progress:
        """Return how far vehicles are that lack some of these visits.

        Parameters
        ----------
        visits : sequence of int
            What each lacks.
        arrived : sequence of bool
            Whether each has arrived since.
        """
        made = (all_ - left for all_, left in zip(self.visits, visits, strict=True))
        now = (one or other for one, other in zip(self.arrived, arrived, strict=True))
        return Progress(tuple(made), tuple(now))


@dataclass(frozen=True, slots=True, eq=False)
class Itinerary:
    """Goals at the ends of windows, and by when visits and arrivals are due.

    Attributes
    ----------
    scenario : Scenario
        The whole mission, goals assigned.
    guide : callable
        Where vehicles are to be at a step.
    visits : tuple of tuple of int
        Of each vehicle, the step by which each visit is due.
    arrivals : tuple of int
        The step by which each vehicle is to arrive and stay.
    """

    scenario: Scenario
    guide: Guide
    visits: tuple[tuple[int, ...], ...]
    arrivals: tuple[int, ...]

    @classmethod
    def planned(cls, scenario: Scenario, window: int) -> Itinerary:
        """Return the itinerary of a plan in coarse steps, noise aside.

        Parameters
        ----------
        scenario : Scenario
            The whole mission.
        window : int
            Steps of a window.

        Raises
        ------
        NoPlanError
            If there is no coarse plan.
        """
        coarse = coarse_plan(scenario, window)
        if scenario.goals:
            scenario = _assigned(scenario, coarse)
        dues = [_dues(coarse, i) for i in range(len(scenario.vehicles))]

        def goals(step: int) -> list[Goal]:
            if step >= scenario.horizon:
                return [v.goal for v in scenario.vehicles]
            pairs = zip(scenario.vehicles, coarse.states, strict=True)
            return [_goal_at(vehicle, path[step]) for vehicle, path in pairs]

        return cls(scenario, goals, tuple(d[0] for d in dues), tuple(d[1] for d in dues))

    @classmethod
    def given(cls, scenario: Scenario, guide: Guide) -> Itinerary:
        """Return the itinerary of a guide that somebody gave: all is due when its window ends.

        Parameters
        ----------
        scenario : Scenario
            The whole mission.
        guide : callable
            Where vehicles are to be at a step.

        Raises
        ------
        ScenarioError
            If goals are to be assigned, or a visit has no window.
        """
        if scenario.goals:
            message = "are to be assigned, which a guide does not: give each vehicle its own"
            raise ScenarioError(message, ("goals",))
        visits = []
        for i, vehicle in enumerate(scenario.vehicles):
            for j, visit in enumerate(vehicle.via):
                if visit.between is None:
                    message = "needs a window of steps, which says by when it is due by the guide"
                    raise ScenarioError(message, ("vehicles", i, "via", j))
            visits.append(tuple(due for _, due in steps_of_visits(vehicle.via, scenario.horizon)))
        arrivals = (v.goal.window(scenario.horizon)[1] for v in scenario.vehicles)
        return cls(scenario, guide, tuple(visits), tuple(arrivals))

    def until(self, end: int) -> Scenario:
        """Return the mission up to a step, toward where the guide leads there; visits aside.

        Parameters
        ----------
        end : int
            The last step, at most its horizon.
        """
        pairs = zip(self.scenario.vehicles, self.guide(end), strict=True)
        vehicles = tuple(changed(v, goal=replace(g, within=None), via=()) for v, g in pairs)
        obstacles = tuple(_until(obstacle, end) for obstacle in self.scenario.obstacles)
        return changed(self.scenario, horizon=end, vehicles=vehicles, obstacles=obstacles)

    def asked(self, window: Scenario, step: int, done: Progress) -> Scenario:
        """Return a window with the visits and arrivals that are due in it.

        Parameters
        ----------
        window : Scenario
            Its steps, from one of the mission's on.
        step : int
            Of the mission, at which it begins.
        done : Progress
            By then.
        """
        if not self.scenario.has_windows:
            return window
        due = self.due(step + window.horizon, done)
        vehicles = []
        for i, vehicle in enumerate(window.vehicles):
            asked = slice(done.visits[i], due.visits[i])
            via = self._visits(i, asked, step, window.horizon)
            goal, within = vehicle.goal, self.scenario.vehicles[i].goal.within
            if within is not None and step + window.horizon >= self.arrivals[i]:
                # A vehicle that was pushed out of its goal is to come back.
                is_there = done.arrived[i] or within[1] <= step
                left = (1, window.horizon) if is_there else _from(within, step, window.horizon)
                goal = replace(self.scenario.vehicles[i].goal, within=left)
            vehicles.append(changed(vehicle, via=via, goal=goal))
        return changed(window, vehicles=tuple(vehicles))

    def due(self, end: int, done: Progress) -> Progress:
        """Return how far vehicles are once they have made the visits that are due by a step.

        Parameters
        ----------
        end : int
            Of the mission.
        done : Progress
            How far they are.
        """
        pairs = zip(self.visits, done.visits, strict=True)
        visits = (max(bisect_right(dues, end), made) for dues, made in pairs)
        return Progress(tuple(visits), done.arrived)

    def _visits(self, i: int, asked: slice, step: int, horizon: int) -> tuple[Visit, ...]:
        """Return visits with their windows from a step on."""
        whole = self.scenario
        return tuple(
            changed(visit, between=_from(visit.window(whole.horizon), step, horizon))
            for visit in whole.vehicles[i].via[asked]
        )


def _assigned(scenario: Scenario, coarse: CoarsePlan) -> Scenario:
    """Return a mission with the goals that its coarse plan assigned."""
    pairs = zip(scenario.vehicles, coarse.goals(scenario.goals), strict=True)
    return changed(scenario, vehicles=tuple(changed(v, goal=goal) for v, goal in pairs), goals=())


def _dues(coarse: CoarsePlan, vehicle: int) -> tuple[tuple[int, ...], int]:
    """Return the mission's steps of a vehicle's visits and of its arrival in a coarse plan."""
    planned, path = coarse.plan.scenario.vehicles[vehicle], coarse.plan.trajectories[vehicle]
    system = planned.system
    places = path.means[:, list(system.position)]
    speeds = None if system.velocity is None else path.means[:, list(system.velocity)]
    steps = steps_visited(planned.via, places, speeds)
    arrival = planned.goal.arrival(places, speeds)
    last = len(path.means) - 1 if arrival is None else arrival
    return tuple(coarse.stride * step for step in steps), coarse.stride * last


def _from(window: tuple[int, int], step: int, horizon: int) -> tuple[int, int]:
    """Return a window of steps as it is over so many steps from a later one on."""
    return max(window[0] - step, 1), min(window[1] - step, horizon)


def _goal_at(vehicle: Vehicle, state: Vector) -> Goal:
    """Return a goal around a state on the way."""
    system = vehicle.system
    speed = None
    if system.velocity is not None:
        speed = _EASE * np.abs(state[list(system.velocity)]) + 1e-3
        if vehicle.speed_limit is not None:
            speed = np.minimum(speed, vehicle.speed_limit)
    return Goal.at(state[list(system.position)], 0.5 * vehicle.radius, speed)


def _until(obstacle: Obstacle, end: int) -> Obstacle:
    """Return an obstacle as far as a step."""
    if not obstacle.is_moving:
        return obstacle
    shape, spread = obstacle.shape, obstacle.spread
    if isinstance(shape, MovingShape):
        shape = MovingShape(shape.outlines[: end + 1])
    if spread is not None:
        spread = spread.since(0, end)
    return changed(obstacle, shape=shape, spread=spread, steps=obstacle.steps[: end + 1])
