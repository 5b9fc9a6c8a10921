"""Searching many sets, here or on an executor; the answers are the same."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

from radmpc.model.scenario import Scenario
from radmpc.planners.certified.problem import Order, SetProblem, SetState, advance
from radmpc.planners.executing import run_elsewhere
from radmpc.program.build import condensed_models
from radmpc.solvers.solution import Limits

__all__ = ["SetSearch", "search_sets"]

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
