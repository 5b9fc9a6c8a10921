"""A search in a process of its own: its state, and what may be done with it."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from typing import Any, Literal

from radmpc.model.plan import Plan
from radmpc.serving.failures import CallError
from radmpc.serving.processes.crew import Crew
from radmpc.serving.processes.worker import Worker
from radmpc.serving.protocol import SearchState
from radmpc.serving.views.numbers import significant
from radmpc.serving.wording import for_page
from radmpc.serving.work.asking import Asked, Ended

__all__ = ["Search"]

_PATIENCE = 15.0
"""Seconds that a search which was stopped, or has used its time, may take to end [s]; then it is
killed, and its best plan kept."""

_TICK = 0.25
"""Seconds between two tellings of a search that runs [s]."""


class Search:
    """A search, from its start to its end.

    Parameters
    ----------
    number : str
        By which pages name it.
    document, revision
        What is planned.
    asked : Asked
        How.
    changed : callable
        Called with the search when its state has changed.
    improved : callable
        Given every plan better than those before, and the one it ends with.
    """

    def __init__(
        self,
        number: str,
        document: str,
        revision: int,
        asked: Asked,
        *,
        changed: Callable[[Search], None],
        improved: Callable[[Search, Plan, Ended | None], None],
    ) -> None:
        self.number, self.document, self.revision = number, document, revision
        self.asked = asked
        self._changed, self._improved = changed, improved
        self._worker: Worker | None = None
        self._is_over, self._has_failed, self._is_stopped = False, False, False
        self._stage = "starting"
        self._note: str | None = None
        self._cost: float | None = None
        self._bound: float | None = None
        self._found = 0
        self._has_news = False
        self._begun: float | None = None
        self._held = 0.0
        self._held_since: float | None = None
        self._ended: float | None = None
        self._task: asyncio.Task[None] | None = None

    @property
    def is_over(self) -> bool:
        """Whether it has ended."""
        return self._is_over

    @property
    def seconds(self) -> float:
        """How long it has searched, pauses not counted [s]."""
        if self._begun is None:
            return 0.0  # the process is still loading
        now = self._ended or self._held_since or time.monotonic()
        return now - self._begun - self._held

    @property
    def state(self) -> SearchState:
        """What pages are told."""
        gap, bound = None, self._bound
        if self._cost is not None and bound is not None:
            # A plan with half-spaces of any direction may cost less than any by faces.
            bound = min(bound, self._cost)
            gap = (self._cost - bound) / self._cost if self._cost > 0.0 else 0.0
        state: Literal["running", "paused", "ended", "failed"] = "running"
        if self._is_over:
            state = "failed" if self._has_failed else "ended"
        elif self._held_since is not None:
            state = "paused"
        return {
            "search": self.number,
            "document": self.document,
            "revision": self.revision,
            "planner": self.asked.planner,
            "state": state,
            "seconds": round(self.seconds, 2),
            "limit": self.asked.seconds,
            "stage": self._stage,
            "cost": significant(self._cost),
            "bound": significant(bound),
            "gap": significant(gap),
            "found": self._found,
            "note": self._note,
        }

    def begin(self, crew: Crew) -> None:
        """Begin, in a process of the crew."""
        self._task = asyncio.get_running_loop().create_task(self._run(crew))

    def stop(self) -> None:
        """End with the best plan so far."""
        self.resume()
        self._is_stopped = True
        if self._worker is not None:
            self._worker.stop()
            asyncio.get_running_loop().call_later(_PATIENCE, self._give_up)

    def pause(self) -> None:
        """Stand still; the time limit does, too. One that was stopped goes on to its end."""
        is_free = not (self._is_over or self._is_stopped)
        if self._worker is not None and is_free and self._held_since is None:
            self._worker.hold()
            self._held_since = time.monotonic()
            self._changed(self)

    def resume(self) -> None:
        """Go on."""
        if self._worker is not None and self._held_since is not None:
            self._held += time.monotonic() - self._held_since
            self._held_since = None
            self._worker.go_on()
            self._changed(self)

    async def _run(self, crew: Crew) -> None:
        """Search, and tell."""
        try:
            async with crew.worker() as worker:
                self._worker = worker
                if self._is_stopped:
                    self._end("stopped before it began")
                    return
                ticking = asyncio.get_running_loop().create_task(self._tick())
                try:
                    ended = await worker.run("plan", self.asked, listener=self._take)
                finally:
                    ticking.cancel()
                    self._worker = None
                self._finish(ended)
        except CallError as error:
            self._fail(error)
        except Exception as error:
            # Else it would seem to go on for ever.
            self._fail(CallError("internal", f"internal error: {type(error).__name__}"))

    def _finish(self, ended: Ended) -> None:
        """Take the plan at the end, or none."""
        plan = ended.plan
        if plan.cost is not None:
            self._cost = plan.cost
            # Planners that tell of none on the way end with one all the same.
            self._found = max(self._found, 1)
        bounds = [b for b in (plan.lower_bound, plan.certified_lower_bound) if b is not None]
        self._bound = max(bounds, default=self._bound)
        self._improved(self, plan, ended)
        self._end(for_page(plan.status_sentence))

    def _fail(self, error: CallError) -> None:
        """Take an end without an answer."""
        if self._is_stopped and self._found:
            self._end("stopped; the best plan so far is kept")
            return
        self._has_failed = True
        kept = "; the best plan so far is kept" if self._found else ""
        self._end(f"{error}{kept}")

    def _end(self, note: str) -> None:
        """Be over."""
        self._ended = self._held_since or time.monotonic()
        self._held_since = None
        self._is_over, self._note, self._stage = True, note, ""
        self._changed(self)

    def _give_up(self) -> None:
        """Kill what does not end when asked to."""
        if self._worker is not None and not self._is_over:
            self._worker.kill()

    def _take(self, kind: str, news: Any) -> None:
        """Take news of the worker."""
        if kind == "begun":
            self._begun, self._stage = time.monotonic() - self._held, "planning"
        elif kind == "progress":
            stage, done, total = news
            self._stage = f"{stage} {done}/{total}" if total and total > 1 else str(stage)
        elif kind == "found":
            cost, bound = news
            self._stage = "first plans" if self._stage == "planning" else self._stage
            if self._cost is None or cost < self._cost:
                self._cost = float(cost)
            self._bound = self._bound if bound is None else float(bound)
        elif kind == "improved":
            self._found += 1
            self._cost = news.cost
            self._improved(self, news, None)
            self._changed(self)
            return
        self._has_news = True

    async def _tick(self) -> None:
        """Tell the state now and then while it changes, and look after the time limit."""
        late = 1.5 * self.asked.seconds + 2.0 * _PATIENCE
        while not self._is_over:
            await asyncio.sleep(_TICK)
            if self._has_news:
                self._has_news = False
                self._changed(self)
            if self.seconds > late:
                self._is_stopped = True
                self._give_up()
