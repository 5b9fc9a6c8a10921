"""Visits in a program: disjunctions over the steps at which they may take place, without risk.

A visit of one step is hard rows. Any other is a disjunction whose alternatives are steps, each with
rows for the mean position, and speed, at that step. Where the windows of consecutive visits
overlap, columns for their times, as shares of the horizon, keep them in order: the alternative of
step s fixes its visit's time at s / T, and times rise by 1 / T at least from visit to visit.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy.sparse import block_diag, csr_array

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.model.visits import Visit, steps_of_visits
from radmpc.program.avoidance import Part, RowBlock
from radmpc.program.condensed import CondensedModel

__all__ = [
    "TimeColumns",
    "at_steps",
    "fixed_visit_rows",
    "is_disjunctive",
    "time_columns",
    "times_of",
    "visit_blocks",
    "visiting_steps",
]

_MISSED = 1e6
"""What a meter beside a box counts, in meters from its middle [-]: of the steps in the box the one
nearest to its middle is taken."""

_ROUNDING = 1e-7
"""Distance from a box up to which a position counts as in it [m]: above the solver's tolerance."""


def is_disjunctive(model: CondensedModel) -> bool:
    """Whether a step has to be chosen for any visit of a vehicle."""
    return any(first < last for first, last in _windows(model))


def _windows(model: CondensedModel) -> tuple[tuple[int, int], ...]:
    """Return the steps of each visit of a vehicle."""
    return steps_of_visits(model.vehicle.via, model.horizon)


def _timed(model: CondensedModel) -> tuple[tuple[int, ...], tuple[bool, ...]]:
    """Return the visits that need a time, and whether each follows the one before at once."""
    windows = _windows(model)
    overlaps = [one[1] >= two[0] for one, two in pairwise(windows)]
    befores = [False, *overlaps]
    afters = [*overlaps, False]
    timed = [j for j in range(len(windows)) if befores[j] or afters[j]]
    return tuple(timed), tuple(befores[j] for j in timed)


@dataclass(frozen=True, slots=True, eq=False)
class TimeColumns:
    """The columns of visits' times; t of them, vehicle by vehicle.

    Attributes
    ----------
    blocks : (t,) int array
        The vehicle of each.
    visits : (t,) int array
        Which of its visits.
    lower, upper : (t,) array
        Bounds [shares of the horizon].
    order : (o, t) sparse array
        Rows that keep times in order, ``order @ times >= 1 / T``.
    """

    blocks: Indices
    visits: Indices
    lower: Vector
    upper: Vector
    order: csr_array

    @property
    def count(self) -> int:
        """Number of columns."""
        return int(self.blocks.size)


def time_columns(models: Sequence[CondensedModel]) -> TimeColumns:
    """Return the columns of the times of vehicles' visits.

    Parameters
    ----------
    models : sequence of CondensedModel
        The vehicles of a program.
    """
    blocks: list[int] = []
    visits: list[int] = []
    bounds, orders = [], []
    for i, model in enumerate(models):
        timed, follows = _timed(model)
        blocks += [i] * len(timed)
        visits += timed
        bounds += [_windows(model)[j] for j in timed]
        later = np.flatnonzero(follows)
        rows = np.zeros((later.size, len(timed)))
        rows[np.arange(later.size), later] = 1.0
        rows[np.arange(later.size), later - 1] = -1.0
        orders.append(rows)
    shares = np.array(bounds, dtype=np.float64).reshape(-1, 2) / models[0].horizon
    return TimeColumns(
        np.array(blocks, dtype=np.int64),
        np.array(visits, dtype=np.int64),
        shares[:, 0],
        shares[:, 1],
        csr_array(block_diag(orders)),
    )


def fixed_visit_rows(model: CondensedModel) -> tuple[Matrix, Vector, Vector]:
    """Return the rows of the visits of a vehicle whose step is given, over its controls.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.

    Returns
    -------
    (h, T*m), (h,) and (h,) array
        Rows, lower and upper bounds.
    """
    rows, lowers, uppers = [], [], []
    for visit, (first, last) in zip(model.vehicle.via, _windows(model), strict=True):
        if first != last:
            continue
        rows.append(model.position[first])
        lowers.append(visit.lower - model.drift_position[first])
        uppers.append(visit.upper - model.drift_position[first])
        velocity, drift = model.velocity, model.drift_velocity
        if visit.speed is not None and velocity is not None and drift is not None:
            rows.append(velocity[first])
            lowers.append(-visit.speed - drift[first])
            uppers.append(visit.speed - drift[first])
    if not rows:
        none = np.zeros(0)
        return np.zeros((0, model.position.shape[2])), none, none
    return np.vstack(rows), np.concatenate(lowers), np.concatenate(uppers)


def visit_blocks(
    models: Sequence[CondensedModel], parts: Sequence[Part], times: TimeColumns, *, intervals: bool
) -> Iterator[tuple[str, RowBlock, tuple[str, ...]]]:
    """Yield the rows of the visits whose step is to be chosen.

    All rows of a visit are one event: without noise they run no risk, or all of it.

    Parameters
    ----------
    models : sequence of CondensedModel
        The vehicles of a program.
    parts : sequence of Part
        Each vehicle's place among the outputs, which are positions, controls, and times.
    times : TimeColumns
        The times.
    intervals : bool
        Whether windows of avoidances are intervals, from whose number their step follows.

    Yields
    ------
    str, RowBlock and tuple of str
        A vehicle's name, the rows, and the names of its visits.
    """
    begin = max(part.controls + 2 * part.control_bounds.size for part in parts)
    for i, (model, part) in enumerate(zip(models, parts, strict=True)):
        mine = np.flatnonzero(times.blocks == i).tolist()
        outputs = {int(times.visits[t]): begin + t for t in mine}
        if is_disjunctive(model):
            yield model.vehicle.name, *_visit_block(model, part, outputs, intervals=intervals)


def _visit_block(
    model: CondensedModel, part: Part, times: dict[int, int], *, intervals: bool
) -> tuple[RowBlock, tuple[str, ...]]:
    """Return the rows of a vehicle's visits, times' outputs given by their numbers; and names."""
    pieces, names, firsts = [], [], []
    for j, (first, last) in enumerate(_windows(model)):
        if first < last:
            steps = np.arange(first, last + 1)
            pieces.append(_visit_rows(model, part, model.vehicle.via[j], steps, times.get(j)))
            names.append(f"via[{j}]")
            firsts.append(first)
    bases = np.cumsum([0, *(piece.offsets.size for piece in pieces)])
    every = np.arange(len(pieces))
    offsets = np.concatenate([piece.offsets for piece in pieces])
    block = RowBlock(
        entry_rows=np.concatenate([p.rows + b for p, b in zip(pieces, bases, strict=False)]),
        entry_outputs=np.concatenate([piece.outputs for piece in pieces]),
        entry_values=np.concatenate([piece.values for piece in pieces]),
        offsets=offsets,
        deviations=np.zeros(offsets.size),
        events=np.repeat(every, np.diff(bases)),
        event_steps=np.array(firsts),
        alternative_sizes=np.concatenate([piece.sizes for piece in pieces]),
        avoidance_sizes=np.array([piece.sizes.size for piece in pieces]),
        avoidance_windows=np.array(firsts) - (0 if intervals else 1),
        presolved_risk=0.0,
        event_things=every,
        avoidance_things=every,
    )
    return block, tuple(names)


@dataclass(frozen=True, slots=True, eq=False)
class _Rows:
    """The rows of one visit, step by step, numbered from 0."""

    rows: Indices
    outputs: Indices
    values: Vector
    offsets: Vector
    sizes: Indices


def _visit_rows(
    model: CondensedModel, part: Part, visit: Visit, steps: Indices, time: int | None
) -> _Rows:
    """Return the rows of a visit at each of some steps: box, speed, time."""
    d, horizon = visit.lower.size, model.horizon
    velocity, drift = model.velocity, model.drift_velocity
    has_speed = visit.speed is not None and velocity is not None
    size = 2 * d + (2 * d if has_speed else 0) + (0 if time is None else 2)
    signs = np.repeat([1.0, -1.0], d)
    first_rows = size * np.arange(steps.size)[:, None]
    places = part.position + steps[:, None] * d + np.tile(np.arange(d), 2)
    rows = [(first_rows + np.arange(2 * d)).ravel()]
    outputs, values = [places.ravel()], [np.tile(signs, steps.size)]
    offsets = [np.tile(np.append(visit.upper, -visit.lower), (steps.size, 1))]
    if visit.speed is not None and velocity is not None and drift is not None:
        moves = velocity[steps]
        both = np.concatenate([moves, -moves], axis=1)
        halves = np.concatenate([both, -both], axis=2)
        number, row, column = np.nonzero(halves)
        rows.append(size * number + 2 * d + row)
        outputs.append(part.controls + column)
        values.append(halves[number, row, column])
        offsets.append(np.tile(visit.speed, 2) - signs * np.tile(drift[steps], 2))
    if time is not None:
        rows.append((first_rows + size - 2 + np.arange(2)).ravel())
        outputs.append(np.full(2 * steps.size, time))
        values.append(np.tile([1.0, -1.0], steps.size))
        shares = steps[:, None] / horizon
        offsets.append(np.concatenate([shares, -shares], axis=1))
    return _Rows(
        np.concatenate(rows),
        np.concatenate(outputs),
        np.concatenate(values),
        np.concatenate(offsets, axis=1).ravel(),
        np.full(steps.size, size),
    )


def visiting_steps(model: CondensedModel, controls: Matrix) -> tuple[int, ...]:
    """Return the steps at which a vehicle makes its visits; where it misses any, the nearest.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    controls : (T, m) array
        Its nominal controls.

    Returns
    -------
    tuple of int
        One per visit, rising, each within its window.
    """
    horizon, via = model.horizon, model.vehicle.via
    means = model.drift_position + model.position @ controls.ravel()
    totals, before = np.zeros(horizon + 1), []
    for visit, (first, last) in zip(via, _windows(model), strict=True):
        beside = np.maximum(np.maximum(visit.lower - means, means - visit.upper), 0.0).sum(axis=1)
        velocity, drift = model.velocity, model.drift_velocity
        if visit.speed is not None and velocity is not None and drift is not None:
            speeds = np.abs(drift + velocity @ controls.ravel())
            beside += np.maximum(speeds - visit.speed, 0.0).sum(axis=1)
        beside[beside <= _ROUNDING] = 0.0
        costs = _MISSED * beside + np.linalg.norm(means - visit.center, axis=1)
        costs[:first] = costs[last + 1 :] = np.inf
        # The best way to have made all earlier visits before each step.
        order = np.minimum.accumulate(totals)
        is_new = np.append(True, totals[1:] < order[:-1])
        best = np.maximum.accumulate(np.where(is_new, np.arange(horizon + 1), 0))
        before.append(np.append(0, best[:-1]))
        totals = costs + np.append(np.inf if len(before) > 1 else 0.0, order[:-1])
    steps = [int(totals.argmin())] if via else []
    for earlier in before[:0:-1]:
        steps.append(int(earlier[steps[-1]]))
    return tuple(reversed(steps))


def at_steps(model: CondensedModel, steps: Sequence[int]) -> CondensedModel:
    """Return a vehicle whose visits take place at given steps.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    steps : sequence of int
        One per visit, rising.
    """
    pairs = zip(model.vehicle.via, steps, strict=True)
    via = tuple(replace(visit, between=(k, k)) for visit, k in pairs)
    return replace(model, vehicle=replace(model.vehicle, via=via))


def times_of(models: Sequence[CondensedModel], controls: Sequence[Matrix]) -> Vector:
    """Return the columns of visits' times for given controls.

    Parameters
    ----------
    models : sequence of CondensedModel
        The vehicles of a program.
    controls : sequence of (T, m) array
        Nominal controls of each.

    Returns
    -------
    (t,) array
        Shares of the horizon.
    """
    steps = []
    for model, each in zip(models, controls, strict=True):
        visiting = visiting_steps(model, each)
        steps += [visiting[j] for j in _timed(model)[0]]
    return np.array(steps, dtype=np.float64) / models[0].horizon
