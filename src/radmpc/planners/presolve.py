"""What rules out any plan before a search: control, time, closed ways, risk at starts and goals.

Every reason here is a proof: no plan exists, whatever the half-spaces or alternatives.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from radmpc.model.scenario import Scenario
from radmpc.planners.endpoints.floors import EndpointHazard, Floors, floors
from radmpc.planners.endpoints.screening import are_surely_harmless
from radmpc.planners.shared_reasons import (
    ROUNDING,
    endpoint_sentences,
    goal_sentence,
    range_sentences,
    visit_sentences,
)
from radmpc.planners.wording import endpoints_text, listed
from radmpc.program.condensed import CondensedModel
from radmpc.records import dataclass

__all__ = [
    "Reason",
    "enclosed_reasons",
    "endpoint_reasons",
    "grouped",
    "hazards_of",
    "sure_reasons",
]

_GROUPED = 3
"""Vehicles with the same reason from which on one sentence names them all [-]."""

_TOLD = 8
"""Sentences at most [-]; one more says how many are left out."""


@dataclass(frozen=True, slots=True)
class Reason:
    """Why some vehicles have no plan.

    Attributes
    ----------
    members : tuple of int
        The vehicles, by their numbers in the scenario.
    text : str
        A sentence about them; of a single vehicle what follows "Vehicle 'name' ".
    many : str or None
        The same of several vehicles; empty where the text is a sentence of its own, None where
        nothing but moving starts or goals could help.
    """

    members: tuple[int, ...]
    text: str
    many: str | None = None


def sure_reasons(scenario: Scenario, models: Sequence[CondensedModel]) -> list[Reason]:
    """Return why there can be no plan, as far as no search is needed to know.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    models : sequence of CondensedModel
        Its vehicles over the whole horizon.

    Returns
    -------
    list of Reason
        Empty where nothing is wrong at first sight.
    """
    # Checks borrow words from here, and load no solver for them.
    from radmpc.planners.reaching.limits import sure_reach_texts  # noqa: PLC0415 - for planners alone
    from radmpc.planners.reaching.reserves import overdrawn_texts  # noqa: PLC0415 - for planners alone

    reasons = []
    for i, model in enumerate(models):
        reason = overdrawn_texts(model) or sure_reach_texts(scenario, model)
        if reason is not None:
            reasons.append(Reason((i,), *reason))
    if not are_surely_harmless(scenario, models):
        reasons += endpoint_reasons(scenario, floors(scenario, models))
    reasons += _lost_ranges(scenario, models) if scenario.keep else []
    reasons += enclosed_reasons(scenario, {i for reason in reasons for i in reason.members})
    reasons += late_around(scenario, models, {i for reason in reasons for i in reason.members})
    reasons += blocked_by_another(scenario)
    return reasons + [Reason(*told) for told in visit_sentences(scenario, models)]


def blocked_by_another(scenario: Scenario) -> list[Reason]:
    """Say which vehicles have to pass each other in a passage that is too narrow for two.

    Parameters
    ----------
    scenario : Scenario
        The fleet.

    Returns
    -------
    list of Reason
        One per pair; each is a proof for every plan along intervals.
    """
    if scenario.num_vehicles < 2 or scenario.workspace is None:
        return []
    from radmpc.planners.reaching.passing import blocked_pairs, blocked_text  # noqa: PLC0415 - pairs within borders alone

    found = blocked_pairs(scenario)
    return [Reason(one.members, blocked_text(scenario, one)) for one in found]


def enclosed_reasons(scenario: Scenario, exempt: Collection[int] = ()) -> list[Reason]:
    """Say which vehicles have no way to a visit or their goal, however long it takes.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    exempt : collection of int
        Vehicles that nothing more has to be said of.

    Returns
    -------
    list of Reason
        One per vehicle; a closed way is a proof for every plan along intervals.
    """
    if not scenario.obstacles:
        return []
    from radmpc.planners.reaching.enclosed import BarriersOfAll, closed_text  # noqa: PLC0415 - obstacles alone close ways

    barriers, reasons = BarriersOfAll(scenario), []
    for i, vehicle in enumerate(scenario.vehicles):
        closed = None if i in exempt else barriers.closed(vehicle)
        if closed is not None:
            text = f"Vehicle {vehicle.name!r} {closed_text(vehicle, closed)}."
            reasons.append(Reason((i,), text))
    return reasons


def late_around(
    scenario: Scenario, models: Sequence[CondensedModel], exempt: Collection[int] = ()
) -> list[Reason]:
    """Say which vehicles are late for a visit or their goal at full speed around obstacles.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    models : sequence of CondensedModel
        Its vehicles over the whole horizon.
    exempt : collection of int
        Vehicles that nothing more has to be said of.

    Returns
    -------
    list of Reason
        One per vehicle; each is a proof for every plan along intervals.
    """
    if not scenario.obstacles:
        return []
    from radmpc.planners.reaching.around import WaysAround, late_text  # noqa: PLC0415 - obstacles alone are in the way

    ways, reasons = WaysAround(scenario), []
    for i, model in enumerate(models):
        late = None if i in exempt else ways.late(model.vehicle, model.control_bounds)
        if late is not None:
            text = f"{late_text(scenario, late)}."
            reasons.append(Reason((i,), text, text.replace(" its ", " their ")))
    return reasons


def _lost_ranges(scenario: Scenario, models: Sequence[CondensedModel]) -> list[Reason]:
    """Say which vehicles begin or end out of the range that they keep."""
    from radmpc.planners.endpoints.ranges import lost_ranges  # noqa: PLC0415 - few keep a range

    found = [one for end in (False, True) for one in lost_ranges(scenario, models, at_goal=end)]
    return [Reason(*told) for told in range_sentences(scenario, found)]


def grouped(
    scenario: Scenario, reasons: Sequence[Reason]
) -> list[tuple[tuple[int, ...] | None, str]]:
    """Return reasons in words, one sentence for vehicles that share one.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    reasons : sequence of Reason
        What was found.

    Returns
    -------
    list of (tuple of int or None, str)
        Each sentence with the vehicles it is about, if something may be tried for them: None
        where it is about starts and goals, which only their owner can move.
    """
    names = [repr(v.name) for v in scenario.vehicles]
    groups: dict[tuple[str, str | None], list[Reason]] = {}
    for reason in reasons:
        groups.setdefault((reason.text, reason.many), []).append(reason)
    told: list[tuple[tuple[int, ...] | None, str]] = []
    for (text, many), group in groups.items():
        if not many:
            told.append((None if many is None else group[0].members, text))
        elif len(group) < _GROUPED:
            told += [(one.members, f"Vehicle {names[one.members[0]]} {text}") for one in group]
        else:
            members = tuple(one.members[0] for one in group)
            told.append((members, f"Vehicles {listed([names[i] for i in members])} {many}"))
    hidden = len(told) - _TOLD
    return [*told[:_TOLD], (None, f"There are {hidden} more reasons.")] if hidden > 0 else told


def endpoint_reasons(scenario: Scenario, floors: Floors) -> list[Reason]:
    """Say what starts and goals risk, where that alone is above Δ.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    floors : Floors
        What they risk.

    Returns
    -------
    list of Reason
        Empty where they risk no more than Δ.
    """
    threshold = scenario.risk_bound * (1.0 + ROUNDING)
    if floors.total <= threshold:
        return []
    hazards = (*floors.starts, *floors.goals)
    alone = [hazard for hazard in hazards if hazard.risk > threshold]
    reasons = [Reason(*told) for told in endpoint_sentences(scenario, alone)]
    if reasons:
        return reasons
    for i in range(scenario.num_vehicles):
        for at_goal in (False, True):
            risk = float(floors.vehicles[i, int(at_goal)])
            if risk > threshold:
                own = _own(hazards, i, at_goal=at_goal)
                tell = goal_sentence if at_goal and len(own) > 1 else endpoints_text
                reasons.append(Reason((i,), tell(scenario, own, risk)))
    if reasons:
        return reasons
    ranked = tuple(sorted(hazards, key=lambda hazard: -hazard.risk))
    everyone = tuple(sorted({i for hazard in ranked for i in hazard.members}))
    return [Reason(everyone, endpoints_text(scenario, ranked, floors.total))]


def hazards_of(floors: Floors, members: Sequence[int]) -> list[EndpointHazard]:
    """Return what starts and goals of some vehicles risk among themselves, the greatest first.

    Parameters
    ----------
    floors : Floors
        What those of all risk.
    members : sequence of int
        The vehicles.
    """
    whom = set(members)
    own = [hazard for hazard in (*floors.starts, *floors.goals) if whom.issuperset(hazard.members)]
    return sorted(own, key=lambda hazard: -hazard.risk)


def _own(hazards: Sequence[EndpointHazard], i: int, *, at_goal: bool) -> tuple[EndpointHazard, ...]:
    """Return the hazards of one vehicle at one endpoint, others aside."""
    return tuple(d for d in hazards if d.members == (i,) and d.at_goal == at_goal)
