"""Searching many sets, here or on an executor; the answers are the same."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor

from radmpc.model.scenario import Scenario
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.problem import Order, SetProblem, SetState, advance
from radmpc.planners.certified.state.bounds import reported_bound
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.tuning import TUNING
from radmpc.planners.executing import run_elsewhere
from radmpc.records import dataclass, replace
from radmpc.solvers.priced.set_bounds import SetBound
from radmpc.solvers.solution import Limits

__all__ = ["SetSearch", "search_sets", "solve_sets"]

_TUNED = TUNING.sets

_CHUNKS = 16
"""Parts that a round's small sets are handed out in [-]: each worth sending, enough to share."""

_SHORT = 60
"""Avoidances up to which a set is always searched here [-]: those of `fleet(1000)` with as many
take 0.3 ms, if they are of one vehicle, and 0.6 of two; their programs are 60 and 120 kB."""

_SMALL = 2
"""Vehicles of the largest sets that are handed out together [-]."""


_Parts = Mapping[int, Sequence[tuple[Members, float]]]
"""Sets with lower bounds on their values at some price, by their first vehicles."""


@dataclass(frozen=True, slots=True, eq=False)
class SetSearch:
    """One set to be searched; pickles.

    Attributes
    ----------
    members : tuple of int
        The vehicles.
    problem : SetProblem
        The set's program: to send it takes a tenth of the time of building it anew.
    scenario : Scenario
        These vehicles alone, with what they may meet.
    state : SetState or None
        How far the search has come.
    order : Order
        What is asked.
    """

    members: Members
    problem: SetProblem
    scenario: Scenario
    state: SetState | None
    order: Order

    @property
    def is_short(self) -> bool:
        """Whether searching it mostly takes less than sending it."""
        return self.problem.program.num_avoidances <= _SHORT

    def run(self, limits: Limits) -> SetState:
        """Search the set; return how far that came."""
        return advance(self.problem, self.scenario, self.state, self.order, limits)


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
            fleet.improved(state.incumbent.controls)
            fleet.found(state.incumbent.cost, reported_bound(fleet, state, fleet.gap))

    searches, parts = [], _known_parts(state, unit_price)
    for members in sets:
        order = _order(fleet, state, members, unit_price, effort, parts, is_rough=is_rough)
        if order is not None:
            # Rows of vehicles and pairs are known here: a worker would take five times as long.
            problem, known = fleet.programs.problem(members), state.set_states.get(members)
            alone = fleet.programs.alone(members)
            searches.append(SetSearch(members, problem, alone, known, order))
    found = search_sets(searches, fleet.limits, fleet.executor, tell)
    new = {search.members: one for search, one in zip(searches, found, strict=True)}
    return replace(state, set_states={**state.set_states, **new})


def _order(
    fleet: Fleet,
    state: SearchState,
    members: Members,
    unit_price: float,
    effort: int,
    parts: _Parts,
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
        _scale(fleet, members, unit_price),
        target - spent,
        sum(fleet.base[i] for i in members),
        _bounds_of_parts(parts, members) or _bound_alone(fleet, members),
        state.hint(fleet, members),
        is_rough,
    )


def _scale(fleet: Fleet, members: Members, unit_price: float) -> float:
    """Return the value below which a set's gap is taken of this instead.

    A large fleet has few sets of several vehicles: what these leave open is little beside the
    whole, however much it is beside themselves.
    """
    if not fleet.is_large or len(members) <= _SMALL:
        return unit_price
    return max(unit_price, _TUNED.fleet_share * sum(fleet.base))


def _known_parts(state: SearchState, unit_price: float) -> _Parts:
    """Return the sets searched at a price, with their bounds, by their first vehicles."""
    parts: dict[int, list[tuple[Members, float]]] = {}
    for members, known in state.set_states.items():
        if known.unit_price == unit_price:
            parts.setdefault(members[0], []).append((members, known.bound))
    return parts


def _bounds_of_parts(parts: _Parts, members: Members) -> tuple[SetBound, ...]:
    """Return the lower bounds proven for subsets of a set."""
    if len(members) == 1:
        return ()
    whole = set(members)
    return tuple(
        SetBound(frozenset(members.index(i) for i in part), bound)
        for first in members
        for part, bound in parts.get(first, ())
        if len(part) < len(members) and whole.issuperset(part)
    )


def _bound_alone(fleet: Fleet, members: Members) -> tuple[SetBound, ...]:
    """Return what a single vehicle costs in empty space, where its program does not say so."""
    vehicle = fleet.scenario.vehicles[members[0]]
    if len(members) > 1 or not (vehicle.via or vehicle.goal.within is not None):
        return ()
    return (SetBound(frozenset({0}), fleet.base[members[0]]),)


def search_sets(
    searches: Sequence[SetSearch],
    limits: Limits,
    executor: Executor | None,
    progress: Callable[[int, int], None],
) -> list[SetState]:
    """Search sets that have no vehicle in common.

    Parameters
    ----------
    searches : sequence of SetSearch
        The sets.
    limits : Limits
        When to stop early.
    executor : Executor or None
        None searches here. Short searches are always done here, and what a worker that died took
        with it.
    progress : callable
        Called with the number of sets done, and of all.

    Returns
    -------
    list of SetState
        In the order of the searches.
    """
    long = [number for number, search in enumerate(searches) if not search.is_short]
    if executor is None or len(long) < 2:
        return _searched_here(searches, limits, progress)
    shares = _shared_out([len(searches[number].members) for number in long])
    tasks = [[long[place] for place in places] for places in shares]
    chunks = [tuple(searches[number] for number in numbers) for numbers in tasks]
    states: dict[int, SetState] = {}

    def search_short() -> None:
        for number, search in enumerate(searches):
            if search.is_short:
                states[number] = search.run(limits)

    answers = run_elsewhere(_search_in_turn, chunks, limits, executor, progress, search_short)
    for numbers, chunk, answer in zip(tasks, chunks, answers, strict=True):
        found = _searched_here(chunk, limits, progress) if answer is None else answer
        states |= zip(numbers, found, strict=True)
    return [states[number] for number in range(len(searches))]


def _shared_out(sizes: Sequence[int]) -> list[list[int]]:
    """Return the numbers of sets of some sizes in parts to be handed out, the longest first.

    The largest sets come first and alone, since all the others are done while the hardest is.
    """
    order = sorted(range(len(sizes)), key=lambda i: -sizes[i])
    large = [[i] for i in order if sizes[i] > _SMALL]
    small = order[len(large) :]
    step = max(1, -(-len(small) // _CHUNKS))
    return large + [small[i : i + step] for i in range(0, len(small), step)]


def _searched_here(
    searches: Sequence[SetSearch], limits: Limits, progress: Callable[[int, int], None]
) -> list[SetState]:
    """Search sets in this process."""
    found: list[SetState] = []
    for search in searches:
        found.append(search.run(limits))
        progress(len(found), len(searches))
    return found


def _search_in_turn(searches: Sequence[SetSearch], limits: Limits) -> list[SetState]:
    """Search sets in a worker."""
    return _searched_here(searches, limits, lambda done, total: None)
