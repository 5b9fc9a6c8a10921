"""What others send to a vehicle's port, and what arrives twice or in another order."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest
from boats import asked, sea

pytest.importorskip("pymavlink", reason="needs: pip install 'radmpc[mavlink]'")

from px4 import HOLD, Px4, free_port, in_the_air
from pymavlink.dialects.v20 import common

from radmpc.simulators import mavlink
from radmpc.simulators.fix import Fix
from radmpc.simulators.link import Link, LinkError
from radmpc.simulators.mavlink import Mavlink

AIR = sea(dt=0.4, horizon=8)
STARTS = tuple(vehicle.start for vehicle in AIR.vehicles)


class Sender:
    """An autopilot's messages, sent by hand to a port."""

    def __init__(self, port: int, system: int = 1) -> None:
        self._protocol = common.MAVLink(None, system, common.MAV_COMP_ID_AUTOPILOT1)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._to = "127.0.0.1", port
        self._socket.connect(self._to)

    def beat(self, mode: int = 6, autopilot: int = common.MAV_AUTOPILOT_PX4) -> None:
        """Send a heartbeat of an armed vehicle."""
        base = common.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | common.MAV_MODE_FLAG_SAFETY_ARMED
        kind = common.MAV_TYPE_QUADROTOR, autopilot
        self.send(common.MAVLink_heartbeat_message(*kind, base, mode << 16, 4, 3))

    def place(self, stamp: int, north: float, east: float) -> None:
        """Send where it is, at rest, at a time since its start [ms]."""
        numbers = north, east, -5.0, 0.0, 0.0, 0.0
        self.send(common.MAVLink_local_position_ned_message(stamp, *numbers))

    def send(self, message: Any) -> None:
        """Send a message."""
        self._socket.send(message.pack(self._protocol))
        self._protocol.seq = (self._protocol.seq + 1) % 256

    def close(self) -> None:
        """Close its socket."""
        self._socket.close()


@contextmanager
def linked(*systems: int) -> Iterator[tuple[Link, list[Sender]]]:
    """Return a link, and senders of some systems to its port."""
    port = free_port(1)
    link = Link("east", "127.0.0.1", port)
    senders = [Sender(port, system) for system in systems]
    try:
        yield link, senders
    finally:
        for one in (link, *senders):
            one.close()


@pytest.mark.parametrize("second", [1, 2])
def test_two_vehicles_on_one_port_are_refused_before_either_is_commanded(second: int) -> None:
    with linked(1, second) as (link, (one, other)):
        one.beat()
        link.receive()
        other.beat()
        line = (
            rf"^vehicle 'east': 127\.0\.0\.1:\d+ must be one vehicle's, got system 1 from "
            rf"127\.0\.0\.1:\d+ and system {second} from 127\.0\.0\.1:\d+$"
        )
        with pytest.raises(LinkError, match=line):
            link.receive()


@pytest.mark.parametrize("second", [1, 2])
@pytest.mark.parametrize("autopilot", [common.MAV_AUTOPILOT_PX4, common.MAV_AUTOPILOT_INVALID])
def test_a_vehicle_that_is_flown_is_not_mistaken_for_another_on_its_port(
    second: int, autopilot: int
) -> None:
    with linked(1, second) as (link, (one, other)):
        one.beat()
        one.place(10, 1.0, 2.0)
        link.receive()
        link.is_watched = True
        other.beat(mode=3, autopilot=autopilot)
        other.place(20, 50.0, 60.0)
        link.receive()
        assert link.is_offboard
        assert link.is_ours
        assert link.fix is not None
        assert link.fix.position.tolist() == [2.0, 1.0, 5.0]


def test_a_position_counts_once_and_not_after_a_later_one() -> None:
    times = iter(np.arange(100.0))
    port = free_port(1)
    link, sender = Link("east", "127.0.0.1", port, lambda: float(next(times))), Sender(port)
    found = []
    try:
        sender.beat()
        # In order, again, late, and twice later.
        for stamp, north in ((9000, 1.0), (9000, 2.0), (8950, 3.0), (9050, 4.0), (20_000, 5.0)):
            sender.place(stamp, north, 0.0)
            link.receive()
            assert link.fix is not None
            found.append((link.fix.position[1], link.fix.time))
        sender.place(10, 6.0, 0.0)  # of a vehicle that was started again
        link.receive()
    finally:
        sender.close()
        link.close()
    assert [north for north, _ in found] == [1.0, 1.0, 1.0, 4.0, 5.0]
    assert found[0] == found[1] == found[2]
    assert link.fix.position[1] == 6.0


def test_a_stamp_goes_on_after_the_largest() -> None:
    fix = Fix(0.0, np.zeros(3), np.zeros(3), 2**32 - 20)
    assert fix.is_before(30)
    assert not fix.is_before(2**32 - 70)
    assert not Fix(0.0, np.zeros(3), np.zeros(3), 30).is_before(2**32 - 20)


@pytest.mark.slow
@pytest.mark.waits
def test_another_vehicle_on_the_port_ends_no_flight_and_is_told_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(mavlink, "_BEFORE", 0.15)
    port = free_port(2)
    vehicles = Px4(port, (0.0, 0.0, -5.0)), Px4(port + 1, (0.0, 14.0, -5.0))
    other, stopped = Px4(port, (50.0, 50.0, -5.0)), threading.Event()
    thread = threading.Thread(target=other.run, args=(stopped,))
    with in_the_air(*vehicles):
        backend = Mavlink(AIR, address=f"127.0.0.1:{port}", altitude=5.0, rate=50.0)
        backend.reset()
        thread.start()
        try:
            for _ in range(AIR.horizon):
                states, _ = backend.advance(asked(AIR, STARTS, [0.0, 0.0]))
                assert np.abs(states[0]).max() < 0.5
        finally:
            backend.close()
            stopped.set()
            thread.join()
    assert vehicles[0].modes[-1] == HOLD
    assert not other.setpoints
    assert not other.modes
