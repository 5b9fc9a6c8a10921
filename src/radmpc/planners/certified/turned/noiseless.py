"""Plans without noise, as starts for turning half-spaces.

A program may be infeasible by the faces although there is a plan: two vehicles that pass each other
closely, with hardly any noise, may be kept apart by no face at both ends of an interval and still
never touch. A plan of each vehicle alone, or of all without noise, may be certified as it is, or
become so.
"""

from __future__ import annotations

import time

import numpy as np

from radmpc.arrays import Matrix
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.certified.turned.turned_plans import plan_by_turning
from radmpc.planners.coarse_search import propose_alternatives
from radmpc.planners.verdict import Judge
from radmpc.solvers.branch.branch import Branch
from radmpc.solvers.solution import Limits

__all__ = ["turn_from_noiseless"]

_TOGETHER = 2.0
"""Time that all vehicles take together at least, in multiples of what each takes by itself, added
up [-]: in the harbor 2 to 3."""


def turn_from_noiseless(fleet: Fleet, state: SearchState, judge: Judge) -> SearchState:
    """Turn half-spaces to plans of the vehicles each alone, and of all without noise.

    Parameters
    ----------
    fleet : Fleet
        The fleet; nothing is done where it is large.
    state : SearchState
        What is known of it.
    judge : callable
        The referee.

    Returns
    -------
    SearchState
        With what is certified and cheaper than the incumbent.
    """
    count = fleet.scenario.num_vehicles
    if count > TUNING.most_vehicles or fleet.limits.reached:
        return state
    limits = fleet.limits.within(TUNING.noiseless_share * fleet.limits.seconds_left)
    begun, programs = time.monotonic(), fleet.programs
    whole, alone = tuple(range(count)), []
    apart: tuple[Matrix, ...] = ()
    for members in fleet.singles if count > 1 else ():
        if fleet.limits.reached:
            return state
        alone.append(_noiseless(fleet, members, limits))
    found = [z for z in alone if z is not None]
    if found and len(found) == count:
        apart = programs.controls(fleet.singles, found)
    is_late = fleet.limits.seconds_left < _TOGETHER * (time.monotonic() - begun)
    together = None if is_late else _noiseless(fleet, whole, limits)
    if apart:
        state = plan_by_turning(fleet, state, judge, fleet.singles, apart)
    if together is not None:
        controls = programs.controls((whole,), (together,))
        if not apart or not all(map(np.array_equal, controls, apart)):
            state = plan_by_turning(fleet, state, judge, (whole,), controls)
    return state


def _noiseless(fleet: Fleet, members: Members, limits: Limits) -> np.ndarray | None:
    """Return a plan of some vehicles on which every row of the faces just holds."""
    problem = fleet.programs.problem(members)
    program = problem.program
    margins = np.zeros(program.rows.count)
    return (
        Branch(TUNING.noiseless_nodes * len(members))
        .solve(
            program,
            margins,
            gap=fleet.gap,
            limits=limits,
            guide=lambda: propose_alternatives(program, problem.models, margins, limits),
        )
        .z
    )
