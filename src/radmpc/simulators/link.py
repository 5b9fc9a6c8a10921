"""One vehicle that speaks MAVLink: what it says, and what it is told."""

from __future__ import annotations

import socket
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from radmpc.arrays import Vector
from radmpc.errors import RadmpcError
from radmpc.simulators.fix import Fix
from radmpc.simulators.optional import loaded
from radmpc.simulators.px4_modes import MODES, OFFBOARD, PX4, mode_text

__all__ = ["Link", "LinkError"]

_USE_ALL_BUT_YAW = 0b1100_0000_0000
"""POSITION_TARGET_TYPEMASK: position, velocity and acceleration count [-]."""

_NORTH_EAST_DOWN = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
"""From the scenario's east, north, up, and back [-]."""

_GROUND_STATION = 255, 190
"""System and component that speak here [-]."""


class LinkError(RadmpcError):
    """A vehicle that is not heard, refuses, or does not get where it must begin."""


class Link:
    """A socket, and the protocol's state on it.

    Parameters
    ----------
    name : str
        The vehicle, for messages.
    host, port : str, int
        Where its messages arrive (UDP).
    clock : callable
        Returns seconds.

    Attributes
    ----------
    name : str
        The vehicle.
    address : str
        Where its messages arrive, for messages.
    fix : Fix or None
        Where it last said it was.
    heard : float
        When it was last heard, by the clock [s].
    is_ours : bool
        Whether it has accepted offboard mode, or is in it: others are not told to hold.
    is_offboard : bool
        Whether it is in offboard mode, by its last heartbeat.
    is_armed : bool
        Whether its motors run, by its last heartbeat.
    is_watched : bool
        Whether it flies what is streamed. What others send to its port is ignored from then
        on; before, it is not clear which of them is the vehicle.

    Raises
    ------
    LinkError
        If the address cannot be listened at.
    """

    def __init__(
        self, name: str, host: str, port: int, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._dialect: Any = loaded("pymavlink.dialects.v20.common", "mavlink")
        self.name = name
        self.address = f"{host}:{port}"
        self._clock = clock
        self._begun = clock()
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        try:
            self._socket.bind((host, port))
        except OSError as error:
            self._socket.close()
            raise LinkError(
                f"vehicle {name!r}: cannot listen at {self.address}: {error.strerror}"
            ) from error
        self._protocol = self._dialect.MAVLink(None, *_GROUND_STATION)
        self._protocol.robust_parsing = True
        self._peer: tuple[str, int] | None = None
        self._target = 0, 0
        self._answers: dict[int, int] = {}
        self._last_beat = float("-inf")
        self._mode, self._asked = (0, 0), ""
        self.fix: Fix | None = None
        self.heard = float("-inf")
        self.is_ours = self.is_offboard = self.is_armed = self.is_watched = False

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()

    def receive(self) -> None:
        """Take what has arrived; what is no MAVLink is dropped."""
        while True:
            try:
                data, peer = self._socket.recvfrom(4096)
            except (BlockingIOError, ConnectionError):
                return
            for message in self._protocol.parse_buffer(data) or ():
                self._take(message, peer)

    def _take(self, message: Any, peer: tuple[str, int]) -> None:
        """Take one message of the vehicle."""
        kind, now = message.get_type(), self._clock()
        sender = message.get_srcSystem(), message.get_srcComponent()
        is_other = (peer, sender) != (self._peer, self._target)
        if kind == "HEARTBEAT" and sender[1] == self._dialect.MAV_COMP_ID_AUTOPILOT1:
            if is_other and self.is_watched:
                return
            self._check_beat(message, peer)
            self._peer, self._target, self.heard = peer, sender, now
            self._mode = (message.custom_mode >> 16) & 0xFF, (message.custom_mode >> 24) & 0xFF
            self.is_ours = self.is_offboard = self._mode[0] == OFFBOARD
            self.is_armed = bool(message.base_mode & self._dialect.MAV_MODE_FLAG_SAFETY_ARMED)
        elif is_other:
            return
        elif kind == "LOCAL_POSITION_NED":
            self._take_place(message)
        elif kind == "COMMAND_ACK":
            self._answers[message.command] = message.result
            is_accepted = message.result == self._dialect.MAV_RESULT_ACCEPTED
            if message.command == self._command("offboard") and is_accepted:
                self.is_ours = self._asked == "offboard"

    def _take_place(self, message: Any) -> None:
        """Take a position, unless it is no number, came twice, or a later one came before it."""
        m, now = message, self._clock()
        numbers = np.array([[m.x, m.y, m.z], [m.vx, m.vy, m.vz]])
        is_later = self.fix is None or self.fix.is_before(m.time_boot_ms)
        if is_later and np.isfinite(numbers).all():
            place, speed = numbers @ _NORTH_EAST_DOWN
            self.fix, self.heard = Fix(now, place, speed, m.time_boot_ms), now

    def _check_beat(self, message: Any, peer: tuple[str, int]) -> None:
        """Refuse what is not flown by PX4, and a second vehicle on the port."""
        if message.autopilot != PX4:
            raise LinkError(
                f"vehicle {self.name!r}: must be flown by PX4 (autopilot 12), "
                f"got autopilot {message.autopilot}"
            )
        system, known = message.get_srcSystem(), self._target[0]
        if self._peer is not None and (peer, system) != (self._peer, known):
            first, second = (
                f"system {number} from {host}:{port}"
                for number, (host, port) in ((known, self._peer), (system, peer))
            )
            raise LinkError(
                f"vehicle {self.name!r}: {self.address} must be one vehicle's, "
                f"got {first} and {second}"
            )

    @property
    def mode(self) -> str:
        """The name of the mode that its last heartbeat said, for messages."""
        return mode_text(*self._mode)

    def beat(self) -> None:
        """Send a heartbeat once a second."""
        now = self._clock()
        if now - self._last_beat >= 1.0 and self._peer is not None:
            self._last_beat = now
            dialect = self._dialect
            kinds = dialect.MAV_TYPE_GCS, dialect.MAV_AUTOPILOT_INVALID
            self._send(dialect.MAVLink_heartbeat_message(*kinds, 0, 0, 0, 3))

    def steer(self, position: Vector, velocity: Vector, acceleration: Vector) -> None:
        """Send a setpoint.

        Parameters
        ----------
        position, velocity, acceleration : (3,) array
            East, north, up of the vehicle's local origin [m], [m/s], [m/s²].
        """
        parts = [_NORTH_EAST_DOWN @ part for part in (position, velocity, acceleration)]
        stamp = int(1000.0 * (self._clock() - self._begun)) & 0xFFFFFFFF
        frame = self._dialect.MAV_FRAME_LOCAL_NED
        numbers = [float(number) for part in parts for number in part]
        self._send(
            self._dialect.MAVLink_set_position_target_local_ned_message(
                stamp, *self._target, frame, _USE_ALL_BUT_YAW, *numbers, 0.0, 0.0
            )
        )

    def ask(self, what: str, times: int = 0) -> None:
        """Send a command.

        Parameters
        ----------
        what : {'offboard', 'hold', 'arming'}
            The mode, or to start motors.
        times : int
            How often it has been sent before.
        """
        command = self._command(what)
        if what == "arming":
            parts = 1.0, 0.0, 0.0
        else:
            self._asked = what
            main, sub = MODES[what]
            parts = 1.0, float(main), float(sub)
        self._send(
            self._dialect.MAVLink_command_long_message(
                *self._target, command, min(times, 255), *parts, 0.0, 0.0, 0.0, 0.0
            )
        )

    def forget(self, what: str) -> None:
        """Forget what was answered to a command, before it is sent for another reason.

        Parameters
        ----------
        what : str
            As in `ask`.
        """
        self._answers.pop(self._command(what), None)

    def has_answered(self, what: str) -> bool:
        """Whether anything has been answered to a command, that it is being carried out included.

        Parameters
        ----------
        what : str
            As in `ask`.
        """
        return self._command(what) in self._answers

    def answer(self, what: str) -> bool:
        """Whether a command has been accepted; not yet is no.

        Parameters
        ----------
        what : str
            As in `ask`.

        Raises
        ------
        LinkError
            If it has been refused.
        """
        result = self._answers.get(self._command(what))
        if result in {None, self._dialect.MAV_RESULT_IN_PROGRESS}:
            return False
        if result != self._dialect.MAV_RESULT_ACCEPTED:
            names = self._dialect.enums["MAV_RESULT"]
            word = names[result].name if result in names else f"result {result}"
            reason = word.removeprefix("MAV_RESULT_").lower().replace("_", " ")
            raise LinkError(f"vehicle {self.name!r}: {what} was refused ({reason})")
        return True

    def _command(self, what: str) -> int:
        """Return the number of a command."""
        if what == "arming":
            return int(self._dialect.MAV_CMD_COMPONENT_ARM_DISARM)
        return int(self._dialect.MAV_CMD_DO_SET_MODE)

    def _send(self, message: Any) -> None:
        """Send a message, if anybody was heard; a network that is away is noticed by silence."""
        if self._peer is None:
            return
        try:
            self._socket.sendto(message.pack(self._protocol), self._peer)
        except OSError:
            return
        self._protocol.seq = (self._protocol.seq + 1) % 256
