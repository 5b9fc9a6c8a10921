"""Vehicles that come close are planned together, whatever their risk (Keviczky et al.).

The paper reviews it as the heuristic that its own couplings improve on: a graph with an edge
between any two vehicles within some distance. Here the distance is that of the paths they would
take alone, at the same time, so that the graph follows them over the whole horizon.
"""

from __future__ import annotations

import time
from itertools import pairwise

import numpy as np

from radmpc.arguments import is_number, value_text
from radmpc.arrays import Indices, Tensor, Vector
from radmpc.errors import ScenarioError
from radmpc.model.dynamics import rollout
from radmpc.model.plan import Coupling
from radmpc.model.relations.keep import keep_pairs
from radmpc.model.scenario import Scenario
from radmpc.nearby import near_pairs
from radmpc.planners.components import components
from radmpc.planners.draft import Draft
from radmpc.planners.planner import Decomposition, Planner, Run
from radmpc.planners.sets import SetPlan, in_order, plan_sets, verdict_of_sets
from radmpc.records import dataclass
from radmpc.solvers.solution import Outcome
from radmpc.wording import number_text

__all__ = ["Distance", "close_pairs"]

Sets = tuple[tuple[int, ...], ...]


@dataclass(frozen=True, slots=True)
class Distance(Decomposition):
    """Sets of vehicles whose separate paths come close (Keviczky et al.).

    Attributes
    ----------
    meters : float
        Vehicles are coupled if they come within this distance, center to center [m].
    """

    meters: float = 5.0

    def __post_init__(self) -> None:
        """Refuse what is no distance."""
        if not (is_number(self.meters) and 0.0 <= self.meters < float("inf")):
            raise ScenarioError(
                f"distance must be a number of meters >= 0, got {value_text(self.meters)}"
            )

    def __str__(self) -> str:
        return f"distance({number_text(self.meters)})"

    def plan(self, scenario: Scenario, planner: Planner, run: Run) -> Draft:
        """Plan every vehicle alone, then together those whose paths come close.

        The sets are the connected components of the graph. Nothing keeps them apart but the
        distance: the certificate says whether that was enough.

        Parameters
        ----------
        scenario, planner, run
            As in `Decomposition.plan`.
        """
        begun = time.perf_counter()
        singles: Sets = tuple((i,) for i in range(scenario.num_vehicles))

        alone = plan_sets(scenario, singles, planner, run, "alone")
        steps = tuple(step for plan in alone for step in plan.steps)
        seconds = {"alone": time.perf_counter() - begun}
        if not all(plan.controls for plan in alone):
            status, why = verdict_of_sets(scenario, singles, alone, run.limits)
            return Draft(status, (), singles, steps, (), seconds, why)
        sets, couplings = _sets(scenario, alone, self.meters)
        together = tuple(members for members in sets if len(members) > 1)
        plan_of = dict(zip(singles, alone, strict=True))
        found = plan_sets(scenario, together, planner, run, "sets")
        plan_of |= dict(zip(together, found, strict=True))
        plans = [plan_of[members] for members in sets]
        steps += tuple(step for members in together for step in plan_of[members].steps)
        seconds["sets"] = time.perf_counter() - begun - seconds["alone"]
        status, why = verdict_of_sets(scenario, sets, plans, run.limits)
        is_whole = all(p.outcome in {Outcome.OPTIMAL, Outcome.FEASIBLE} for p in plans)
        ordered = in_order(sets, plans) if is_whole else ()
        return Draft(status, ordered, sets, steps, (), seconds, why, couplings=couplings)


def _sets(
    scenario: Scenario, alone: list[SetPlan], meters: float
) -> tuple[Sets, tuple[Coupling, ...]]:
    """Return the connected components of vehicles that come close, and the graph's edges."""
    positions = np.array(
        [
            rollout(
                vehicle.system, vehicle.start, plan.controls[0], vehicle.pushes(scenario.horizon)
            )[:, list(vehicle.system.position)]
            for vehicle, plan in zip(scenario.vehicles, alone, strict=True)
        ]
    )
    pairs, distances = close_pairs(positions, meters)
    names = [vehicle.name for vehicle in scenario.vehicles]
    kept = keep_pairs(scenario.keep, names)
    sets = components(scenario.num_vehicles, [*pairs.tolist(), *((i, j) for i, j, _ in kept)])
    couplings = tuple(
        Coupling(names[i], names[j], "distance", closest)
        for (i, j), closest in zip(pairs.tolist(), distances.tolist(), strict=True)
    )
    return sets, (*couplings, *(Coupling(names[i], names[j], "range", w) for i, j, w in kept))


def close_pairs(positions: Tensor, meters: float) -> tuple[Indices, Vector]:
    """Return which pairs come within a distance on straight paths from step to step.

    Parameters
    ----------
    positions : (N, T+1, d) array
        Where everyone is at each step [m].
    meters : float
        The distance, center to center [m].

    Returns
    -------
    pairs : (p, 2) int array
        Pairs i < j, ascending.
    distances : (p,) array
        How close they come [m].
    """
    closest: dict[tuple[int, int], float] = {}
    for here, ahead in pairwise(positions.swapaxes(0, 1)):
        # Two that come close within the step have middles no further apart than this.
        longest = float(np.linalg.norm(ahead - here, axis=1).max(initial=0.0))
        near = near_pairs(0.5 * (here + ahead), meters + longest)
        i, j = near[:, 0], near[:, 1]
        start, end = here[i] - here[j], ahead[i] - ahead[j]
        move = end - start
        length = np.maximum((move**2).sum(axis=1), 1e-300)
        share = np.clip(-(start * move).sum(axis=1) / length, 0.0, 1.0)
        least = np.linalg.norm(start + share[:, None] * move, axis=1)
        close = least <= meters
        for (one, two), gap in zip(near[close].tolist(), least[close].tolist(), strict=True):
            closest[one, two] = min(gap, closest.get((one, two), gap))
    pairs = sorted(closest)
    distances = np.array([closest[pair] for pair in pairs])
    return np.array(pairs, dtype=np.int64).reshape(-1, 2), distances
