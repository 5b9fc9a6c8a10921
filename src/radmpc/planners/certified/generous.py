"""Plans whose simple bounds sum to far more than the risk bound, where the referee allows them."""

from __future__ import annotations

from dataclasses import replace

from radmpc.arrays import Matrix
from radmpc.model.plan import LedgerRow
from radmpc.planners.certified.best import Best
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.search import PriceSearch
from radmpc.planners.certified.verdict import Judge, Verdict

__all__ = ["spend_more"]

_MORE = 20.0
"""Factor by which the bound that a fleet is planned with is raised at a time."""

_MOST = 0.45
_UNSPENT = 0.5
"""Share of Δ that the referee leaves from which on more is tried. Half-spaces held over whole
intervals, with the whole bow in reserve, can sum to thousands of times what it finds."""

_LARGEST_SET = 4
"""Vehicles of a set beyond which the search takes too long to be made again."""

_PATIENCE = 0.4
"""Share of the time that the first search may have taken."""


def spend_more(search: PriceSearch, seconds: float) -> None:
    """Look for cheaper plans whose simple bounds sum to more, as long as the referee leaves most.

    The fleet is planned as if its risk bound were larger; every plan is judged by the true one.

    Parameters
    ----------
    search : PriceSearch
        With a plan; takes a cheaper one. What it proved stays as it is.
    seconds : float
        What it took so far [s].
    """
    fleet, best = search.fleet, search.best
    scenario, limits = fleet.scenario, fleet.limits
    bound = scenario.risk_bound
    if not _is_worth_it(fleet, best):
        return
    while bound < _MOST:
        if limits.reached or seconds > _PATIENCE * (seconds + limits.seconds_left):
            return
        # Other sides may be cheaper still: the largest bound is tried in any case.
        bound = min(_MORE * bound, _MOST) if _is_worth_it(fleet, best) else _MOST
        lenient = replace(scenario, risk_bound=bound)
        other = Fleet(lenient, fleet.gap, limits, fleet.progress, fleet.executor)
        judge = _scaled(search.judge, bound / scenario.risk_bound)
        trial = PriceSearch(other, Best(), search.gap, judge)
        trial.run()
        found = trial.best
        if not found.controls or found.cost >= best.cost:
            continue
        best.controls, best.cost, best.sets = found.controls, found.cost, found.sets
        best.certified = search.judge(found.controls).certified
        best.spent = found.spent
        best.steps += found.steps
        fleet.met.update(other.met)


def _is_worth_it(fleet: Fleet, best: Best) -> bool:
    """Whether simple bounds, not the referee, keep the plan from being cheaper."""
    granted = fleet.scenario.risk_bound
    is_small = max((len(members) for members in best.sets), default=0) <= _LARGEST_SET
    return bool(best.controls) and is_small and best.certified < _UNSPENT * granted


def _scaled(judge: Judge, factor: float) -> Judge:
    """Return a judge for whom a plan at the true bound is one at a larger bound."""

    def scaled(controls: tuple[Matrix, ...]) -> Verdict:
        verdict = judge(controls)
        ledger = tuple(
            LedgerRow(row.cause, row.vehicle, row.other, row.step, factor * row.risk)
            for row in verdict.ledger
        )
        return Verdict(factor * verdict.certified, ledger)

    return scaled
