"""Setpoints for vehicles over MAVLink, streamed while others decide, and what vehicles say."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.simulators.link import Link, LinkError
from radmpc.simulators.tracking import Reference

__all__ = ["STALE", "Stream"]

STALE = 0.5
"""Age from which a state is no measurement [s]: at 2 m/s a meter."""

_AGAIN = 1.0
"""After which a command without an answer is sent again [s]: datagrams may be lost."""

_TIMES = 3
"""How often a vehicle is told to hold when nobody waits for its answer [-]: one may be lost."""


class Stream:
    """A thread that sends where to be now, and takes what has arrived.

    Parameters
    ----------
    links : sequence of Link
        To the vehicles; closed with the stream.
    period : float
        Between setpoints [s].
    dt : float
        Step [s]: a reference is followed for another one, and then vehicles stay where it led.
    patience : float
        Longest silence, and longest wait for anything [s].
    clock, sleep : callable
        Return seconds, and wait some.
    """

    def __init__(
        self,
        links: Sequence[Link],
        period: float,
        dt: float,
        patience: float,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self._links, self._period, self._dt, self._patience = links, period, dt, patience
        self._clock, self._sleep = clock, sleep
        self._lock = threading.RLock()
        self._stopped = threading.Event()
        self._failure: LinkError | None = None
        self._program: tuple[float, Reference] | None = None
        self._samples: list[tuple[float, Matrix]] = []
        self._thread = threading.Thread(target=self._run, name="mavlink", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Tell vehicles to hold that are in offboard mode, let go of all; nothing runs on."""
        self._stopped.set()
        self._thread.join()
        for link in self._links:
            # What a pilot or a failsafe flies is left alone.
            for _ in range(_TIMES if link.is_ours else 0):
                link.ask("hold")
            link.close()

    def take_command(self) -> None:
        """Have every vehicle fly what is streamed, and notice from then on if one does not.

        Raises
        ------
        LinkError
            If one refuses, does not answer, or does not do what it accepted.
        """
        for what in ("offboard", "arming"):
            self.command(what)
        links = self._links
        self.wait_for(
            lambda i: links[i].is_offboard, "accepts offboard mode, and does not enter it"
        )
        self.wait_for(lambda i: links[i].is_armed, "accepts arming, and is not armed")
        with self._lock:
            for link in links:
                link.is_watched = True

    def follow(self, begun: float, reference: Reference) -> None:
        """Steer along a reference from now on.

        Parameters
        ----------
        begun : float
            When it begins, by the clock [s].
        reference : Reference
            In the vehicles' own frames, in space.
        """
        with self._lock:
            self._program = begun, reference

    def hold(self, places: Matrix) -> None:
        """Steer for places and stay there.

        Parameters
        ----------
        places : (N, 3) array
            In the vehicles' own frames [m].
        """
        self.follow(self._clock(), Reference(places, np.zeros_like(places), np.zeros_like(places)))

    def visited(self) -> tuple[Vector, Tensor]:
        """Return when and where all vehicles were since this was last asked, decisions included.

        Returns
        -------
        times : (S,) array
            By the clock [s].
        places : (S, N, 3) array
            In their own frames [m].
        """
        with self._lock:
            samples, self._samples = self._samples, []
        places = np.array([place for _, place in samples]).reshape(-1, len(self._links), 3)
        return np.array([moment for moment, _ in samples], dtype=np.float64), places

    def measured(self) -> tuple[Matrix, Matrix]:
        """Return positions and velocities now, (N, 3) each; what is stale is not a number."""
        places, velocities = np.full((2, len(self._links), 3), np.nan)
        with self._lock:
            now = self._clock()
            for i, link in enumerate(self._links):
                if link.fix is not None and now - link.fix.time < STALE:
                    places[i], velocities[i] = link.fix.at(now), link.fix.velocity
        return places, velocities

    def command(self, what: str) -> None:
        """Ask every vehicle for something, again if it does not answer, until all have accepted.

        Parameters
        ----------
        what : {'offboard', 'hold', 'arming'}
            The mode, or to start motors.

        Raises
        ------
        LinkError
            If one refuses, or does not answer.
        """
        asked = [(-np.inf, 0)] * len(self._links)

        def has_accepted(i: int) -> bool:
            link, now, (last, times) = self._links[i], self._clock(), asked[i]
            if link.has_answered(what):
                return link.answer(what)
            if now - last >= _AGAIN:
                link.ask(what, times)
                asked[i] = now, times + 1
            return False

        with self._lock:
            for link in self._links:
                link.forget(what)
        self.wait_for(has_accepted, f"does not answer to {what}")

    def wait_for(self, has: Callable[[int], bool], lack: str) -> None:
        """Wait until all vehicles have something.

        Parameters
        ----------
        has : callable
            Whether the vehicle of a number has it.
        lack : str
            What is wrong with one that has not.

        Raises
        ------
        LinkError
            If one has not in time.
        """
        end = self._clock() + self._patience
        while True:
            with self._lock:
                lacking = [link for i, link in enumerate(self._links) if not has(i)]
            if not lacking:
                return
            if self._failure is not None:
                raise self._failure
            if self._clock() > end:
                link = lacking[0]
                if not np.isfinite(link.heard):
                    lack = f"nothing is heard at {link.address}"
                raise LinkError(f"vehicle {link.name!r}: {lack}, waited {self._patience:g} s")
            self._sleep(self._period)

    def wait_until(self, moment: float) -> None:
        """Wait, as long as all vehicles are heard.

        Parameters
        ----------
        moment : float
            By the clock [s].

        Raises
        ------
        LinkError
            If one is lost.
        """
        while True:
            now = self._clock()
            if self._failure is not None:
                raise self._failure
            for link in self._links:
                if now - link.heard > self._patience:
                    raise LinkError(f"vehicle {link.name!r}: not heard for {self._patience:g} s")
            if now >= moment:
                return
            self._sleep(min(self._period, moment - now))

    def _run(self) -> None:
        """Send and receive until stopped: what the thread does."""
        while not self._stopped.is_set():
            try:
                with self._lock:
                    self._exchange()
            except LinkError as error:
                self._failure = error
                return
            self._sleep(self._period)

    def _exchange(self) -> None:
        """Take what has arrived, and send where to be now."""
        for link in self._links:
            link.receive()
            link.beat()
            if link.is_watched and not link.is_offboard:
                raise LinkError(
                    f"vehicle {link.name!r}: left offboard mode ({link.mode}): a pilot or a "
                    "failsafe has taken over"
                )
            if link.is_watched and not link.is_armed:
                raise LinkError(f"vehicle {link.name!r}: was disarmed")
        if self._program is None:
            return
        now = self._clock()
        begun, reference = self._program
        places, velocities = reference.at(min(now - begun, 2.0 * self._dt))
        pushes = reference.accelerations
        if now - begun > 2.0 * self._dt:
            # Beyond the step and another one it is nobody's plan any more: stay there.
            velocities, pushes = np.zeros_like(velocities), np.zeros_like(pushes)
        for i, link in enumerate(self._links):
            link.steer(places[i], velocities[i], pushes[i])
        fixes = [link.fix for link in self._links]
        if all(fix is not None and now - fix.time < STALE for fix in fixes):
            where = np.array([fix.at(now) for fix in fixes if fix is not None])
            self._samples.append((now, where))
