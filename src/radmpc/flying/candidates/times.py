"""How long a decision may still take, and what of that planning gets and judging needs."""

from __future__ import annotations

from collections.abc import Callable

from radmpc.flying.candidates.judging import NOT_IN_TIME, Candidate
from radmpc.records import dataclass

__all__ = ["CUT_OFF", "LATE", "NO_TIME", "DecisionTimes", "Timer"]

LATE = "the candidate came too late"
"""Why a candidate is not flown that is there when the decision is due."""

NO_TIME = "there was no time to plan"
"""Why no planner was asked."""

CUT_OFF = frozenset({LATE, NO_TIME, NOT_IN_TIME})
"""Why there is no other leg where the deadline left no time for one."""

_TELLING = 5e-4
"""Time before a deadline from which on the tail is flown [s]: the segments of eight vehicles take
0.2 ms of processor."""

_PLANNING_SHARE = 0.8
"""Share of the time to the deadline that planning gets at most [-]; the rest is for judging."""

_FADING = 0.7
"""Share of what judging, or an overrun, took once which the next one takes at least [-]: of a
dozen plans in a row of the harbor from where its vehicles were, planning ended 40 ms late once or
twice, the others 2 to 20."""

_SPREAD = 1.25
"""Time that judging may take in multiples of what the last one took a step [-]: at 1, 4 % of the
harbor's decisions within 0.15 s came late, by 2 to 13 ms."""


@dataclass(frozen=True, slots=True)
class Timer:
    """How long a decision may still take.

    Attributes
    ----------
    clock : callable
        Returns seconds.
    end : float
        When the decision is due, by that clock [s]; inf is never.
    """

    clock: Callable[[], float]
    end: float

    @property
    def left(self) -> float:
        """Seconds to the end; negative after it."""
        return self.end - self.clock()

    def is_over(self) -> bool:
        """Whether the decision is due."""
        return self.end < float("inf") and self.left < 0.0

    def is_nearly_over(self) -> bool:
        """Whether there is only time left to tell what was decided."""
        return self.left < _TELLING


@dataclass(slots=True)
class DecisionTimes:
    """How long judging took, and planning past its limit: what the next ones are expected to take.

    Attributes
    ----------
    judging : float
        To judge a step of a candidate [s]; 0 before any was.
    overrun : float
        Of planning [s]: planners look at the clock between pieces of work.
    """

    judging: float = 0.0
    overrun: float = 0.0

    def planning_seconds(self, timer: Timer, steps: int) -> float | None:
        """Return what planning may take, so that its plan is judged in time [s]; None: no limit.

        Parameters
        ----------
        timer : Timer
            Of the decision.
        steps : int
            To be planned.

        Returns
        -------
        float or None
            Where there is no time to plan, 0, and less is expected to be needed the next time.
        """
        if timer.end == float("inf"):
            return None
        # The longest piece of planning is mostly to judge a plan.
        judging = _SPREAD * self.judging * steps
        seconds = min(
            _PLANNING_SHARE * timer.left, timer.left - judging - max(judging, self.overrun)
        )
        if seconds <= 0.0:
            self.judging, self.overrun = _FADING * self.judging, _FADING * self.overrun
        return max(seconds, 0.0)

    def note_overrun(self, seconds: float) -> None:
        """Expect the next planning to end as late, or a little earlier than the latest before.

        Parameters
        ----------
        seconds : float
            Past its limit [s]; negative within it.
        """
        self.overrun = max(seconds, _FADING * self.overrun)

    def is_too_late(self, timer: Timer, steps: int) -> bool:
        """Whether a candidate that is there now is expected to be judged too late.

        Parameters
        ----------
        timer : Timer
            Of the decision.
        steps : int
            That it has.
        """
        return timer.left <= _SPREAD * self.judging * steps

    def in_time(self, judge: Callable[[], Candidate], timer: Timer, steps: int) -> Candidate:
        """Judge a candidate, if that is expected to end before the decision is due.

        Parameters
        ----------
        judge : callable
            Judges it.
        timer : Timer
            Of the decision.
        steps : int
            That it has.

        Returns
        -------
        Candidate
            Without a leg where it was not, or came too late.
        """
        if self.is_too_late(timer, steps):
            self.judging *= _FADING
            return Candidate(None, None, LATE)
        begun = timer.clock()
        found = judge()
        if found.price is not None:
            self.judging = max((timer.clock() - begun) / steps, _FADING * self.judging)
        return Candidate(None, found.price, LATE) if timer.is_over() else found
