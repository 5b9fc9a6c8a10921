"""Good steps for visits and arrivals, before there is any plan.

Half-spaces are turned to plans whose visits keep the steps at which they are made. The first plan
has them at the steps that cost least in empty space, as far as moving one at a time tells.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np

from radmpc.arrays import Matrix
from radmpc.model.visits import steps_of_visits
from radmpc.planners.certified.turned.touring.leg_steps import steps_by_legs
from radmpc.planners.certified.turned.touring.tour_lp import TourLp
from radmpc.planners.certified.turned.touring.visit_lp import VisitLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.program.condensed import CondensedModel
from radmpc.program.hazards import Hazards
from radmpc.program.visits.columns import has_choice_of_arrival
from radmpc.program.visits.steps import at_steps
from radmpc.records import dataclass, replace

__all__ = ["GoodVisits", "at_good_visits", "good_steps"]

_MOVES = (4, 2, 1)
"""Steps that a visit is moved by while it pays, long moves first [-]."""

_FARTHEST = 8
"""The part of the horizon that the longest moves take at most, where that is more than the longest
of these [-]: they double."""

_MOST_RUNS = 36
"""Runs of visits up to which they are moved together [-]: those of eight visits. Surveys have more,
and their order leaves them little to choose."""

_PAYS = 1e-6
"""Share of the cost that a move gains at least [-]."""

_MADE = 1e-6
"""What boxes may be missed by [m, m/s]."""


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
    if least == np.inf:
        return tuple(steps)  # it cannot reach its goal, whatever it visits when
    has_choice = arrivals[0] < arrivals[1]
    is_good = by_legs is not None and not has_choice and program.missed <= _MADE
    if is_good and not is_thorough:
        return tuple(steps)
    alone = [(j, j + 1) for j in range(count)]
    runs = [(i, j) for i in range(count) for j in range(i + 2, count + 1)]
    runs = runs if is_thorough and len(runs) <= _MOST_RUNS else []
    rounds = [] if is_good else [(move, alone) for move in _moves(model.horizon)]
    rounds.append((1, [*runs, *alone]))
    return _while_it_pays(program, (steps, least), rounds, (windows, arrivals))


def _while_it_pays(
    program: VisitLp,
    begun: tuple[list[int], float],
    rounds: Sequence[tuple[int, Sequence[tuple[int, int]]]],
    bounds: tuple[Sequence[tuple[int, int]], tuple[int, int]],
) -> tuple[int, ...]:
    """Return steps, which are given with their cost, after moving parts of them while that pays."""
    steps, least = begun
    known = {tuple(steps)}
    for move, parts in rounds:
        has_moved = True
        while has_moved:
            has_moved = False
            for (i, j), by in product(parts, (-move, move)):
                moved = [*steps[:i], *(k + by for k in steps[i:j]), *steps[j:]]
                # What was looked at before costs no less than the least.
                if tuple(moved) in known or not all(
                    _is_allowed(moved, k, *bounds) for k in range(i, j)
                ):
                    continue
                known.add(tuple(moved))
                most = least - _PAYS * abs(least)
                cost = program.cost(moved, most)
                if cost < most:
                    steps, least, has_moved = moved, cost, True
    return tuple(steps)


def _moves(horizon: int) -> tuple[int, ...]:
    """Return the steps that visits are moved by alone, longest first."""
    moves = [*_MOVES]
    while 2 * moves[0] <= horizon // _FARTHEST:
        moves.insert(0, 2 * moves[0])
    return tuple(moves)


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
