"""Planning in a worker: news while it goes on, and in the end the plan or why there is none."""

from __future__ import annotations

import time
from dataclasses import replace

from radmpc.io.native.decoding import decode_scenario
from radmpc.planning import plan
from radmpc.serving.protocol import Remark
from radmpc.serving.work.asking import Asked, Ended, asked_planner
from radmpc.serving.work.control import Control

__all__ = ["plan_content"]

_PAUSE = 0.1
"""Seconds between two pieces of news that nobody could read faster."""


def plan_content(control: Control, asked: Asked) -> Ended:
    """Plan a document.

    Parameters
    ----------
    control : Control
        Receives ``progress``, costs ``found``, and plans that ``improved``.
    asked : Asked
        What is planned, and how.
    """
    news = _News(control)
    control.tell("begun", None)
    scenario = decode_scenario(asked.content)
    if asked.risk_bound is not None:
        scenario = replace(scenario, risk_bound=asked.risk_bound)
    result = plan(
        scenario,
        asked_planner(asked),
        time_limit=asked.seconds,
        progress=news.progress,
        found=news.found,
        improved=lambda better: control.tell("improved", better),
        stop=control.is_stopped,
    )
    record = result.record
    remarks: tuple[Remark, ...] = ()
    if not result.is_certified:
        from radmpc.serving.work.reasons import remarks_of  # noqa: PLC0415 - loads the preflight checks; few need it

        remarks = remarks_of(record)
    return Ended(record, remarks)


class _News:
    """Tells the server what it may want to show, and no more often than that."""

    def __init__(self, control: Control) -> None:
        self._control = control
        self._stage, self._next = "", 0.0

    def progress(self, stage: str, done: int, total: int | None) -> None:
        """Tell what planning is at."""
        if stage == self._stage and not self._is_due():
            return
        self._stage = stage
        self._control.tell("progress", (stage, done, total))

    def found(self, cost: float, bound: float | None) -> None:
        """Tell what the best plan costs."""
        self._control.tell("found", (cost, bound))

    def _is_due(self) -> bool:
        """Whether it is time for the next piece of news."""
        now = time.perf_counter()
        if now < self._next:
            return False
        self._next = now + _PAUSE
        return True
