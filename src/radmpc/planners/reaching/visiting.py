"""Whether a vehicle can make its visits and reach its goal with nothing in the way.

Linear programs whose visits' steps are open say nothing of these visits. Steps are fixed one visit
after the other here, the one first that a path misses by most, until a path makes all visits, or no
choice of steps is left.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from radmpc.arrays import Matrix, Vector
from radmpc.program.condensed import CondensedModel
from radmpc.program.limits.hard import hard_rows
from radmpc.program.visits.columns import windows_of
from radmpc.program.visits.rows import rows_at
from radmpc.records import replace
from radmpc.solvers.lp.choosing import bounded_lp
from radmpc.solvers.lp.outcome import LpOutcome
from radmpc.solvers.lp.switched_rows import SwitchedRows

__all__ = ["UNREACHED", "makes_visits", "reaches_goal", "without_visits"]

UNREACHED = 1e-6
"""Distance from a box from which it counts as out of reach [m]: reach is exact up to rounding."""

_MOST_SOLVES = 300
"""Linear programs that are solved for one vehicle [-], 0.2 ms each: four visits within 24 steps
were ruled out by fewer; of eight within 60 steps that is not known."""

_MADE = 1e-6
"""What a box, or a speed, may be missed by [m, m/s]."""

Steps = tuple[int | None, ...]
"""Of the visits; None is open."""


def without_visits(model: CondensedModel, within: tuple[int, int] | None) -> CondensedModel:
    """Return a vehicle that has only to be at its goal.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    within : tuple of (int, int) or None
        The window of its arrival; None is at the horizon.
    """
    goal = replace(model.vehicle.goal, within=within)
    return replace(model, vehicle=replace(model.vehicle, via=(), goal=goal), time_cost=0.0)


def reaches_goal(model: CondensedModel, within: tuple[int, int] | None) -> bool:
    """Whether a vehicle can be at its goal from the end of a window on, visits aside.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    within : tuple of (int, int) or None
        The window; None is the horizon.

    Returns
    -------
    bool
        False is proven by a linear program.
    """
    return _Search(without_visits(model, within)).solve(()) is not LpOutcome.INFEASIBLE


def makes_visits(model: CondensedModel) -> bool | None:
    """Whether a vehicle can make all its visits in order and be at its goal in time.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.

    Returns
    -------
    bool or None
        False is proven by linear programs; None where too many of them would be needed.
    """
    return model.kept.once(_makes_visits, model) if model.vehicle.via else True


def _makes_visits(model: CondensedModel) -> bool | None:
    """Search, in depth first."""
    search = _Search(model)
    to_try: list[Steps] = [search.root]
    while to_try:
        steps = to_try.pop()
        if search.solves >= _MOST_SOLVES:
            return None
        outcome = search.solve(steps)
        if outcome is LpOutcome.INFEASIBLE:
            continue
        if outcome is not LpOutcome.OPTIMAL:
            return None
        missed = search.missed()
        if search.makes_all(steps, missed):
            return True
        to_try += search.children(steps, missed)
    return False


class _Search:
    """A vehicle's linear program, with rows of visits at steps that are on or off.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    """

    def __init__(self, model: CondensedModel) -> None:
        self._model = model
        self.solves = 0
        # Visits whose step is given are branched on, too: all rows are added here.
        alone = replace(model, vehicle=replace(model.vehicle, via=()))
        rows, lower, upper = hard_rows(alone)
        bounds = np.maximum(np.tile(model.control_bounds.ravel(), 2), 0.0)
        self._lp = bounded_lp(np.ones(bounds.size), np.zeros(bounds.size), bounds)
        self._lp.add_rows(csr_array(np.hstack([rows, -rows])), lower, upper)
        self._visits = SwitchedRows(self._lp, self._rows_at)
        self._windows = windows_of(model) if model.vehicle.via else ()
        self.root: Steps = tuple(a if a == b else None for a, b in self._windows)

    def solve(self, steps: Steps) -> LpOutcome:
        """Solve it with some visits at steps, the others left out."""
        self._visits.ask_for({(j, k) for j, k in enumerate(steps) if k is not None})
        self.solves += 1
        return self._lp.solve()[0]

    def _rows_at(self, key: tuple[int, int]) -> tuple[csr_array, Vector, Vector]:
        """Return the rows of a visit at a step."""
        visit, step = key
        rows, lower, upper = rows_at(self._model, self._model.vehicle.via[visit], step)
        return csr_array(np.hstack([rows, -rows])), lower, upper

    def missed(self) -> Matrix:
        """Return by how much the last path misses each box, or its speed, at each step, (v, T+1).

        Where no path comes, and outside its window, a visit is missed by infinity.
        """
        model = self._model
        span = model.position.shape[2]
        found = self._lp.point()
        controls = found[:span] - found[span : 2 * span]
        places = model.drift_position + model.position @ controls
        missed = np.full((len(self._windows), model.horizon + 1), np.inf)
        for j, (visit, (first, last)) in enumerate(
            zip(model.vehicle.via, self._windows, strict=True)
        ):
            beside = np.maximum(visit.lower - places, places - visit.upper).max(axis=1)
            velocity, drift = model.velocity, model.drift_velocity
            if visit.speed is not None and velocity is not None and drift is not None:
                speeds = np.abs(drift + velocity @ controls)
                beside = np.maximum(beside, (speeds - visit.speed).max(axis=1))
            gap = np.maximum(model.reach_lower - visit.upper, visit.lower - model.reach_upper)
            beside[gap.max(axis=1) > UNREACHED] = np.inf
            missed[j, first : last + 1] = np.maximum(beside[first : last + 1], 0.0)
        return missed

    def makes_all(self, steps: Steps, missed: Matrix) -> bool:
        """Whether the last path makes all visits in order, each as early as it can."""
        before = -1
        for step, beside in zip(steps, missed, strict=True):
            there = np.flatnonzero(beside[before + 1 :] <= _MADE) + before + 1
            if step is not None:
                there = np.array([step])
            if not there.size or there[0] <= before:
                return False
            before = int(there[0])
        return True

    def children(self, steps: Steps, missed: Matrix) -> list[Steps]:
        """Return steps with one more fixed, in all ways that are left, the most likely last."""
        choices = {
            j: self._choices(steps, j, missed[j]) for j, step in enumerate(steps) if step is None
        }
        if not choices:
            return []
        # A visit that no step is left for ends this branch; the one missed by most goes first.
        nearest = {j: missed[j, ks].min(initial=np.inf) for j, ks in choices.items()}
        j = max(choices, key=lambda one: float(nearest[one]))
        ranked = sorted(choices[j], key=lambda k: -float(missed[j, k]))
        return [(*steps[:j], k, *steps[j + 1 :]) for k in ranked]

    def _choices(self, steps: Steps, j: int, missed: Vector) -> list[int]:
        """Return the steps that are left for a visit between those that are fixed."""
        first, last = self._windows[j]
        for i, step in enumerate(steps):
            if step is not None and i < j:
                first = max(first, step + j - i)
            elif step is not None:
                last = min(last, step - (i - j))
        return [k for k in range(first, last + 1) if np.isfinite(missed[k])]
