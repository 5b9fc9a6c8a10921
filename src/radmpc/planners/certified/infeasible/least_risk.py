"""The least that a fleet can risk, whatever the effort: the smallest bound that would do."""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from radmpc.arrays import Matrix
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.infeasible.tuning import TUNING
from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.rounds import Round, run_round
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.presolve import sure_reasons
from radmpc.program.build import condensed_models
from radmpc.program.program import RiskItem
from radmpc.records import dataclass, replace
from radmpc.solvers.solution import Limits

__all__ = ["LeastRisk", "feasible_within", "least_risk"]

_UNIT = 0.49
"""The unit of risk, and with it the row risk cap [-]: below one half a row's tail is convex."""

_HazardKey = tuple[str, str, str | None]
"""Cause, vehicle, and what it may hit."""


@dataclass(frozen=True, slots=True, eq=False)
class LeastRisk:
    """How little a fleet can risk.

    Attributes
    ----------
    risk : float
        What the best plan found runs, by union bounds [-]; inf without one.
    bound : float
        What every plan runs at least, by union bounds [-]; inf where there is none at any risk.
    controls : tuple of (T, m) array
        That plan, per vehicle; empty without one.
    sets : tuple of tuple of int
        Vehicles that were planned together.
    takers : tuple of (RiskItem, float)
        The hazards of that plan, the greatest first, each with its worst step.
    stuck : tuple of int
        Vehicles that together have no plan at any risk; empty if there are none such.
    """

    risk: float
    bound: float
    controls: tuple[Matrix, ...] = ()
    sets: tuple[Members, ...] = ()
    takers: tuple[tuple[RiskItem, float], ...] = ()
    stuck: Members = ()


def least_risk(scenario: Scenario, limits: Limits, enough: float = 0.0) -> LeastRisk:
    """Minimize what a fleet risks.

    Parameters
    ----------
    scenario : Scenario
        The fleet, with the bound that was asked for.
    limits : Limits
        When to stop early.
    enough : float
        A plan that runs no more than this ends the search [-].

    Returns
    -------
    LeastRisk
        With the set that has no plan at all, if there is one.
    """
    lenient = replace(scenario, risk_bound=_UNIT)
    tolerance = TUNING.tolerance * scenario.risk_bound / _UNIT
    fleet = Fleet.of(lenient, tolerance, limits, is_costless=True)
    state = replace(SearchState.of(fleet), unit_price=1.0)
    best = LeastRisk(float("inf"), 0.0)
    if state.budget <= 0.0 or not fleet.programs.build_alone(limits):
        return best
    for effort in TUNING.efforts:
        state = replace(state, effort=effort)
        while True:
            state, found = run_round(fleet, state)
            if found is None or not found.is_initial:
                break
            best = _better(fleet, best, found)
            if best.risk <= enough:
                return best
        stuck = state.without_plan()
        if stuck is not None:
            return LeastRisk(float("inf"), float("inf"), stuck=stuck)
        if found is not None:
            best = _better(fleet, best, found)
        if best.risk <= enough or limits.reached or (found is not None and not found.is_limited):
            break
    return best


def feasible_within(scenario: Scenario, limits: Limits) -> bool | None:
    """Whether there is a plan within Δ by union bounds; None where the time given does not tell.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    limits : Limits
        When to stop looking.
    """
    if limits.reached:
        return None
    if sure_reasons(scenario, condensed_models(scenario)):
        return False
    found = least_risk(scenario, limits, scenario.risk_bound)
    if found.risk <= scenario.risk_bound:
        return True
    return False if found.bound > scenario.risk_bound else None


def _better(fleet: Fleet, best: LeastRisk, found: Round) -> LeastRisk:
    """Return the better of two plans, with the better bound."""
    initial = fleet.initial
    # At a price of 1, and with effort free, the value is the risk in units.
    bound = max(best.bound, fleet.unit * found.least + initial)
    presolved = sum(fleet.programs.problem(m).program.presolved_risk for m in found.sets)
    risk = initial + presolved + found.risk + found.inter_set_risk
    if risk >= best.risk:
        return replace(best, bound=min(bound, best.risk))
    points = [plan.z for plan in found.plans]
    controls = fleet.programs.controls(found.sets, points)
    return LeastRisk(risk, min(bound, risk), controls, found.sets, _takers(fleet, found))


def _takers(fleet: Fleet, found: Round) -> tuple[tuple[RiskItem, float], ...]:
    """Return what each hazard takes over the whole horizon, with its worst step."""
    total: dict[_HazardKey, float] = defaultdict(float)
    worst: dict[_HazardKey, tuple[float, RiskItem]] = {}
    names = [v.name for v in fleet.scenario.vehicles]
    for hazard in fleet.start_hazards:
        two = len(hazard.members) == 2
        other = names[hazard.members[1]] if two else hazard.other
        risk_item = RiskItem(hazard.cause, names[hazard.members[0]], other, 0)
        total[risk_item[:3]] += hazard.risk
        worst[risk_item[:3]] = (hazard.risk, risk_item)
    for members, plan in zip(found.sets, found.plans, strict=True):
        program = fleet.programs.problem(members).program
        risks = program.event_risks(plan.z, plan.selection)
        for event in np.flatnonzero(risks > 0.0):
            risk_item = program.risk_items[int(program.rows.risk_items[event])]
            key = risk_item[:3]
            total[key] += float(risks[event])
            if key not in worst or risks[event] > worst[key][0]:
                worst[key] = (float(risks[event]), risk_item)
    ranked = sorted(total, key=lambda key: -total[key])
    return tuple((worst[key][1], total[key]) for key in ranked)
