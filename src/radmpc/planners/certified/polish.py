"""From the best sides at a price of risk to a plan within the bound, exactly."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Vector
from radmpc.gaussian import clearance_for
from radmpc.planners.certified.problem import SetProblem
from radmpc.solvers.lp import LpOutcome, WarmLp
from radmpc.solvers.risk_tree import Incumbent

__all__ = ["polish"]

_ROUNDS = 4
_LEAST = 1e-9
"""Share of the budget that every row is granted at least."""

_SLACK = 1e-6
"""Share of the budget kept back, so that the solver's tolerance cannot exceed it."""


def polish(
    problems: Sequence[SetProblem], found: Sequence[Incumbent], budget: float
) -> tuple[Vector, ...] | None:
    """Fit a fleet's risks to a budget, every side as it is.

    The risks that the rows run are scaled to the budget and given back as fixed margins; at the
    price where the budget is just used that is optimal, near it nearly so.

    Parameters
    ----------
    problems : sequence of SetProblem
        The sets.
    found : sequence of Incumbent
        The plan of each.
    budget : float
        What the rows of all sets may risk together.

    Returns
    -------
    tuple of (n,) array or None
        Points whose true risks stay within the budget; None where these sides do not allow it.
    """
    if budget <= 0.0:
        return None
    points = [incumbent.z for incumbent in found]
    best, least = None, float("inf")
    for _ in range(_ROUNDS):
        risks = [
            p.program.event_risks(z, i.selection)
            for p, z, i in zip(problems, points, found, strict=True)
        ]
        total = float(sum(r.sum() for r in risks))
        if total <= budget:
            cost = sum(float(p.program.cost @ z) for p, z in zip(problems, points, strict=True))
            if cost >= least * (1.0 - 1e-5):
                return best if best is not None and cost >= least else tuple(points)
            best, least = tuple(points), cost
            if total >= budget * (1.0 - 1e-3):
                return best
        scale = budget * (1.0 - _SLACK) / max(total, 1e-300)
        moved = []
        for problem, incumbent, z, risk in zip(problems, found, points, risks, strict=True):
            if float(risk.sum()) <= _LEAST * budget:
                moved.append(z)
                continue
            granted = np.clip(risk * scale, _LEAST * budget, 0.49)
            z_new = _at(problem, incumbent, granted)
            if z_new is None:
                return best
            moved.append(z_new)
        points = moved
    return best


def _at(problem: SetProblem, incumbent: Incumbent, granted: Vector) -> Vector | None:
    """Return the least-cost point of a set whose events take at most what they are granted."""
    rows = problem.program.rows
    chosen = problem.program.selected_rows(incumbent.selection)
    margins = np.zeros(rows.count)
    margins[chosen] = rows.deviations[chosen] * clearance_for(granted[rows.events[chosen]])
    lp = WarmLp(problem.program, margins)
    lp.activate(chosen.tolist())
    outcome, _ = lp.solve()
    return lp.point() if outcome is LpOutcome.OPTIMAL else None
