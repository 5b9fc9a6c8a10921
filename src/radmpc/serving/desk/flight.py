"""A flight: under way in a process of its own, or read from its file."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from typing import Any, Literal

from radmpc.serving.failures import CallError
from radmpc.serving.processes.crew import Crew
from radmpc.serving.processes.worker import Worker
from radmpc.serving.protocol import FlightState, TickView

__all__ = ["OpenFlight"]

_PATIENCE = 20.0
"""Seconds that a flight which was stopped may take to end its tick [s]; then it is killed."""


class OpenFlight:
    """A flight, from its start to its end.

    Parameters
    ----------
    number : str
        By which pages name it.
    document, plan : str
        What is flown.
    steps : int
        Of the whole mission.
    risk_bound : float
        Δ [-].
    ticks : sequence of TickView
        What is known of it already.
    note : str or None
        How it ended; None where it is yet to begin.

    Attributes
    ----------
    log : object
        The place of the file that it writes, None if it writes none.
    """

    def __init__(
        self,
        number: str,
        document: str,
        plan: str,
        steps: int,
        risk_bound: float,
        *,
        ticks: Sequence[TickView] = (),
        note: str | None = None,
    ) -> None:
        self.number, self.document, self.plan = number, document, plan
        self.steps, self.risk_bound = steps, risk_bound
        self.ticks: list[TickView] = list(ticks)
        self.log: object = None
        self._note, self._is_over, self._has_failed = note, note is not None, False
        self._worker: Worker | None = None
        self._is_stopped = False
        self._task: asyncio.Task[None] | None = None

    @property
    def is_over(self) -> bool:
        """Whether it has ended."""
        return self._is_over

    @property
    def state(self) -> FlightState:
        """What pages are told."""
        state: Literal["running", "ended", "failed"] = "running"
        if self._is_over:
            state = "failed" if self._has_failed else "ended"
        return {
            "flight": self.number,
            "document": self.document,
            "plan": self.plan,
            "state": state,
            "step": self.ticks[-1]["step"] if self.ticks else 0,
            "steps": self.steps,
            "riskBound": self.risk_bound,
            "ticks": list(self.ticks),
            "note": self._note,
        }

    def begin(
        self,
        crew: Crew,
        args: Sequence[object],
        *,
        changed: Callable[[OpenFlight], None],
        ticked: Callable[[OpenFlight, TickView], None],
    ) -> None:
        """Begin, in a process of the crew.

        Parameters
        ----------
        crew : Crew
            Of the server.
        args : sequence
            What the job takes.
        changed, ticked : callable
            Called with the flight, and with its ticks.
        """
        running = self._run(crew, args, changed, ticked)
        self._task = asyncio.get_running_loop().create_task(running)

    def stop(self) -> None:
        """End after this tick."""
        self._is_stopped = True
        if self._worker is not None:
            self._worker.stop()
            asyncio.get_running_loop().call_later(_PATIENCE, self._give_up)

    async def _run(
        self,
        crew: Crew,
        args: Sequence[object],
        changed: Callable[[OpenFlight], None],
        ticked: Callable[[OpenFlight, TickView], None],
    ) -> None:
        """Fly, and tell."""

        def take(kind: str, news: Any) -> None:
            if kind == "tick":
                self.ticks.append(news)
                ticked(self, news)

        try:
            async with crew.worker() as worker:
                self._worker = worker
                try:
                    note = "stopped before it began"
                    if not self._is_stopped:
                        note = await worker.run("fly", *args, listener=take)
                finally:
                    self._worker = None
                self._note = note
        except CallError as error:
            self._has_failed, self._note = True, str(error)
        except Exception as error:
            # Else it would seem to go on for ever.
            self._has_failed, self._note = True, f"internal error: {type(error).__name__}"
        self._is_over = True
        changed(self)

    def _give_up(self) -> None:
        """Kill what does not end when asked to."""
        if self._worker is not None and not self._is_over:
            self._worker.kill()
