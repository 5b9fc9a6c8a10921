"""Why a plan is as it is, in words: who had to be planned together, and what limits it."""

from __future__ import annotations

from radmpc.model.limits import TightLimit, tight_limits
from radmpc.model.plan import Coupling, Plan

__all__ = ["limits_text", "reasons_text"]

_MOST_REASONS = 4
_MOST_LIMITS = 4
_SPENT = 0.97
"""Share of the risk bound beyond which it counts as used up."""


def reasons_text(plan: Plan) -> str:
    """Return why vehicles were planned together, the strongest reasons first.

    Parameters
    ----------
    plan : Plan
        With couplings.

    Returns
    -------
    str
        Four reasons at most, and how many others there are.
    """
    ordered = sorted(plan.couplings, key=_strength, reverse=True)
    told = [_reason(coupling) for coupling in ordered[:_MOST_REASONS]]
    hidden = len(ordered) - len(told)
    return "; ".join(told) + (f"; and {hidden} more couplings" if hidden else "")


def _strength(coupling: Coupling) -> float:
    """Return what orders reasons: likely collisions first, then those that have no number."""
    if coupling.value is None:
        return 1.0 if coupling.reason == "share" else 0.0
    return -coupling.value if coupling.reason == "distance" else coupling.value


def _reason(coupling: Coupling) -> str:
    """Return one reason."""
    pair, value = f"{coupling.vehicle} and {coupling.other}", coupling.value or 0.0
    if coupling.reason == "collision":
        return f"{pair} would run a risk of {min(value, 1.0):.2g} if planned apart"
    if coupling.reason == "risk":
        return f"{pair} run a risk of {value:.2g} in the approximation"
    if coupling.reason == "blocked":
        return f"{pair} block each other in the approximation"
    if coupling.reason == "distance":
        return f"{pair} come within {value:.3g} m if planned apart"
    return f"{pair} need more than their shares of the risk bound"


def limits_text(plan: Plan) -> str:
    """Return what keeps a plan from costing less: the risk bound, or limits of vehicles.

    Parameters
    ----------
    plan : Plan
        With trajectories.

    Returns
    -------
    str
        Empty where neither is used up: then the ways themselves cost as much.
    """
    texts = []
    certified, bound = plan.risk.certified, plan.risk.bound
    if certified is not None and certified >= _SPENT * bound:
        texts.append(f"the risk bound ({100.0 * certified / bound:.0f} % of it spent)")
    limits = tight_limits(plan)
    texts += [_limit(limit) for limit in limits[:_MOST_LIMITS]]
    hidden = len(limits) - _MOST_LIMITS
    if hidden > 0:
        texts.append(f"{hidden} more limits")
    return ", ".join(texts)


def _limit(limit: TightLimit) -> str:
    """Return one limit and how long it is in use."""
    steps = "1 step" if limit.num_steps == 1 else f"{limit.num_steps} steps"
    return f"{limit.limit} limit of {limit.vehicle} ({steps})"
