"""The named methods: each a record of three choices, each from the paper's text.

A preset's choices are loaded when its record is made: one of them runs, and most of the rest is of
no use to it. Hence they are read from the package's front.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from types import MappingProxyType

from radmpc import planners
from radmpc.arguments import value_text
from radmpc.errors import ScenarioError
from radmpc.planners.planner import Planner
from radmpc.records import dataclass, replace

__all__ = ["COMPARED", "DEFAULT", "PRESETS", "Preset", "called", "parse_planner"]

DEFAULT = "certified"
"""The planner used when none is named."""

COMPARED = ("rmpc-rrt", "distance", "radmpc", "multi-vehicle", "certified")
"""The planners compared when none is named: one for each idea, and none that takes minutes."""


@dataclass(frozen=True, slots=True)
class Preset:
    """A named planner.

    Attributes
    ----------
    name : str
        What users type.
    summary : str
        One line for lists.
    make : callable
        Makes its record; loads what that is made of.
    argument : callable or None
        Makes the planner from the number in ``name(number)``; None takes no number.
    """

    name: str
    summary: str
    make: Callable[[], Planner]
    argument: Callable[[float], Planner] | None = None

    @property
    def planner(self) -> Planner:
        """Its record."""
        return self.make()


def _multi_vehicle(threshold: float = 1e-6) -> Planner:
    """Algorithm 1 at a coupling threshold Ψ."""
    return Planner(planners.Ira(), planners.Branch(), planners.Couplings(threshold))


_ALL = (
    Preset(
        "milp",
        "Deterministic: noise ignored, one mixed-integer program for the fleet.",
        lambda: Planner(planners.NoRisk(), planners.BigM(), planners.Centralized()),
    ),
    Preset(
        "dlp",
        "Deterministic, the disjunctions searched directly instead of by binaries.",
        lambda: Planner(planners.NoRisk(), planners.Branch(), planners.Centralized()),
    ),
    Preset(
        "rmpc",
        "Robust: every constraint keeps 3 standard deviations; one mixed-integer program.",
        lambda: Planner(planners.Sigmas(3.0), planners.BigM(), planners.Centralized()),
        lambda count: Planner(planners.Sigmas(count), planners.BigM(), planners.Centralized()),
    ),
    Preset(
        "dmpc",
        "Robust and decentralized: one vehicle at a time in a receding horizon.",
        lambda: Planner(planners.Sigmas(3.0), planners.BigM(), planners.Receding()),
        lambda count: Planner(planners.Sigmas(count), planners.BigM(), planners.Receding()),
    ),
    Preset(
        "uniform",
        "Chance-constrained with the same risk for every constraint (Blackmore, Ono, Williams).",
        lambda: Planner(planners.Uniform(), planners.BigM(), planners.Centralized()),
    ),
    Preset(
        "ira",
        "Iterative risk allocation over the whole fleet: the paper's reference.",
        lambda: Planner(planners.Ira(), planners.BigM(), planners.Centralized()),
    ),
    Preset(
        "distance",
        "Vehicles whose paths alone come within 5 m are planned together by IRA (Keviczky).",
        lambda: Planner(planners.Ira(), planners.Branch(), planners.Distance()),
        lambda meters: Planner(planners.Ira(), planners.Branch(), planners.Distance(meters)),
    ),
    Preset(
        "radmpc",
        "Algorithm 2 alone: fast, decentralized, from a common pool of risk; an approximation.",
        lambda: Planner(planners.Pool(), planners.Branch(), planners.Receding()),
    ),
    Preset(
        "multi-vehicle",
        "Algorithm 1: RADMPC finds which vehicles interact, then IRA plans each set.",
        _multi_vehicle,
        _multi_vehicle,
    ),
    Preset(
        "rmpc-rrt",
        "Robust and decentralized, by random trees: one vehicle at a time, no optimizer.",
        lambda: Planner(planners.Sigmas(3.0), planners.Rrt(), planners.Receding()),
        lambda count: Planner(planners.Sigmas(count), planners.Rrt(), planners.Receding()),
    ),
    Preset(
        "certified",
        "Faces and risks optimized together, to a proven gap; never above the risk bound.",
        lambda: Planner(planners.Optimal(), planners.Branch(), planners.Certified()),
        lambda seconds: Planner(planners.Optimal(), planners.Branch(), planners.Certified(seconds)),
    ),
)

PRESETS: Mapping[str, Preset] = MappingProxyType({preset.name: preset for preset in _ALL})
"""Every named planner, in the order of the paper's review."""


def parse_planner(text: str) -> Planner:
    """Return the planner that a name stands for.

    Parameters
    ----------
    text : str
        ``name`` or ``name(number)``, as in ``multi-vehicle(1e-4)``.

    Returns
    -------
    Planner
        Its record.

    Raises
    ------
    ScenarioError
        If there is no such planner or it takes no number.
    """
    pattern = r"\s*([a-z-]+)\s*(?:\(\s*([^()]*?)\s*\))?\s*"
    match = re.fullmatch(pattern, text) if isinstance(text, str) else None
    if match is None or match[1] not in PRESETS:
        raise ScenarioError(
            f"planner must be one of {', '.join(PRESETS)}, got {value_text(text)}{_near(text)}"
        )
    preset = PRESETS[match[1]]
    if match[2] is None:
        return preset.planner
    if preset.argument is None:
        raise ScenarioError(f"planner {preset.name!r} takes no argument, got {text!r}")
    try:
        number = float(match[2])
    except ValueError as error:
        raise ScenarioError(f"planner {preset.name!r} takes a number, got {text!r}") from error
    return preset.argument(number)


def _near(text: object) -> str:
    """Return the name that a misspelled one may stand for, as a question; empty if none is near."""
    from difflib import get_close_matches  # noqa: PLC0415 - most names are spelled right

    word = text[:100].strip().lower() if isinstance(text, str) else ""
    near = get_close_matches(word, PRESETS, n=1)
    return f"; did you mean {near[0]!r}?" if near else ""


def called(planner: Planner) -> str:
    """Return what users type for a planner.

    Parameters
    ----------
    planner : Planner
        With any gap.

    Returns
    -------
    str
        The name of its preset, its number with it; its choices where it is none.
    """
    numbers = re.findall(r"\(([-+\d][-+.\de]*)", str(planner))
    texts = [f"{name}({number})" for name in PRESETS for number in numbers]
    for text in (*PRESETS, *texts):
        try:
            preset = parse_planner(text)
        except ScenarioError:
            continue  # it takes no such number
        if replace(preset, gap=planner.gap) == planner:
            return text
    return str(planner)
