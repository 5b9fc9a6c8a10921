"""Whether a search is left for a plan that it does not reach."""

from __future__ import annotations

from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.state.bounds import bound_on_cost
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.solvers.solution import relative_gap

__all__ = ["is_outdone"]

_DEARER = 0.1
"""Share by which the plan of a search is dearer than another at which it is left [-]: those of
`parking` and `zigzag` begin 12 and 57 % dearer, and end there after 30 s."""

_OPEN = 0.5
"""Gap of the other plan to what the search has proven from which it is left [-]."""


def is_outdone(fleet: Fleet, state: SearchState, rival: float) -> bool:
    """Whether a search among obstacles is left for a far cheaper plan by turned half-spaces.

    Where its own first plans are that dear, and most of the gap is open, it finds none as cheap,
    and other bounds come further in its time.

    Parameters
    ----------
    fleet, state
        As in `bound_on_cost`.
    rival : float
        Cost of that plan; inf without one.
    """
    if fleet.is_large or not (fleet.scenario.obstacles and state.has_plan):
        return False
    is_dearer = state.incumbent.cost > (1.0 + _DEARER) * rival
    return is_dearer and relative_gap(rival, bound_on_cost(fleet, state)) > _OPEN
