"""Where a vehicle may be at all in a plan that costs less than the one at hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.program.condensed import CondensedModel
from radmpc.program.program import DisjunctiveProgram
from radmpc.solvers.lp.highs_lp import HighsLp, LpOutcome
from radmpc.solvers.solution import Limits

__all__ = ["within_tube"]


def within_tube(
    model: CondensedModel, program: DisjunctiveProgram, most_cost: float, limits: Limits
) -> CondensedModel:
    """Return a vehicle whose reach is that of plans up to a cost.

    Two linear programs per axis and step, without hazards. What they prove bounds the reach, so
    that a solver's tolerances do no harm.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    program : DisjunctiveProgram
        Of this vehicle alone: its hard rows and outputs are used.
    most_cost : float
        The cost.
    limits : Limits
        When to stop early, with the reach that is known by then.
    """
    lower, upper = model.reach_lower.copy(), model.reach_upper.copy()
    shape = lower.shape
    positions, constant = program.outputs[: program.num_positions], program.constant
    for entry in range(shape[1], program.num_positions):
        if limits.reached:
            break
        along = positions[[entry]].toarray()[0]
        place = np.unravel_index(entry, shape)
        least = _least(program, along, most_cost) + constant[entry]
        most = constant[entry] - _least(program, -along, most_cost)
        lower[place] = min(max(lower[place], least), model.reach_upper[place])
        upper[place] = max(min(upper[place], most), lower[place])
    return replace(model, reach_lower=_kept(lower), reach_upper=_kept(upper))


def _least(program: DisjunctiveProgram, along: Vector, most_cost: float) -> float:
    """Return the proven least of a linear function over the plans of a vehicle up to a cost."""
    lp = HighsLp(along, program.lower, program.upper)
    lp.add_rows(program.hard, program.hard_lower, program.hard_upper)
    columns = np.arange(program.num_columns, dtype=np.int32)
    lp.add_row(columns, program.cost, -np.inf, most_cost)
    outcome, bound = lp.solve()
    return bound if outcome is LpOutcome.OPTIMAL else -np.inf


def _kept(places: Matrix) -> Matrix:
    """Return an array that nobody writes to."""
    places.setflags(write=False)
    return places
