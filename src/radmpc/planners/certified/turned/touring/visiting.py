"""Good steps for visits and arrivals, before there is any plan.

Half-spaces are turned to plans whose visits keep the steps at which they are made. The first plan
has them at the steps that cost least in empty space, as far as moving one at a time tells.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
from scipy.sparse import csr_array

from radmpc.arrays import Matrix, Vector
from radmpc.model.visits import Visit, steps_of_visits
from radmpc.planners.certified.turned.touring.leg_steps import steps_by_legs
from radmpc.planners.certified.turned.touring.tour_lp import TourLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.program.condensed import CondensedModel
from radmpc.program.hazards import Hazards
from radmpc.program.limits.hard import hard_rows
from radmpc.program.visits.columns import has_choice_of_arrival
from radmpc.program.visits.rows import rows_at
from radmpc.program.visits.steps import at_steps
from radmpc.records import dataclass, replace
from radmpc.solvers.lp.choosing import bounded_lp
from radmpc.solvers.lp.outcome import LpOutcome
from radmpc.solvers.lp.switched_rows import SwitchedRows

__all__ = ["GoodVisits", "VisitLp", "at_good_visits", "good_steps"]

_MOVES = (4, 2, 1)
"""Steps that a visit is moved by while it pays, long moves first [-]."""

_MOST_RUNS = 36
"""Runs of visits up to which they are moved together [-]: those of eight visits. Surveys have more,
and their order leaves them little to choose."""

_PAYS = 1e-6
"""Share of the cost that a move gains at least [-]."""

_MADE = 1e-6
"""What boxes may be missed by [m, m/s]."""

_MISSED = 1e3
"""What a meter beside a box costs, in what a meter's detour over one step costs [-]: enough for
visits to be missed only where there is no way to make them."""

_FAR = 100.0
"""How far a box may be missed, in what it is missed by without any control [-]: of finite bounds on
columns linear programs can be proven, the better the smaller they are."""


def _arrival(model: CondensedModel, step: int) -> int | None:
    """Return the step of arrival where time costs anything."""
    return step if model.time_cost > 0.0 else None


@dataclass(frozen=True, slots=True, eq=False)
class GoodVisits:
    """A fleet whose visits take place at good steps, obstacles and others aside.

    Attributes
    ----------
    hazards : Hazards
        The fleet, boxes and goals due at single steps.
    to_choose : tuple of CondensedModel
        Its vehicles, visits at any step of their windows.
    alone : tuple of (T, m) array or None
        What they do by themselves, where that is known.
    """

    hazards: Hazards
    to_choose: tuple[CondensedModel, ...]
    alone: tuple[Matrix, ...] | None = None


def at_good_visits(hazards: Hazards) -> GoodVisits:
    """Return a fleet with visits at steps that cost little in empty space.

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    """
    models, alone, is_thorough = [], [], hazards.count <= TUNING.few
    for i, model in enumerate(hazards.models):
        found = None if is_thorough else _by_legs(hazards, i)
        if found is None:
            *steps, arrival = good_steps(model, is_thorough=is_thorough)
            models.append(at_steps(model, steps, _arrival(model, arrival)))
        else:
            models.append(found[0])
            alone.append(found[1])
    controls = tuple(alone) if len(alone) == len(models) else None
    return GoodVisits(replace(hazards, models=tuple(models)), hazards.models, controls)


def _by_legs(hazards: Hazards, i: int) -> tuple[CondensedModel, Matrix] | None:
    """Return a vehicle with visits at the steps by legs, and what it does; None if it cannot."""
    model = hazards.models[i]
    windows = steps_of_visits(model.vehicle.via, model.horizon)
    steps = steps_by_legs(model, windows, _at_even_speed(model, windows))
    if steps is None or has_choice_of_arrival(model):
        return None
    at_them, program = at_steps(model, steps, None), TourLp(hazards, (i,))
    program.visit([at_them])
    alone = program.alone()
    return None if alone is None else (at_them, alone[0])


def good_steps(model: CondensedModel, *, is_thorough: bool = True) -> tuple[int, ...]:
    """Return steps for a vehicle's visits, and for its arrival, that cost little in empty space.

    Those that straight legs between boxes make cheapest to begin with, or at even speed from box to
    box; then one visit after the other is moved while that pays, and runs of visits together. A
    heuristic: so not every better choice is found.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    is_thorough : bool
        Whether visits are moved from where legs have them, where these can be made at all: of six
        visits that saves 0.7 % in empty space, and takes ten times as long.

    Returns
    -------
    tuple of int
        One per visit, rising, each within its window; then that of the arrival.
    """
    window = model.vehicle.goal.window(model.horizon)
    arrivals = window if has_choice_of_arrival(model) else (window[1], window[1])
    windows = steps_of_visits(model.vehicle.via, model.horizon)
    even = _at_even_speed(model, windows)
    by_legs = steps_by_legs(model, windows, even)
    steps = [*(even if by_legs is None else by_legs), arrivals[1]]
    program, count = VisitLp(model), len(steps)
    least = program.cost(steps)
    has_choice = arrivals[0] < arrivals[1]
    is_good = by_legs is not None and not has_choice and program.missed <= _MADE
    if is_good and not is_thorough:
        return tuple(steps)
    alone = [(j, j + 1) for j in range(count)]
    runs = [(i, j) for i in range(count) for j in range(i + 2, count + 1)]
    runs = runs if is_thorough and len(runs) <= _MOST_RUNS else []
    rounds = [] if is_good else [(move, alone) for move in _MOVES]
    for move, parts in [*rounds, (1, [*runs, *alone])]:
        has_moved = True
        while has_moved:
            has_moved = False
            for (i, j), by in product(parts, (-move, move)):
                moved = [*steps[:i], *(k + by for k in steps[i:j]), *steps[j:]]
                if not all(_is_allowed(moved, k, windows, arrivals) for k in range(i, j)):
                    continue
                cost = program.cost(moved)
                if cost < least - _PAYS * abs(least):
                    steps, least, has_moved = moved, cost, True
    return tuple(steps)


def _is_allowed(
    steps: Sequence[int], j: int, windows: Sequence[tuple[int, int]], arrivals: tuple[int, int]
) -> bool:
    """Whether a step is in its window, and that of a visit between those of its neighbors."""
    if j == len(windows):
        return arrivals[0] <= steps[j] <= arrivals[1]
    before = steps[j - 1] if j else -1
    after = steps[j + 1] if j + 1 < len(windows) else windows[j][1] + 1
    return before < steps[j] < after and windows[j][0] <= steps[j] <= windows[j][1]


def _at_even_speed(model: CondensedModel, windows: Sequence[tuple[int, int]]) -> list[int]:
    """Return the steps of visits at even speed from middle to middle, as far as windows allow."""
    vehicle = model.vehicle
    middles = [visit.center for visit in vehicle.via]
    corners = np.array([model.drift_position[0], *middles, vehicle.goal.center])
    along = np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))
    shares = along[:-1] / max(float(along[-1]), 1e-9)
    steps: list[int] = []
    for share, (first, last) in zip(shares.tolist(), windows, strict=True):
        earliest = max(first, steps[-1] + 1) if steps else first
        steps.append(min(max(round(share * model.horizon), earliest), last))
    return steps


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
        nothing = np.zeros((len(rows), self._count))
        self._lp.add_rows(csr_array(np.hstack([rows, -rows, nothing])), lower, upper)
        self._boxes = SwitchedRows(self._lp, self._rows_at)

    def cost(self, steps: Sequence[int | None]) -> float:
        """Return the least cost with visits and arrival at some steps, what is missed included.

        Parameters
        ----------
        steps : sequence of int or None
            Of the visits, then of the arrival; where it is None a visit need not be made, and what
            an arrival costs is that of its first step.
        """
        target = {(j, k) for j, k in enumerate(steps[:-1]) if k is not None}
        first, last = self._model.vehicle.goal.window(self._model.horizon)
        arrival = steps[-1]
        if arrival is not None:
            target |= {(self._count - 1, k) for k in range(arrival, last)}
        self._boxes.ask_for(target)
        outcome, bound = self._lp.solve()
        due = first if arrival is None else arrival
        time = self._model.time_cost * due / self._model.horizon
        return bound + time if outcome is LpOutcome.OPTIMAL else np.inf

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
        goal, via = self._model.vehicle.goal, self._model.vehicle.via
        boxes = (*via, Visit(goal.lower, goal.upper, speed=goal.speed))
        rows, lower, upper = rows_at(self._model, boxes[visit], step)
        both = np.vstack([rows, -rows])
        beside = np.zeros((len(both), self._count))
        beside[:, visit] = 1.0
        right = np.append(lower, -upper)
        return csr_array(np.hstack([both, -both, beside])), right, np.full(right.size, np.inf)
