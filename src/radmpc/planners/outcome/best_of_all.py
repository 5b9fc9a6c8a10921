"""What is told of plans of one assignment after the other: of all of them, as of one problem."""

from __future__ import annotations

from collections.abc import Callable

from radmpc.model.plan import Plan
from radmpc.planners.planner import TellBest

__all__ = ["BestOfAll", "Cheaper"]


class Cheaper:
    """Hands on every plan that is cheaper than all before it, of whichever assignment.

    Parameters
    ----------
    improved : callable
        Takes the plans.

    Attributes
    ----------
    least : float
        Cost of the last one; inf before the first.
    """

    def __init__(self, improved: Callable[[Plan], None]) -> None:
        self._improved = improved
        self.least = float("inf")

    def __call__(self, plan: Plan) -> None:
        """Hand a plan on, unless it is dearer."""
        if plan.cost is not None and plan.cost < self.least:
            self.least = plan.cost
            self._improved(plan)


class BestOfAll:
    """Tells what the best plan so far costs, and what plans of any assignment cost at least.

    Parameters
    ----------
    found : callable
        Told both, as in `Run`.
    """

    def __init__(self, found: TellBest) -> None:
        self._found = found
        self._cost, self._bound = float("inf"), -float("inf")

    def while_planning(self, floor: float, others: float) -> TellBest:
        """Return what one assignment is to tell; plans dearer than the best so far are left out.

        Parameters
        ----------
        floor : float
            What its plans cost at least, whatever comes of planning it.
        others : float
            What plans of all others cost at least.
        """

        def tell(cost: float, bound: float | None) -> None:
            if cost <= self._cost:
                self._cost = cost
                own = floor if bound is None else max(bound, floor)
                self.settle(min(own, others))

        return tell

    def settle(self, bound: float) -> None:
        """Tell the best plan, and the best bound so far; nothing before the first plan.

        Parameters
        ----------
        bound : float
            What plans of any assignment cost at least.
        """
        self._bound = max(self._bound, bound)
        if self._cost < float("inf"):
            self._found(self._cost, min(self._bound, self._cost))
