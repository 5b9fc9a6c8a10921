"""What a plan states of itself, compared with its scenario: status, bounds, sets, ledger."""

from __future__ import annotations

import re
from collections.abc import Mapping
from math import fsum, inf, isnan

from radmpc.arguments import is_integer, is_number
from radmpc.model.plan import Coupling, Plan, Reason, Status
from radmpc.referee.claims.tolerances import of_cost

__all__ = ["ledger_problems", "statement_problems"]

_SUM_TOL = 1e-6
"""Relative difference [-] by which a ledger may miss the certified risk: rounding in a file."""

_BOUND_TOL = 1e-3
"""What a lower bound may be above a cost by, as a share of what costs may differ by [-]."""

_USUAL_GAP = 1e-3
"""Relative gap of planners that prove one, where their record names none [-]."""

_GAP_TOL = 1e-2
"""Share of a gap by which bound and cost may be further apart: they are summed anew [-]."""

_LEAST_COST = 1e-9
"""Costs below this count as this in relative gaps: a plan may cost nothing."""

_MOST: Mapping[Reason, float] = {"collision": inf, "risk": 1.0, "distance": inf, "range": inf}
"""What the value of a coupling is at most, by its reason [- or m]; others have none."""


def statement_problems(plan: Plan) -> list[str]:
    """Return which of a plan's words about itself cannot be true together.

    Parameters
    ----------
    plan : Plan
        With trajectories.
    """
    problems = []
    if plan.status in {Status.INFEASIBLE, Status.LIMIT}:
        problems.append(f"plan: status is {plan.status.value!r}, yet there are trajectories")
    if plan.status is Status.OPTIMAL and plan.lower_bound is None:
        problems.append("plan: status is 'optimal' without a lower bound")
    for name, bound in (
        ("lower bound", plan.lower_bound),
        ("lower bound of any certified plan", plan.certified_lower_bound),
    ):
        if bound is not None and isnan(bound):
            problems.append(f"plan: {name} is nan, must be a number")
            continue
        if plan.cost is None or bound is None:
            continue
        if bound - plan.cost > _BOUND_TOL * of_cost(plan.scenario, plan.cost):
            problems.append(f"plan: {name} {bound:.9g} is above the cost {plan.cost:.9g}")
    problems += _gap_problems(plan) + _search_problems(plan)
    price = plan.risk.price
    if price is not None and not price >= 0.0:
        problems.append(f"plan: states a shadow price of risk of {price:.9g}, must be >= 0")
    names = sorted(v.name for v in plan.scenario.vehicles)
    if sorted(name for group in plan.sets for name in group) != names:
        problems.append("plan: its sets do not hold every vehicle once")
    if not all(plan.sets):
        problems.append("plan: one of its sets is empty")
    return problems + _coupling_problems(plan) + ledger_problems(plan) + _sum_problems(plan)


def _gap_problems(plan: Plan) -> list[str]:
    """Say where an optimal plan is further from its bounds than the gap its planner was asked for.

    A bound on any certified plan bounds those by faces. Texts that are no planner's record, or of
    one that proves nothing, state no gap.
    """
    bounds = [b for b in (plan.lower_bound, plan.certified_lower_bound) if b is not None]
    gap = _gap_asked(plan.planner)
    if plan.status is not Status.OPTIMAL or gap is None or plan.cost is None or not bounds:
        return []
    apart = (plan.cost - max(bounds)) / max(abs(plan.cost), _LEAST_COST)
    if not apart > gap * (1.0 + _GAP_TOL):
        return []
    return [
        f"plan: status is 'optimal', asked for was a gap of {gap:g}, lower bound "
        f"{max(bounds):.9g} and cost {plan.cost:.9g} are {apart:.3g} apart"
    ]


def _gap_asked(planner: str) -> float | None:
    """Return the relative gap that a planner's record states, or that it leaves as usual."""
    match = re.search(r", gap=([-+.\de]+)$", planner)
    if match is not None:
        try:
            gap = float(match[1])
        except ValueError:
            return None
        return gap if 0.0 < gap < 1.0 else None
    return _USUAL_GAP if re.search(r", certified(\([^()]*\))?$", planner) else None


def _search_problems(plan: Plan) -> list[str]:
    """Name seconds that no clock measures, and a first plan that cannot have been."""
    problems = [
        f"plan: states {_shown(seconds)} seconds for {stage!r}, must be a number >= 0"
        for stage, seconds in plan.seconds.items()
        if not (is_number(seconds) and 0.0 <= seconds < inf)
    ]
    first, bound = plan.first, plan.certified_lower_bound
    if first is None:
        return problems
    if first.seconds < 0.0:
        problems.append(
            f"plan: states that its first plan was there after {first.seconds:.9g} seconds, "
            "must be >= 0"
        )
    if bound is not None and bound - first.cost > _BOUND_TOL * of_cost(plan.scenario, first.cost):
        problems.append(
            f"plan: states a first certified plan of cost {first.cost:.9g}, below {bound:.9g}, the "
            "lower bound of any certified plan"
        )
    return problems


def ledger_problems(plan: Plan) -> list[str]:
    """Name rows of the ledger about vehicles, obstacles or steps that the scenario lacks.

    Parameters
    ----------
    plan : Plan
        Any.

    Returns
    -------
    list of str
        Each said once.
    """
    vehicles = {v.name for v in plan.scenario.vehicles}
    partners = {
        "pair": vehicles,
        "obstacle": {o.name for o in plan.scenario.obstacles},
        "workspace": set[str](),
        "range": vehicles,
    }
    problems = []
    for row in plan.risk.ledger:
        about = f"plan: a ledger row of cause {row.cause!r} names"
        if row.vehicle not in vehicles:
            problems.append(f"{about} vehicle {row.vehicle!r}, who is not in the scenario")
        # Without a partner a row is the sum over all that is far away.
        is_itself = row.cause in {"pair", "range"} and row.other == row.vehicle
        if row.cause not in partners:
            problems.append(f"{about} no cause there is, allowed are {', '.join(partners)}")
        elif row.other is not None and (is_itself or row.other not in partners[row.cause]):
            problems.append(f"{about} other {row.other!r}, which is none of the scenario's")
        if not (is_integer(row.step) and 0 <= row.step <= plan.scenario.horizon):
            problems.append(f"{about} step {row.step}, the last is {plan.scenario.horizon}")
    return list(dict.fromkeys(problems))


def _sum_problems(plan: Plan) -> list[str]:
    """Say where the rows of a ledger do not add up to the certified risk that is stated with it."""
    certified = plan.risk.certified
    if certified is None or not plan.risk.ledger:
        return []
    total = fsum(row.risk for row in plan.risk.ledger)
    if abs(total - certified) <= _SUM_TOL * max(total, certified):
        return []
    return [
        f"plan: its ledger sums to {total:.9g}, it states a certified risk of {certified:.9g}: "
        "both must be equal"
    ]


def _coupling_problems(plan: Plan) -> list[str]:
    """Name couplings of vehicles that the scenario lacks, or whose value is not of their reason."""
    vehicles = {v.name for v in plan.scenario.vehicles}
    problems = []
    for coupling in plan.couplings:
        about = f"plan: a coupling of reason {coupling.reason!r} names"
        problems += [
            f"{about} vehicle {name!r}, who is not in the scenario"
            for name in (coupling.vehicle, coupling.other)
            if name not in vehicles
        ]
        if coupling.vehicle == coupling.other:
            problems.append(f"{about} vehicle {coupling.vehicle!r} twice")
        problems += _value_problems(coupling)
    return list(dict.fromkeys(problems))


def _value_problems(coupling: Coupling) -> list[str]:
    """Name a value that is missing, or that a coupling's reason does not allow."""
    value, most = coupling.value, _MOST.get(coupling.reason)
    if most is None:
        allowed = "" if value is None else "none"
    elif is_number(value) and 0.0 <= value <= most:
        allowed = ""
    else:
        allowed = f"a number from 0 to {most:g}" if most < inf else "a number of at least 0"
    if not allowed:
        return []
    pair = f"{coupling.vehicle!r} and {coupling.other!r}"
    given = "none" if value is None else _shown(value)
    return [
        f"plan: the coupling of {pair} of reason {coupling.reason!r} has a value of {given}, "
        f"allowed is {allowed}"
    ]


def _shown(value: object) -> str:
    """Return a number with nine digits, anything else as it is written."""
    return f"{value:.9g}" if is_number(value) else repr(value)
