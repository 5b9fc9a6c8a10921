"""When a planner told of its first plan."""

from __future__ import annotations

import math
import time

from radmpc.model.plan import FirstPlan
from radmpc.planners.planner import TellBest

__all__ = ["NotingFirst"]


class NotingFirst:
    """Notes when the first plan is told of, and tells on.

    Parameters
    ----------
    found : callable
        Takes the cost of the best plan so far, and a lower bound or None.
    begun : float
        Value of ``time.perf_counter()`` when planning began.

    Attributes
    ----------
    first : FirstPlan or None
        The first plan; None before it.
    """

    def __init__(self, found: TellBest, begun: float) -> None:
        self._found, self._begun = found, begun
        self.first: FirstPlan | None = None

    def __call__(self, cost: float, bound: float | None) -> None:
        """Tell of a plan."""
        if self.first is None and math.isfinite(cost):
            self.first = FirstPlan(time.perf_counter() - self._begun, float(cost))
        self._found(cost, bound)
