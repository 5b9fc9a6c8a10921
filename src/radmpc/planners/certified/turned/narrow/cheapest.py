"""Of several routes around obstacles, for each vehicle the one of the least effort alone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Indices, Matrix
from radmpc.planners.certified.turned.detours import NARROW, Toll, detours
from radmpc.planners.certified.turned.grid import Grid
from radmpc.planners.certified.turned.paths import Paths, timed_by_visits
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.program.hazards import Hazards
from radmpc.solvers.solution import Limits

__all__ = ["cheapest_routes"]

_WAYS = 4
"""Routes of a vehicle that are compared at most [-]: the shortest that keeps clear of gaps where it
can, that through gaps, and both again beside all before."""

_GOOD = 1.3
"""Effort of a route, in multiples of what it would take without obstacles, at which no other is
sought [-]."""

_SWEEPS = 6
"""Times that a vehicle is planned on a route, at most [-]: most take one to three."""

_MISSED, _MOST_MISSED, _LACKING = 0.02, 0.2, 10.0
"""What a vehicle may miss there at no charge, and at most, to count as a route all the same, since
turning half-spaces gains that [m]; and what is charged for the rest of it [effort per m]. Among the
nine boxes of db-CBS `forest` cheap routes miss 0.03 to 0.09 m, and those that miss nothing cost
twice as much."""


def cheapest_routes(
    hazards: Hazards,
    alone: Paths,
    stopped: Sequence[int] | Indices,
    clearance: float,
    limits: Limits,
) -> dict[int, Matrix]:
    """Return routes around obstacles: the shortest, or others where these take less effort.

    What is short on a grid may wind, and whoever keeps clear of all gaps may go far around. Two or
    three linear programs of one vehicle tell what a route takes: 2 to 5 ms among a hundred boxes.

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    alone : Paths
        What vehicles do by themselves.
    stopped : sequence of int
        Those that obstacles stop.
    clearance : float
        Standard deviations that they keep [-].
    limits : Limits
        When to stop.

    Returns
    -------
    dict of int to (p, d) array
        Corners of the routes from start to goal [m], of those for which there is one.
    """
    grid, trial = Grid.of(hazards), SuccessiveLp(hazards, limits)
    found = detours(hazards, stopped, clearance, grid)
    if len(found) > TUNING.weighed:
        return found
    state, direct = alone.state(), detours(hazards, list(found), clearance, grid, Toll(1.0))
    for i, shortest in found.items():
        if limits.reached:
            break
        least = float(np.abs(alone.controls[i]).sum())
        known = [shortest, direct.get(i, shortest)]
        costs: list[tuple[bool, float, int]] = []
        for number in range(_WAYS):
            if number >= len(known):
                toll = Toll((NARROW, 1.0)[number % 2], tuple(known))
                known.append(detours(hazards, [i], clearance, grid, toll).get(i, shortest))
            if any(np.array_equal(known[number], one) for one in known[:number]):
                continue
            trial.restore(state)
            trial.refer(i, timed_by_visits(hazards.models[i], known[number]))
            enough = min((effort for missed, effort, _ in costs if not missed), default=np.inf)
            missed, effort = _planned(trial, i, clearance, enough, limits)
            lacking = _LACKING * max(missed - _MISSED, 0.0)
            costs.append((missed > _MOST_MISSED, effort + lacking, number))
            if (missed <= _MISSED and effort <= _GOOD * least) or limits.reached:
                break
        found[i] = known[min(costs)[2]]
    return found


def _planned(
    trial: SuccessiveLp, vehicle: int, clearance: float, enough: float, limits: Limits
) -> tuple[float, float]:
    """Return what a vehicle misses on its route once planned there, and its effort [m], [m/s²].

    It is planned until it misses nothing, or its effort is enough to know that others are better:
    effort grows with what a miss costs.
    """
    missed = effort = np.inf
    penalty = TUNING.first_penalty
    for _ in range(_SWEEPS):
        trial.plan_alone(vehicle, clearance, penalty)
        missed = float(trial.missed[vehicle])
        effort = float(np.abs(trial.paths.controls[vehicle]).sum())
        if missed <= _MISSED or effort >= enough or limits.reached:
            break
        penalty = min(TUNING.penalty_growth * penalty, TUNING.last_penalty)
    return missed, effort
