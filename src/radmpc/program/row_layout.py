"""Rows laid out: the entries of every alternative over positions and controls, events numbered."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Vector
from radmpc.program.avoidance import Body, End, Part, RowBlock, Windows

__all__ = ["empty_block", "lay_out"]


def empty_block(presolved_risk: float, num_presolved: int) -> RowBlock:
    """Return a block without rows.

    Parameters
    ----------
    presolved_risk : float
        Risk charged for its windows.
    num_presolved : int
        How many windows it has, all of them presolved.
    """
    none, ints = np.zeros(0), np.zeros(0, dtype=np.int64)
    return RowBlock(
        entry_rows=ints,
        entry_outputs=ints,
        entry_values=none,
        offsets=none,
        deviations=none,
        events=ints,
        event_steps=ints,
        alternative_sizes=ints,
        avoidance_sizes=ints,
        avoidance_windows=ints,
        presolved_risk=presolved_risk,
        num_presolved=num_presolved,
    )


def lay_out(
    body: Body,
    windows: Windows,
    ends: list[End],
    chosen: tuple[Indices, Indices, Vector],
    presolved_risk: float,
    kept: tuple[np.ndarray, Indices],
) -> RowBlock:
    """Return the rows of chosen alternatives, ends fastest.

    Parameters
    ----------
    body : Body
        What avoids.
    windows : Windows
        What it avoids, and when.
    ends : list of End
        The conditions of an alternative.
    chosen : tuple of (a,) array
        Window, face and share θ of the near end of each alternative.
    presolved_risk : float
        Charged for the windows that ask for no choice.
    kept : tuple of (w,) array
        Which windows ask for a choice, and how many alternatives each of these has.

    Returns
    -------
    RowBlock
        Numbers count from 0.
    """
    if not windows.intervals:
        return _at_steps(body, windows, ends[0], chosen[:2], presolved_risk, kept)
    window, face, share = chosen
    num_ends, count = len(ends), len(window)
    normals = windows.normals[window, face]
    shares = np.stack([share if end.is_near else 1.0 - share for end in ends], axis=1)
    reserves = 4.0 * np.square(shares) * float(windows.intervals)
    # One row where at most one control bends the path toward the face, else two: see below.
    counts = 1 + ((reserves > 0.0) & (_num_pulls(body, normals) > 1)[:, None])
    firsts = np.cumsum(counts.ravel()) - counts.ravel()
    firsts = firsts.reshape(count, num_ends)
    entries = _entries(body, windows, ends, (window, normals, reserves), (firsts, counts))
    repeats = counts.ravel()
    direction = np.repeat(windows.directions[window, face], num_ends)
    kinds = np.tile([end.kind for end in ends], count)
    every_step = np.stack([end.steps[window] for end in ends], axis=1)
    things = np.repeat(windows.things[window], num_ends)
    keys, events = _numbered((things, every_step.ravel(), 2 * direction + kinds))
    offsets = np.stack([end.offsets[window, face] for end in ends], axis=1)
    deviations = np.stack([end.deviations[window, face] for end in ends], axis=1)
    return RowBlock(
        entry_rows=np.concatenate([rows.ravel() for rows, _, _ in entries]),
        entry_outputs=np.concatenate([outputs.ravel() for _, outputs, _ in entries]),
        entry_values=np.concatenate([values.ravel() for _, _, values in entries]),
        offsets=np.repeat(offsets.ravel(), repeats),
        deviations=np.repeat(deviations.ravel(), repeats),
        events=np.repeat(events, repeats),
        event_steps=keys[1],
        alternative_sizes=counts.sum(axis=1),
        avoidance_sizes=kept[1],
        avoidance_windows=windows.numbers[kept[0]],
        presolved_risk=presolved_risk,
        num_presolved=int(np.count_nonzero(~kept[0])),
        event_things=keys[0],
        avoidance_things=windows.things[kept[0]],
    )


def _at_steps(
    body: Body,
    windows: Windows,
    end: End,
    chosen: tuple[Indices, Indices],
    presolved_risk: float,
    kept: tuple[np.ndarray, Indices],
) -> RowBlock:
    """Return what `lay_out` does where only steps count: a row per alternative."""
    window = chosen[0]
    count, normals = window.size, windows.normals[chosen]
    rows, things, steps = np.arange(count), windows.things[window], end.steps[window]
    keys, events = _numbered((things, steps, 2 * windows.directions[chosen] + end.kind))
    entries = [_position_entries(part, rows, normals, steps) for part in body.parts]
    return RowBlock(
        entry_rows=np.concatenate([each for each, _, _ in entries]),
        entry_outputs=np.concatenate([outputs.ravel() for _, outputs, _ in entries]),
        entry_values=np.concatenate([values.ravel() for _, _, values in entries]),
        offsets=end.offsets[chosen],
        deviations=end.deviations[chosen],
        events=events,
        event_steps=keys[1],
        alternative_sizes=np.ones(count, dtype=np.int64),
        avoidance_sizes=kept[1],
        avoidance_windows=windows.numbers[kept[0]],
        presolved_risk=presolved_risk,
        num_presolved=int(np.count_nonzero(~kept[0])),
        event_things=keys[0],
        avoidance_things=windows.things[kept[0]],
    )


def _entries(
    body: Body,
    windows: Windows,
    ends: list[End],
    chosen: tuple[Indices, Vector, Vector],
    numbered: tuple[Indices, Indices],
) -> list[tuple[Indices, Indices, Vector]]:
    """Return rows, outputs and values of the entries of every alternative's rows.

    Parameters
    ----------
    body, windows, ends
        As in `lay_out`.
    chosen : tuple of (a,), (a, d) and (a, ends) array
        Window and normal of each alternative, and what multiple of the sagitta each end reserves.
    numbered : tuple of (a, ends) int array
        Number of the first row of each end, and how many rows it has.
    """
    window, normals, reserves = chosen
    number = windows.numbers[window]
    firsts, counts = numbered
    entries: list[tuple[Indices, Indices, Vector]] = []
    for e, end in enumerate(ends):
        steps, reserve = end.steps[window], reserves[:, e]
        is_split = counts[:, e] == 2
        plain = firsts[:, e]
        bent = plain[is_split] + 1
        for part in body.parts:
            entries.append(_position_entries(part, plain, normals, steps))
            entries.append(_position_entries(part, bent, normals[is_split], steps[is_split]))
            if windows.intervals and part.sagitta.any():
                one, two = ~is_split & (reserve > 0.0), is_split
                entries.append(
                    _half_sagitta_entries(part, plain[one], normals[one], number[one], reserve[one])
                )
                entries.append(
                    _sagitta_entries(part, bent, normals[two], number[two], reserve[two])
                )
    return entries


def _position_entries(
    part: Part, rows: Indices, normals: Vector, steps: Indices
) -> tuple[Indices, Indices, Vector]:
    """Return the entries ``sign · normal`` at the position of each row's step."""
    d = normals.shape[1]
    outputs = part.position + steps[:, None] * d + np.arange(d)
    return np.repeat(rows, d), outputs, part.sign * normals


def _num_pulls(body: Body, normals: Vector) -> Indices:
    """Return how many controls bend the mean curve along each normal, (c,)."""
    pulls = [np.abs(normals @ part.sagitta) > 1e-12 for part in body.parts]
    return np.asarray(np.concatenate(pulls, axis=1).sum(axis=1))


# With S the sagitta per control, the curve leaves its chord by −4 s (1 − s) S u, so it comes closer
# along n by at most b = −n·S u (relative: the sum over both parts, with their signs), and only
# where b > 0. A reserve of c·max(0, b) is two rows of one event, margin >= 0 and margin >= c·b.
# Where only one control has a part in b, max(0, b) is one of the halves of |u| that the cost needs
# anyway, and one row says both.


def _sagitta_entries(
    part: Part, rows: Indices, normals: Vector, number: Indices, reserve: Vector
) -> tuple[Indices, Indices, Vector]:
    """Return the entries that reserve a multiple of the mean curve's sagitta, signed."""
    pull = reserve[:, None] * (part.sign * (normals @ part.sagitta))
    m = pull.shape[1]
    plus = part.controls + number[:, None] * m + np.arange(m)
    outputs = np.concatenate([plus, plus + part.control_bounds.size], axis=1)
    return np.repeat(rows, 2 * m), outputs, np.concatenate([-pull, pull], axis=1)


def _half_sagitta_entries(
    part: Part, rows: Indices, normals: Vector, number: Indices, reserve: Vector
) -> tuple[Indices, Indices, Vector]:
    """Return the entries that reserve a multiple of it where it comes closer, by halves of |u|."""
    pull = part.sign * (normals @ part.sagitta)
    m = pull.shape[1]
    span = part.control_bounds.size
    outputs = part.controls + number[:, None] * m + np.arange(m) + np.where(pull > 0.0, span, 0)
    return np.repeat(rows, m), outputs, reserve[:, None] * np.abs(pull)


def _numbered(keys: tuple[Indices, Indices, Indices]) -> tuple[tuple[Indices, Indices], Indices]:
    """Return thing and step of each distinct (thing, step, direction), and every row's number."""
    things, steps, directions = keys
    width, span = int(directions.max(initial=0)) + 1, int(steps.max(initial=0)) + 1
    found, numbers = np.unique((things * span + steps) * width + directions, return_inverse=True)
    of_events, at = np.divmod(found // width, span)
    return (of_events, at), numbers
