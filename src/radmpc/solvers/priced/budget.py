"""Branch and bound over alternatives and risks within a hard risk budget.

Prices find the plans on the lower convex hull of cost over risk; where alternatives change, the
best plan within a budget may lie above the hull, and no price finds it. Here the budget is the
unit, which the linear programs keep anyway, and the price only breaks ties.
"""

from __future__ import annotations

from radmpc.solvers.priced.tree import RiskTree
from radmpc.solvers.priced.value import Precision

__all__ = ["OVER", "BudgetTree"]

OVER = 2e-6
"""Share of the budget by which a candidate may exceed it [-]: what tangents and solver leave."""

_MISSING = 0.5 * OVER
"""Units by which the risk of chosen rows may be underestimated in all [-]; more tangents
otherwise."""


class BudgetTree(RiskTree):
    """The search for the least cost within a budget; see `RiskTree`, whose unit is the budget."""

    @classmethod
    def precision(cls, gap: float, scale: float) -> Precision:
        """Return how exact it is: a hard budget takes more tangents.

        Parameters
        ----------
        gap, scale : float
            As in `Precision`.
        """
        return Precision(gap, scale, rounds=60, most_units=1.0 + OVER, missing=_MISSING)
