"""The record of the rounds, for users who watch and for what is read afterwards."""

from __future__ import annotations

import logging
from dataclasses import replace

from radmpc.planners.certified.bounds import bound_on_cost
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.rounds import Round
from radmpc.planners.certified.state import SearchState
from radmpc.planners.draft import Step
from radmpc.solvers.solution import relative_gap

__all__ = ["recorded"]

_LOG = logging.getLogger(__name__)


def recorded(fleet: Fleet, state: SearchState, candidate: Round, seconds: float) -> SearchState:
    """Log a round, and add it to the record.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    state : SearchState
        After the round was judged.
    candidate : Round
        The round.
    seconds : float
        What it took [s].

    Returns
    -------
    SearchState
        With one step more; nothing else is changed.
    """
    state = replace(state, steps=(*state.steps, _step(fleet, state, candidate, seconds)))
    _tell(fleet, state, candidate)
    return state


def _tell(fleet: Fleet, state: SearchState, candidate: Round) -> None:
    """Log a round."""
    step, incumbent, plan = state.steps[-1], state.incumbent, "no plan yet"
    if incumbent.controls:
        plan = (
            f"best cost {incumbent.cost:.6g}, gap {100.0 * step.gap:.2g} %, certificate "
            f"{incumbent.certified:.3g} of risk bound {fleet.scenario.risk_bound:g}"
        )
    _LOG.info(
        "%s %d: %d sets, the largest of %d; 1 %% of the risk bound at a price of %.3g; union "
        "bounds sum to %.3g, up to %.3g allowed; %s; %.2f s",
        step.stage,
        step.iteration + 1,
        len(candidate.sets),
        max(len(members) for members in candidate.sets),
        candidate.unit_price / fleet.unit * 0.01 * fleet.scenario.risk_bound,
        candidate.risk + candidate.inter_set_risk,
        state.budget,
        plan,
        step.seconds,
    )


def _step(fleet: Fleet, state: SearchState, candidate: Round, seconds: float) -> Step:
    """Return the record of a round."""
    plans = candidate.plans
    return Step(
        stage="initial" if candidate.is_initial else "round",
        vehicles=tuple(v.name for v in fleet.scenario.vehicles),
        iteration=len(state.steps),
        cost=sum(plan.cost for plan in plans),
        num_active=0,
        num_chosen=sum(plan.selection.size for plan in plans),
        allocated=state.budget,
        used=candidate.risk + candidate.inter_set_risk,
        gap=relative_gap(state.incumbent.cost, bound_on_cost(fleet, state)),
        nodes=sum(state.set_states[m].nodes for m in candidate.sets if m in state.set_states),
        seconds=seconds,
    )
