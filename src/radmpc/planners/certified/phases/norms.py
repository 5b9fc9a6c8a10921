"""Turning the polytopes of limits of norms to a plan, which leaves it all that norms do."""

from __future__ import annotations

from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.phases.tuning import TUNING
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.verdict import Judge
from radmpc.program.limits.norms import turned_inside
from radmpc.records import replace

__all__ = ["turned_to_norms"]


def turned_to_norms(fleet: Fleet, state: SearchState, judge: Judge) -> SearchState:
    """Turn half-spaces between polytopes that have a corner wherever the plan is at a norm.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    state : SearchState
        With a plan, or without.
    judge : callable
        The referee.

    Returns
    -------
    SearchState
        With a cheaper plan where there is one; the same where norms are free.
    """
    if not (fleet.keeps_norms and state.has_plan):
        return state
    from radmpc.planners.certified.turned.turned_plans import turn_half_spaces  # noqa: PLC0415 - few have any

    for _ in range(TUNING.norm_turns):
        before = state.incumbent
        if fleet.limits.reached:
            break
        state = turn_half_spaces(_turned(fleet, state), state, judge)
        if before.cost - state.incumbent.cost <= TUNING.little * fleet.gap * before.cost:
            break
    return state


def _turned(fleet: Fleet, state: SearchState) -> Fleet:
    """Return the fleet with polytopes turned to its best plan."""
    hazards = fleet.programs.hazards
    models = tuple(map(turned_inside, hazards.models, state.incumbent.controls))
    return Fleet.of(
        fleet.scenario,
        fleet.gap,
        fleet.limits,
        improved=fleet.improved,
        executor=fleet.executor,
        hazards=replace(hazards, models=models),
    )
