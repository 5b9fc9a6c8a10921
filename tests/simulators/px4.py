"""A vehicle that speaks MAVLink on a socket as PX4 does, a point mass that follows setpoints."""

from __future__ import annotations

import os
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from pymavlink.dialects.v20 import common

_TICK = 0.01
HOLD = (4, 3)
"""PX4's main and sub mode."""


@dataclass
class Px4:
    """What it is, what it does wrong, and what it was told.

    Times are seconds since it was armed.
    """

    port: int
    start: tuple[float, float, float]  # north, east, down
    refuses: tuple[int, ...] = ()
    ignores: tuple[int, ...] = ()
    loses: tuple[int, ...] = ()  # as ignores, each the first time alone
    silent_after: float = np.inf
    blind: tuple[float, float] = (np.inf, np.inf)
    autopilot: int = common.MAV_AUTOPILOT_PX4
    garbage: bool = False
    pilot_after: float = np.inf  # a pilot switches to position control
    fails_after: float = np.inf  # motors stop
    stays: bool = False  # in the mode in which it is, whatever it answers
    setpoints: list[np.ndarray] = field(default_factory=list)
    modes: list[tuple[int, int]] = field(default_factory=list)
    lost_setpoints: bool = False
    heard: list[tuple[int, int]] = field(default_factory=list)  # commands, how often sent before

    def run(self, stopped: threading.Event) -> None:
        """Fly until stopped."""
        self._protocol = common.MAVLink(None, 1, common.MAV_COMP_ID_AUTOPILOT1)
        self._protocol.robust_parsing = True
        self._place, self._speed = np.array(self.start, dtype=float), np.zeros(3)
        self._armed: float | None = None
        self._mode = (3, 0)
        self._last, self._moved = -np.inf, time.monotonic()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as self._socket:
            self._socket.setblocking(False)
            count = 0
            while not stopped.wait(_TICK):
                self._listen()
                self._fly()
                self._talk(count)
                count += 1
            self._listen()

    def _since_armed(self) -> float:
        return -1.0 if self._armed is None else time.monotonic() - self._armed

    def _listen(self) -> None:
        while True:
            try:
                data, _ = self._socket.recvfrom(4096)
            except (BlockingIOError, ConnectionError):
                return
            for message in self._protocol.parse_buffer(data) or ():
                kind = message.get_type()
                if kind == "SET_POSITION_TARGET_LOCAL_NED":
                    m = message
                    rows = [[m.x, m.y, m.z], [m.vx, m.vy, m.vz], [m.afx, m.afy, m.afz]]
                    self.setpoints.append(np.array(rows))
                    self._last = time.monotonic()
                elif kind == "COMMAND_LONG" and self._since_armed() < self.silent_after:
                    self._obey(message)

    def _obey(self, message: Any) -> None:
        result = common.MAV_RESULT_ACCEPTED
        is_first = not any(command == message.command for command, _ in self.heard)
        self.heard.append((message.command, message.confirmation))
        if message.command in self.ignores or (is_first and message.command in self.loses):
            return
        if message.command in self.refuses:
            result = common.MAV_RESULT_DENIED
        elif message.command == common.MAV_CMD_DO_SET_MODE:
            mode = int(message.param2), int(message.param3)
            self.modes.append(mode)
            if mode == (6, 0) and (len(self.setpoints) < 2 or time.monotonic() - self._last > 0.5):
                result = common.MAV_RESULT_TEMPORARILY_REJECTED
            elif not self.stays:
                self._mode = mode
        elif message.command == common.MAV_CMD_COMPONENT_ARM_DISARM:
            self._armed = time.monotonic()
        self._send(common.MAVLink_command_ack_message(message.command, result))

    def _fly(self) -> None:
        now = time.monotonic()
        passed, self._moved = min(now - self._moved, 5.0 * _TICK), now
        if not (self._mode == (6, 0) and self._armed is not None):
            return
        if time.monotonic() - self._last > 0.5:
            self._mode, self.lost_setpoints = HOLD, True
            return
        if self._since_armed() > self.pilot_after:
            self._mode = (3, 0)
            return
        place, speed, push = self.setpoints[-1]
        push = push + 60.0 * (place - self._place) + 15.0 * (speed - self._speed)
        self._speed = self._speed + passed * push
        self._place = self._place + passed * self._speed

    def _talk(self, count: int) -> None:
        since = self._since_armed()
        if since > self.silent_after:
            return
        if self.garbage:
            self._socket.sendto(b"\xfd\x09nonsense" * 3, ("127.0.0.1", self.port))
        if count % 20 == 0:
            kind = common.MAV_TYPE_QUADROTOR, self.autopilot
            is_armed = self._armed is not None and since < self.fails_after
            base = common.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
            base |= common.MAV_MODE_FLAG_SAFETY_ARMED * is_armed
            mode = self._mode[0] << 16 | self._mode[1] << 24
            self._send(common.MAVLink_heartbeat_message(*kind, base, mode, 4, 3))
        if count % 2 == 0 and not self.blind[0] < since < self.blind[1]:
            numbers = [float(number) for number in (*self._place, *self._speed)]
            self._send(common.MAVLink_local_position_ned_message(10 * count, *numbers))

    def _send(self, message: Any) -> None:
        self._socket.sendto(message.pack(self._protocol), ("127.0.0.1", self.port))
        self._protocol.seq = (self._protocol.seq + 1) % 256


@contextmanager
def in_the_air(*vehicles: Px4) -> Iterator[None]:
    """Have vehicles live while the context lasts."""
    stopped = threading.Event()
    threads = [threading.Thread(target=one.run, args=(stopped,)) for one in vehicles]
    for thread in threads:
        thread.start()
    try:
        yield
    finally:
        stopped.set()
        for thread in threads:
            thread.join()


def free_port(count: int) -> int:
    """Return the first of some ports nobody listens at.

    Each process looks elsewhere first: between looking and listening another could take them.
    """
    begin = 10 * (os.getpid() % 4000)
    for step in range(0, 40000, 10):
        first = 20000 + (begin + step) % 40000
        sockets = []
        try:
            for port in range(first, first + count):
                sockets.append(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
                sockets[-1].bind(("127.0.0.1", port))
        except OSError:
            continue
        finally:
            for one in sockets:
                one.close()
        return first
    raise OSError("no ports are free")
