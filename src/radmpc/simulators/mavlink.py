"""Vehicles that speak MAVLink: timed setpoints out, states in, in real time."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import numpy as np

from radmpc.arguments import value_text
from radmpc.arrays import Matrix, Vector
from radmpc.errors import ArgumentError, ArgumentTypeError
from radmpc.flying.tick import Contact, Segment
from radmpc.model.scenario import Scenario
from radmpc.simulators.link import Link, LinkError
from radmpc.simulators.optional import loaded
from radmpc.simulators.options import number_within
from radmpc.simulators.streaming import Stream
from radmpc.simulators.surroundings import Surroundings
from radmpc.simulators.tracking import Reference, States, check_simulated, states_of

__all__ = ["Mavlink"]

_BEFORE = 0.5
"""How long setpoints are streamed before the mode is asked for [s]; PX4 wants some at 2 Hz."""

_CLOSE = 0.5
"""Distance from its start at which a vehicle is there [m]."""

_SLOW = 0.5
"""Speed up to which it is there, and does not only fly by [m/s]."""


class Mavlink:
    """PX4 vehicles in offboard mode, each on a UDP port of its own.

    A thread streams setpoints (position, velocity, acceleration of the segment, by the time since
    its step began) also while the next decision is made, and takes what vehicles say. A state that
    is older than half a second is no measurement: the mission flies its tail on. Vehicles that are
    not heard for ``patience``, leave offboard mode or are disarmed end the flight. All that are in
    offboard mode are then told to hold, as they are at its end: what a pilot or a failsafe flies is
    left alone.

    Parameters
    ----------
    scenario : Scenario
        What is flown: double integrators, along intervals; x east, y north, z up.
    rng : object
        Not used: vehicles bring their own noise.
    address : str
        ``HOST:PORT`` where the first vehicle's messages arrive; the others' at the next ports.
    homes : {'origin', 'starts'}
        Where vehicles' local frames begin: all at the scenario's origin, or each at its start.
    altitude : float
        Of a scenario in the plane, above the local origin [m].
    rate : float
        Setpoints in a second [1/s].
    patience : float
        Longest silence, and longest wait for an answer or for the start to be reached [s].
    clock, sleep : callable
        Return seconds, and wait some.

    Raises
    ------
    ArgumentTypeError
        If an argument is of another kind.
    ArgumentError
        If a value is not allowed, or pymavlink is not installed.
    ScenarioError
        If the scenario is none for vehicles in continuous time.
    """

    def __init__(
        self,
        scenario: Scenario,
        rng: object = None,
        *,
        address: str = "127.0.0.1:14540",
        homes: str = "origin",
        altitude: float | str = 0.0,
        rate: float | str = 20.0,
        patience: float | str = 10.0,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        del rng
        _check_functions(clock=clock, sleep=sleep)
        check_simulated(scenario, "vehicles over MAVLink")
        loaded("pymavlink.dialects.v20.common", "mavlink")
        self._host, self._port = _parsed(address, scenario.num_vehicles)
        if homes not in {"origin", "starts"}:
            raise ArgumentError(f"homes must be 'origin' or 'starts', got {homes!r}")
        self._height = number_within(altitude, "altitude", 0.0, 10_000.0, "m")
        self._period = 1.0 / number_within(rate, "rate", 5.0, 200.0, "1/s")
        self._patience = number_within(patience, "patience", 0.1, 600.0, "s")
        self._scenario, self._clock, self._sleep = scenario, clock, sleep
        self._starts = self._in_space(np.array([v.start_position for v in scenario.vehicles]))
        self._homes = np.zeros_like(self._starts)
        if homes == "starts":
            # Above its own origin a vehicle in the plane flies at the altitude that was told.
            self._homes[:, : scenario.dimension] = self._starts[:, : scenario.dimension]
        self._surroundings = Surroundings(scenario)
        self._stream: Stream | None = None
        self._step = 0
        self._begun = 0.0

    def reset(self) -> tuple[States, tuple[Contact, ...]]:
        """Find the vehicles, take command, arm them, and bring them to their starts.

        They go there in straight lines, all at once: nothing is planned for that way.

        Returns
        -------
        states : tuple of (n,) array
            In the scenario's order.
        contacts : tuple of Contact
            What is hit there already.

        Raises
        ------
        LinkError
            If an address cannot be listened at, or a vehicle is not heard, refuses, or does not get
            to its start.
        """
        self.close()
        self._step = 0
        stream = self._opened()
        try:
            stream.wait_for(
                lambda i: bool(np.isfinite(stream.measured()[0][i]).all()),
                "says nothing of where it is",
            )
            stream.hold(stream.measured()[0])
            self._sleep(_BEFORE)
            stream.take_command()
            goals = self._starts - self._homes
            stream.hold(goals)
            stream.wait_for(
                lambda i: _is_at(goals[i], *(part[i] for part in stream.measured())),
                "does not get to its start",
            )
        except LinkError:
            self.close()
            raise
        stream.visited()  # on the way to the start nothing counts
        self._begun = self._clock()
        states, places = self._states(stream)
        return states, self._surroundings.at_start(places)

    def advance(self, segments: Sequence[Segment]) -> tuple[States, tuple[Contact, ...]]:
        """Steer along segments for a step.

        Parameters
        ----------
        segments : sequence of Segment
            What every vehicle is to do, in the scenario's order.

        Returns
        -------
        states : tuple of (n,) array
            After it; of a vehicle that has not been heard lately not a number.
        contacts : tuple of Contact
            What was hit on the way.

        Raises
        ------
        LinkError
            If a vehicle is lost, is taken over, or was never taken command of.
        """
        if self._stream is None:
            raise LinkError("not in command of the vehicles: call reset before advance")
        stream, dt = self._stream, self._scenario.dt
        # Vehicles wait at their starts for the first decision. Later ones find them in the air,
        # where they went on meanwhile: one that took longer than its step delays all that follow.
        begun = max(self._begun, self._clock() - dt) if self._step else self._clock()
        stream.follow(begun, self._own(Reference.of(segments)))
        self._step += 1
        self._begun = begun + dt
        try:
            stream.wait_until(self._begun)
        except LinkError:
            self.close()
            raise
        times, places = stream.visited()
        states, _ = self._states(stream)
        if self._step == self._scenario.horizon:
            self.close()
        shares = np.clip((times - begun) / dt, 0.0, 1.0)
        where = (places + self._homes)[..., : self._scenario.dimension]
        if not len(where):
            return states, ()
        return states, self._surroundings.contacts(self._step, shares, where)

    def close(self) -> None:
        """Tell vehicles in offboard mode to hold, and let go of all; nothing runs on."""
        stream, self._stream = self._stream, None
        if stream is not None:
            stream.close()

    def __enter__(self) -> Mavlink:
        """Return itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Let go of the vehicles."""
        self.close()

    def _opened(self) -> Stream:
        """Listen for all vehicles."""
        links: list[Link] = []
        try:
            for i, vehicle in enumerate(self._scenario.vehicles):
                links.append(Link(vehicle.name, self._host, self._port + i, self._clock))
        except LinkError:
            for link in links:
                link.close()
            raise
        stream = Stream(
            links, self._period, self._scenario.dt, self._patience, self._clock, self._sleep
        )
        self._stream = stream
        return stream

    def _states(self, stream: Stream) -> tuple[States, Matrix]:
        """Return states now, and positions."""
        d = self._scenario.dimension
        places, velocities = stream.measured()
        where = (places + self._homes)[:, :d]
        return states_of(self._scenario, where, velocities[:, :d]), where

    def _own(self, reference: Reference) -> Reference:
        """Return a reference in vehicles' own frames."""
        return Reference(
            self._in_space(reference.positions) - self._homes,
            self._in_space(reference.velocities, 0.0),
            self._in_space(reference.accelerations, 0.0),
        )

    def _in_space(self, rows: Matrix, height: float | None = None) -> Matrix:
        """Return rows with a third coordinate, if they lack one: the altitude unless told."""
        if rows.shape[1] == 3:
            return rows
        third = self._height if height is None else height
        return np.column_stack([rows, np.full(len(rows), third)])


def _check_functions(**functions: object) -> None:
    """Refuse what cannot be called, as options of a command line cannot."""
    for name, function in functions.items():
        if not callable(function):
            raise ArgumentTypeError(f"{name} must be a function, got {value_text(function)}")


def _is_at(goal: Vector, place: Vector, velocity: Vector) -> bool:
    """Whether a vehicle is where it should be, and nearly at rest; not a number is no."""
    return bool(np.linalg.norm(place - goal) < _CLOSE and np.linalg.norm(velocity) < _SLOW)


def _parsed(address: str, count: int) -> tuple[str, int]:
    """Return host and first port."""
    host, colon, port = address.rpartition(":") if isinstance(address, str) else ("", "", "")
    if not (colon and host and port.isdigit() and 1 <= int(port) <= 65536 - count):
        raise ArgumentError(
            f"address must be HOST:PORT, and have ports for {count} vehicles, got {address!r}"
        )
    return host, int(port)
