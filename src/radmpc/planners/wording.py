"""Sentences about hazards, and numbers rounded to the safe side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from radmpc.model.plan import Cause
from radmpc.model.scenario import Scenario
from radmpc.planners.endpoints.floors import EndpointHazard
from radmpc.planners.endpoints.ranges import LostRange
from radmpc.planners.endpoints.strays import Stray, stray_of
from radmpc.program.program import RiskItem
from radmpc.solvers.solution import Limits

__all__ = [
    "endpoints_text",
    "hazard_name",
    "is_contact",
    "least_text",
    "limit_clause",
    "listed",
    "lost_range_text",
    "rounded",
    "stray_text",
]

_NAMED = 3
"""Names or hazards that a sentence lists at most [-]; it says how many others there are."""

_ROUNDING = 1e-6
"""By how much a probability may exceed 1 [-]: the error of the integrals."""


def listed(names: Sequence[str], last: str = "and") -> str:
    """Return names as a list in words, three at most and how many others there are.

    Parameters
    ----------
    names : sequence of str
        One or more.
    last : str
        The word before the last.
    """
    if len(names) > _NAMED + 1:
        names = [*names[:_NAMED], f"{len(names) - _NAMED} more"]
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} {last} {names[-1]}"


def limit_clause(limits: Limits) -> str:
    """Return which limit ended a search, and what to do about it, after a colon."""
    if not limits.reason:
        return "the searches ended at their limits of nodes."
    advice = "" if limits.is_stopped() else " Raise it."
    return f"{limits.reason}.{advice}"


def rounded(risk: float, bound: float) -> str:
    """Return a risk in as many digits, two at least, as tell it from a bound; 1 at most.

    Parameters
    ----------
    risk, bound : float
        Probabilities [-].
    """
    if risk > 1.0 + _ROUNDING:
        # A sum of bounds on probabilities.
        return "1 or more"
    for digits in range(2, 17):
        text = f"{risk:.{digits}g}"
        if (float(text) > bound) == (risk > bound) and float(text) != bound:
            break
    return text


def least_text(risk: float) -> str:
    """Return what is risked at least in two digits; 1 at most.

    Parameters
    ----------
    risk : float
        A sum of bounds on probabilities [-].
    """
    return "1 or more" if risk > 1.0 + _ROUNDING else f"{risk:.2g}"


def is_contact(scenario: Scenario, hazard: EndpointHazard) -> bool:
    """Whether the means touch, or leave the workspace, wherever they are at an endpoint.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    hazard : EndpointHazard
        What may happen there.
    """
    reach = sum(scenario.vehicles[i].radius for i in hazard.members)
    return hazard.distance < (0.0 if hazard.cause == "workspace" else reach)


def endpoints_text(scenario: Scenario, hazards: Sequence[EndpointHazard], risk: float) -> str:
    """Return what starts and goals risk at least, which is above Δ.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    hazards : sequence of EndpointHazard
        One, or the greatest first.
    risk : float
        What they risk together.

    Returns
    -------
    str
        Where and what, and the numbers.
    """
    bound = f"risk_bound {scenario.risk_bound:g}"
    if len(hazards) == 1:
        return _one(scenario, hazards[0], rounded(risk, scenario.risk_bound), bound)
    number = rounded(risk, scenario.risk_bound)
    parts = [f"{_what(scenario, d)} ({least_text(d.risk)})" for d in hazards[:_NAMED]]
    hidden = len(hazards) - len(parts)
    more = f"; and {hidden} more" if hidden > 0 else ""
    aside = ", ranges aside," if scenario.keep else ""
    return (
        f"Starts and goals alone{aside} run a risk of {number}, above {bound}: "
        f"{'; '.join(parts)}{more}."
    )


def _what(scenario: Scenario, hazard: EndpointHazard) -> str:
    """Name a hazard and the endpoint."""
    names = [repr(scenario.vehicles[i].name) for i in hazard.members]
    place = "goal" if hazard.at_goal else "start"
    if hazard.cause == "pair":
        return f"the {place}s of {names[0]} and {names[1]}"
    what = "the workspace border" if hazard.other is None else f"obstacle {hazard.other!r}"
    return f"the {place} of {names[0]} at {what}"


def _one(scenario: Scenario, hazard: EndpointHazard, number: str, bound: str) -> str:
    """Return the sentence about one hazard."""
    names = [repr(scenario.vehicles[i].name) for i in hazard.members]
    radii = [scenario.vehicles[i].radius for i in hazard.members]
    risk = f"a risk of {number}"
    if hazard.risk > scenario.risk_bound:
        risk += f", above {bound}"
    place = "goal" if hazard.at_goal else "start"
    if hazard.cause == "pair":
        return _pair(scenario, hazard, names, risk)
    best = "even its best point is" if hazard.at_goal else "it is"
    if hazard.cause == "workspace":
        if hazard.distance < 0.0:
            return f"The {place} of vehicle {names[0]} lies outside the workspace."
        stray = stray_of(scenario, hazard)
        if stray is not None:
            return stray_text(scenario, names, [stray], at_goal=hazard.at_goal)
        where = f"{best} {hazard.distance:.3g} m from the border"
        head = f"The {place} of vehicle {names[0]} is too close to the workspace border"
    else:
        if is_contact(scenario, hazard):
            return (
                f"The {place} of vehicle {names[0]} lies within obstacle {hazard.other!r} grown by "
                f"the vehicle's radius of {radii[0]:g} m ({risk})."
            )
        where = f"{best} {hazard.distance:.3g} m from it, at a radius of {radii[0]:g} m,"
        head = f"The {place} of vehicle {names[0]} is too close to obstacle {hazard.other!r}"
    return f"{head}: {where} and runs {risk}."


def _pair(scenario: Scenario, hazard: EndpointHazard, names: Sequence[str], risk: str) -> str:
    """Return the sentence about two places."""
    place = "goals" if hazard.at_goal else "starts"
    radii = [scenario.vehicles[i].radius for i in hazard.members]
    need = f"{radii[0] + radii[1]:.3g} m (radii {radii[0]:g} and {radii[1]:g} m)"
    most = "at most " if hazard.at_goal else ""
    apart = f"{most}{hazard.distance:.3g} m apart"
    head = f"The {place} of vehicles {names[0]} and {names[1]} are too close to each other"
    if is_contact(scenario, hazard):
        return f"{head}: they overlap, {apart} where {need} are needed ({risk})."
    return f"{head}: they are {apart}, contact is at {need}, and that alone runs {risk}."


def stray_text(
    scenario: Scenario, names: Sequence[str], strays: Sequence[Stray], *, at_goal: bool
) -> str:
    """Say that vehicles stray too far for the workspace, wherever their starts or goals are.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    names : sequence of str
        The vehicles, one or more.
    strays : sequence of Stray
        How far each of them strays.
    at_goal : bool
        At their goals rather than at their starts.

    Returns
    -------
    str
        A sentence.
    """
    place, bound = "goal" if at_goal else "start", scenario.risk_bound
    least = min(strays, key=lambda stray: stray.deviation)
    risk = rounded(min(stray.risk for stray in strays), bound)
    causes = {
        "open loop": "; without feedback that grows with every step",
        "feedback": "; under this feedback that grows with every step",
    }
    why = causes.get(least.grows or "", "") if len({one.grows for one in strays}) == 1 else ""
    if len(strays) == 1:
        head = f"Vehicle {names[0]} strays too far for the workspace: its standard deviation"
        where = f"at its {place} is {least.deviation:.3g} m"
        who = "it"
    else:
        head = f"Vehicles {listed(names)} stray too far for the workspace: standard deviations"
        where = f"at their {place}s are {least.deviation:.3g} m or more"
        who = "each"
    return (
        f"{head} {where}, and even in the middle {who} would run a risk of {risk} to leave it, "
        f"above risk_bound {bound:g}{why}."
    )


def hazard_name(risk_item: RiskItem) -> str:
    """Return the parties of a hazard in words.

    Parameters
    ----------
    risk_item : RiskItem
        The hazard.
    """
    cause: Cause | Literal["visit"] = risk_item.cause
    if cause == "visit":
        return f"vehicle {risk_item.vehicle!r} and its {risk_item.other}"
    if cause == "pair":
        return f"vehicles {risk_item.vehicle!r} and {risk_item.other!r}"
    if cause == "obstacle":
        return f"vehicle {risk_item.vehicle!r} and obstacle {risk_item.other!r}"
    if cause == "range":
        return f"the range that {risk_item.vehicle!r} and {risk_item.other!r} keep"
    return f"vehicle {risk_item.vehicle!r} and the workspace border"


def lost_range_text(scenario: Scenario, lost: LostRange) -> str:
    """Say that two vehicles begin or end out of the range that they keep.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    lost : LostRange
        Who, and how far apart.

    Returns
    -------
    str
        A sentence.
    """
    one, two = (repr(scenario.vehicles[i].name) for i in lost.members)
    what, more = ("goals", " or more") if lost.at_goal else ("starts", "")
    return (
        f"The {what} of vehicles {one} and {two} are {lost.distance:.4g} m apart{more}: there they "
        f"lose the range that they keep ({lost.within:g} m) with probability "
        f"{lost.risk:.3g}{more}, and risk_bound is {scenario.risk_bound:g}."
    )
