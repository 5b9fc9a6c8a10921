"""Ranges that are lost at starts or goals, wherever vehicles go in between."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from radmpc.gaussian import Tail, clearance
from radmpc.model.relations.keep import keep_pairs
from radmpc.model.scenario import Scenario
from radmpc.planners.endpoints.boxes import Box
from radmpc.planners.endpoints.floors import EndpointHazard
from radmpc.program.condensed import CondensedModel
from radmpc.program.relative import relative_covariances
from radmpc.records import dataclass

__all__ = ["LostRange", "lost_ranges"]


@dataclass(frozen=True, slots=True)
class LostRange:
    """Two vehicles whose starts or goals are too far apart for the range that they keep.

    Attributes
    ----------
    members : tuple of int
        Their numbers in the scenario.
    at_goal : bool
        At the goals rather than at the starts.
    distance : float
        Least distance of the two means there [m].
    within : float
        The range [m].
    risk : float
        Least probability that it is lost there [-].
    """

    members: tuple[int, int]
    at_goal: bool
    distance: float
    within: float
    risk: float

    @property
    def hazard(self) -> EndpointHazard:
        """The same as a hazard among others."""
        return EndpointHazard("range", self.members, None, self.at_goal, self.risk, self.distance)


def lost_ranges(
    scenario: Scenario, models: Sequence[CondensedModel], *, at_goal: bool
) -> Iterator[LostRange]:
    """Yield the pairs whose starts or goals alone risk a range.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    models : sequence of CondensedModel
        Its vehicles over the whole horizon.
    at_goal : bool
        At the goals rather than at the starts.

    Yields
    ------
    LostRange
        The disc of a range lies within the half-space that touches it toward the nearest place of
        the box of differences, and all of the box is beyond that place: what leaves the half-space
        leaves the disc.
    """
    tail = Tail(scenario.covariance_samples)
    for i, j, within in keep_pairs(scenario.keep, [v.name for v in scenario.vehicles]):
        one, two = (Box.at_endpoint(models[k], at_goal=at_goal) for k in (i, j))
        nearest = np.clip(0.0, one.lower - two.upper, one.upper - two.lower)
        distance = float(np.linalg.norm(nearest))
        if distance <= 0.0:
            continue
        normal = nearest / distance
        covariance = relative_covariances(models[i], models[j])[-1 if at_goal else 0]
        deviation = float(np.sqrt(max(normal @ covariance @ normal, 0.0)))
        slack = within - distance
        held = clearance(np.array([slack]), np.array([deviation]))
        risk = float(tail.probability(held)[0])
        yield LostRange((i, j), at_goal, distance, within, risk)
