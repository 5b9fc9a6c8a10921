"""Where a vehicle may be at all in a plan that costs less than the one at hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.model.scenario import Scenario
from radmpc.program.build import build_program
from radmpc.program.condensed import CondensedModel
from radmpc.program.program import DisjunctiveProgram
from radmpc.solvers.lp.bounded_lp import BoundedLp
from radmpc.solvers.lp.choosing import bounded_lp
from radmpc.solvers.lp.outcome import LpOutcome
from radmpc.solvers.solution import Limits

__all__ = ["in_empty_space", "within_tube"]


def in_empty_space(scenario: Scenario, model: CondensedModel) -> DisjunctiveProgram:
    """Return the program of a vehicle alone, without any obstacles.

    Among two hundred boxes it takes a tenth of the memory of that with them.

    Parameters
    ----------
    scenario : Scenario
        The vehicle's, whatever others are in it.
    model : CondensedModel
        The vehicle.
    """
    alone = scenario.with_vehicles([model.vehicle], [])
    return build_program(alone, (model,), risk_bound=scenario.risk_bound)


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
        Of this vehicle alone, see `in_empty_space`: its hard rows and outputs are used.
    most_cost : float
        The cost.
    limits : Limits
        When to stop early, with the reach that is known by then.
    """
    lower, upper = model.reach_lower.copy(), model.reach_upper.copy()
    shape = lower.shape
    lp = _cheap_plans(program, most_cost)
    places = np.unravel_index(np.arange(shape[1], program.num_positions), shape)
    along = program.outputs[shape[1] : program.num_positions].toarray()
    constant = program.constant[shape[1] : program.num_positions]
    least, most = (_least(lp, sign * along, limits) for sign in (1.0, -1.0))
    lower[places] = np.minimum(np.maximum(lower[places], constant + least), upper[places])
    upper[places] = np.maximum(np.minimum(upper[places], constant - most), lower[places])
    return replace(model, reach_lower=_kept(lower), reach_upper=_kept(upper))


def _cheap_plans(program: DisjunctiveProgram, most_cost: float) -> BoundedLp:
    """Return the plans of a vehicle up to a cost, without hazards, as a linear program."""
    lp = bounded_lp(np.zeros(program.num_columns), program.lower, program.upper)
    lp.add_rows(program.hard, program.hard_lower, program.hard_upper)
    columns = np.arange(program.num_columns, dtype=np.int32)
    lp.add_row(columns, program.cost, -np.inf, most_cost)
    return lp


def _least(lp: BoundedLp, along: Matrix, limits: Limits) -> Vector:
    """Return the proven least of linear functions, one by one; −inf where none is known."""
    least = np.full(len(along), -np.inf)
    for number, each in enumerate(along):
        if limits.reached:
            break
        lp.change_cost(each)
        outcome, bound = lp.solve()
        if outcome is LpOutcome.OPTIMAL:
            least[number] = bound
    return least


def _kept(places: Matrix) -> Matrix:
    """Return a read-only array."""
    places.setflags(write=False)
    return places
