"""The linear program of one vehicle in empty space, visits and arrival at given steps."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csr_array

from radmpc.arrays import Matrix, Vector
from radmpc.model.visits import Visit
from radmpc.program.condensed import CondensedModel
from radmpc.program.limits.hard import hard_rows
from radmpc.program.visits.rows import rows_at
from radmpc.records import replace
from radmpc.solvers.lp.choosing import bounded_lp
from radmpc.solvers.lp.outcome import LpOutcome
from radmpc.solvers.lp.switched_rows import Key, SwitchedRows

__all__ = ["VisitLp"]

_MISSED = 1e3
"""What a meter beside a box costs, in what a meter's detour over one step costs [-]: enough for
visits to be missed only where there is no way to make them."""

_FAR = 100.0
"""How far a box may be missed, in what it is missed by without any control [-]: of finite bounds on
columns linear programs can be proven, the better the smaller they are."""

_LONG = 60
"""Steps beyond which rows wait until they are missed [-]: each has an entry for every control, and
few of those that keep a vehicle slow, or where it arrived, are active. Without all of them a solve
takes a tenth of the time over 400 steps, as long over 100."""

_AT_ONCE = 8
"""Rows of a kind that stop waiting at once [-], from all over the horizon: what one step misses its
neighbors do, and few of these are left to be missed after it is not."""

_TOL = 1e-8
"""What rows that wait may be missed by [m, m/s, control]."""

_HARD = -1
"""Stands for the hard rows among the numbers of visits."""


def _far(model: CondensedModel) -> float:
    """Return how far a box may be missed [m]."""
    goal = model.vehicle.goal
    middles = [visit.center for visit in model.vehicle.via] + [goal.center]
    return _FAR * (1.0 + max(float(np.abs(model.drift_position - m).max()) for m in middles))


class VisitLp:
    """The least cost of a vehicle in empty space with visits and arrival at given steps.

    Boxes may be missed, at a high price: every choice of steps has a cost.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    """

    def __init__(self, model: CondensedModel) -> None:
        self._model = model
        alone = replace(model, vehicle=replace(model.vehicle, via=()))
        rows, lower, upper = hard_rows(alone)
        span, self._count = rows.shape[1], len(model.vehicle.via) + 1
        weight = model.vehicle.cost_weight or 1.0
        nearest = float(np.abs(model.position[1:]).max(axis=(1, 2)).min())
        beside = _MISSED * weight / max(nearest, 1e-9)
        bounds = np.maximum(np.tile(model.control_bounds.ravel(), 2), 0.0)
        self._lp = bounded_lp(
            np.append(np.full(2 * span, weight), np.full(self._count, beside)),
            np.zeros(2 * span + self._count),
            np.append(bounds, np.full(self._count, _far(model))),
        )
        self._hard = rows, lower, upper
        self._boxes = SwitchedRows(self._lp, self._rows_at)
        self._found: set[Key] = set()
        self._is_long = model.horizon > _LONG
        if not self._is_long:
            self._lp.add_rows(self._packed(rows), lower, upper)

    def cost(self, steps: Sequence[int | None], cutoff: float = np.inf) -> float:
        """Return the least cost with visits and arrival at some steps, what is missed included.

        Parameters
        ----------
        steps : sequence of int or None
            Of the visits, then of the arrival; where it is None a visit need not be made, and what
            an arrival costs is that of its first step.
        cutoff : float
            Cost from which on it does not matter what it is: at least this is returned then.
        """
        target = {(j, k) for j, k in enumerate(steps[:-1]) if k is not None}
        first, last = self._model.vehicle.goal.window(self._model.horizon)
        arrival = steps[-1]
        stays = range(last if arrival is None else arrival, last)
        time = self._model.time_cost * (first if arrival is None else arrival) / self._model.horizon
        target |= self._in_goal(stays)
        while True:
            self._boxes.ask_for(target)
            outcome, bound = self._lp.solve(cutoff - time)
            if outcome not in {LpOutcome.OPTIMAL, LpOutcome.CUTOFF}:
                return np.inf
            missed = set() if outcome is LpOutcome.CUTOFF else self._waiting(stays) - target
            if not missed:
                return bound + time
            self._found |= missed
            target = target | missed

    def _in_goal(self, stays: range) -> set[Key]:
        """Return the rows of the goal at some steps, without those that wait until missed."""
        goal = self._count - 1
        if not self._is_long:
            return {(goal, k) for k in stays}
        kept = {key for key in self._found if key[0] == _HARD or key[1] in stays}
        return kept | {(goal, k) for k in stays[:1]}

    def _waiting(self, stays: range) -> set[Key]:
        """Return what the cheapest path misses: hard rows, and the goal at some steps."""
        if not self._is_long:
            return set()
        controls, (rows, lower, upper) = self.controls(), self._hard
        at = rows @ controls
        found = {(_HARD, r) for r in _worst(np.maximum(lower - at, at - upper))}
        if stays:
            goal, at = (
                self._model.vehicle.goal,
                self._model.path(controls)[stays.start : stays.stop],
            )
            beside = np.maximum(goal.lower - at, at - goal.upper).max(axis=1)
            velocity, drift = self._model.velocity, self._model.drift_velocity
            if goal.speed is not None and velocity is not None and drift is not None:
                speeds = np.abs(drift + velocity @ controls)[stays.start : stays.stop]
                beside = np.maximum(beside, (speeds - goal.speed).max(axis=1))
            worst = _worst(beside - self._lp.point()[-1])
            found |= {(self._count - 1, stays[k]) for k in worst}
        return found

    @property
    def num_rows(self) -> int:
        """Rows that the program has by now."""
        return self._lp.num_rows

    @property
    def missed(self) -> float:
        """How far boxes are missed by the cheapest path at the steps last asked for [m]."""
        return float(self._lp.point()[-self._count :].sum())

    def controls(self) -> Vector:
        """Return the controls of the cheapest path at the steps last asked for, (T m,)."""
        span = self._model.position.shape[2]
        found = self._lp.point()
        return np.asarray(found[:span] - found[span : 2 * span])

    def _rows_at(self, key: tuple[int, int]) -> tuple[csr_array, Vector, Vector]:
        """Return the rows of a visit, or of the goal, at a step."""
        visit, step = key
        if visit == _HARD:
            rows, lower, upper = (each[step : step + 1] for each in self._hard)
            return self._packed(rows), lower, upper
        goal, via = self._model.vehicle.goal, self._model.vehicle.via
        boxes = (*via, Visit(goal.lower, goal.upper, speed=goal.speed))
        rows, lower, upper = rows_at(self._model, boxes[visit], step)
        right = np.append(lower, -upper)
        return self._packed(np.vstack([rows, -rows]), visit), right, np.full(right.size, np.inf)

    def _packed(self, rows: Matrix, visit: int | None = None) -> csr_array:
        """Return rows over controls as rows of all columns; what misses a visit makes up for it."""
        beside = np.zeros((len(rows), self._count))
        if visit is not None:
            beside[:, visit] = 1.0
        return csr_array(np.hstack([rows, -rows, beside]))


def _worst(beyond: Vector) -> list[int]:
    """Return which rows are missed most, one from each part of the horizon at most."""
    parts = np.array_split(np.arange(beyond.size), min(_AT_ONCE, max(beyond.size, 1)))
    worst = [int(part[beyond[part].argmax()]) for part in parts if part.size]
    return [k for k in worst if beyond[k] > _TOL]
