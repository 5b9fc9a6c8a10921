"""Sentences about dangers, and numbers rounded to the safe side."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, floor, log10

from radmpc.model.scenario import Scenario
from radmpc.planners.endpoint_risk import Danger
from radmpc.solvers.solution import Limits

__all__ = [
    "is_contact",
    "limit_clause",
    "listed",
    "places_text",
    "rounded",
    "rounded_down",
    "rounded_up",
]

_NAMED = 3


def listed(names: Sequence[str], last: str = "and") -> str:
    """Return names in a row, three at most and how many others there are."""
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
    """Return a risk in as many digits, two at least, as tell it from a bound."""
    for digits in range(2, 17):
        text = f"{risk:.{digits}g}"
        if (float(text) > bound) == (risk > bound) and float(text) != bound:
            break
    return text


def rounded_up(risk: float) -> str:
    """Return a risk in two digits, not below it."""
    unit = 10.0 ** (floor(log10(max(risk, 1e-300))) - 1)
    return f"{ceil(risk / unit * (1.0 - 1e-9)) * unit:.2g}"


def rounded_down(risk: float) -> str:
    """Return a risk in two digits, not above it."""
    unit = 10.0 ** (floor(log10(max(risk, 1e-300))) - 1)
    return f"{floor(risk / unit * (1.0 + 1e-9)) * unit:.2g}"


def is_contact(scenario: Scenario, danger: Danger) -> bool:
    """Whether means touch, or leave the workspace, wherever they are in a place."""
    reach = sum(scenario.vehicles[i].radius for i in danger.members)
    return danger.distance < (0.0 if danger.cause == "workspace" else reach)


def places_text(scenario: Scenario, dangers: Sequence[Danger], risk: float) -> str:
    """Return what places risk at least, which is above Δ.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    dangers : sequence of Danger
        One, or the greatest first.
    risk : float
        What they risk together.

    Returns
    -------
    str
        Where and what, the numbers, and what would help.
    """
    bound = f"risk_bound {scenario.risk_bound:g}"
    if len(dangers) == 1:
        return _one(scenario, dangers[0], rounded(risk, scenario.risk_bound), bound)
    number = rounded(risk, scenario.risk_bound)
    parts = [f"{_what(scenario, d)} ({d.risk:.2g})" for d in dangers[:_NAMED]]
    hidden = len(dangers) - len(parts)
    more = f"; and {hidden} more" if hidden > 0 else ""
    return (
        f"Starts and goals alone run a risk of {number}, above {bound}: "
        f"{'; '.join(parts)}{more}. Move them, reduce the noise, or raise risk_bound."
    )


def _what(scenario: Scenario, danger: Danger) -> str:
    """Name a danger and its place."""
    names = [repr(scenario.vehicles[i].name) for i in danger.members]
    place = "goal" if danger.at_goal else "start"
    if danger.cause == "pair":
        return f"the {place}s of {names[0]} and {names[1]}"
    what = "the workspace border" if danger.other is None else f"obstacle {danger.other!r}"
    return f"the {place} of {names[0]} at {what}"


def _one(scenario: Scenario, danger: Danger, number: str, bound: str) -> str:
    """Return the sentence about one danger."""
    names = [repr(scenario.vehicles[i].name) for i in danger.members]
    radii = [scenario.vehicles[i].radius for i in danger.members]
    risk = f"a risk of {number}"
    if danger.risk > scenario.risk_bound:
        risk += f", above {bound}"
    cure = "" if danger.at_goal else " or reduce initial_covariance"
    place = "goal" if danger.at_goal else "start"
    if danger.cause == "pair":
        return _pair(scenario, danger, names, risk)
    best = "even its best point is" if danger.at_goal else "it is"
    if danger.cause == "workspace":
        if danger.distance < 0.0:
            return (
                f"The {place} of vehicle {names[0]} lies outside the workspace. Move the {place}."
            )
        where = f"{best} {danger.distance:.3g} m from the border"
        head = f"The {place} of vehicle {names[0]} is too close to the workspace border"
    else:
        if is_contact(scenario, danger):
            return (
                f"The {place} of vehicle {names[0]} lies within obstacle {danger.other!r} grown by "
                f"the vehicle's radius of {radii[0]:g} m ({risk}). Move the {place}."
            )
        where = f"{best} {danger.distance:.3g} m from it, at a radius of {radii[0]:g} m,"
        head = f"The {place} of vehicle {names[0]} is too close to obstacle {danger.other!r}"
    if danger.at_goal:
        cure = ", or reduce the noise"
    return f"{head}: {where} and runs {risk}. Move the {place} away{cure}."


def _pair(scenario: Scenario, danger: Danger, names: Sequence[str], risk: str) -> str:
    """Return the sentence about two places."""
    place = "goals" if danger.at_goal else "starts"
    radii = [scenario.vehicles[i].radius for i in danger.members]
    need = f"{radii[0] + radii[1]:.3g} m (radii {radii[0]:g} and {radii[1]:g} m)"
    most = "at most " if danger.at_goal else ""
    apart = f"{most}{danger.distance:.3g} m apart"
    head = f"The {place} of vehicles {names[0]} and {names[1]} are too close to each other"
    if is_contact(scenario, danger):
        return (
            f"{head}: they overlap, {apart} where {need} are needed ({risk}). Move a {place[:-1]}."
        )
    cure = "the noise" if danger.at_goal else "initial_covariance"
    return (
        f"{head}: they are {apart}, contact is at {need}, and that alone runs {risk}. "
        f"Move a {place[:-1]} or reduce {cure}."
    )
