"""Why a plan is as it is, in words: what was planned together, what limits it, what to try."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from radmpc.model.limits import tight_limits
from radmpc.model.plan import Coupling, Plan, Status
from radmpc.model.relations.couplings import unexplained_sets
from radmpc.model.scenario import Scenario
from radmpc.wording import count_text, names_of_choices, percent, short_cost

__all__ = [
    "advice_text",
    "assumed_noise_text",
    "cost_text",
    "left_over_text",
    "limits_text",
    "price_text",
    "reasons_text",
]

_MOST_REASONS = 4
"""Reasons for planning together that a report lists; the rest is counted."""

_MOST_LIMITS = 4
"""Limits in use, and vehicles at one of them, that a report lists; the rest is counted."""

_USED = 0.97
"""Share of the risk bound beyond which it counts as used up."""

_MUCH_LEFT = 0.15
"""Share of the risk bound from which on what is left over needs a reason."""

_LEAST_SAVED = 1e-6
"""Share of the cost [-] below which saving it is saving nothing."""

_PRICED = "certified"
"""The decomposition that knows a shadow price, as it is written in plans."""

_ROUNDING = 1e-9
"""Relative difference of a cost and its bound that is none."""


def reasons_text(plan: Plan) -> str:
    """Return why vehicles were planned together, the strongest reasons first.

    Parameters
    ----------
    plan : Plan
        With sets.

    Returns
    -------
    str
        Four reasons at most, how many others there are, and which sets have none; empty where
        everyone was planned alone.
    """
    ordered = sorted(plan.couplings, key=_strength, reverse=True)
    sure = [c for c in ordered if c.is_sure]
    told = [_sure_text(sure)] if len(sure) > 1 else []
    rest = ordered[len(sure) :] if told else ordered
    num_told = _MOST_REASONS - len(told)
    told += [coupling.sentence for coupling in rest[:num_told]]
    hidden = len(rest[num_told:])
    told += [f"and {count_text(hidden, 'more coupling')}"] if hidden else []
    return "; ".join([*told, *_without_reasons(plan)])


def _without_reasons(plan: Plan) -> list[str]:
    """Return, where there are any, which sets were planned together without estimates."""
    unexplained = unexplained_sets(plan.sets, plan.couplings)
    if not unexplained:
        return []
    # Whose reasons are told is plain where they are told of nobody.
    who = f"{_unexplained(unexplained)} " if plan.couplings else ""
    return [f"{who}planned together from the start: no risk of planning them apart was estimated"]


def _unexplained(sets: Sequence[Sequence[str]]) -> str:
    """Return a few sets, and how many others there are."""
    told = ["{" + ", ".join(group) + "}" for group in sets[:_MOST_REASONS]]
    hidden = len(sets) - len(told)
    return ", ".join(told) + (f" and {count_text(hidden, 'more set')}" if hidden else "")


def _sure_text(sure: Sequence[Coupling]) -> str:
    """Return one sentence about all pairs that would almost surely collide."""
    pairs = [f"{c.vehicle} and {c.other}" for c in sure[:_MOST_REASONS]]
    hidden = len(sure) - len(pairs)
    pairs += [count_text(hidden, "more pair")] if hidden else []
    return f"{', '.join(pairs)} would almost surely collide if planned apart"


def _strength(coupling: Coupling) -> float:
    """Return what orders reasons: likely collisions first, then those that have no number."""
    if coupling.value is None:
        return 1.0 if coupling.reason == "share" else 0.0
    if coupling.reason == "range":
        return 0.0
    return -coupling.value if coupling.reason == "distance" else coupling.value


def limits_text(plan: Plan) -> str:
    """Return what keeps a plan from costing less: the risk bound, or limits of vehicles.

    Parameters
    ----------
    plan : Plan
        With trajectories.

    Returns
    -------
    str
        Empty where neither is used up: then the paths themselves cost as much.
    """
    texts = []
    certified, bound = plan.risk.certified, plan.risk.bound
    # A planner that exceeds the bound was not held up by it.
    if certified is not None and _USED * bound <= certified <= bound:
        texts.append(f"the risk bound ({100.0 * certified / bound:.0f} % of it used)")
    alike: dict[tuple[str, int], list[str]] = {}
    for limit in tight_limits(plan):
        alike.setdefault((limit.limit, limit.num_steps), []).append(limit.vehicle)
    groups = list(alike.items())
    texts += [_limits(kind, steps, names) for (kind, steps), names in groups[:_MOST_LIMITS]]
    hidden = sum(len(names) for _, names in groups[_MOST_LIMITS:])
    if hidden:
        texts.append(count_text(hidden, "more limit"))
    return ", ".join(texts)


def _limits(kind: str, num_steps: int, names: Sequence[str]) -> str:
    """Return one limit, whose it is and how long it is in use."""
    steps = count_text(num_steps, "step")
    if len(names) == 1:
        return f"{kind} limit of {names[0]} ({steps})"
    hidden = len(names) - _MOST_LIMITS
    more = f" and {hidden} more" if hidden > 0 else ""
    return f"{kind} limits of {', '.join(names[:_MOST_LIMITS])}{more} ({steps} each)"


def cost_text(plan: Plan) -> str:
    """Return the cost, and the lower bounds and gaps where there are."""
    cost, bound, gap = plan.cost, plan.lower_bound, plan.certified_gap
    if cost is None:
        return "none"
    least = plan.certified_lower_bound
    if least is not None and gap is not None:
        on_any = f"{short_cost(least)} for any certified plan, gap {percent(gap)}"
        if bound is None:
            return f"{short_cost(cost)} (lower bound {on_any})"
        by_faces = f"{short_cost(bound)} for plans by faces, gap {percent(_gap(cost, bound))}"
        return f"{short_cost(cost)} (lower bounds: {on_any}; {by_faces})"
    if bound is None:
        return f"{short_cost(cost)} (no lower bound)"
    if cost < bound - _ROUNDING * abs(bound):
        return (
            f"{short_cost(cost)} (below {short_cost(bound)}, the least of plans whose union bound "
            "is within the risk bound: the certificate, which is tighter, lets this one use more)"
        )
    return f"{short_cost(cost)} (lower bound {short_cost(bound)}, gap {percent(_gap(cost, bound))})"


def _gap(cost: float, bound: float) -> float:
    """Return what a cost could fall by at most, as a share of it."""
    return 0.0 if cost <= 0.0 else max(cost - bound, 0.0) / cost


def left_over_text(plan: Plan) -> str | None:
    """Return why a plan leaves much of the risk bound and is called optimal nevertheless.

    Parameters
    ----------
    plan : Plan
        With trajectories, of a planner that keeps the risk within its bound.

    Returns
    -------
    str or None
        One clause; None where little is left over, or nothing was proven.
    """
    certified, bound, price = plan.risk.certified, plan.risk.bound, plan.risk.price
    is_free = price == 0.0
    if certified is None or not (is_free or plan.status is Status.OPTIMAL):
        return None
    left = 1.0 - certified / bound
    if left < _MUCH_LEFT or (price is not None and price > 0.0):
        return None
    share = f"{100.0 * left:.0f} % of the bound"
    if is_free:
        return (
            f"{share}: using it would not make the plan cheaper, the paths to the goals and the "
            "limits of the vehicles cost as much anyway"
        )
    return (
        f"{share}: the planner counts by union bounds, which sum to more than the certificate, "
        "and by these the plan is optimal"
    )


def price_text(plan: Plan) -> str:
    """Return what a little more of Δ would save, or why that is not known.

    Parameters
    ----------
    plan : Plan
        With trajectories, of a planner that keeps the risk within its bound.

    Returns
    -------
    str
        One clause.
    """
    price, cost = plan.risk.price, plan.cost or 0.0
    if price is None:
        return f"not computed: {_no_price(plan)}"
    saved = 0.01 * plan.risk.bound * price
    if cost <= 0.0 or saved < _LEAST_SAVED * cost:
        return "none: more of it would save nothing"
    return f"1 % more would save about {saved:.2g}, {100.0 * saved / cost:.2g} % of the cost"


def _no_price(plan: Plan) -> str:
    """Return why a plan comes without a shadow price."""
    certified, bound = plan.risk.certified, plan.risk.bound
    if _PRICED not in names_of_choices(plan.planner):
        return f"only the planner '{_PRICED}' looks for it"
    if certified is not None and certified <= 0.0:
        return "the plan runs no risk"
    if certified is None or plan.lower_bound is None or 1.0 - certified / bound <= _MUCH_LEFT:
        return "the search ended before it had proven anything at a price of risk"
    if plan.status is not Status.OPTIMAL:
        return "the search ended before it was known whether using more would save anything"
    return "the union bounds that the search counts by are used up, the risk bound is not"


def advice_text(plan: Plan, preset: str = "", *, bounds_risk: bool = True) -> str | None:
    """Return what to try where a plan exceeds the risk bound.

    Parameters
    ----------
    plan : Plan
        With trajectories.
    preset : str
        The planner as it was asked for.
    bounds_risk : bool
        Whether it keeps the risk within the bound at all.

    Returns
    -------
    str or None
        One sentence; None where the plan is within, or there is no more to say than that it is not.
    """
    certified = plan.risk.certified
    if certified is None or certified <= plan.risk.bound:
        return None
    if not bounds_risk:
        return (
            f"{preset or 'this planner'} does not bound the risk: it ignores the noise, or holds "
            "back a fixed number of standard deviations; --planner certified keeps to the bound"
        )
    if not plan.risk.ledger:
        return None
    worst = max(plan.risk.ledger, key=lambda row: row.risk)
    group_of = {name: i for i, group in enumerate(plan.sets) for name in group}
    if worst.cause != "pair" or worst.other is None:
        return None
    if group_of.get(worst.vehicle) == group_of.get(worst.other):
        return None
    return (
        f"{worst.vehicle} and {worst.other} were planned apart but may meet; --planner certified "
        "plans such vehicles together, and returns no plan above the bound"
    )


def assumed_noise_text(scenario: Scenario) -> str | None:
    """Return the noise that an import added, because its problem states none.

    Parameters
    ----------
    scenario : Scenario
        Its ``source`` says what was chosen.

    Returns
    -------
    str or None
        One line; None where the noise is the scenario's own.
    """
    choices = (scenario.source or {}).get("choices")
    noise = choices.get("noise") if isinstance(choices, Mapping) else None
    if not isinstance(noise, str):
        return None
    return f"added by the import, the problem states none: {' '.join(noise.split())}"
