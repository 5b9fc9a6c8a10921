"""Chance rows of one danger over all windows: faces, noise, bow, and what reach already settles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from radmpc.arrays import Indices, Tensor, Vector
from radmpc.gaussian import clearance_for, tail_probability
from radmpc.program.program import SETTLED_RISK, SETTLED_SHARE

__all__ = ["Body", "RowBlock", "Windows", "danger_rows"]


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """What is kept apart, one vehicle or the relative motion of two, over the outputs.

    Attributes
    ----------
    lower, upper : (T+1, d) array
        Reach of the (relative) position [m].
    covariances : (T+1, d, d) array
        Covariance of the (relative) position [m²].
    parts : tuple of Part
        One vehicle, or two with signs +1 and −1.
    """

    lower: Vector
    upper: Vector
    covariances: Tensor
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
    bow : float
        ``dt²/8`` for a double integrator, 0 where the path is the straight segment.
    """

    sign: float
    position: int
    controls: int
    control_bounds: Vector
    bow: float


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


@dataclass(frozen=True, slots=True, eq=False)
class _End:
    """One end of all windows: which step, right sides, deviations, worst and best clearance."""

    steps: Indices
    offsets: Vector
    deviations: Vector
    worst: Vector
    best: Vector


def danger_rows(body: Body, windows: Windows, risk_bound: float) -> RowBlock | None:
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
    RowBlock or None
        None where every window is settled at a risk of exactly 0.
    """
    num_windows = len(windows.near)
    first = 0 if windows.intervals else 1
    bow = _worst_bow(body, windows) if windows.intervals else np.zeros(windows.near.shape)
    ends = [_end(body, windows.normals, windows.near, bow, first + np.arange(num_windows))]
    if windows.intervals:
        ends.append(_end(body, windows.normals, windows.far, bow, 1 + np.arange(num_windows)))
    worst = np.minimum.reduce([end.worst for end in ends])
    best = np.minimum.reduce([end.best for end in ends])
    safest = worst.argmax(axis=1)
    enough = float(clearance_for(min(SETTLED_RISK, SETTLED_SHARE * risk_bound)))
    settled = worst.max(axis=1) >= enough
    risks = sum(tail_probability(end.worst[np.arange(num_windows), safest]) for end in ends)
    settled_risk = float(np.sum(np.asarray(risks)[settled]))
    if np.all(settled):
        return None if settled_risk == 0.0 else _empty_block(settled_risk)
    window, face = np.nonzero((best >= 0.0) & ~settled[:, None])
    counts = np.bincount(window, minlength=num_windows)[~settled]
    return _assemble(body, windows, ends, (window, face), settled_risk, (~settled, counts))


def _end(body: Body, normals: Tensor, offsets: Vector, bow: Vector, steps: Indices) -> _End:
    """Rate one end of every window over the whole reach."""
    low, high = body.lower[steps][:, None, :], body.upper[steps][:, None, :]
    largest = np.where(normals > 0.0, normals * high, normals * low).sum(axis=2)
    smallest = np.where(normals > 0.0, normals * low, normals * high).sum(axis=2)
    variances = np.einsum("wfa,wab,wfb->wf", normals, body.covariances[steps], normals)
    deviations = np.sqrt(np.maximum(variances, 0.0))
    return _End(
        steps,
        offsets,
        deviations,
        _in_deviations(offsets - largest - bow, deviations),
        # Reach is exact only up to rounding: keep what misses by less than a micrometer.
        _in_deviations(offsets - smallest + 1e-6, deviations),
    )


def _in_deviations(slack: Vector, deviations: Vector) -> Vector:
    """Return slacks in standard deviations, ±inf without noise."""
    noisy = deviations > 0.0
    certain = np.where(slack >= 0.0, np.inf, -np.inf)
    with np.errstate(over="ignore"):
        return np.where(noisy, slack / np.where(noisy, deviations, 1.0), certain)


def _worst_bow(body: Body, windows: Windows) -> Vector:
    """Return the largest bow of the mean curve towards each face, (w, f) [m]."""
    bow = np.zeros(windows.near.shape)
    for part in body.parts:
        if part.bow > 0.0:
            bounds = np.maximum(part.control_bounds, 0.0)
            bow += part.bow * np.einsum("wfa,wa->wf", np.abs(windows.normals), bounds)
    return bow


def _empty_block(settled_risk: float) -> RowBlock:
    """Return a block without rows."""
    none, ints = np.zeros(0), np.zeros(0, dtype=np.int64)
    return RowBlock(ints, ints, none, none, none, ints, ints, ints, ints, ints, settled_risk)


def _assemble(
    body: Body,
    windows: Windows,
    ends: list[_End],
    chosen: tuple[Indices, Indices],
    settled_risk: float,
    kept: tuple[np.ndarray, Indices],
) -> RowBlock:
    """Lay out the rows of the chosen (window, face) alternatives, ends fastest."""
    window, face = chosen
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
        for part in body.parts:
            entries.append(_position_entries(part, rows, normals, steps[:, e]))
            if windows.intervals and part.bow > 0.0:
                entries.append(_bow_entries(part, rows, normals, window))
    direction = np.repeat(windows.directions[window, face], num_ends)
    keys, events = _numbered(steps.ravel(), direction)
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
    )


def _position_entries(
    part: Part, rows: Indices, normals: Vector, steps: Indices
) -> tuple[Indices, Indices, Vector]:
    """Return the entries ``sign · normal`` at the position of each row's step."""
    d = normals.shape[1]
    outputs = part.position + steps[:, None] * d + np.arange(d)
    return np.repeat(rows, d), outputs, part.sign * normals


def _bow_entries(
    part: Part, rows: Indices, normals: Vector, window: Indices
) -> tuple[Indices, Indices, Vector]:
    """Return the entries that add the mean curve's bow over its chord.

    The curve leaves its chord by ``−a τ(dt−τ)/2``, so it comes closer along n only where n·a < 0,
    by at most ``dt²/8 · max(0, −n·a) <= dt²/8 · Σ |nᵢ| (uᵢ⁻ where nᵢ > 0, else uᵢ⁺)``: linear in
    the two halves of |u| that the cost needs anyway.
    """
    d = normals.shape[1]
    facing = part.sign * normals
    span = part.control_bounds.size
    outputs = part.controls + window[:, None] * d + np.arange(d) + np.where(facing > 0.0, span, 0)
    return np.repeat(rows, d), outputs, part.bow * np.abs(facing)


def _numbered(steps: Indices, directions: Indices) -> tuple[Indices, Indices]:
    """Return the step of each distinct (step, direction) and the number of each row's pair."""
    width = int(directions.max(initial=0)) + 1
    keys, numbers = np.unique(steps * width + directions, return_inverse=True)
    return keys // width, numbers
