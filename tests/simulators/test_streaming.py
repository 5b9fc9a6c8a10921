"""What a stream of setpoints records, and what it sends when nobody decides."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import cast

import numpy as np
import pytest

pytest.importorskip("pymavlink", reason="needs: pip install 'radmpc[mavlink]'")

from radmpc.arrays import Vector
from radmpc.simulators.fix import Fix
from radmpc.simulators.link import Link
from radmpc.simulators.streaming import Stream
from radmpc.simulators.tracking import Reference

DT = 2.0
REFERENCE = Reference(np.array([[1.0, 0.0, 5.0]]), np.array([[1.0, 0.0, 0.0]]), np.eye(3)[:1])


class Clock:
    """Seconds that pass when they are told to."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        """Return the time."""
        return self.now


class Standing:
    """A link to a vehicle that is where it began, and is told where to be."""

    name, is_watched, is_ours, is_offboard, is_armed = "east", False, False, True, True

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self.told: list[tuple[float, Vector, Vector, Vector]] = []

    @property
    def fix(self) -> Fix:
        """Where it is, always new."""
        return Fix(self._clock.now, np.zeros(3), np.zeros(3), 0)

    def steer(self, position: Vector, velocity: Vector, acceleration: Vector) -> None:
        """Take a setpoint."""
        self.told.append((self._clock.now, position, velocity, acceleration))

    def receive(self) -> None:
        """Hear nothing new."""

    beat = close = receive


@contextmanager
def streamed() -> Iterator[tuple[Stream, Standing, Clock]]:
    """Return a stream to one vehicle."""
    clock = Clock()
    link = Standing(clock)
    made = Stream([cast("Link", link)], 0.01, DT, 1.0, clock, lambda seconds: time.sleep(0.001))
    try:
        yield made, link, clock
    finally:
        made.close()


def at(moment: float, link: Standing, clock: Clock) -> tuple[Vector, Vector, Vector]:
    """Return the setpoint of a moment."""
    clock.now = moment
    # The clock may move on between its reading and the first setpoint.
    while [when for when, *_ in link.told[-2:]] != [moment, moment]:
        time.sleep(0.001)
    return link.told[-1][1:]


def test_where_vehicles_are_while_a_decision_is_made_is_looked_at_once() -> None:
    with streamed() as (stream, link, clock):
        stream.follow(0.0, REFERENCE)
        for moment in (1.0, 2.0, 3.0):
            at(moment, link, clock)
        # A decision is made, and the next step begins.
        stream.follow(2.0, REFERENCE)
        at(4.0, link, clock)
        first, places = stream.visited()
        at(5.0, link, clock)
        second, _ = stream.visited()
    assert {1.0, 2.0, 3.0} < set(first.tolist())
    assert places.shape == (len(first), 1, 3)
    assert not {1.0, 2.0, 3.0} & set(second.tolist())
    assert 5.0 in second


def test_without_a_decision_a_vehicle_goes_on_for_a_step_and_stays_there() -> None:
    with streamed() as (stream, link, clock):
        stream.follow(0.0, REFERENCE)
        going = at(1.5 * DT, link, clock)
        staying = [at(moment, link, clock) for moment in (2.0 * DT + 0.1, 5.0 * DT)]
    assert [part.tolist() for part in going] == [[8.5, 0.0, 5.0], [4.0, 0.0, 0.0], [1.0, 0.0, 0.0]]
    for setpoint in staying:
        parts = [part.tolist() for part in setpoint]
        assert parts == [[13.0, 0.0, 5.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
