"""Searching many sets, here or on an executor; the answers are the same."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace

from radmpc.model.scenario import Scenario
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.problem import Order, SetProblem, SetState, advance
from radmpc.planners.certified.state.bounds import reported_bound
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.tuning import TUNING
from radmpc.planners.executing import run_elsewhere
from radmpc.program.build import condensed_models
from radmpc.solvers.priced.lp import SetBound
from radmpc.solvers.solution import Limits

__all__ = ["SetSearch", "search_sets", "solve_sets"]

_TUNED = TUNING.sets

_CHUNKS = 16
"""Parts that a round's sets are handed out in [-]: each worth sending, enough to share."""


@dataclass(frozen=True, slots=True, eq=False)
class SetSearch:
    """One set to be searched; pickles.

    Attributes
    ----------
    members : tuple of int
        The vehicles.
    scenario : Scenario
        These vehicles alone, with what they may meet.
    state : SetState or None
        How far the search has come.
    order : Order
        What is asked.
    """

    members: tuple[int, ...]
    scenario: Scenario
    state: SetState | None
    order: Order


def solve_sets(
    fleet: Fleet,
    state: SearchState,
    sets: Sequence[Members],
    unit_price: float,
    effort: int,
    *,
    is_rough: bool = False,
) -> SearchState:
    """Bring every set's search to a price.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    state : SearchState
        Where their searches stood.
    sets : sequence of tuple of int
        Sets that have no vehicle in common.
    unit_price : float
        Cost of one unit of risk.
    effort : int
        Multiplies the nodes that every set gets [-].
    is_rough : bool
        Whether plans are only to tell the price, so that the lattice is not searched.

    Returns
    -------
    SearchState
        With a state of each of these sets; nothing else is changed.
    """

    def tell(done: int, total: int) -> None:
        fleet.progress(done, total)
        if state.has_plan:
            fleet.found(state.incumbent.cost, reported_bound(fleet, state, fleet.gap))

    searches = []
    for members in sets:
        order = _order(fleet, state, members, unit_price, effort, is_rough=is_rough)
        if order is not None:
            fleet.programs.problem(members)
            alone = fleet.programs.alone(members)
            searches.append(SetSearch(members, alone, state.set_states.get(members), order))
    found = search_sets(searches, fleet.programs.problem, fleet.limits, fleet.executor, tell)
    new = {search.members: one for search, one in zip(searches, found, strict=True)}
    return replace(state, set_states={**state.set_states, **new})


def _order(
    fleet: Fleet,
    state: SearchState,
    members: Members,
    unit_price: float,
    effort: int,
    *,
    is_rough: bool,
) -> Order | None:
    """Return what a set is asked at a price; None where more search adds nothing."""
    known = state.set_states.get(members)
    nodes = _TUNED.nodes
    if not state.has_tried_initial_plan:
        nodes = _TUNED.trial_nodes_alone if len(members) == 1 else _TUNED.trial_nodes
    target = nodes * effort * len(members)
    spent = known.nodes if known is not None and known.unit_price == unit_price else 0
    if known is not None and (
        known.bound == float("inf") or (spent and not (known.is_limited and spent < target))
    ):
        return None
    return Order(
        fleet.unit,
        unit_price,
        _TUNED.gap_share * fleet.gap,
        unit_price,
        target - spent,
        sum(fleet.base[i] for i in members),
        _bounds_of_parts(state, members, unit_price),
        state.hint(fleet, members),
        is_rough,
    )


def _bounds_of_parts(
    state: SearchState, members: Members, unit_price: float
) -> tuple[SetBound, ...]:
    """Return the lower bounds proven for subsets of a set at this price."""
    if len(members) == 1:
        return ()
    whole = set(members)
    return tuple(
        SetBound(frozenset(members.index(i) for i in part), known.bound)
        for part, known in state.set_states.items()
        if len(part) < len(members) and known.unit_price == unit_price and whole.issuperset(part)
    )


def search_sets(
    searches: Sequence[SetSearch],
    problem: Callable[[tuple[int, ...]], SetProblem],
    limits: Limits,
    executor: Executor | None,
    progress: Callable[[int, int], None],
) -> list[SetState]:
    """Search sets that have no vehicle in common.

    Parameters
    ----------
    searches : sequence of SetSearch
        The sets.
    problem : callable
        Returns a set's program, for those searched here.
    limits : Limits
        When to stop early.
    executor : Executor or None
        None searches here. What a worker that died took with it is searched here, too.
    progress : callable
        Told how many sets are done, of how many.

    Returns
    -------
    list of SetState
        In the order of the searches.
    """
    if executor is None or len(searches) < 2:
        found = []
        for search in searches:
            found.append(
                advance(
                    problem(search.members), search.scenario, search.state, search.order, limits
                )
            )
            progress(len(found), len(searches))
        return found
    size = -(-len(searches) // _CHUNKS)
    chunks = [tuple(searches[i : i + size]) for i in range(0, len(searches), size)]
    states: list[SetState] = []
    answers = run_elsewhere(_search_afresh, chunks, limits, executor, progress)
    for chunk, answer in zip(chunks, answers, strict=True):
        states += search_sets(chunk, problem, limits, None, progress) if answer is None else answer
    return states


def _search_afresh(searches: Sequence[SetSearch], limits: Limits) -> list[SetState]:
    """Search sets whose programs are not at hand."""
    found = []
    for search in searches:
        models = condensed_models(search.scenario)
        everyone = tuple(range(len(models)))
        problem = SetProblem.of(search.scenario, everyone, models, search.order.unit)
        found.append(advance(problem, search.scenario, search.state, search.order, limits))
    return found
