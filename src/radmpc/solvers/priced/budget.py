"""Branch and bound over alternatives and risks within a hard risk budget.

Prices find the plans on the lower convex hull of cost over risk; where alternatives change, the
best plan within a budget may lie above the hull, and no price finds it. Here the budget is the
unit, which the linear programs keep anyway, and the price only breaks ties.
"""

from __future__ import annotations

from radmpc.arrays import Vector
from radmpc.solvers.priced.rating import Rating
from radmpc.solvers.priced.tree import RiskTree

__all__ = ["OVER", "BudgetTree"]

OVER = 2e-6
"""Share of the budget by which a candidate may exceed it [-]: what tangents and solver leave."""

_MISSING = 0.5 * OVER
"""Units by which the risk of chosen rows may be underestimated in all [-]; more tangents
otherwise."""


class BudgetTree(RiskTree):
    """The search for the least cost within a budget; see `RiskTree`, whose unit is the budget."""

    rounds = 60
    """Times that a node's linear program is solved at most: a hard budget takes more tangents."""

    def _worth(self, z: Vector, rating: Rating) -> float:
        """Return a point's value; inf beyond the budget."""
        return float("inf") if rating.risk > (1.0 + OVER) * self.unit else super()._worth(z, rating)

    def _refine(self, point: Vector, rating: Rating, tolerance: float) -> bool:
        """Add tangents where a point within the budget by them is beyond it in truth."""
        if super()._refine(point, rating, tolerance):
            return True
        is_beyond = rating.risk > (1.0 + OVER) * self.unit
        return is_beyond and self.lp.refine(rating, point, _MISSING)
