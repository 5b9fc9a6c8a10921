"""What an operator should know of a document before planning it, at its places, with cures."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from radmpc.io.native.decoding import decode_scenario
from radmpc.model.scenario import Scenario
from radmpc.preflight import Concern, Narrowest, Outlook, concerns_of, outlook_of
from radmpc.serving.protocol import Change, Content, Cure, Path, Remark
from radmpc.serving.work.control import Control

__all__ = ["concern_remarks", "concerns_of_content", "horizon_cure", "risk_bound_cure"]

_PATHS: Mapping[str, tuple[str | int, ...]] = {
    "time": ("horizon",),
    "noise": ("defaults",),
    "assumed noise": ("defaults",),
    "track": ("obstacles",),
}
"""Where concerns stand that are about no vehicle in particular, or about all."""


def concerns_of_content(control: Control, content: Content) -> list[Remark]:
    """Return what to know of a document that is a scenario.

    Parameters
    ----------
    control : Control
        Not used: this takes a moment.
    content : mapping
        The document.
    """
    del control
    return concern_remarks(outlook_of(decode_scenario(content)), content)


def concern_remarks(outlook: Outlook, content: Content) -> list[Remark]:
    """Return concerns as remarks.

    Parameters
    ----------
    outlook : Outlook
        What was seen.
    content : mapping
        The document, which cures change.
    """
    return [_remark(concern, outlook, content) for concern in concerns_of(outlook)]


def horizon_cure(scenario: Scenario, horizon: int) -> Cure:
    """Return the cure of a longer horizon.

    Parameters
    ----------
    scenario : Scenario
        Whose step counts.
    horizon : int
        Steps.
    """
    label = f"Horizon {horizon} steps ({horizon * scenario.dt:g} s)"
    return {"label": label, "changes": [{"path": ["horizon"], "value": horizon}]}


def risk_bound_cure(risk_bound: float) -> Cure:
    """Return the cure of a larger Δ."""
    change: Path = ["risk_bound"]
    return {
        "label": f"Risk bound {risk_bound:g}",
        "changes": [{"path": change, "value": risk_bound}],
    }


def _remark(concern: Concern, outlook: Outlook, content: Content) -> Remark:
    """Return a concern as a remark."""
    scenario = outlook.scenario
    names = [vehicle.name for vehicle in scenario.vehicles]
    whom = [names.index(name) for name in concern.vehicles]
    path: Path = list(_PATHS.get(concern.kind, ()))
    if whom and (not path or concern.kind == "noise"):
        path = ["vehicles", whom[0]]
    return {
        "severity": "fatal" if concern.is_fatal else "warning",
        "text": concern.text,
        "path": path,
        "vehicles": list(concern.vehicles),
        "at": _place(concern, outlook, whom),
        "cures": _cures(concern, scenario, content, whom),
    }


def _place(concern: Concern, outlook: Outlook, whom: list[int]) -> list[float] | None:
    """Return where a concern is."""
    if not whom:
        return None
    vehicle, seen = outlook.scenario.vehicles[whom[0]], outlook.vehicles[whom[0]]
    place = vehicle.start_position
    if concern.kind == "narrow" and isinstance(seen.narrowest, Narrowest):
        place = np.array(seen.narrowest.position)
    elif concern.kind in {"time", "deviation"}:
        place = vehicle.goal.center
    elif concern.kind == "endpoint":
        hazards = [h for h in outlook.hazards if set(whom) >= set(h.members)]
        worst = max(hazards, key=lambda hazard: hazard.risk, default=None)
        if worst is not None and worst.at_goal:
            place = outlook.scenario.vehicles[worst.members[0]].goal.center
    return [round(float(x), 4) for x in place]


def _cures(concern: Concern, scenario: Scenario, content: Content, whom: list[int]) -> list[Cure]:
    """Return what cures a concern, as far as it says what."""
    cures: list[Cure] = []
    if concern.horizon is not None:
        cures.append(horizon_cure(scenario, concern.horizon))
    if concern.kind == "deviation" and all(scenario.vehicles[i].gain is None for i in whom):
        changes = feedback_changes(content, scenario, whom)
        if changes:
            cures.append({"label": "Add feedback (lqr, Q = 1, R = 1)", "changes": changes})
    return cures


def feedback_changes(
    content: Content, scenario: Scenario, whom: list[int], weight: float = 1.0
) -> list[Change]:
    """Return changes that put a regulator to some vehicles: in the defaults where all are meant.

    Parameters
    ----------
    content : mapping
        The document.
    scenario : Scenario
        What it says.
    whom : list of int
        The vehicles.
    weight : float
        R of the regulator, with Q = 1 [-].
    """
    regulator = {"lqr": {"Q": 1.0, "R": weight}}
    stated = [i for i, entry in enumerate(content["vehicles"]) if "feedback" in entry]
    if len(whom) == scenario.num_vehicles and not stated:
        return [{"path": ["defaults", "feedback"], "value": regulator}]
    return [{"path": ["vehicles", i, "feedback"], "value": regulator} for i in whom]
