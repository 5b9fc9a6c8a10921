"""What rules out any plan before a search: control reserve, time, and risk at starts and goals.

Every reason here is a proof: no plan exists, whatever the half-spaces or alternatives.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.model.scenario import Scenario
from radmpc.planners.endpoints.floors import EndpointHazard, Floors, floors
from radmpc.planners.endpoints.screening import are_surely_harmless
from radmpc.planners.shared_reasons import (
    ROUNDING,
    endpoint_sentences,
    range_sentences,
    visit_sentences,
)
from radmpc.planners.wording import endpoints_text, listed
from radmpc.program.condensed import CondensedModel
from radmpc.records import dataclass

__all__ = [
    "Reason",
    "endpoint_reasons",
    "grouped",
    "hazards_of",
    "overdrawn_texts",
    "reserve_reason",
    "sure_reasons",
    "too_far_texts",
]

_GROUPED = 3
"""Vehicles with the same reason from which on one sentence names them all [-]."""

_TOLD = 8
"""Sentences at most [-]; one more says how many are left out."""

_NOTICED = 0.5
"""Share of the control limit from which on what feedback reserves is worth telling [-]."""


_UNREACHED = 1e-6
"""Distance from a box from which it counts as out of reach [m]: reach is exact up to rounding."""


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
    reasons = []
    for i, model in enumerate(models):
        reason = overdrawn_texts(model) or _too_far(scenario, model) or _beyond_reach(model)
        if reason is not None:
            reasons.append(Reason((i,), *reason))
    if not are_surely_harmless(scenario, models):
        reasons += endpoint_reasons(scenario, floors(scenario, models))
    reasons += _lost_ranges(scenario, models) if scenario.keep else []
    return reasons + [Reason(*told) for told in visit_sentences(scenario, models)]


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


def reserve_reason(model: CondensedModel) -> str | None:
    """Say how much control the feedback keeps back, where that is much of it.

    Returns
    -------
    str or None
        What follows "the feedback"; None without feedback, or where it takes little.
    """
    vehicle = model.vehicle
    if vehicle.gain is None:
        return None
    reserves = vehicle.control_limit - model.control_bounds
    step, axis = (
        int(k)
        for k in np.unravel_index((reserves / vehicle.control_limit).argmax(), reserves.shape)
    )
    kept, limit = float(reserves[step, axis]), float(vehicle.control_limit[axis])
    if kept < _NOTICED * limit:
        return None
    unit = " m/s²" if vehicle.system.is_double_integrator else ""
    return (
        f"keeps back {kept:.3g} of {limit:.3g}{unit} on axis {axis} at step {step} "
        f"({vehicle.control_sigmas:g} standard deviations)"
    )


def overdrawn_texts(model: CondensedModel) -> tuple[str, str] | None:
    """Say that feedback takes more control than there is."""
    if np.all(model.control_bounds >= 0.0):
        return None
    step, axis = (int(k) for k in np.argwhere(model.control_bounds < 0.0)[0])
    vehicle = model.vehicle
    limit = float(vehicle.control_limit[axis])
    unit = " m/s²" if vehicle.system.is_double_integrator else ""
    text = (
        f"has no control left to steer: at step {step} the feedback alone takes more than control "
        f"axis {axis} allows, it keeps back {limit - model.control_bounds[step, axis]:.3g} of "
        f"{limit:.3g}{unit} ({vehicle.control_sigmas:g} standard deviations)."
    )
    return text, text.replace("has no", "have no", 1)


def _too_far(scenario: Scenario, model: CondensedModel) -> tuple[str, str] | None:
    """Say that full throttle does not lead to the goal in time, axis by axis."""
    missing = model.reach_lower - model.reach_upper
    if np.all(missing <= 1e-6):
        return None
    return too_far_texts(scenario, model)


def _beyond_reach(model: CondensedModel) -> tuple[str, str] | None:
    """Say that full throttle does not lead to a box and on to the goal in time."""
    if not model.vehicle.via:
        return None
    from radmpc.model.visits import steps_of_visits  # noqa: PLC0415 - few visit anything

    via = model.vehicle.via
    for j, (first, last) in enumerate(steps_of_visits(via, model.horizon)):
        during = slice(first, last + 1)
        gap = np.maximum(
            model.reach_lower[during] - via[j].upper, via[j].lower - model.reach_upper[during]
        )
        if float(gap.max(axis=1).min()) > _UNREACHED:
            text = (
                f"cannot be in the box of via[{j}] at any step from {first} to {last} and at its "
                "goal in time under its control and speed limits, obstacles aside."
            )
            many = text.replace("its goal", "their goals").replace("its control", "their control")
            return text, many
    return None


def too_far_texts(scenario: Scenario, model: CondensedModel) -> tuple[str, str]:
    """Return the sentence that a goal is out of reach.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    model : CondensedModel
        The vehicle over the whole horizon.

    Returns
    -------
    pair of str
        What follows "Vehicle 'name'", and the same of several vehicles.
    """
    seconds = scenario.horizon * scenario.dt
    kept = reserve_reason(model)
    because = f" (the feedback {kept})" if kept else ""
    end = (
        f" within {scenario.horizon} steps ({seconds:g} s) under its control and speed "
        f"limits{because}, obstacles aside."
    )
    return (
        f"cannot reach its goal{end}",
        f"cannot reach their goals{end.replace(' its ', ' their ')}",
    )


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
                reasons.append(Reason((i,), endpoints_text(scenario, own, risk)))
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
