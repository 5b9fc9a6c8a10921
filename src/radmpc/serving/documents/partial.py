"""What of a document can be drawn although it is no scenario yet: nothing is drawn at first."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from radmpc.errors import ScenarioError
from radmpc.io.native.decoding import decode_scenario
from radmpc.serving.protocol import Content, ScenarioView
from radmpc.serving.views.handles import is_number
from radmpc.serving.views.scenario import scenario_view

__all__ = ["partial_view"]

_LISTS = ("vehicles", "obstacles")

_ATTEMPTS = 3
"""How often what is wrong is left out before nothing is drawn [-]."""


def partial_view(content: Content, errors: Sequence[ScenarioError]) -> ScenarioView | None:
    """Return a document as far as it can be drawn, None where that is not at all.

    Parameters
    ----------
    content : mapping
        The document.
    errors : sequence of ScenarioError
        What is wrong with it.
    """
    lists = {key: content.get(key) for key in _LISTS}
    if not all(isinstance(part, list) for part in lists.values()):
        return None
    kept = {key: list(range(len(part))) for key, part in lists.items() if isinstance(part, list)}
    for _ in range(_ATTEMPTS):
        kept = _without(kept, errors)
        if not kept["vehicles"]:
            return _world(content, kept)
        part = {**content, **{key: [content[key][i] for i in kept[key]] for key in _LISTS}}
        try:
            return _renumbered(scenario_view(decode_scenario(part), part), kept)
        except ScenarioError as error:
            errors = (error, *error.more)
    return None


def _without(kept: dict[str, list[int]], errors: Sequence[ScenarioError]) -> dict[str, list[int]]:
    """Return the entries of lists that nothing is wrong with."""
    wrong = {tuple(error.path[:2]) for error in errors if len(error.path) > 1}
    return {
        key: [i for place, i in enumerate(places) if (key, place) not in wrong]
        for key, places in kept.items()
    }


def _world(content: Content, kept: dict[str, list[int]]) -> ScenarioView | None:
    """Return a world without vehicles: one that stands in for them is left out again."""
    workspace = content.get("workspace")
    if not isinstance(workspace, dict):
        return None
    ends = [workspace.get(key) for key in ("min", "max")]
    if not all(isinstance(end, list) and all(map(is_number, end)) for end in ends):
        return None
    place = [0.5 * (low + high) for low, high in zip(*ends, strict=False)]
    stand_in = {"name": "-", "start": place, "goal": {"center": place}}
    numbers = {"radius": 1e-3, "control_limit": 1.0, "dynamics": {"model": "double_integrator"}}
    part: dict[str, Any] = {
        "format": content.get("format"),
        "name": content.get("name"),
        "dt": content.get("dt"),
        "horizon": content.get("horizon"),
        "risk_bound": content.get("risk_bound"),
        "workspace": workspace,
        "obstacles": [content["obstacles"][i] for i in kept["obstacles"]],
        "vehicles": [{**stand_in, **numbers}],
    }
    try:
        view = _renumbered(scenario_view(decode_scenario(part), part), kept)
    except ScenarioError:
        return None
    return {**view, "vehicles": []}


def _renumbered(view: ScenarioView, kept: dict[str, list[int]]) -> ScenarioView:
    """Return a view whose paths count entries as the document does."""

    def put(part: Any) -> Any:
        if isinstance(part, dict):
            return {key: put(value) for key, value in part.items()}
        if isinstance(part, (list, tuple)):
            is_path = len(part) > 1 and part[0] in _LISTS and isinstance(part[1], int)
            if is_path and part[1] < len(kept[part[0]]):
                return [part[0], kept[part[0]][part[1]], *part[2:]]
            return [put(item) for item in part]
        return part

    if all(places == list(range(len(places))) for places in kept.values()):
        return view
    return {**view, "vehicles": put(view["vehicles"]), "obstacles": put(view["obstacles"])}
