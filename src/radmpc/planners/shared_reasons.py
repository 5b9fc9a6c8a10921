"""Starts or goals of several vehicles at fault for the same reason: one sentence names them all."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from radmpc.model.scenario import Scenario
from radmpc.planners.endpoints.floors import EndpointHazard
from radmpc.planners.endpoints.ranges import LostRange
from radmpc.planners.endpoints.strays import stray_of
from radmpc.planners.wording import (
    endpoints_text,
    is_contact,
    listed,
    lost_range_text,
    rounded,
    stray_text,
)

if TYPE_CHECKING:
    from radmpc.planners.endpoints.visiting import RiskyVisit
    from radmpc.program.condensed import CondensedModel

__all__ = [
    "ROUNDING",
    "endpoint_sentences",
    "goal_sentence",
    "range_sentences",
    "visit_sentences",
]

ROUNDING = 1e-6
"""Share of Δ by which a risk must exceed it to count as above [-]: the error of the integrals."""

_SHARED = 3
"""Vehicles with the same reason from which on one sentence names them all [-]."""


def endpoint_sentences(
    scenario: Scenario, hazards: Sequence[EndpointHazard]
) -> list[tuple[tuple[int, ...], str]]:
    """Return what is wrong with starts and goals, each of which is above Δ by itself.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    hazards : sequence of EndpointHazard
        Those starts and goals.

    Returns
    -------
    list of (tuple of int, str)
        Vehicles, and the sentence about them: one where three or more share the reason.
    """
    told = []
    for group in _groups(scenario, hazards):
        members = tuple(sorted({i for hazard in group for i in hazard.members}))
        if len(members) < _SHARED:
            told += [(d.members, endpoints_text(scenario, (d,), d.risk)) for d in group]
        elif group[0].cause == "pair":
            told.append((members, _pairs_text(scenario, members, group)))
        else:
            told.append((members, _shared_text(scenario, members, group)))
    return told


def range_sentences(
    scenario: Scenario, found: Sequence[LostRange]
) -> list[tuple[tuple[int, ...], str]]:
    """Return which vehicles begin or end out of the range that they keep.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    found : sequence of LostRange
        What its starts and goals risk of ranges.

    Returns
    -------
    list of (tuple of int, str)
        Two vehicles, and the sentence about them, where that alone is above Δ.
    """
    threshold = scenario.risk_bound * (1.0 + ROUNDING)
    return [(one.members, lost_range_text(scenario, one)) for one in found if one.risk > threshold]


def visit_sentences(
    scenario: Scenario, models: Sequence[CondensedModel]
) -> list[tuple[tuple[int, ...], str]]:
    """Return which vehicles have a visit that alone is above Δ.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    models : sequence of CondensedModel
        Its vehicles over the whole horizon.

    Returns
    -------
    list of (tuple of int, str)
        A vehicle, and the sentence about the first such visit of it.
    """
    if not any(vehicle.via for vehicle in scenario.vehicles):
        return []
    from radmpc.planners.endpoints.visiting import risky_visits  # noqa: PLC0415 - few visit anything

    told: dict[int, str] = {}
    for found in risky_visits(scenario, models, scenario.risk_bound * (1.0 + ROUNDING)):
        told.setdefault(found.vehicle, _visit_text(scenario, found))
    return [((i,), text) for i, text in told.items()]


def _visit_text(scenario: Scenario, found: RiskyVisit) -> str:
    """Return why a visit alone is above Δ."""
    vehicle, (first, last) = scenario.vehicles[found.vehicle], found.steps
    when = f"at step {first}" if first == last else f"at any step from {first} to {last}"
    bound = scenario.risk_bound
    risk = f"a risk of {rounded(found.risk, bound)} {when}, above risk_bound {bound:g}"
    head = f"The box of via[{found.visit}] of vehicle {vehicle.name!r}"
    if found.within is not None:
        return (
            f"{head} lies within obstacle {found.within!r} grown by the vehicle's radius of "
            f"{vehicle.radius:g} m ({risk})."
        )
    return _too_close(head, found.hazards, risk)


def goal_sentence(scenario: Scenario, hazards: Sequence[EndpointHazard], risk: float) -> str:
    """Return why a goal is above Δ that is so by nothing alone: what it is near is so together.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    hazards : sequence of EndpointHazard
        What the goal of one vehicle is near, other vehicles aside. Each has a best point of its
        own, so that they may risk much less than the sum at any one point.
    risk : float
        Of all of them at the best point [-].

    Returns
    -------
    str
        A sentence.
    """
    bound, (i,) = scenario.risk_bound, hazards[0].members
    head = f"The goal of vehicle {scenario.vehicles[i].name!r}"
    told = f"a risk of {rounded(risk, bound)}, above risk_bound {bound:g}"
    return _too_close(head, hazards, told)


def _too_close(head: str, hazards: Sequence[EndpointHazard], risk: str) -> str:
    """Return the sentence about a box that is near several things at once."""
    names = ["the workspace border" if one.other is None else f"obstacle {one.other!r}"
             for one in hazards]  # fmt: skip
    return f"{head} is too close to {listed(names)}: even its best point runs {risk}."


def _groups(scenario: Scenario, hazards: Sequence[EndpointHazard]) -> list[list[EndpointHazard]]:
    """Return hazards of one reason; of pairs, those that hang together."""
    groups: list[list[EndpointHazard]] = []
    for hazard in hazards:
        akin = [g for g in groups if _is_akin(scenario, g, hazard)]
        for group in akin:
            groups.remove(group)
        groups.append([*(one for group in akin for one in group), hazard])
    return groups


def _is_akin(scenario: Scenario, group: Sequence[EndpointHazard], hazard: EndpointHazard) -> bool:
    """Whether a hazard has the reason of a group."""
    first = group[0]
    if (first.cause, first.at_goal) != (hazard.cause, hazard.at_goal):
        return False
    if is_contact(scenario, first) != is_contact(scenario, hazard):
        return False
    if (stray_of(scenario, first) is None) != (stray_of(scenario, hazard) is None):
        return False
    if hazard.cause != "pair":
        return True
    return any(set(one.members) & set(hazard.members) for one in group)


def _pairs_text(scenario: Scenario, members: Sequence[int], group: Sequence[EndpointHazard]) -> str:
    """Return the sentence about starts or goals too close to each other."""
    place = "goals" if group[0].at_goal else "starts"
    nearest = min(group, key=lambda hazard: hazard.distance)
    names = [repr(scenario.vehicles[i].name) for i in nearest.members]
    contact = sum(scenario.vehicles[i].radius for i in nearest.members)
    most = "at most " if nearest.at_goal else ""
    return (
        f"The {place} of vehicles {_names(scenario, members)} are too close to each other: those "
        f"of {' and '.join(names)} are {most}{nearest.distance:.3g} m apart, contact is at "
        f"{contact:.3g} m ({_risks(scenario, group)})."
    )


def _shared_text(
    scenario: Scenario, members: Sequence[int], group: Sequence[EndpointHazard]
) -> str:
    """Return the sentence about starts or goals too close to obstacles or to the border."""
    first, *_ = group = sorted(group, key=lambda hazard: hazard.members)
    place = "goals" if first.at_goal else "starts"
    head = f"The {place} of vehicles {_names(scenario, members)}"
    obstacles = list(dict.fromkeys(repr(d.other) for d in group if d.other is not None))
    what = f"obstacle{'s' if len(obstacles) > 1 else ''} {listed(obstacles)}" if obstacles else ""
    risks = _risks(scenario, group)
    if is_contact(scenario, first):
        if first.cause == "workspace":
            return f"{head} lie outside the workspace."
        return f"{head} lie within {what} grown by the vehicles' radii ({risks})."
    strays = [stray for stray in (stray_of(scenario, hazard) for hazard in group) if stray]
    if strays:
        names = [repr(scenario.vehicles[i].name) for i in members]
        return stray_text(scenario, names, strays, at_goal=first.at_goal)
    nearest = min(hazard.distance for hazard in group)
    where = "even their best points are" if first.at_goal else "they are"
    aside = ", radii not counted," if what else ""
    return (
        f"{head} are too close to {what or 'the workspace border'}: {where} {nearest:.3g} m away "
        f"or more{aside} and run {risks}."
    )


def _names(scenario: Scenario, members: Sequence[int]) -> str:
    """Return vehicles in a row."""
    return listed([repr(scenario.vehicles[i].name) for i in members])


def _risks(scenario: Scenario, group: Sequence[EndpointHazard]) -> str:
    """Return what the starts or goals of a group risk, each by itself."""
    bound = scenario.risk_bound
    least, most = (rounded(f(d.risk for d in group), bound) for f in (min, max))
    span = f"a risk of {most} each" if least == most else f"risks of {least} to {most}"
    return f"{span}, above risk_bound {bound:g}"
