"""A document understood: the scenario that it is, or what is wrong with it, each at its place."""

from __future__ import annotations

from radmpc.errors import ScenarioError
from radmpc.io.native.decoding import decode_scenario
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass, field
from radmpc.serving.documents.partial import partial_view
from radmpc.serving.protocol import Content, Path, Remark, ScenarioView
from radmpc.serving.views.handles import is_number, value_at
from radmpc.serving.views.scenario import scenario_view

__all__ = ["Reading", "read_content"]

_MOST = 40
"""Errors of one document that are told."""

_NEVER = 1e12
"""Coordinates from which on nothing is drawn [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Reading:
    """What became of a document.

    Attributes
    ----------
    scenario : Scenario or None
        None where something is wrong.
    view : ScenarioView or None
        The same, ready to be drawn.
    remarks : tuple of Remark
        What is wrong.
    partial : ScenarioView or None
        What of it can be drawn although something is wrong.
    """

    scenario: Scenario | None
    view: ScenarioView | None
    remarks: tuple[Remark, ...] = field(default=())
    partial: ScenarioView | None = None


def read_content(content: Content) -> Reading:
    """Return what a document says.

    Parameters
    ----------
    content : mapping
        As a scenario file has it, perhaps not yet whole.
    """
    try:
        scenario = decode_scenario(content)
        return Reading(scenario, scenario_view(scenario, content))
    except ScenarioError as error:
        errors = (error, *error.more)[:_MOST]
        remarks = tuple(_remark(one, content) for one in errors)
        return Reading(None, None, remarks, partial_view(content, errors))


def _remark(error: ScenarioError, content: Content) -> Remark:
    """Return an error at its place."""
    path = list(error.path)
    vehicle = value_at(content, [*path[:2], "name"]) if path[:1] == ["vehicles"] else None
    return {
        "severity": "error",
        "text": str(error),
        "path": path,
        "vehicles": [vehicle] if isinstance(vehicle, str) else [],
        "at": _place(content, path),
        "cures": [],
    }


def _place(content: Content, path: Path) -> list[float] | None:
    """Return where on the map something of a document is, None where it is nowhere."""
    for depth in range(len(path), 0, -1):
        part = value_at(content, path[:depth])
        if depth <= 2 and isinstance(part, dict):
            part = next(
                (
                    part[key]
                    for key in ("start", "vertices", "line", "min", "offsets")
                    if key in part
                ),
                None,
            )
        place = _first_point(part)
        if place is not None:
            return place
    return None


def _first_point(part: object) -> list[float] | None:
    """Return the first point that a part of a document has, at two coordinates or three."""
    while isinstance(part, list) and part and isinstance(part[0], list):
        part = part[0]
    if not isinstance(part, list) or len(part) < 2:
        return None
    if not all(is_number(x) and abs(x) < _NEVER for x in part):
        return None
    return [float(x) for x in part[:2]]
