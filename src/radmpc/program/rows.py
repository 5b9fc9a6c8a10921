"""Chance rows of one danger over all windows: faces, noise, sagitta, and what reach settles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.gaussian import clearance_for, tail_probability
from radmpc.program.program import SETTLED_RISK, SETTLED_SHARE
from radmpc.program.reserve import shares_of_reserve

__all__ = ["Body", "Part", "RowBlock", "Windows", "danger_rows"]

_LEAST_DEVIATION = 1e-8
"""Noise that is there counts as at least so much [m]: solvers refuse slopes of 1e15 and more, which
deviations left over by cancellation give, and what this keeps is below a tenth of a micrometer."""


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """What is kept apart, one vehicle or the relative motion of two, over the outputs.

    Attributes
    ----------
    lower, upper : (T+1, d) array
        Reach of the (relative) position [m].
    covariances : (T+1, d, d) array
        Covariance of the (relative) position [m²].
    bent : (T, d, d) array or None
        Covariance of what feedback held over a step makes of the deviation at its start [m²];
        None where no part of the body bends its path by feedback.
    parts : tuple of Part
        One vehicle, or two with signs +1 and −1.
    """

    lower: Vector
    upper: Vector
    covariances: Tensor
    bent: Tensor | None
    parts: tuple[Part, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """One vehicle's place among the outputs.

    Attributes
    ----------
    sign : float
        +1, or −1 for the second vehicle of a pair.
    position : int
        Output number of its position at k = 0, axis 0; steps follow, axes fastest.
    controls : int
        Output number of its control u⁺ at k = 0, axis 0; u⁻ follows after all u⁺.
    control_bounds : (T, m) array
        Largest |ū|.
    sagitta : (d, m) array
        How far the path hangs off its chord at mid-step, per control; 0 where it is straight.
    """

    sign: float
    position: int
    controls: int
    control_bounds: Vector
    sagitta: Matrix


@dataclass(frozen=True, slots=True, eq=False)
class Windows:
    """Faces to stay within at each window, ``normals @ position <= near`` (and ``far``).

    Attributes
    ----------
    normals : (w, f, d) array
        Directions *into* what is avoided.
    near, far : (w, f) array
        Right sides at the window's start and end [m]; −inf marks a face that is not there.
    directions : (w, f) int array
        Equal numbers are equal normals.
    intervals : bool
        Whether window j is [j, j+1] or step j+1 alone.
    """

    normals: Tensor
    near: Vector
    far: Vector
    directions: Indices
    intervals: bool


@dataclass(frozen=True, slots=True, eq=False)
class RowBlock:
    """The rows of one danger; numbers of rows, events and steps count from 0 within the block."""

    entry_rows: Indices
    entry_outputs: Indices
    entry_values: Vector
    offsets: Vector
    deviations: Vector
    events: Indices
    event_steps: Indices
    alternative_sizes: Indices
    avoidance_sizes: Indices
    avoidance_windows: Indices
    settled_risk: float
    num_settled: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class _End:
    """One condition at all windows: which step, right sides, deviations, slacks over the reach.

    ``kind`` tells apart deviations of one step that are not nested: 0 is the position's own, 1
    what feedback held over the following step makes of it. ``is_near`` tells whose share of the
    reserve for the sagitta it keeps. ``least`` and ``most`` are slacks without any reserve [m].
    """

    kind: int
    is_near: bool
    steps: Indices
    offsets: Vector
    deviations: Vector
    least: Vector
    most: Vector


def danger_rows(body: Body, windows: Windows, risk_bound: float) -> RowBlock:
    """Return the rows of one danger, or its settled risk alone.

    A window some face of which holds for every admissible control with a risk of at most
    `SETTLED_RISK` (less where Δ is tiny) is settled: it is charged that risk and needs no choice.
    A face that no admissible control satisfies even without noise is no alternative.

    Parameters
    ----------
    body : Body
        What is kept apart.
    windows : Windows
        From what, when.
    risk_bound : float
        Δ: what counts as settled is small against it.

    Returns
    -------
    RowBlock
        Without rows where every window is settled.
    """
    num_windows = len(windows.near)
    enough = float(clearance_for(min(SETTLED_RISK, SETTLED_SHARE * risk_bound)))
    after = 1 + np.arange(num_windows)
    if not windows.intervals:
        ends = [_end(body, windows.normals, windows.near, after, body.covariances[after])]
        bow, shares = np.zeros(windows.near.shape), [np.full(windows.near.shape, 0.5)]
    else:
        before = np.arange(num_windows)
        here = (body, windows.normals, windows.near, before)
        there = (body, windows.normals, windows.far, after)
        ends = [_end(*here, body.covariances[before])]
        if body.bent is not None:
            ends.append(_end(*here, body.bent[before], kind=1))
        ends.append(_end(*there, body.covariances[after], is_near=False))
        bow = _worst_bow(body, windows)
        near = np.minimum.reduce([_spare(end, enough) for end in ends[:-1]])
        shares = shares_of_reserve(near, _spare(ends[-1], enough), bow)
    worst = [_worst(ends, bow, share) for share in shares]
    best = np.minimum.reduce([_in_deviations(end.most, end.deviations) for end in ends])
    settled_by = worst[0].max(axis=1)
    settled = settled_by >= enough
    safest = worst[0].argmax(axis=1)
    every = np.arange(num_windows)
    risks = sum(tail_probability(_clearance(end, bow, shares[0])[every, safest]) for end in ends)
    settled_risk = float(np.sum(np.asarray(risks)[settled]))
    if np.all(settled):
        return _empty_block(settled_risk, num_windows)
    possible = (best >= 0.0) & ~settled[:, None]
    offered = np.stack([possible & np.isfinite(share) for share in shares], axis=2)
    window, face, option = np.nonzero(offered)
    share = np.stack(shares, axis=2)[window, face, option]
    counts = np.bincount(window, minlength=num_windows)[~settled]
    return _assemble(body, windows, ends, (window, face, share), settled_risk, (~settled, counts))


def _end(
    body: Body,
    normals: Tensor,
    offsets: Vector,
    steps: Indices,
    covariances: Tensor,
    *,
    kind: int = 0,
    is_near: bool = True,
) -> _End:
    """Rate one end of every window over the whole reach."""
    low, high = body.lower[steps][:, None, :], body.upper[steps][:, None, :]
    largest = np.where(normals > 0.0, normals * high, normals * low).sum(axis=2)
    smallest = np.where(normals > 0.0, normals * low, normals * high).sum(axis=2)
    variances = np.einsum("wfa,wab,wfb->wf", normals, covariances, normals)
    deviations = np.sqrt(np.maximum(variances, 0.0))
    return _End(
        kind,
        is_near,
        steps,
        offsets,
        np.where(deviations > 0.0, np.maximum(deviations, _LEAST_DEVIATION), 0.0),
        offsets - largest,
        # Reach is exact only up to rounding: keep what misses by less than a micrometer.
        offsets - smallest + 1e-6,
    )


def _spare(end: _End, enough: float) -> Vector:
    """Return what an end keeps beyond being settled, wherever the body may be [m]."""
    return end.least - enough * end.deviations


def _clearance(end: _End, bow: Vector, share: Vector) -> Vector:
    """Return the least clearance of an end over the reach, its share of the reserve kept."""
    kept = share if end.is_near else 1.0 - share
    reserve = 4.0 * np.square(np.where(np.isfinite(share), kept, 0.5)) * bow
    return _in_deviations(end.least - reserve, end.deviations)


def _worst(ends: list[_End], bow: Vector, share: Vector) -> Vector:
    """Return the least clearance of all ends over the reach."""
    return np.asarray(np.minimum.reduce([_clearance(end, bow, share) for end in ends]))


def _in_deviations(slack: Vector, deviations: Vector) -> Vector:
    """Return slacks in standard deviations, ±inf without noise."""
    noisy = deviations > 0.0
    certain = np.where(slack >= 0.0, np.inf, -np.inf)
    with np.errstate(over="ignore"):
        return np.where(noisy, slack / np.where(noisy, deviations, 1.0), certain)


def _worst_bow(body: Body, windows: Windows) -> Vector:
    """Return the largest sagitta of the mean curve towards each face, (w, f) [m]."""
    bow = np.zeros(windows.near.shape)
    for part in body.parts:
        bounds = np.maximum(part.control_bounds, 0.0)
        bow += np.einsum("wfc,wc->wf", np.abs(windows.normals @ part.sagitta), bounds)
    return bow


def _empty_block(settled_risk: float, num_settled: int) -> RowBlock:
    """Return a block without rows."""
    none, ints = np.zeros(0), np.zeros(0, dtype=np.int64)
    return RowBlock(
        ints, ints, none, none, none, ints, ints, ints, ints, ints, settled_risk, num_settled
    )


def _assemble(
    body: Body,
    windows: Windows,
    ends: list[_End],
    chosen: tuple[Indices, Indices, Vector],
    settled_risk: float,
    kept: tuple[np.ndarray, Indices],
) -> RowBlock:
    """Lay out the rows of the chosen (window, face, share) alternatives, ends fastest."""
    window, face, share = chosen
    num_ends, count = len(ends), len(window)
    normals = windows.normals[window, face]
    entries: list[tuple[Indices, Indices, Vector]] = []
    offsets = np.empty((count, num_ends))
    deviations = np.empty((count, num_ends))
    steps = np.empty((count, num_ends), dtype=np.int64)
    for e, end in enumerate(ends):
        rows = np.arange(count) * num_ends + e
        offsets[:, e] = end.offsets[window, face]
        deviations[:, e] = end.deviations[window, face]
        steps[:, e] = end.steps[window]
        reserve = 4.0 * np.square(share if end.is_near else 1.0 - share)
        for part in body.parts:
            entries.append(_position_entries(part, rows, normals, steps[:, e]))
            if windows.intervals and part.sagitta.any():
                entries.append(_bow_entries(part, rows, normals, window, reserve))
    direction = np.repeat(windows.directions[window, face], num_ends)
    kinds = np.tile([end.kind for end in ends], count)
    keys, events = _numbered(steps.ravel(), 2 * direction + kinds)
    return RowBlock(
        entry_rows=np.concatenate([rows.ravel() for rows, _, _ in entries]),
        entry_outputs=np.concatenate([outputs.ravel() for _, outputs, _ in entries]),
        entry_values=np.concatenate([values.ravel() for _, _, values in entries]),
        offsets=offsets.ravel(),
        deviations=deviations.ravel(),
        events=events,
        event_steps=keys,
        alternative_sizes=np.full(count, num_ends),
        avoidance_sizes=kept[1],
        avoidance_windows=np.flatnonzero(kept[0]),
        settled_risk=settled_risk,
        num_settled=int(np.count_nonzero(~kept[0])),
    )


def _position_entries(
    part: Part, rows: Indices, normals: Vector, steps: Indices
) -> tuple[Indices, Indices, Vector]:
    """Return the entries ``sign · normal`` at the position of each row's step."""
    d = normals.shape[1]
    outputs = part.position + steps[:, None] * d + np.arange(d)
    return np.repeat(rows, d), outputs, part.sign * normals


def _bow_entries(
    part: Part, rows: Indices, normals: Vector, window: Indices, reserve: Vector
) -> tuple[Indices, Indices, Vector]:
    """Return the entries that reserve a multiple of the mean curve's sagitta.

    With S the sagitta per control, the curve leaves its chord by ``−4 s (1 − s) S u``, so it comes
    closer along n only where n·S u < 0, by at most ``max(0, −n·S u) <= Σ |(n·S)ᵢ| (uᵢ⁻ where
    (n·S)ᵢ > 0, else uᵢ⁺)``: linear in the two halves of |u| that the cost needs anyway.
    """
    pull = part.sign * (normals @ part.sagitta)
    m = pull.shape[1]
    span = part.control_bounds.size
    outputs = part.controls + window[:, None] * m + np.arange(m) + np.where(pull > 0.0, span, 0)
    return np.repeat(rows, m), outputs, reserve[:, None] * np.abs(pull)


def _numbered(steps: Indices, directions: Indices) -> tuple[Indices, Indices]:
    """Return the step of each distinct (step, direction) and the number of each row's pair."""
    width = int(directions.max(initial=0)) + 1
    keys, numbers = np.unique(steps * width + directions, return_inverse=True)
    return keys // width, numbers
