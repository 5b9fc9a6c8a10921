"""Vehicles that stray too far for the workspace: noise at fault, not a start or a goal."""

from __future__ import annotations

from typing import Literal

import numpy as np

from radmpc.gaussian import Tail, clearance
from radmpc.model.scenario import Scenario
from radmpc.planners.endpoints.floors import EndpointHazard
from radmpc.records import dataclass

__all__ = ["Stray", "stray_of"]

_GROWN = 1.2
"""Ratio of standard deviations at the end and halfway from which on they grow [-]: steady ones have
1, those of open loop 2 to 3."""


@dataclass(frozen=True, slots=True)
class Stray:
    """A vehicle whose noise leaves no place for it within the workspace.

    Attributes
    ----------
    deviation : float
        Its standard deviation along the axis that is worst [m].
    risk : float
        What it would risk in the middle of the workspace, which is least [-].
    grows : {'open loop', 'feedback'} or None
        Whether the deviation still grows at the end, and with what; None at a start.
    """

    deviation: float
    risk: float
    grows: Literal["open loop", "feedback"] | None


def stray_of(scenario: Scenario, hazard: EndpointHazard) -> Stray | None:
    """Return how far a vehicle strays where it may leave the workspace.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    hazard : EndpointHazard
        What a start or a goal risks.

    Returns
    -------
    Stray or None
        None where it is no matter of the border, where the place lies outside, or where some other
        place would do.
    """
    workspace = scenario.workspace
    if hazard.cause != "workspace" or hazard.distance < 0.0 or workspace is None:
        return None
    vehicle = scenario.vehicles[hazard.members[0]]
    axes = list(vehicle.system.position)
    spread = np.sqrt(vehicle.covariances(scenario.horizon)[:, axes, axes].clip(min=0.0))
    last = -1 if hazard.at_goal else 0
    slack = 0.5 * (workspace.upper - workspace.lower)
    tail = Tail(scenario.covariance_samples)
    risk = 2.0 * float(tail.probability(clearance(slack, spread[last])).sum())
    if risk <= scenario.risk_bound:
        return None
    worst = int((spread[last] / slack).argmax())
    is_growing = spread[-1, worst] > _GROWN * spread[scenario.horizon // 2, worst]
    grows: Literal["open loop", "feedback"] | None = None
    if hazard.at_goal and is_growing:
        grows = "open loop" if vehicle.gain is None else "feedback"
    return Stray(float(spread[last, worst]), risk, grows)
