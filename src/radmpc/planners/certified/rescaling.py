"""A round's plan with the risks of its rows rescaled to a budget."""

from __future__ import annotations

from radmpc.arrays import Vector
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.repair import AllocatedPrograms, repair, repriced
from radmpc.planners.certified.rounds import Round
from radmpc.planners.certified.tuning import TUNING
from radmpc.solvers.priced.budget import OVER

__all__ = ["rescaled"]

_TUNED = TUNING.acceptance


def rescaled(
    fleet: Fleet,
    candidate: Round,
    budget: float,
    inter_set_risk: float,
    programs: AllocatedPrograms,
) -> tuple[Vector, ...] | None:
    """Return a round's plan with its risks rescaled to a budget.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    candidate : Round
        The plan at its price.
    budget : float
        What its union bounds may sum to beyond the risk of the starts [-].
    inter_set_risk : float
        How much of it is reserved for risk between sets [-].
    programs : AllocatedPrograms
        Those of other budgets.

    Returns
    -------
    tuple of (n,) array or None
        A point per set; None where these alternatives exceed the budget.
    """
    problems = [fleet.programs.problem(m) for m in candidate.sets]
    whole, budget = budget, budget - inter_set_risk
    plans = candidate.plans
    if budget < candidate.risk <= (1.0 + 2.0 * OVER) * budget:
        # At its budget up to rounding: nothing to rescale.
        whole, budget = whole + candidate.risk - budget, candidate.risk
    points = repair(problems, plans, budget, programs, is_large=fleet.is_large)
    for factor in _TUNED.dearer:
        if points is not None:
            break
        # Scaled margins ask too much of some row; a higher price lets rows share as they can.
        plans = tuple(
            repriced(p, plan, fleet.unit, factor * candidate.unit_price, fleet.limits)
            if plan.risk > _TUNED.little * fleet.unit
            else plan
            for p, plan in zip(problems, plans, strict=True)
        )
        if sum(plan.risk for plan in plans) <= budget:
            points = repair(problems, plans, budget, programs, is_large=fleet.is_large)
    raw = tuple(plan.z for plan in candidate.plans)
    fits = candidate.risk <= budget
    if points is None:
        return raw if fits else None
    points = _kept_apart(fleet, candidate, raw, points)
    risk = sum(
        float(programs.risks(*each).sum()) for each in zip(problems, plans, points, strict=True)
    )
    risk += sum(fleet.programs.inter_set_risks(candidate.sets, points).values())
    return points if risk <= whole else raw if fits else None


def _kept_apart(
    fleet: Fleet, candidate: Round, raw: tuple[Vector, ...], points: tuple[Vector, ...]
) -> tuple[Vector, ...]:
    """Give sets that were moved into another's way their plans of the round back."""
    chosen = list(points)
    for _ in range(_TUNED.take_backs):
        set_risks = fleet.programs.inter_set_risks(candidate.sets, chosen)
        if (
            sum(set_risks.values())
            <= 2.0 * candidate.inter_set_risk + _TUNED.inter_set_share * fleet.gap * fleet.unit
        ):
            break
        for pair, risk in set_risks.items():
            if risk > 0.5 * candidate.inter_set_risk / len(set_risks):
                for number in pair:
                    chosen[number] = raw[number]
    return tuple(chosen)
