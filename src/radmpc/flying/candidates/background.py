"""Planning for the next step while this one is flown, on an executor that is given."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import CancelledError, Executor, Future, wait
from typing import TYPE_CHECKING

from radmpc.arrays import Vector
from radmpc.flying.candidates.judging import Candidate, Order, Planning, failed, judged
from radmpc.flying.warm.goals import widened
from radmpc.model.scenario import Scenario
from radmpc.referee.conditional.scales import Scale

if TYPE_CHECKING:
    from radmpc.model.plan import Plan
    from radmpc.result import Result

__all__ = ["Background"]


class Background:
    """One order at a time, given out at a step and judged at a later one.

    What comes of it is data: it is judged by what is measured when it has come, however late, and
    whatever became of it costs nothing.

    Parameters
    ----------
    planning : callable
        What plans; pickles if the executor is of processes.
    executor : Executor
        Where; its owner shuts it down.
    """

    def __init__(self, planning: Planning, executor: Executor) -> None:
        self._planning = planning
        self._executor = executor
        self._asked: tuple[Scenario, int, Scale, bool] | None = None
        self._future: Future[tuple[Result | Plan | None, Scenario]] | None = None
        self._refusal: Exception | None = None

    def begin(self, left: Scenario, step: int, scale: Scale, seconds: float | None) -> None:
        """Give out an order, unless the last one is still being worked on.

        Parameters
        ----------
        left : Scenario
            The steps that are left by then, from expected states.
        step : int
            Of the mission, to come.
        scale : Scale
            What the scenario takes for known of the factor of covariances.
        seconds : float or None
            What planning may take [s].
        """
        if self._future is not None:
            return
        self._asked, self._refusal = (left, step, scale, seconds is not None), None
        try:
            self._future = self._executor.submit(_planned, self._planning, left, seconds)
        except Exception as error:
            self._refusal = error

    def wait(self, seconds: float | None = None) -> bool:
        """Wait until the order has been worked on; return whether none is left.

        Parameters
        ----------
        seconds : float or None
            At most; None is as long as it takes.
        """
        return self._future is None or not wait([self._future], seconds).not_done

    def arrived(self, step: int, states: Sequence[Vector], scale: Scale) -> Candidate | None:
        """Return what came of the order, given what is measured; None where there was none.

        Parameters
        ----------
        step : int
            Of the mission.
        states : sequence of (n,) array
            Measured there.
        scale : Scale
            What is known there of the factor of covariances.
        """
        asked, refusal = self._asked, self._refusal
        if asked is None:
            return None
        if refusal is not None:
            self._asked = self._refusal = None
            return failed(refusal)
        if self._future is None or not self._future.done():
            return Candidate(None, None, "the plan made in the background is late")
        future, self._future, self._asked = self._future, None, None
        try:
            answer, wide = future.result()
        except (Exception, CancelledError) as error:
            return failed(error)
        return judged(answer, Order(asked[0], wide, *asked[1:]), step, states, scale)

    def close(self) -> None:
        """Give up the order; one that has begun runs to its end, unheard."""
        if self._future is not None:
            self._future.cancel()
        self._asked = self._future = self._refusal = None


def _planned(
    planning: Planning, left: Scenario, seconds: float | None
) -> tuple[Result | Plan | None, Scenario]:
    """Plan, in whatever process; return the scenario with the goals that were asked for, too."""
    wide = widened(left)
    return planning(wide, seconds), wide
