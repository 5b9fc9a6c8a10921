"""A scenario checked: whether it is valid, and what an operator should know before planning."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from radmpc.console.output import show, show_json, width
from radmpc.console.running.guard import Code
from radmpc.console.words import scenario_line
from radmpc.model.relations.goals import places_of
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.preflight.concerns import Concern, concerns_of
from radmpc.preflight.outlook import Outlook, VehicleOutlook, outlook_of
from radmpc.preflight.places import Narrowest, Passage
from radmpc.wording import count_text

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.text import Text

    from radmpc.console.reports.progress import ProgressCallback

__all__ = ["check_report", "outlook_json", "run_check"]

_COLUMNS = (
    "vehicle",
    "least time",
    "kept back",
    "saturates",
    "at the end",
    "start risk",
    "goal risk",
    "narrowest place",
)

_PLACES = {
    Passage.WIDE: "wide",
    Passage.UNKNOWN: "?",
    Passage.TOO_LARGE: "not computed",
    Passage.CLOSED: "no path",
}
"""What stands for a narrowest place where there is none to name."""

_WHY_NOT = {
    Passage.UNKNOWN: "out of reach",
    Passage.TOO_LARGE: "too large",
    Passage.CLOSED: "no path",
}
"""Why a narrowest place is not known, for programs."""

_NOTHING = 1e-12
"""Probability below which none is told [-], unless the risk bound is small, too."""

_LEAST_SHARE = 1e-4
"""Share of the risk bound from which on a probability is told however small it is [-]."""

_GAP = "  "
"""What separates columns."""


def run_check(scenario: Scenario, *, as_json: bool) -> int:
    """Look at a valid scenario and report.

    Parameters
    ----------
    scenario : Scenario
        As read from its file.
    as_json : bool
        Whether stdout gets JSON rather than the report.

    Returns
    -------
    int
        The exit code: that of a valid file, whatever is warned of.
    """
    outlook, concerns = _watched(scenario) if sys.stderr.isatty() else _seen(scenario, None)
    if as_json:
        show_json(outlook_json(outlook, concerns))
    else:
        show(*check_report(outlook, concerns))
    return Code.OK


def _seen(
    scenario: Scenario, progress: ProgressCallback | None
) -> tuple[Outlook, tuple[Concern, ...]]:
    """Return what there is to see of a scenario, and to warn of."""
    outlook = outlook_of(scenario, progress)
    if progress is not None:
        count = len(outlook.vehicles)
        progress("looked at vehicles, trying what helps", count, count)
    return outlook, concerns_of(outlook)


def _watched(scenario: Scenario) -> tuple[Outlook, tuple[Concern, ...]]:
    """Do the same while somebody waits: narrow places beside uncertain obstacles take seconds."""
    from radmpc.console.reports.progress import progress_line  # noqa: PLC0415 - for terminals alone

    with progress_line() as line:
        return _seen(scenario, line)


def check_report(outlook: Outlook, concerns: Sequence[Concern]) -> list[RenderableType]:
    """Return what was seen as parts to show: warnings first.

    Parameters
    ----------
    outlook : Outlook
        What was seen.
    concerns : sequence of Concern
        What to warn of.
    """
    head = f"valid: {scenario_line(outlook.scenario)}"
    vehicles = zip(outlook.scenario.vehicles, outlook.vehicles, strict=True)
    rows = [_COLUMNS, *(_row(outlook.scenario, *one) for one in vehicles)]
    widest = [max(len(row[k]) for row in rows) for k in range(len(_COLUMNS))]
    warnings = [_warning(concern) for concern in concerns]
    parts: list[RenderableType] = [head, *_goals(outlook.scenario), *warnings, ""]
    notes = _notes(outlook.vehicles)
    if sum(widest) + len(_GAP) * (len(widest) - 1) > width():
        return [*parts, *_blocks(rows), *notes]
    lines = [
        _GAP.join(cell.ljust(most) for cell, most in zip(row, widest, strict=True)).rstrip()
        for row in rows
    ]
    return [*parts, *lines, *notes]


def _notes(vehicles: Sequence[VehicleOutlook]) -> list[str]:
    """Return what cells without a number mean, where there are any."""
    notes = []
    if any(seen.narrowest is Passage.TOO_LARGE for seen in vehicles):
        notes.append(
            "not computed: what the vehicle can reach is too large beside its hull to be searched"
        )
    if any(seen.narrowest is Passage.UNKNOWN or seen.saturation is None for seen in vehicles):
        notes.append("?: no path to the goal is known that the vehicle can fly in time")
    return ["", *notes] if notes else []


def _goals(scenario: Scenario) -> list[str]:
    """Return the assumed assignment, if goals are shared."""
    if not scenario.goals:
        return []
    from radmpc.preflight.goals import assigned_text  # noqa: PLC0415 - few share goals

    return [assigned_text(scenario)]


def _warning(concern: Concern) -> Text:
    """Return a warning as a line."""
    from rich.text import Text  # noqa: PLC0415 - a scenario without warnings does without

    word, style = ("no plan", "red") if concern.is_fatal else ("warning", "yellow")
    return Text(f"{word}: {concern.text}", style=style)


def _blocks(rows: Sequence[Sequence[str]]) -> list[RenderableType]:
    """Return a table that is too wide for the terminal as a block of lines per vehicle."""
    head, *vehicles = rows
    longest = max(len(word) for word in head)
    lines: list[RenderableType] = []
    for row in vehicles:
        lines.append(row[0])
        told = zip(head[1:], row[1:], strict=True)
        lines += [f"  {name.ljust(longest)}{_GAP}{cell}" for name, cell in told]
    return lines


def _row(scenario: Scenario, vehicle: Vehicle, seen: VehicleOutlook) -> tuple[str, ...]:
    """Return the cells of one vehicle, in letters that every terminal has."""
    horizon, bound = scenario.horizon, scenario.risk_bound
    least, due = seen.least_steps_with_feedback, vehicle.goal.window(horizon)[1]
    time = f"{'-' if least is None else least} of {count_text(horizon, 'step')}"
    return (
        seen.name,
        f"{time}, due at {due}" if due < horizon else time,
        f"{100.0 * seen.reserve.share:.0f} %" if seen.reserve.share else "-",
        _risk(seen.saturation, bound),
        f"{seen.end_deviation:.3g} m",
        _risk(seen.start_risk, bound),
        _risk(seen.goal_risk, bound),
        _place(seen.narrowest),
    )


def _risk(risk: float | None, bound: float) -> str:
    """Return a probability in two digits, or that it is as good as none beside the risk bound."""
    if risk is None:
        return "?"
    if risk > 1.0:
        return ">= 1"  # a sum of bounds
    # Beside a tiny bound a tiny risk may be all that there is to tell.
    is_told = risk > 0.0 and risk >= min(_NOTHING, _LEAST_SHARE * bound)
    return f"{risk:.2g}" if is_told else "-"


def _place(place: Narrowest | Passage) -> str:
    """Return the narrowest place in a few words."""
    if isinstance(place, Passage):
        return _PLACES[place]
    names = " and ".join("border" if name is None else name for name in place.beside)
    told = f"{place.clearance:.2g} m"
    if place.deviations is not None:
        told += f", {place.deviations:.2g} std"
    return f"{told}: {names}"


def outlook_json(outlook: Outlook, concerns: Sequence[Concern]) -> dict[str, object]:
    """Return the same as plain values.

    Parameters
    ----------
    outlook : Outlook
        What was seen.
    concerns : sequence of Concern
        What to warn of.
    """
    scenario = outlook.scenario
    names = [vehicle.name for vehicle in scenario.vehicles]
    return {
        "valid": True,
        "scenario": scenario.name,
        "horizon": scenario.horizon,
        "dt": scenario.dt,
        "risk_bound": scenario.risk_bound,
        "least_risk": outlook.least_risk,
        "warnings": [
            {
                "kind": concern.kind,
                "vehicles": list(concern.vehicles),
                "text": concern.text,
                "rules_out": concern.is_fatal,
            }
            for concern in concerns
        ],
        "goals": list(places_of(scenario.goals, [v.goal for v in scenario.vehicles]))
        if scenario.goals
        else [],
        "vehicles": [_vehicle_json(seen) for seen in outlook.vehicles],
        "endpoints": [
            {
                "at": "goal" if hazard.at_goal else "start",
                "cause": hazard.cause,
                "members": [names[i] for i in hazard.members],
                "obstacle": hazard.other,
                "risk": hazard.risk,
                "distance": hazard.distance,
            }
            for hazard in outlook.hazards
        ],
    }


def _vehicle_json(seen: VehicleOutlook) -> dict[str, object]:
    """Return one vehicle as plain values."""
    reserve = seen.reserve
    return {
        "name": seen.name,
        "least_steps": seen.least_steps,
        "least_steps_with_feedback": seen.least_steps_with_feedback,
        "end_deviation": seen.end_deviation,
        "kept_back": {
            "share": reserve.share,
            "kept": reserve.kept,
            "limit": reserve.limit,
            "axis": reserve.axis,
            "at_step": reserve.step,
        },
        "saturation": seen.saturation,
        "start_risk": seen.start_risk,
        "goal_risk": seen.goal_risk,
        "narrowest": _narrowest_json(seen.narrowest),
        "visits": list(seen.visits),
    }


def _narrowest_json(place: Narrowest | Passage) -> dict[str, object]:
    """Return the narrowest place as plain values; what is not known is null."""
    if isinstance(place, Passage):
        nothing = dict.fromkeys(("clearance", "deviations", "position", "step", "beside"))
        # Programs that read this know two answers without a place.
        found = place if place is Passage.WIDE else Passage.UNKNOWN
        return {"found": found.value, "why": _WHY_NOT.get(place), **nothing}
    return {
        "found": "narrow",
        "why": None,
        "clearance": place.clearance,
        "deviations": place.deviations,
        "position": list(place.position),
        "step": place.step,
        "beside": list(place.beside),
    }
