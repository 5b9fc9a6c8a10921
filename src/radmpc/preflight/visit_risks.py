"""Visits that alone risk more than Δ; nothing is loaded for it where nothing is near a box."""

from __future__ import annotations

from collections.abc import Iterator
from math import log, sqrt

import numpy as np

from radmpc.model.scenario import Scenario
from radmpc.model.visits import Visit
from radmpc.preflight.outlook import Outlook

__all__ = ["describe_risky_visits"]

_LEAST = 1e-4
"""Share of Δ below which a hazard counts as nothing [-], as in `Floors`."""


def describe_risky_visits(outlook: Outlook) -> Iterator[tuple[tuple[str, ...], str]]:
    """Yield the visits that no plan can make within Δ.

    Parameters
    ----------
    outlook : Outlook
        What was seen of a scenario.

    Yields
    ------
    tuple of str
        Whose it is.
    str
        A sentence.
    """
    scenario = outlook.scenario
    # The tail at q deviations is at most exp(−q²/2)/2.
    far = sqrt(-2.0 * log(2.0 * _LEAST * scenario.risk_bound))
    is_near = any(
        _is_near(scenario, visit, vehicle.radius + far * seen.end_deviation)
        for vehicle, seen in zip(scenario.vehicles, outlook.vehicles, strict=True)
        for visit in vehicle.via
    )
    if not is_near:
        return
    from radmpc.planners.shared_reasons import visit_sentences  # noqa: PLC0415 - loads scipy
    from radmpc.program.build import condensed_models  # noqa: PLC0415 - loads scipy

    for members, text in visit_sentences(scenario, condensed_models(scenario)):
        yield tuple(scenario.vehicles[i].name for i in members), text


def _is_near(scenario: Scenario, visit: Visit, reach: float) -> bool:
    """Whether a visit is near the border or an obstacle; one that moves may be anywhere."""
    workspace = scenario.workspace
    if workspace is not None:
        away = np.minimum(visit.lower - workspace.lower, workspace.upper - visit.upper)
        if away.min() <= reach:
            return True
    for obstacle in scenario.obstacles:
        if len(obstacle.steps) > 1 or obstacle.spread is not None:
            return True
        for piece in obstacle.at(0):
            low, high = piece.vertices.min(axis=0), piece.vertices.max(axis=0)
            gaps = np.maximum(np.maximum(low - visit.upper, visit.lower - high), 0.0)
            if float(np.linalg.norm(gaps)) <= reach:
                return True
    return False
