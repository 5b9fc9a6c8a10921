"""Boats that follow a mission's segments by heading and speed, in waves, wind and a current."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.errors import ScenarioError
from radmpc.flying.tick import Contact, Segment
from radmpc.model.scenario import Scenario
from radmpc.simulators.gusts import Gusts
from radmpc.simulators.options import number_within, vector_within
from radmpc.simulators.otter import OTTER, accelerations, heading_vectors, thrust_of
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
        self._inverse = OTTER.mass_inverse
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
        self._positions, self._velocities = started(self._scenario, self._rng)
        self._headings: Vector | None = None
        self._relative = np.zeros((self._scenario.num_vehicles, 3))
        self._thrust = np.zeros((self._scenario.num_vehicles, 2))
        contacts = self._surroundings.at_start(self._positions)
        return states_of(self._scenario, self._positions, self._velocities), contacts

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
        if self._headings is None:
            self._headings = self._pointed(reference)
        self._step += 1
        tick = self._scenario.dt / self._num_samples
        visited = [self._positions]
        for number in range(self._num_samples):
            self._headings = self._moved(reference, number * tick, tick, self._headings)
            visited.append(self._positions)
        shares = np.linspace(0.0, 1.0, len(visited))
        contacts = self._surroundings.contacts(self._step, shares, np.array(visited))
        return states_of(self._scenario, self._positions, self._velocities), contacts

    def _pointed(self, reference: Reference) -> Vector:
        """Return headings of boats that wait for their first segment, pointing where it leads."""
        wanted = reference.at(_PILOT.ahead)[1] - self._water
        headings: Vector = np.arctan2(wanted[:, 1], wanted[:, 0])
        ahead, left = heading_vectors(headings)
        through = self._velocities - self._water
        self._relative[:, 0] = np.einsum("ij,ij->i", ahead, through)
        self._relative[:, 1] = np.einsum("ij,ij->i", left, through)
        return headings

    def _moved(self, reference: Reference, time: float, tick: float, headings: Vector) -> Vector:
        """Move boats by a short time, and return their new headings."""
        wanted = self._commands(reference, time, headings)
        share = 1.0 - math.exp(-tick / OTTER.propeller_time)
        self._thrust = self._thrust + share * (wanted - self._thrust)
        forces = self._pushes.advance(tick).copy()
        forces[:, 0] += self._thrust.sum(axis=1)
        forces[:, 2] += OTTER.lever * (self._thrust[:, 1] - self._thrust[:, 0])
        rates = accelerations(OTTER, self._inverse, self._relative, forces)
        self._relative = self._relative + tick * rates
        turned: Vector = headings + tick * self._relative[:, 2]
        self._water = self._current + self._streams.advance(tick)[0]
        learned = 1.0 - math.exp(-tick / _PILOT.memory)
        self._known_water = self._known_water + learned * (self._water - self._known_water)
        ahead, left = heading_vectors(turned)
        before = self._velocities
        u, v = self._relative[:, :1], self._relative[:, 1:2]
        self._velocities = u * ahead + v * left + self._water
        self._positions = self._positions + 0.5 * tick * (before + self._velocities)
        return turned

    def _commands(self, reference: Reference, time: float, headings: Vector) -> Matrix:
        """Return the thrust that follows a reference by heading and speed, (N, 2) [N]."""
        places, velocities = reference.at(time)
        ahead, _ = heading_vectors(headings)
        water = velocities + _PILOT.pull * (places - self._positions) - self._known_water
        course = water + _PILOT.ahead * reference.accelerations
        speed = np.linalg.norm(course, axis=1)
        error = np.arctan2(course[:, 1], course[:, 0]) - headings
        # Slow boats go astern: the opposite heading will do where it is nearer.
        span = np.where(speed < _PILOT.slow, np.pi, 2.0 * np.pi)
        error = np.where(speed < _PILOT.still, 0.0, (error + 0.5 * span) % span - 0.5 * span)
        surge, _, yaw = OTTER.inertia
        turn = _PILOT.yaw_rate**2 * error - 2.0 * _PILOT.yaw_rate * self._relative[:, 2]
        moment = yaw * turn + OTTER.damping[2] * self._relative[:, 2]
        wanted = np.einsum("ij,ij->i", ahead, water)
        gained = np.einsum("ij,ij->i", ahead, reference.accelerations)
        gained = gained + _PILOT.surge_rate * (wanted - self._relative[:, 0])
        force: Vector = surge * gained + OTTER.damping[0] * wanted
        return thrust_of(OTTER, force, moment)


def _check_radii(scenario: Scenario) -> None:
    """Refuse discs that the hull does not fit in."""
    for i, vehicle in enumerate(scenario.vehicles):
        if vehicle.radius < _HULL - 1e-3:
            raise ScenarioError(
                f"must be at least {_HULL:.2f} m to be flown with a boat, whose hull is 2 m long, "
                f"got {vehicle.radius:g} m",
                ("vehicles", i, "radius"),
            )
