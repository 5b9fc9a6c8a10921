"""The bound on plans by faces whose union bound is at most Δ, searched at the plan's price."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.phases.tuning import TUNING
from radmpc.planners.certified.proof.grouping import Proven, grows_after
from radmpc.planners.certified.proof.norms import outside_norms_of
from radmpc.planners.certified.proof.tuning import TUNING as PROOF_TUNING
from radmpc.planners.certified.state.bounds import is_told, shadow_price
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.verdict import Judge
from radmpc.records import replace
from radmpc.solvers.solution import relative_gap

if TYPE_CHECKING:
    # Vehicles without conflicts need no bound.
    from radmpc.planners.certified.proof.search import BoundSearch

__all__ = ["bound_faces", "bound_faces_of_each"]


def bound_faces(
    fleet: Fleet,
    state: SearchState,
    price: float,
    most_nodes: float,
    below: Proven = MappingProxyType({}),
) -> SearchState:
    """Bound plans by faces whose union bound is at most Δ, by the sets of the plan at hand.

    Parameters
    ----------
    fleet : Fleet
        The fleet, with the limits that end this.
    state : SearchState
        With a plan.
    price : float
        A shadow price of the risk, per unit of probability.
    most_nodes : float
        Nodes after which no set is searched on [-].
    below : mapping of tuple of int to mapping of tuple of int to RelaxedSet
        What is known of relaxations at that price.

    Returns
    -------
    SearchState
        With that bound.
    """
    left = fleet.scenario.risk_bound - fleet.initial
    if left <= 0.0:
        return state
    from radmpc.planners.certified.proof.search import BoundSearch  # noqa: PLC0415 - vehicles without conflicts do without

    outside = outside_norms_of(fleet, state.incumbent.controls)
    begin = state.incumbent, price, float(sum(outside.base)), most_nodes
    search = BoundSearch(outside, *begin, is_by_faces=True, below=below)
    search.run()
    return _with_bound(state, left, search.best)


def bound_faces_of_each(
    fleet: Fleet, state: SearchState, most_nodes: float, judge: Judge | None = None
) -> SearchState:
    """Bound them where a search left a gap: every vehicle alone first, then sets.

    A search at a price counts union bounds up to what the referee may leave of them, many times Δ,
    and its sets share that. Here a vehicle risks Δ at most, and in narrow ways it is what each has
    to go around that makes plans dear.

    Parameters
    ----------
    fleet, state, most_nodes
        As in `bound_faces`.
    judge : callable or None
        The referee, for half-spaces to be turned to what vehicles do alone; None turns none.

    Returns
    -------
    SearchState
        With that bound, and a cheaper plan if any; as it is where the gap asked for is proven, in
        large fleets, and where no plan by faces is within Δ.
    """
    left = fleet.scenario.risk_bound - fleet.initial
    is_asked = not (fleet.is_large or fleet.scenario.has_windows)
    if left <= 0.0 or not is_asked or fleet.limits.reached or is_told(fleet, state):
        return state
    from radmpc.planners.certified.proof.search import BoundSearch  # noqa: PLC0415 - few need it

    price = shadow_price(fleet, state)
    if price is None:
        price = fleet.first_unit_price(state.budget) / fleet.unit
    outside, incumbent = outside_norms_of(fleet, state.incumbent.controls), state.incumbent
    base = float(sum(outside.base))
    search = BoundSearch(outside, incumbent, price, base, most_nodes, is_by_faces=True)
    _move_price(search, fleet.singles, TUNING.efforts_for_price)
    _move_price(search, fleet.singles, TUNING.efforts_alone)
    state = _turned_to_alone(fleet, search, state, judge)
    if not search.is_over:
        from radmpc.planners.certified.phases.least_alone import with_least_alone  # noqa: PLC0415 - few need it

        search = _continued(search, with_least_alone(outside, state.incumbent, left))
        _advance(search, fleet.singles, range(TUNING.efforts_alone, TUNING.efforts))
        state = _turned_to_alone(fleet, search, state, judge)
        _choose_price(search, incumbent.sets, price)
        _advance(search, incumbent.sets, range(TUNING.efforts))
    # Where faces leave no plan at all, the one at hand is best among none.
    return _with_bound(state, left, search.best) if search.best < float("inf") else state


def _turned_to_alone(
    fleet: Fleet, search: BoundSearch, state: SearchState, judge: Judge | None
) -> SearchState:
    """Turn half-spaces to the best that vehicles do alone among obstacles, on other sides."""
    incumbent = state.incumbent
    if judge is None or fleet.limits.reached or not fleet.scenario.obstacles:
        return state
    from radmpc.planners.certified.phases.sides_alone import turned_to_alone  # noqa: PLC0415 - few need it

    state = turned_to_alone(fleet, state, search.relaxed_controls(), search.price, judge)
    if state.incumbent.cost < incumbent.cost:
        search.continue_from(state.incumbent, search.price)
    return state


def _move_price(search: BoundSearch, sets: tuple[Members, ...], efforts: int) -> None:
    """Move the price while that raises the bound: the plan at hand may risk little of Δ.

    Bounds come the sooner the higher the price is, so that a lower one takes more efforts to tell.
    """
    _advance(search, sets, range(efforts))
    for _ in range(TUNING.price_moves):
        price, bound = search.price, search.bound_here()
        if search.is_over or _pays_nothing(search) or not search.moves_price(TUNING.most_step):
            return
        _advance(search, sets, range(efforts))
        if search.bound_here() <= bound:
            search.go_on_at(price)
            return


def _pays_nothing(search: BoundSearch) -> bool:
    """Whether what is searched costs no more than in empty space, whatever it risks.

    No price of risk is better than another then.
    """
    at_risk = search.price * search.fleet.scenario.risk_bound
    least = float(sum(search.fleet.base))
    return relative_gap(search.bound_here() + at_risk, least) <= search.gap


def _choose_price(search: BoundSearch, sets: tuple[Members, ...], other: float) -> None:
    """Go on at the price that a first effort for sets proves more with.

    Vehicles that pay nothing alone make risk cheap, which those that meet others do not.
    """
    found, least = search.price, float(sum(search.fleet.base))
    pays_alone = relative_gap(search.best, least) > search.gap
    if max(map(len, sets)) == 1 or found == other or pays_alone:
        return
    _advance(search, sets, range(1))
    bound = search.bound_here()
    if search.is_over:
        return
    search.go_on_at(other)
    _advance(search, sets, range(1))
    if search.bound_here() <= bound:
        search.go_on_at(found)


def _continued(search: BoundSearch, fleet: Fleet) -> BoundSearch:
    """Return a search that goes on with more known of what vehicles cost at least."""
    from radmpc.planners.certified.proof.search import BoundSearch  # noqa: PLC0415 - few need it

    return BoundSearch(
        fleet,
        search.incumbent,
        search.price,
        max(search.best, float(sum(fleet.base))),
        search.most_nodes,
        is_by_faces=True,
        nodes=search.nodes,
        proven=search.proven,
    )


def _advance(search: BoundSearch, sets: tuple[Members, ...], efforts: range) -> None:
    """Search these sets on, by more and more nodes, until nothing comes of it."""
    search.regroup(sets)
    for effort in efforts:
        before = search.nodes
        # What it is told of the gap does not count: here every bit of bound does.
        search.advance(PROOF_TUNING.nodes, effort, search.order)
        is_large = max(map(len, search.order)) >= PROOF_TUNING.least_climbed
        is_more = is_large and grows_after(effort, PROOF_TUNING.nodes)
        if search.is_over or (search.nodes == before and not is_more):
            break


def _with_bound(state: SearchState, left: float, bound: float) -> SearchState:
    """Return the state with a bound on plans whose union bound comes to what is left of Δ."""
    bounds = (*state.outside_bounds, (left, min(bound, state.incumbent.cost)))
    return replace(state, outside_bounds=bounds)
