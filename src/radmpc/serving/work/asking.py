"""What a search is asked, and how it ends: what goes between server and worker."""

from __future__ import annotations

import re
from collections.abc import Container, Mapping
from typing import TYPE_CHECKING

from radmpc.arguments import value_text
from radmpc.errors import ScenarioError
from radmpc.model.plan import Plan
from radmpc.records import dataclass, replace
from radmpc.serving.protocol import Remark

if TYPE_CHECKING:
    from radmpc.planners.planner import Planner

__all__ = ["Asked", "Ended", "asked_planner", "check_flight", "check_planner"]

_REMOTE = ("mavlink",)
"""Backends that reach beyond this machine: the page does not start them."""


@dataclass(frozen=True, slots=True)
class Asked:
    """What a search is asked.

    Attributes
    ----------
    content : mapping
        The document.
    planner : str
        A preset.
    seconds : float
        Time limit [s].
    gap : float or None
        Relative gap; None is the preset's.
    risk_bound : float or None
        Δ in place of the document's.
    """

    content: Mapping[str, object]
    planner: str
    seconds: float
    gap: float | None = None
    risk_bound: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Ended:
    """How a search ended.

    Attributes
    ----------
    plan : Plan
        Also without trajectories.
    remarks : tuple of Remark
        Why there is none, or none within Δ, at the places it is about.
    """

    plan: Plan
    remarks: tuple[Remark, ...]


_NAME = re.compile(r"\s*([a-z-]+)\s*(?:\([^()]{0,30}\)\s*)?")


def check_planner(name: str) -> None:
    """Refuse a planner that there is none of, before any solver is loaded.

    Raises
    ------
    ScenarioError
        With the names that there are.
    """
    from radmpc.planners.presets import PRESETS  # noqa: PLC0415 - after the first answer

    if not _is_among(name, PRESETS):
        raise ScenarioError(f"planner must be one of {', '.join(PRESETS)}, got {value_text(name)}")


def check_flight(options: Mapping[str, object]) -> None:
    """Refuse a backend or a planner that there is none of, before a flight is begun.

    Parameters
    ----------
    options : mapping
        ``with`` and ``replan``, both optional; ``none`` flies the plan as it is.

    Raises
    ------
    ScenarioError
        With the names that there are, or how else it is flown.
    """
    from radmpc.flying.backends import BACKENDS  # noqa: PLC0415 - after the first answer
    from radmpc.planners.presets import PRESETS  # noqa: PLC0415 - after the first answer

    backend, replan = options.get("with") or "model", options.get("replan") or "certified"
    if backend in _REMOTE:
        raise ScenarioError(f"{backend!r} is not flown from a page: radmpc fly --with {backend}")
    if backend not in BACKENDS:
        known = ", ".join(name for name in BACKENDS if name not in _REMOTE)
        raise ScenarioError(f"options.with must be one of {known}, got {value_text(backend)}")
    if replan != "none" and not _is_among(str(replan), PRESETS):
        known = ", ".join(("none", *PRESETS))
        raise ScenarioError(f"options.replan must be one of {known}, got {value_text(replan)}")


def _is_among(name: str, presets: Container[str]) -> bool:
    """Whether a planner's name, perhaps with a number, is one of those that there are."""
    match = _NAME.fullmatch(name)
    return match is not None and match[1] in presets


def asked_planner(asked: Asked) -> Planner:
    """Return the planner that is asked for.

    Raises
    ------
    ScenarioError
        If there is none of that name, or the gap is none.
    """
    from radmpc.planners.presets import parse_planner  # noqa: PLC0415 - after the first answer

    known = parse_planner(asked.planner)
    return known if asked.gap is None else replace(known, gap=asked.gap)
