"""The rows of visits: hard ones where the step is given, alternatives where it is to be chosen."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.model.visits import Visit
from radmpc.program.avoidance import Part, RowBlock
from radmpc.program.condensed import CondensedModel
from radmpc.program.visits.columns import (
    ARRIVAL,
    TimeColumns,
    has_choice_of_arrival,
    is_disjunctive,
    windows_of,
)
from radmpc.records import dataclass

__all__ = ["fixed_visit_rows", "rows_at", "visit_blocks"]


def fixed_visit_rows(model: CondensedModel) -> tuple[Matrix, Vector, Vector]:
    """Return the rows of the visits of a vehicle whose step is given, over its controls.

    A visit that has no step left, as where given steps do not rise, is a row that nothing keeps.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.

    Returns
    -------
    (h, T*m), (h,) and (h,) array
        Rows, lower and upper bounds.
    """
    found = [
        rows_at(model, visit, first) if first == last else _contradiction(model)
        for visit, (first, last) in zip(model.vehicle.via, windows_of(model), strict=True)
        if first >= last
    ]
    if not found:
        none = np.zeros(0)
        return np.zeros((0, model.position.shape[2])), none, none
    rows, lowers, uppers = zip(*found, strict=True)
    return np.vstack(rows), np.concatenate(lowers), np.concatenate(uppers)


def _contradiction(model: CondensedModel) -> tuple[Matrix, Vector, Vector]:
    """Return a row that no controls keep: nothing is at least 1."""
    return np.zeros((1, model.position.shape[2])), np.ones(1), np.full(1, np.inf)


def rows_at(model: CondensedModel, visit: Visit, step: int) -> tuple[Matrix, Vector, Vector]:
    """Return the rows of a visit at a given step, over a vehicle's controls.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    visit : Visit
        The box, and the speed in it; its window does not matter.
    step : int
        The step.

    Returns
    -------
    (h, T*m), (h,) and (h,) array
        Rows, lower and upper bounds.
    """
    rows, drift = model.position[step], model.drift_position[step]
    lower, upper = visit.lower - drift, visit.upper - drift
    velocity, carried = model.velocity, model.drift_velocity
    if visit.speed is None or velocity is None or carried is None:
        return rows, lower, upper
    return (
        np.vstack([rows, velocity[step]]),
        np.append(lower, -visit.speed - carried[step]),
        np.append(upper, visit.speed - carried[step]),
    )


def visit_blocks(
    models: Sequence[CondensedModel], parts: Sequence[Part], times: TimeColumns, *, intervals: bool
) -> Iterator[tuple[str, RowBlock, tuple[str, ...]]]:
    """Yield the rows of the visits, and of the arrival, whose step is to be chosen.

    All rows of a visit are one event: without noise they run no risk, or all of it. An arrival is a
    disjunction for each step but the last of its window: in the goal by then, or later.

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
    for j, (first, last) in enumerate(windows_of(model)):
        if first < last:
            steps = np.arange(first, last + 1)
            pieces.append(_visit_rows(model, part, model.vehicle.via[j], steps, times.get(j)))
            names.append(f"via[{j}]")
            firsts.append(first)
    if has_choice_of_arrival(model):
        goal = model.vehicle.goal
        box = Visit(goal.lower, goal.upper, speed=goal.speed)
        for step in range(*goal.window(model.horizon)):
            pieces.append(_arrival_rows(model, part, box, step, times[ARRIVAL]))
            names.append("goal")
            firsts.append(step)
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


def _arrival_rows(model: CondensedModel, part: Part, box: Visit, step: int, time: int) -> _Rows:
    """Return the rows of being in the goal at a step, or arriving later."""
    there = _visit_rows(model, part, box, np.array([step]), None)
    count = there.offsets.size
    return _Rows(
        np.append(there.rows, count),
        np.append(there.outputs, time),
        np.append(there.values, -1.0),
        np.append(there.offsets, -(step + 1) / model.horizon),
        np.array([count, 1]),
    )


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
