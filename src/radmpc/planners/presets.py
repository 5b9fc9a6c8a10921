"""The named methods: each a record of three choices, each from the paper's text."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from radmpc.arguments import told
from radmpc.errors import ScenarioError
from radmpc.planners.centralized import Centralized
from radmpc.planners.certified.planning import Certified
from radmpc.planners.distance import Distance
from radmpc.planners.paper.algorithm_1_multi_vehicle import Couplings
from radmpc.planners.paper.algorithm_2_radmpc import Receding
from radmpc.planners.planner import Planner
from radmpc.planners.policies import Ira, NoRisk, Optimal, Pool, Sigmas, Uniform
from radmpc.solvers.branch.branch import Branch
from radmpc.solvers.milp.big_m import BigM
from radmpc.solvers.rrt.rrt import Rrt

__all__ = ["COMPARED", "DEFAULT", "PRESETS", "Preset", "parse_planner"]

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
    planner : Planner
        Its record.
    argument : callable or None
        Makes the planner from the number in ``name(number)``; None takes no number.
    """

    name: str
    summary: str
    planner: Planner
    argument: Callable[[float], Planner] | None = None


def _multi_vehicle(threshold: float = 1e-6) -> Planner:
    """Algorithm 1 at a coupling threshold Ψ."""
    return Planner(Ira(), Branch(), Couplings(threshold))


_ALL = (
    Preset(
        "milp",
        "Deterministic: noise ignored, one mixed-integer program for the fleet.",
        Planner(NoRisk(), BigM(), Centralized()),
    ),
    Preset(
        "dlp",
        "Deterministic, the disjunctions searched directly instead of by binaries.",
        Planner(NoRisk(), Branch(), Centralized()),
    ),
    Preset(
        "rmpc",
        "Robust: every constraint keeps 3 standard deviations; one mixed-integer program.",
        Planner(Sigmas(3.0), BigM(), Centralized()),
        lambda count: Planner(Sigmas(count), BigM(), Centralized()),
    ),
    Preset(
        "dmpc",
        "Robust and decentralized: one vehicle at a time in a receding horizon.",
        Planner(Sigmas(3.0), BigM(), Receding()),
        lambda count: Planner(Sigmas(count), BigM(), Receding()),
    ),
    Preset(
        "uniform",
        "Chance-constrained with the same risk for every constraint (Blackmore, Ono, Williams).",
        Planner(Uniform(), BigM(), Centralized()),
    ),
    Preset(
        "ira",
        "Iterative risk allocation over the whole fleet: the paper's reference.",
        Planner(Ira(), BigM(), Centralized()),
    ),
    Preset(
        "distance",
        "Vehicles whose ways alone come within 5 m are planned together by IRA (Keviczky).",
        Planner(Ira(), Branch(), Distance()),
        lambda meters: Planner(Ira(), Branch(), Distance(meters)),
    ),
    Preset(
        "radmpc",
        "Algorithm 2 alone: fast, decentralized, from a common pool of risk; an approximation.",
        Planner(Pool(), Branch(), Receding()),
    ),
    Preset(
        "multi-vehicle",
        "Algorithm 1: RADMPC finds who interacts, then IRA plans each set.",
        _multi_vehicle(),
        _multi_vehicle,
    ),
    Preset(
        "rmpc-rrt",
        "Robust and decentralized, by random trees: one vehicle at a time, no optimizer.",
        Planner(Sigmas(3.0), Rrt(), Receding()),
        lambda count: Planner(Sigmas(count), Rrt(), Receding()),
    ),
    Preset(
        "certified",
        "Faces and risks optimized together, to a proven gap; never above the risk bound.",
        Planner(Optimal(), Branch(), Certified()),
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
        raise ScenarioError(f"planner must be one of {', '.join(PRESETS)}, got {told(text)}")
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
