"""Why there is no plan, in terms of the scenario: vehicles, obstacles, steps and limits."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from itertools import combinations

import numpy as np

from radmpc.model.limits import outside_norms
from radmpc.model.scenario import Scenario
from radmpc.planners.conflicts import cannot_avoid, start_too_risky
from radmpc.planners.cures.trying import passage_sentence, reach_sentence
from radmpc.planners.endpoints.floors import floors
from radmpc.planners.planner import Planner
from radmpc.planners.policies.policy import SolveRequest
from radmpc.planners.presolve import Reason, enclosed_reasons, endpoint_reasons, grouped
from radmpc.planners.reaching.empty_space import in_empty_space
from radmpc.planners.reaching.limits import reach_texts, too_fast_texts
from radmpc.planners.reaching.reserves import overdrawn_texts
from radmpc.planners.reaching.visiting import makes_visits
from radmpc.planners.wording import endpoints_text, is_contact, limit_clause
from radmpc.program.build import build_program, condensed_models
from radmpc.program.condensed import CondensedModel
from radmpc.records import replace
from radmpc.solvers.branch.branch import Branch
from radmpc.solvers.lp.outcome import LpOutcome
from radmpc.solvers.lp.warm_lp import WarmLp
from radmpc.solvers.solution import Limits, Outcome

__all__ = [
    "explain_infeasible",
    "explain_stuck",
    "trivially_infeasible",
    "unable_alone",
]

_MAX_NODES = 2_000
"""Nodes to find out whether a vehicle or a pair alone has a plan [-]."""


def explain_infeasible(
    scenario: Scenario, planner: Planner, limits: Limits, fleet_bound: float | None = None
) -> str:
    """Find the simplest reason why vehicles cannot be planned.

    Tried in this order: feedback that needs more control than there is, goals out of reach, closed
    ways, risk at the start, things that cannot be avoided wherever the vehicles may be, single
    vehicles, pairs.

    Parameters
    ----------
    scenario : Scenario
        Vehicles that could not be planned, with their Δ.
    planner : Planner
        Risk policy and gap that they were planned with.
    limits : Limits
        When to stop looking.
    fleet_bound : float or None
        Δ of the whole fleet, of which these have a share; None where theirs is all of it.

    Returns
    -------
    str
        A few sentences, naming vehicles, obstacles and times.
    """
    models = condensed_models(scenario)
    unable = [
        Reason((i,), *texts)
        for i, model in enumerate(models)
        if (texts := unable_alone(scenario, model)) is not None
    ]
    if unable:
        late = [i for reason in unable for i in reason.members]
        cure = reach_sentence(scenario, late, partial(_finds_way, planner), limits)
        return " ".join(filter(None, [*(text for _, text in grouped(scenario, unable)), cure]))
    closed = enclosed_reasons(scenario)
    if closed:
        return " ".join(text for _, text in grouped(scenario, closed))
    text, members = _no_way(scenario, planner, limits)
    if not members:
        return text
    part = scenario.subset(members, scenario.risk_bound)
    cure = passage_sentence(part, partial(_finds_way, planner), limits, fleet_bound)
    return " ".join(filter(None, [text, _share_text(scenario, fleet_bound), cure]))


def _share_text(scenario: Scenario, fleet_bound: float | None) -> str:
    """Say what share of the fleet's Δ some vehicles have; empty where it is all of it."""
    if fleet_bound is None or scenario.risk_bound >= fleet_bound * (1.0 - 1e-9):
        return ""
    whose = "Its" if scenario.num_vehicles == 1 else "Their"
    return (
        f"{whose} share of risk_bound {fleet_bound:g}, by head count, is {scenario.risk_bound:g}."
    )


def _no_way(scenario: Scenario, planner: Planner, limits: Limits) -> tuple[str, tuple[int, ...]]:
    """Say which vehicles have no route: alone, in pairs or together."""
    everyone = tuple(range(scenario.num_vehicles))
    reason = trivially_infeasible(scenario, deterministic=planner.policy.family == "deterministic")
    if reason:
        return reason, everyone
    is_open = False
    blocked = []
    for i in everyone:
        outcome = _solved_alone(scenario, (i,), planner, limits)
        if outcome is Outcome.INFEASIBLE:
            blocked.append(_no_way_alone(scenario, i, planner))
        is_open |= outcome is Outcome.LIMIT
    if blocked:
        alone = tuple(i for reason in blocked for i in reason.members)
        return " ".join(text for _, text in grouped(scenario, blocked)), alone
    for members in combinations(everyone, 2):
        outcome = _solved_alone(scenario, members, planner, limits)
        if outcome is Outcome.INFEASIBLE:
            return _no_way_together(scenario, members, planner), members
        is_open |= outcome is Outcome.LIMIT
    if is_open:
        return f"{_OPEN}: {limit_clause(limits)}", ()
    return _general(planner), everyone


def _finds_way(planner: Planner, scenario: Scenario, limits: Limits) -> bool:
    """Whether vehicles have a plan together, by the rows of a planner."""
    models = condensed_models(scenario)
    if any(unable_alone(scenario, model) is not None for model in models):
        return False
    deterministic = planner.policy.family == "deterministic"
    if trivially_infeasible(scenario, deterministic=deterministic) is not None:
        return False
    everyone = tuple(range(scenario.num_vehicles))
    outcome = _solved_alone(scenario, everyone, planner, limits)
    return outcome in {Outcome.OPTIMAL, Outcome.FEASIBLE}


def explain_stuck(
    scenario: Scenario, stuck: Sequence[int], planner: Planner, limits: Limits
) -> str | None:
    """Say why some vehicles have no plan on their share of the risk.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    stuck : sequence of int
        Those without a plan.
    planner : Planner
        Risk policy and gap that they were planned with.
    limits : Limits
        When to stop looking.

    Returns
    -------
    str or None
        None where all have a plan.
    """
    if not stuck:
        return None
    whole = scenario.risk_bound
    if planner.policy.family == "deterministic":
        return explain_infeasible(scenario.subset(stuck, whole), planner, limits)
    share = whole * len(stuck) / scenario.num_vehicles
    return explain_infeasible(scenario.subset(stuck, share), planner, limits, whole)


def trivially_infeasible(scenario: Scenario, *, deterministic: bool = False) -> str | None:
    """Say if starts are too risky, or things cannot be avoided wherever the vehicles may be.

    Parameters
    ----------
    scenario : Scenario
        The vehicles, with their Δ.
    deterministic : bool
        Whether risk counts only where it means contact.

    Returns
    -------
    str or None
        The reason, naming vehicles, obstacle and time.
    """
    models = condensed_models(scenario)
    program = build_program(scenario, models, risk_bound=scenario.risk_bound)
    found = floors(scenario, models)
    if not deterministic:
        sure = endpoint_reasons(scenario, found)
        if sure:
            return " ".join(text for _, text in grouped(scenario, sure))
    risks = [risk for _, risk in program.initial]
    # Who ignores noise starts wherever means are free, whatever all starts risk together.
    at_start = max(risks, default=0.0) if deterministic else max(program.initial_risk, sum(risks))
    if risks and at_start >= (0.5 if deterministic else program.risk_bound):
        return start_too_risky(program, at_start)
    infeasible = np.flatnonzero(np.diff(program.avoidance_starts) == 0)
    if infeasible.size:
        taken = [place for place in found.goals if is_contact(scenario, place)]
        if taken:
            return endpoints_text(scenario, taken[:1], taken[0].risk)
        return cannot_avoid(scenario, program.avoidances[int(infeasible[0])])
    return None


_OPEN = "No plan was found, and a limit ended the search for the reason"
"""Said where nothing was ruled out; which limit follows."""


def _general(planner: Planner) -> str:
    """Say that no smaller group explains it."""
    within = "" if planner.policy.family == "deterministic" else " within the risk bound"
    return f"Each vehicle and each pair can be planned, but not all together{within}."


def unable_alone(scenario: Scenario, model: CondensedModel) -> tuple[str, str] | None:
    """Say if a vehicle cannot even make its visits and reach its goal through empty space.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    model : CondensedModel
        The vehicle over the whole horizon.

    Returns
    -------
    tuple of str or None
        What follows "Vehicle 'name'", and the same of several vehicles.
    """
    sure = overdrawn_texts(model) or too_fast_texts(model)
    if sure is not None:
        return sure
    alone = in_empty_space(scenario, model.vehicle)
    if _is_able_alone(alone, model):
        return None
    texts, outside = reach_texts(scenario, model), outside_norms(model.vehicle)
    if outside is model.vehicle:
        return texts
    beyond = replace(alone, vehicles=(outside,))
    if not _is_able_alone(beyond, *condensed_models(beyond)):
        return texts
    # The limits themselves may be enough, and what keeps to a polytope within them is not.
    kept = "limits, of whose norms plans keep to a polytope within"
    one, many = (text.replace("limits", kept, 1) for text in texts)
    return one, many


def _is_able_alone(alone: Scenario, model: CondensedModel) -> bool:
    """Whether linear programs lead a vehicle through empty space, or cannot tell."""
    empty = build_program(alone, [model], risk_bound=alone.risk_bound)
    outcome, _ = WarmLp(empty, np.zeros(empty.rows.count)).solve()
    return outcome is not LpOutcome.INFEASIBLE and makes_visits(model) is not False


def _solved_alone(
    scenario: Scenario, members: tuple[int, ...], planner: Planner, limits: Limits
) -> Outcome:
    """Return how planning some of the vehicles alone with the whole Δ ends."""
    if limits.reached:
        return Outcome.LIMIT
    alone = scenario.subset(members, scenario.risk_bound)
    program = build_program(alone, condensed_models(alone), risk_bound=scenario.risk_bound)
    request = SolveRequest(program, Branch(_MAX_NODES), planner.gap, limits, "explain", ())
    return planner.policy.solve(request).solution.outcome


def _no_way_together(scenario: Scenario, members: tuple[int, ...], planner: Planner) -> str:
    """Name two vehicles for which no plan was found even with the whole Δ to themselves."""
    first, second = (repr(scenario.vehicles[i].name) for i in members)
    sought = planner.policy.sought(scenario.risk_bound)
    # Two that never meet share Δ all the same, and what two keep may be their range.
    shares = planner.policy.family != "deterministic"
    is_in_way = not shares and not scenario.subset(members, scenario.risk_bound).keep
    which = "past each other" if is_in_way else "for both"
    return f"Vehicles {first} and {second} alone find no path {which} {sought}."


def _no_way_alone(scenario: Scenario, i: int, planner: Planner) -> Reason:
    """Return why one vehicle has no plan even with the whole Δ to itself."""
    alone = scenario.subset((i,), scenario.risk_bound)
    program = build_program(alone, condensed_models(alone), risk_bound=scenario.risk_bound)
    hazards = dict.fromkeys(
        repr(e.other) if e.other else "the workspace border" for e in program.risk_items
    )
    sought = planner.policy.sought(scenario.risk_bound)
    text = f"finds no path {sought}; near are {', '.join(hazards)}."
    return Reason((i,), f"alone {text}", f"each {text.replace('finds', 'find', 1)}")
