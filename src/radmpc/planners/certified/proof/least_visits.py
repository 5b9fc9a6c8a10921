"""What a vehicle costs at least in empty space, whenever it makes its visits and arrives.

The relaxations of a program say nothing of a visit whose step is open, and searches of sets branch
on sides of obstacles and on steps alike. One vehicle alone is a small problem: steps are fixed one
visit after the other, the one first that the cheapest path misses by most, and what is left open is
left out. The cheapest path that makes all its visits ends the search; stopped before, the cheapest
that is left is a bound.
"""

from __future__ import annotations

from collections.abc import Iterator
from heapq import heappop, heappush
from itertools import count

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.model.visits import steps_of_visits
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.proof.leg_chain import LegChain
from radmpc.planners.certified.proof.leg_speeds import Table, leg_efforts
from radmpc.planners.certified.turned.touring.visit_lp import VisitLp
from radmpc.program.condensed import CondensedModel
from radmpc.program.visits.columns import has_choice_of_arrival, is_disjunctive
from radmpc.records import dataclass, field, replace
from radmpc.solvers.solution import Limits

__all__ = ["least_cost", "with_least_visits"]

_MOST_SOLVES = 4000
"""Linear programs that are solved for one vehicle [-], about three milliseconds each. Three visits
at any of 30 steps took 27 to 270 (`benchmarks/waypoints.py`)."""

_SHARE = 0.2
"""Share of the time left that all vehicles take together [-]."""

_MADE = 1e-6
"""What a box, or a speed, may be missed by [m, m/s]."""

_ROUNDING = 1e-9
"""Share of a cost that is rounding [-]."""

_UNSOLVED, _DONE = -2, -1
"""Instead of what is to be fixed next: the node is not solved yet; its path makes all visits."""

Steps = tuple[int | None, ...]
"""Of the visits, then of the arrival; None is open."""


def with_least_visits(fleet: Fleet) -> Fleet:
    """Return a fleet whose vehicles cost at least what their visits do in empty space.

    Parameters
    ----------
    fleet : Fleet
        The fleet, with the limits that end the search.
    """
    limits = fleet.limits
    if limits.seconds_left < float("inf"):
        limits = limits.within(_SHARE * limits.seconds_left)
    models = fleet.programs.models
    costs = [0.0] * len(models)
    waiting = [
        i
        for i, model in enumerate(models)
        if is_disjunctive(model) and model.vehicle.cost_weight > 0.0
    ]
    for left, i in zip(range(len(waiting), 0, -1), waiting, strict=True):
        if limits.reached:
            break
        # What one needs less the next ones have more of; a hard one leaves them their shares.
        share = limits.seconds_left / left
        own = limits.within(share) if share < float("inf") else limits
        costs[i] = least_cost(models[i], own)
    return replace(fleet, least_costs=tuple(costs))


def least_cost(model: CondensedModel, limits: Limits, most_solves: int = _MOST_SOLVES) -> float:
    """Return a lower bound on what a vehicle costs in empty space with all its visits.

    Parameters
    ----------
    model : CondensedModel
        The vehicle; its effort costs something.
    limits : Limits
        When to stop early.
    most_solves : int
        Linear programs after which to stop.

    Returns
    -------
    float
        The least cost itself, time included, unless it was stopped.
    """
    search = _Search(model)
    search.push(search.root, 0.0)
    while search.heap:
        bound, _, steps, to_fix = heappop(search.heap)
        if to_fix == _DONE or search.solves >= most_solves or limits.reached:
            return bound - _ROUNDING * abs(bound)
        if to_fix == _UNSOLVED:
            search.solve(steps, bound)
            continue
        for child in search.children(steps, to_fix):
            search.push(child, bound)
    return 0.0  # no step is left: what is wrong is for others to say


@dataclass(slots=True)
class _Search:
    """The search: what is left of it, by cost."""

    model: CondensedModel
    program: VisitLp = field(init=False)
    windows: list[tuple[int, int]] = field(init=False)
    root: Steps = field(init=False)
    heap: list[tuple[float, int, Steps, int]] = field(default_factory=list)
    costs: dict[Steps, float] = field(default_factory=dict)
    solves: int = 0
    numbers: Iterator[int] = field(default_factory=count)

    table: Table | None = None
    chain: LegChain | None = None

    def __post_init__(self) -> None:
        """Fix what has one step only, and the arrival where time costs nothing."""
        model = self.model
        arrival = model.vehicle.goal.window(model.horizon)
        self.program = VisitLp(model)
        self.table = leg_efforts(model)
        if self.table is None:
            self.chain = LegChain.of(model)
        self.windows = [*steps_of_visits(model.vehicle.via, model.horizon), arrival]
        given: list[int | None] = [a if a == b else None for a, b in self.windows]
        if not has_choice_of_arrival(model):
            given[-1] = arrival[1]
        self.root = tuple(given)

    def push(self, steps: Steps, bound: float) -> None:
        """Keep a node that is not solved yet, by what is known of it with one visit left open."""
        known = [self.costs.get(less, 0.0) for less in self._opened(steps)]
        bound = max([bound, *known, self._tabulated(steps)])
        heappush(self.heap, (bound, next(self.numbers), steps, _UNSOLVED))

    def solve(self, steps: Steps, bound: float) -> None:
        """Solve a node and keep it; one that cannot be is dropped."""
        bound = max(bound, self.program.cost(steps))
        self.solves += 1
        self.costs[steps] = bound
        if np.isfinite(bound):
            heappush(self.heap, (bound, next(self.numbers), steps, self._next(steps)))

    def children(self, steps: Steps, j: int) -> Iterator[Steps]:
        """Yield the steps of a node with one more fixed, in all ways that are left."""
        for step in range(*self._range(steps, j)):
            yield (*steps[:j], step, *steps[j + 1 :])

    def _tabulated(self, steps: Steps) -> float:
        """Return what velocities say of a node: the least of all that its open visits can be."""
        places = [
            slice(None) if step is None else slice(step - first, step - first + 1)
            for step, (first, _) in zip(steps[:-1], self.windows, strict=False)
        ]
        time = self.model.time_cost * (steps[-1] or self.windows[-1][0]) / self.model.horizon
        if self.table is not None:
            return float(self.table[tuple(places)].min()) + time
        return time if self.chain is None else self.chain.least(places) + time

    def _opened(self, steps: Steps) -> Iterator[Steps]:
        """Yield the same steps but one, and of three or more each by itself."""
        fixed = [j for j, step in enumerate(steps[:-1]) if step is not None]
        open_to = self.root
        for j in fixed:
            yield (*steps[:j], open_to[j], *steps[j + 1 :])
            if len(fixed) > 1:
                yield tuple(
                    step if i in {j, len(steps) - 1} else open_to[i] for i, step in enumerate(steps)
                )

    def _range(self, steps: Steps, j: int) -> tuple[int, int]:
        """Return the first step that is left for a visit, and the one after the last.

        Between visits that are fixed there is room for all that are open.
        """
        first, last = self.windows[j]
        if j == len(steps) - 1:
            return first, last + 1  # an arrival waits for no visit
        for i, step in enumerate(steps[:-1]):
            if step is not None and i < j:
                first = max(first, step + j - i)
            elif step is not None and i > j:
                last = min(last, step - (i - j))
        return first, last + 1

    def _next(self, steps: Steps) -> int:
        """Return what to fix next after a node was solved; `_DONE` if its path makes all visits."""
        missing = [j for j, step in enumerate(steps) if step is None]
        if not missing:
            return _DONE
        if missing[-1] == len(steps) - 1:
            return missing[-1]  # what time costs is most of it
        missed = self._missed(self.program.controls())
        if self._is_made(steps, missed):
            return _DONE
        away = [missed[j, slice(*self._range(steps, j))].min(initial=np.inf) for j in missing]
        return missing[int(np.argmax(away))]

    def _missed(self, controls: Vector) -> Matrix:
        """Return by how much a path misses each box, or its speed, at each step, (v, T+1)."""
        model = self.model
        places = model.path(controls)
        rows = []
        for visit in model.vehicle.via:
            beside = np.maximum(visit.lower - places, places - visit.upper).max(axis=1)
            velocity, drift = model.velocity, model.drift_velocity
            if visit.speed is not None and velocity is not None and drift is not None:
                speeds = np.abs(drift + velocity @ controls)
                beside = np.maximum(beside, (speeds - visit.speed).max(axis=1))
            rows.append(np.maximum(beside, 0.0))
        return np.array(rows)

    def _is_made(self, steps: Steps, missed: Matrix) -> bool:
        """Whether all visits can be made in order, each as early as that is possible."""
        before = -1
        for j, step in enumerate(steps[:-1]):
            first, last = self.windows[j] if step is None else (step, step)
            first = max(first, before + 1)
            there = np.flatnonzero(missed[j, first : last + 1] <= _MADE)
            if step is None and not there.size:
                return False
            before = first + int(there[0]) if step is None else step
            if before < first:
                return False
        return True
