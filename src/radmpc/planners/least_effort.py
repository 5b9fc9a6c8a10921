"""What one vehicle costs at least with nothing in the way, and the controls that take it there."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix
from radmpc.program.assembly import decision_columns
from radmpc.program.condensed import CondensedModel
from radmpc.records import dataclass
from radmpc.solvers.lp.choosing import bounded_lp
from radmpc.solvers.lp.outcome import LpOutcome

__all__ = ["LeastEffort", "least_effort"]


@dataclass(frozen=True, slots=True, eq=False)
class LeastEffort:
    """The plan of one vehicle in empty space.

    Attributes
    ----------
    cost : float
        Proven least cost; 0 where it cannot reach its goal.
    controls : (T, m) array or None
        The plan; None where there is none, or where steps of visits are open.
    """

    cost: float
    controls: Matrix | None


def least_effort(model: CondensedModel) -> LeastEffort:
    """Return a vehicle's plan in empty space, made once.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    """
    return model.kept.once(_least_effort, model)


def _least_effort(model: CondensedModel) -> LeastEffort:
    """Make it."""
    columns = decision_columns((model,))
    lp = bounded_lp(columns.cost, columns.lower, columns.upper)
    lp.add_rows(columns.hard, columns.hard_lower, columns.hard_upper)
    outcome, cost = lp.solve()
    if outcome is not LpOutcome.OPTIMAL:
        return LeastEffort(0.0, None)
    if columns.times is not None:
        return LeastEffort(cost, None)
    plus, minus = np.split(lp.point(), 2)
    return LeastEffort(cost, (plus - minus).reshape(model.control_bounds.shape))
