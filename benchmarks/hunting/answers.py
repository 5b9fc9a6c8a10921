"""What a scene of the hunt may cost, who plans it, and what one planner answers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from radmpc.planners import Centralized, Ira, Planner, Sigmas, Uniform
from radmpc.planners.presets import PRESETS
from radmpc.result import Result
from radmpc.solvers.branch.branch import Branch

__all__ = ["PLANNERS", "Answer", "Effort"]

PLANNERS: Mapping[str, Planner] = MappingProxyType(
    {
        "certified": PRESETS["certified"].planner,
        "ira": Planner(Ira(), Branch(), Centralized()),
        "uniform": Planner(Uniform(), Branch(), Centralized()),
        "radmpc": PRESETS["radmpc"].planner,
        "distance": PRESETS["distance"].planner,
        "sigmas": Planner(Sigmas(3.0), Branch(), Centralized()),
        "dlp": PRESETS["dlp"].planner,
    }
)
"""Who plans each scene: the planner that is hunted, and others to hold its answers against."""


@dataclass(frozen=True, slots=True)
class Effort:
    """What a scene may cost.

    Attributes
    ----------
    time_limit : float
        Seconds for the certified planner.
    other_limit : float
        Seconds for each of the others.
    samples : int
        Flights of a plan; 0 flies none.
    hang : float
        Seconds after which a call counts as hung, beyond its limit.
    planners : tuple of str
        Who plans, keys of `PLANNERS`.
    by_processor : bool
        Whether seconds of planning are the processor's, which other jobs do not stretch.
    has_norms : bool
        Whether scenes have limits of norms in place of limits of axes.
    """

    time_limit: float = 4.0
    other_limit: float = 2.0
    samples: int = 20_000
    hang: float = 30.0
    planners: tuple[str, ...] = tuple(PLANNERS)
    by_processor: bool = False
    has_norms: bool = False


@dataclass(frozen=True, slots=True)
class Answer:
    """One planner's answer, what it took, and what its plan's simple bounds sum to."""

    result: Result
    seconds: float
    cpu: float
    simple: float = math.inf

    @property
    def is_simple(self) -> bool:
        """Whether there is a sound plan whose simple bounds sum to Δ at most."""
        certificate = self.result.certificate
        if certificate is None or certificate.problems:
            return False
        return self.simple <= certificate.bound

    @property
    def is_certified(self) -> bool:
        """Whether there is a plan within Δ."""
        return self.result.is_certified

    @property
    def cost(self) -> float:
        """Of the plan; inf without one."""
        return math.inf if self.result.cost is None else self.result.cost

    @property
    def gap(self) -> float:
        """Relative gap that is left open; 1 without a plan or a bound."""
        result = self.result
        if result.cost is None or result.lower_bound is None:
            return 1.0
        return (result.cost - result.lower_bound) / max(abs(result.cost), 1e-9)
