"""Boats that follow a mission's segments by heading and speed, in waves, wind and a current."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from radmpc.errors import ScenarioError
from radmpc.flying.tick import Contact, Segment
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass
from radmpc.simulators.gusts import Gusts
from radmpc.simulators.options import number_within, vector_within
from radmpc.simulators.otter import OTTER, Triple, accelerations, thrust_of
from radmpc.simulators.surroundings import Surroundings
from radmpc.simulators.tracking import (
    Reference,
    States,
    check_simulated,
    random_from,
    started,
    states_of,
)

__all__ = ["Boat"]

_SAMPLE = 0.05
"""Step of the simulation, and longest time between two positions that contacts are looked for at
[s]: half the time constant of a propeller."""

_HULL = 0.5 * math.hypot(2.0, 1.08)
"""Radius of the disc about the hull of 2.0 by 1.08 m [m]."""


@dataclass(frozen=True, slots=True)
class _Pilot:
    """The tracking controller's numbers, set by hand on a slalom at 1 m/s.

    Attributes
    ----------
    pull : float
        Speed toward the reference by distance from it [1/s]. Twice as much overshoots in turns.
    ahead : float
        How much earlier the reference's course is steered [s]: about what a turn takes to begin.
    yaw_rate : float
        Natural frequency of the closed loop in yaw, critically damped [rad/s].
    surge_rate : float
        Rate at which a wrong speed through the water is corrected [1/s].
    slow : float
        Speed below which a boat goes astern rather than turn round [m/s].
    still : float
        Speed below which it keeps its heading [m/s].
    memory : float
        Time constant of its estimate of the current, from log and satellites [s].
    """

    pull: float = 0.4
    ahead: float = 0.8
    yaw_rate: float = 1.5
    surge_rate: float = 1.5
    slow: float = 0.5
    still: float = 0.05
    memory: float = 5.0


_PILOT = _Pilot()


@dataclass(slots=True)
class _Hull:
    """One boat's state; in Python's numbers, which are quicker than numpy's for a few boats.

    Attributes
    ----------
    x, y : float
        Position [m].
    vx, vy : float
        Velocity over ground [m/s].
    heading : float
        From x toward y [rad].
    relative : tuple of float
        Surge, sway [m/s] and yaw [rad/s] through the water.
    thrust : tuple of float
        Of the left and the right propeller [N].
    """

    x: float
    y: float
    vx: float
    vy: float
    heading: float = 0.0
    relative: Triple = (0.0, 0.0, 0.0)
    thrust: tuple[float, float] = (0.0, 0.0)


class Boat:
    """Otters, three degrees of freedom each: `radmpc.simulators.otter` has the equations.

    A segment's position and velocity are where its boat was measured; its parabola is followed by
    heading and speed, for boats have no propeller across. What remains is noise to the plan:
    identify it (`radmpc calibrate`) before a certificate is believed.

    Parameters
    ----------
    scenario : Scenario
        What is flown: double integrators in the plane, along intervals, radii of at least 1.14 m.
    rng : Generator, int or None
        Source of all that is random, or its seed.
    current : (2,) array_like
        Mean velocity of the water [m/s].
    current_deviation : float
        By which it varies along each axis, the same for all boats, over half a minute [m/s].
    force : float
        Standard deviation of what wind and waves push each boat with, ahead and across [N]; the
        moment's is a quarter of that at 1 m.
    gust_time : float
        Time constant of that push [s].

    Raises
    ------
    ArgumentTypeError
        If an argument is of another kind.
    ArgumentError
        If a number is out of its range.
    ScenarioError
        If the scenario is none for boats.
    """

    def __init__(
        self,
        scenario: Scenario,
        rng: np.random.Generator | int | None = None,
        *,
        current: Sequence[float] | str = (0.0, 0.0),
        current_deviation: float | str = 0.02,
        force: float | str = 20.0,
        gust_time: float | str = 1.0,
    ) -> None:
        check_simulated(scenario, "a boat", (2,))
        _check_radii(scenario)
        source = random_from(rng)
        spread = number_within(current_deviation, "current_deviation", 0.0, 2.0, "m/s")
        push = number_within(force, "force", 0.0, 500.0, "N")
        memory = number_within(gust_time, "gust_time", 0.01, 1000.0, "s")
        self._current = vector_within(current, "current", 2, 2.0, "m/s")
        self._scenario = scenario
        self._rng = source
        count = scenario.num_vehicles
        self._pushes = Gusts(np.tile([push, push, 0.25 * push], (count, 1)), memory, source)
        self._streams = Gusts(np.full((1, 2), spread), 30.0, source)
        self._num_samples = max(1, math.ceil(scenario.dt / _SAMPLE - 1e-9))
        self._surroundings = Surroundings(scenario)
        self.reset()

    def reset(self) -> tuple[States, tuple[Contact, ...]]:
        """Draw where boats begin, and the sea.

        Returns
        -------
        states : tuple of (4,) array
            In the scenario's order.
        contacts : tuple of Contact
            What is hit there already.
        """
        self._step = 0
        self._pushes.reset()
        self._streams.reset()
        self._water = self._current + self._streams.values[0]
        self._known_water = self._water
        self._has_headings = False
        positions, velocities = started(self._scenario, self._rng)
        rows = np.hstack([positions, velocities]).tolist()
        self._hulls = [_Hull(*row) for row in rows]
        return self._states(), self._surroundings.at_start(positions)

    def advance(self, segments: Sequence[Segment]) -> tuple[States, tuple[Contact, ...]]:
        """Follow segments for a step.

        Parameters
        ----------
        segments : sequence of Segment
            What every boat is to do, in the scenario's order.

        Returns
        -------
        states : tuple of (4,) array
            Positions and velocities over ground after it.
        contacts : tuple of Contact
            What was hit on the way.
        """
        reference = Reference.of(segments)
        if not self._has_headings:
            self._point(reference)
        self._step += 1
        tick = self._scenario.dt / self._num_samples
        visited = [[(hull.x, hull.y) for hull in self._hulls]]
        for number in range(self._num_samples):
            self._move(reference, number * tick, tick)
            visited.append([(hull.x, hull.y) for hull in self._hulls])
        shares = np.linspace(0.0, 1.0, len(visited))
        return self._states(), self._surroundings.contacts(self._step, shares, np.array(visited))

    def _states(self) -> States:
        """Return positions and velocities over ground as states."""
        positions = np.array([(hull.x, hull.y) for hull in self._hulls])
        velocities = np.array([(hull.vx, hull.vy) for hull in self._hulls])
        return states_of(self._scenario, positions, velocities)

    def _point(self, reference: Reference) -> None:
        """Turn boats that wait for their first segment where it leads."""
        self._has_headings = True
        courses = (reference.at(_PILOT.ahead)[1] - self._water).tolist()
        water_x, water_y = self._water.tolist()
        for hull, (east, north) in zip(self._hulls, courses, strict=True):
            hull.heading = math.atan2(north, east)
            cosine, sine = math.cos(hull.heading), math.sin(hull.heading)
            x, y = hull.vx - water_x, hull.vy - water_y
            hull.relative = cosine * x + sine * y, cosine * y - sine * x, 0.0

    def _move(self, reference: Reference, time: float, tick: float) -> None:
        """Move all boats by a short time."""
        pushes = self._pushes.advance(tick).tolist()
        places, velocities = (part.tolist() for part in reference.at(time))
        pushed = reference.accelerations.tolist()
        share = 1.0 - math.exp(-tick / OTTER.propeller_time)
        wanted = [
            self._commands(hull, place, velocity, gained)
            for hull, place, velocity, gained in zip(
                self._hulls, places, velocities, pushed, strict=True
            )
        ]
        self._water = self._current + self._streams.advance(tick)[0]
        learned = 1.0 - math.exp(-tick / _PILOT.memory)
        self._known_water = self._known_water + learned * (self._water - self._known_water)
        water_x, water_y = self._water.tolist()
        for hull, (left, right), push in zip(self._hulls, wanted, pushes, strict=True):
            a, b = hull.thrust
            a, b = a + share * (left - a), b + share * (right - b)
            hull.thrust = a, b
            forces = push[0] + a + b, push[1], push[2] + OTTER.lever * (b - a)
            rates = accelerations(OTTER, hull.relative, forces)
            u, v, r = (old + tick * rate for old, rate in zip(hull.relative, rates, strict=True))
            hull.relative = u, v, r
            hull.heading += tick * r
            cosine, sine = math.cos(hull.heading), math.sin(hull.heading)
            vx, vy = cosine * u - sine * v + water_x, sine * u + cosine * v + water_y
            hull.x += 0.5 * tick * (hull.vx + vx)
            hull.y += 0.5 * tick * (hull.vy + vy)
            hull.vx, hull.vy = vx, vy

    def _commands(
        self, hull: _Hull, place: list[float], velocity: list[float], gained: list[float]
    ) -> tuple[float, float]:
        """Return the thrust that follows a reference by heading and speed [N]."""
        known_x, known_y = self._known_water.tolist()
        x = velocity[0] + _PILOT.pull * (place[0] - hull.x) - known_x
        y = velocity[1] + _PILOT.pull * (place[1] - hull.y) - known_y
        course_x, course_y = x + _PILOT.ahead * gained[0], y + _PILOT.ahead * gained[1]
        speed, error = math.hypot(course_x, course_y), 0.0
        if speed >= _PILOT.still:
            # Slow boats go astern: the opposite heading will do where it is nearer.
            span = math.pi if speed < _PILOT.slow else 2.0 * math.pi
            error = math.remainder(math.atan2(course_y, course_x) - hull.heading, span)
        surge, _, yaw = OTTER.inertia
        u, _, r = hull.relative
        turn = _PILOT.yaw_rate**2 * error - 2.0 * _PILOT.yaw_rate * r
        cosine, sine = math.cos(hull.heading), math.sin(hull.heading)
        wanted = cosine * x + sine * y
        faster = cosine * gained[0] + sine * gained[1] + _PILOT.surge_rate * (wanted - u)
        force = surge * faster + OTTER.damping[0] * wanted
        return thrust_of(OTTER, force, yaw * turn + OTTER.damping[2] * r)


def _check_radii(scenario: Scenario) -> None:
    """Refuse discs that the hull does not fit in."""
    for i, vehicle in enumerate(scenario.vehicles):
        if vehicle.radius < _HULL - 1e-3:
            raise ScenarioError(
                f"must be at least {_HULL:.2f} m to be flown with a boat, whose hull is 2 m long, "
                f"got {vehicle.radius:g} m",
                ("vehicles", i, "radius"),
            )
