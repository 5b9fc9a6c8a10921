"""Bounds around the first plan, and turning it to better sides: the search may be left out.

Turned half-spaces make a first plan cheaper than plans by the program's faces mostly are, if it
passes everything on the best sides. The relaxation by cones tells these sides, and what any
certified plan costs at least. That plans by faces cost no less, either, is then soon proven: their
search is cut off at the cost of the plan at hand.
"""

from __future__ import annotations

import logging

from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.inter_set_risk import by_sets
from radmpc.planners.certified.merging import Members, owners_of
from radmpc.planners.certified.phases.tuning import TUNING
from radmpc.planners.certified.proof.grouping import Proven
from radmpc.planners.certified.proof.norms import outside_norms_of
from radmpc.planners.certified.rounds import merge_worst
from radmpc.planners.certified.state.bounds import reported_bound
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.turned.tuning import TUNING as TURNED_TUNING
from radmpc.planners.verdict import Judge
from radmpc.records import dataclass, field, replace
from radmpc.solvers.solution import relative_gap
from radmpc.wording import count_text, percent

__all__ = ["Ahead", "prove_ahead"]

_LOG = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, eq=False)
class Ahead:
    """What came of it.

    Attributes
    ----------
    state : SearchState
        With the best plan, and the bounds by faces that were proven.
    on_any : float
        No plan that the referee would certify costs less.
    is_closed : bool
        Whether the gap asked for is proven, and the gap to any certified plan is not large.
    proven : mapping of tuple of int to mapping of tuple of int to RelaxedSet
        Where the relaxation is searched on.
    """

    state: SearchState
    on_any: float
    is_closed: bool
    proven: Proven = field(default_factory=dict)


def prove_ahead(
    fleet: Fleet, first: FleetIncumbent, judge: Judge, proof_seconds: float | None
) -> Ahead:
    """Make a first plan as cheap as the bound on any certified plan is near, and bound faces.

    Parameters
    ----------
    fleet : Fleet
        The fleet, with the limits that end this.
    first : FleetIncumbent
        A certified plan.
    judge : callable
        The referee.
    proof_seconds : float or None
        How long the bound on any certified plan may be searched for [s]; None for no such limit.

    Returns
    -------
    Ahead
        Where it is not closed, the search over faces is next.
    """
    outside = outside_norms_of(fleet, first.controls)
    base = float(sum(outside.base))
    state = replace(SearchState.of(fleet), incumbent=replace(first, sets=_kept_together(fleet)))
    if relative_gap(first.cost, base) <= fleet.gap:
        return Ahead(state, min(base, first.cost), True)
    # A vehicle without conflicts costs no more than in empty space, and needs none of this.
    from radmpc.planners.certified.phases.around import Around  # noqa: PLC0415 - vehicles without conflicts do without
    from radmpc.planners.certified.turned.turned_plans import turn_half_spaces  # noqa: PLC0415 - vehicles without conflicts do without

    limits = fleet.limits.within(TUNING.time_share * fleet.limits.seconds_left)
    fleet, outside = fleet.with_limits(limits), outside.with_limits(limits)
    if first.certified < TURNED_TUNING.enough * fleet.scenario.risk_bound:
        # Its price was too high, and tells little of what Δ is worth.
        state = turn_half_spaces(fleet, state, judge)
    around = Around(fleet, state, judge)
    if proof_seconds is not None:
        outside = outside.with_limits(outside.limits.within(proof_seconds))
    around.bound_any(outside)
    around.turn_on()
    gap = relative_gap(around.state.incumbent.cost, around.on_any)
    is_near = gap <= max(TUNING.near, fleet.gap)
    if is_near and not around.is_proven:
        around.bound_faces()
    _tell(fleet, around.state, around.on_any)
    on_any = min(around.on_any, around.state.incumbent.cost)
    return Ahead(around.state, on_any, is_near and around.is_proven, around.proven)


def _kept_together(fleet: Fleet) -> tuple[Members, ...]:
    """Return sets of one vehicle, but those that keep a range together."""
    merging, sets = SearchState.of(fleet).merging, fleet.singles
    while kept := merging.to_merge(sets):
        sets = merge_worst(sets, by_sets(kept, owners_of(sets)))
    return sets


def _tell(fleet: Fleet, state: SearchState, on_any: float) -> None:
    """Log what came of it."""
    incumbent, risk_bound = state.incumbent, fleet.scenario.risk_bound
    bound = max(reported_bound(fleet, state, fleet.gap), on_any)
    _LOG.info(
        "around the first plan: %s; 1 %% of the risk bound at a price of %.3g; best cost "
        "%.6g, gap %s, certificate %.3g of risk bound %g",
        count_text(len(incumbent.sets), "set"),
        0.01 * risk_bound * (incumbent.turned_price or 0.0),
        incumbent.cost,
        percent(relative_gap(incumbent.cost, bound)),
        incumbent.certified,
        risk_bound,
    )
