"""Why a fleet has no plan: which vehicles are stuck, what bound would do, what would help."""

from __future__ import annotations

from collections.abc import Sequence

from radmpc.model.scenario import Scenario
from radmpc.planners.certified.infeasible.answer import WhyNot
from radmpc.planners.certified.infeasible.cures import cure_sentence, endpoint_sentence
from radmpc.planners.certified.infeasible.ended import ended
from radmpc.planners.certified.infeasible.least_risk import LeastRisk, least_risk
from radmpc.planners.certified.infeasible.stuck import stuck_reason
from radmpc.planners.certified.infeasible.tuning import TUNING
from radmpc.planners.explain import unable_alone
from radmpc.planners.presolve import Reason, grouped
from radmpc.planners.within_norms import models_within_norms
from radmpc.planners.wording import hazard_name, limit_clause
from radmpc.rounding import rounded_down, rounded_up
from radmpc.solvers.solution import Limits

__all__ = ["describe_certain", "why_not"]

_WHOLE_STEPS = (
    "Along intervals plans by faces pass everything on one side over a whole step: shorter steps "
    "may leave a way."
)
"""Said of what a search ruled out: the referee looks at parts of a step, each with its own side."""

_NAMED = 3
"""Hazards of the safest plan that are named [-]."""


def describe_certain(scenario: Scenario, reasons: Sequence[Reason], limits: Limits) -> WhyNot:
    """Say what rules out a plan without a search, and what the other vehicles could do.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    reasons : sequence of Reason
        What is certain, at least one.
    limits : Limits
        When to stop looking at what would help, and at the others.

    Returns
    -------
    WhyNot
        A proof.
    """
    stuck = {i for reason in reasons for i in reason.members}
    rest = tuple(i for i in range(scenario.num_vehicles) if i not in stuck)
    texts = _told(scenario, reasons, limits)
    if rest:
        part = scenario.subset(rest, scenario.risk_bound)
        quick = limits.within(TUNING.quick_seconds)
        found = least_risk(part, quick, part.risk_bound)
        if found.stuck:
            members, text, many = stuck_reason(part, found.stuck, quick)
            other = Reason(tuple(rest[i] for i in members), text, many)
            texts += [sentence for _, sentence in grouped(scenario, [other])]
        elif found.risk <= part.risk_bound:
            texts.append(f"{_others(len(rest))} can be planned within the risk bound.")
    return WhyNot(" ".join(texts), is_proven=True, rules_out_any=True)


def why_not(scenario: Scenario, limits: Limits) -> WhyNot:
    """Find out why a fleet has no plan within its bound.

    Vehicles that cannot be planned at any risk are named and left out, until the rest can be:
    what is wrong with some never hides what the others could do.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    limits : Limits
        When to stop looking.

    Returns
    -------
    WhyNot
        The reasons.
    """
    reasons = []
    models = models_within_norms(scenario)
    for i, model in enumerate(models):
        if limits.reached:
            break
        unable = unable_alone(scenario, model)
        if unable is not None:
            reasons.append(Reason((i,), *unable))
    slow = {i for reason in reasons for i in reason.members}
    rest = [i for i in range(scenario.num_vehicles) if i not in slow]
    found: LeastRisk | None = None
    while rest and not limits.reached and len(reasons) < TUNING.max_conflicts:
        part = scenario.subset(tuple(rest), scenario.risk_bound)
        found = least_risk(part, limits)
        if not found.stuck:
            break
        members, text, many = stuck_reason(part, found.stuck, limits)
        reasons.append(Reason(tuple(rest[i] for i in members), text, many))
        rest = [i for place, i in enumerate(rest) if place not in found.stuck]
    if reasons:
        texts = _told(scenario, reasons, limits)
        if len(slow) < len({i for reason in reasons for i in reason.members}):
            texts += _of_whole_steps(scenario)
        if found is not None and not found.stuck:
            texts.append(_of_rest(part, found, limits))
        blocked = () if slow else tuple(sorted({i for r in reasons for i in r.members}))
        # A vehicle late in empty space is late whatever half-spaces keep it clear of others.
        return WhyNot(" ".join(texts), is_proven=True, blocked=blocked, rules_out_any=bool(slow))
    if found is None:  # a limit came first
        return WhyNot(ended(scenario, limits, models), is_proven=False)
    # Above Δ by union bounds, the safest plan may still be within it by the referee's.
    is_proven = found.bound > scenario.risk_bound
    text = _too_much(scenario, found, limits)
    if is_proven:
        texts = [text, cure_sentence(scenario, limits), *_of_whole_steps(scenario)]
        text = " ".join(filter(None, texts))
    everyone = tuple(range(scenario.num_vehicles)) if is_proven else ()
    return WhyNot(text, is_proven, found.controls, found.sets, everyone)


def _of_whole_steps(scenario: Scenario) -> list[str]:
    """Return the sentence that says what a search along intervals rules out; none at steps."""
    return [_WHOLE_STEPS] if scenario.avoidance == "intervals" else []


def _told(scenario: Scenario, reasons: Sequence[Reason], limits: Limits) -> list[str]:
    """Return reasons in words, each with what would help, as far as that can be tried."""
    texts, left = [], TUNING.cured
    for group, sentence in grouped(scenario, reasons):
        texts.append(sentence)
        whom = group or next((one.members for one in reasons if one.text == sentence), None)
        if whom is None or left == 0:
            continue
        left -= 1
        if group is None:
            cure = endpoint_sentence(scenario, whom, limits)
        else:
            cure = cure_sentence(scenario.subset(whom, scenario.risk_bound), limits)
        if cure:
            texts.append(cure)
    return texts


def _others(count: int) -> str:
    """Name vehicles of which nothing is wrong."""
    return f"The other {count} vehicles" if count > 1 else "The other vehicle"


def _of_rest(part: Scenario, found: LeastRisk, limits: Limits) -> str:
    """Say what the other vehicles can do."""
    others = _others(part.num_vehicles)
    if found.risk <= part.risk_bound:
        return f"{others} can be planned within the risk bound."
    if found.bound > part.risk_bound:
        return f"{others}: {_too_much(part, found, limits)}"
    return f"{others}: no plan was found, and none was ruled out."


def _too_much(scenario: Scenario, found: LeastRisk, limits: Limits) -> str:
    """Say what bound would do, and what takes it."""
    bound = f"risk_bound {scenario.risk_bound:g}"
    if not found.controls:
        return f"No plan was found at any risk, and none was ruled out: {limit_clause(limits)}"
    if found.risk <= scenario.risk_bound:
        return (
            f"No plan was certified within {bound}, and none was ruled out: {limit_clause(limits)}"
        )
    takers = "; ".join(
        f"{hazard_name(risk_item)} around step {risk_item.step} ({risk:.2g})"
        for risk_item, risk in found.takers[:_NAMED]
    )
    if found.bound > scenario.risk_bound:
        head = (
            f"No plan is within {bound} by union bounds with the faces of this scenario: every "
            f"such plan runs at least {rounded_down(found.bound):.2g}."
        )
    else:
        head = f"No plan within {bound} was found, and none was ruled out: {limit_clause(limits)}"
    advice = ""
    if found.risk < 0.5:
        advice = f" Raise risk_bound to {rounded_up(found.risk):.2g}, at which there is one."
    return (
        f"{head} The safest found runs {rounded_up(found.risk):.2g}, most of it {takers}.{advice}"
    )
