"""Which sampled trajectories collide in one window: at a step, or on the way to the next.

Positions are arrays (vehicle, axis, sample). The path between two steps is the mean curve plus the
linear interpolation of the deviation: ``x(t) = p + t (p' − p) − 4 b t (1 − t)`` with t from 0 to
1 and b the bow. A cheap test of the chord alone, with ``|b|`` in reserve, passes on the few samples
that come close; those are split into chords whose own bow is below a millimeter, each tested
exactly.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.model.scenario import Workspace
from radmpc.referee.contact import origin_distances, solid_distances
from radmpc.referee.halfspace import CONTACT_TOL
from radmpc.referee.sweep import SweepPart
from radmpc.referee.watch import PairWatch, SolidWatch

__all__ = ["hits_between_pairs", "hits_of_solid", "workspace_exits"]

Flags = npt.NDArray[np.bool_]

_FINENESS = 1e-3


def hits_between_pairs(watch: PairWatch, before: Tensor, after: Tensor | None) -> Flags:
    """Return which samples have two vehicles closer than their radii, (S,) bool.

    Parameters
    ----------
    watch : PairWatch
        Who may meet.
    before, after : (N, d, S) array
        Positions at the window's start and end; no end at a step [m].
    """
    begin = before[watch.first] - before[watch.second]
    reaches = watch.reaches - CONTACT_TOL
    if after is None:
        return np.asarray(np.any(_squared(begin) < np.square(reaches)[:, None], axis=0))
    along = after[watch.first] - after[watch.second] - begin
    length2 = _squared(along)
    t = -(begin * along).sum(axis=1) / np.where(length2 > 0.0, length2, 1.0)
    foot = begin + np.clip(t, 0.0, 1.0)[:, None, :] * along
    sag = np.linalg.norm(watch.bows, axis=1)
    close = _squared(foot) < np.square(reaches + sag)[:, None]
    pair, sample = np.nonzero(close)
    start = begin[pair, :, sample]
    found = _curves_hit(
        start, start + along[pair, :, sample], watch.bows[pair], reaches[pair], origin_distances
    )
    return _flagged(sample[found], before.shape[2])


def hits_of_solid(watch: SolidWatch, before: Tensor, after: Tensor | None) -> Flags:
    """Return which samples have a vehicle closer to a piece than its radius, (S,) bool.

    Parameters
    ----------
    watch : SolidWatch
        Who may touch what.
    before, after : (N, d, S) array
        Positions at the window's start and end; no end at a step [m].
    """
    begin = before[watch.vehicles]
    end = begin if after is None else after[watch.vehicles]
    hits = np.zeros(before.shape[2], dtype=bool)
    for part in watch.parts:
        hits |= _hits_of_part(watch, part, begin, end)
    return hits


def _hits_of_part(watch: SolidWatch, part: SweepPart, begin: Tensor, end: Tensor) -> Flags:
    """Return which samples hit a solid at rest, seen from the frame it rests in."""
    along = end - begin
    if part.drift.any():
        along = along - part.drift[:, None]
    reaches = watch.reaches - CONTACT_TOL
    # Half-spaces of the faces: the whole curve stays on the outer side of one of them.
    reserve = (reaches + np.linalg.norm(watch.bows, axis=1))[:, None]
    at_rest = begin is end and not part.drift.any()
    outside = np.full(begin[:, 0].shape, -np.inf)
    for normal, offset in zip(part.solid.normals, part.solid.offsets, strict=True):
        height = np.einsum("d,mds->ms", normal, begin) - offset
        if not at_rest:
            slope = np.einsum("d,mds->ms", normal, along)
            height += np.minimum(part.begin * slope, part.end * slope)
        np.maximum(outside, height, out=outside)
    vehicle, sample = np.nonzero(outside < reserve)
    start, step = begin[vehicle, :, sample], along[vehicle, :, sample]
    found = _curves_hit(
        start,
        start + step,
        watch.bows[vehicle],
        reaches[vehicle],
        lambda a, b: solid_distances(a, b, part.solid),
        (part.begin, part.end),
    )
    return _flagged(sample[found], begin.shape[2])


def _curves_hit(
    begin: Matrix,
    end: Matrix,
    bows: Matrix,
    reaches: Vector,
    distances: Callable[[Matrix, Matrix], Vector],
    share: tuple[float, float] = (0.0, 1.0),
) -> Flags:
    """Return which of M curves come closer than their reach, chord by chord."""
    first, last = share
    sag = float(np.linalg.norm(bows, axis=1).max(initial=0.0))
    count = max(1, int(np.ceil((last - first) * np.sqrt(sag / _FINENESS))))
    times = np.linspace(first, last, count + 1)
    hits = np.zeros(len(begin), dtype=bool)
    place = _on_curve(begin, end, bows, times[0])
    for t in times[1:]:
        following = _on_curve(begin, end, bows, t)
        open_ones = np.flatnonzero(~hits)
        gaps = distances(place[open_ones], following[open_ones])
        hits[open_ones] = gaps < reaches[open_ones]
        place = following
    return hits


def _on_curve(begin: Matrix, end: Matrix, bows: Matrix, t: float) -> Matrix:
    """Return the points of curves at a share of the interval."""
    return begin + t * (end - begin) - (4.0 * t * (1.0 - t)) * bows


def workspace_exits(
    workspace: Workspace, vehicles: Indices, bows: Matrix, before: Tensor, after: Tensor | None
) -> Flags:
    """Return which samples have a center outside the workspace, (S,) bool.

    Parameters
    ----------
    workspace : Workspace
        The box.
    vehicles : (M,) int array
        Who may leave it.
    bows : (M, d) array
        Bows of their mean curves [m].
    before, after : (N, d, S) array
        Positions at the window's start and end; no end at a step [m].
    """
    begin = before[vehicles]
    low = high = begin
    if after is not None:
        end = after[vehicles]
        # Each axis is a parabola: its extreme is at an end or where its slope vanishes.
        bend = np.broadcast_to(4.0 * bows[:, :, None], begin.shape)
        t = np.clip((bend - (end - begin)) / np.where(bend == 0.0, 1.0, 2.0 * bend), 0.0, 1.0)
        turn = begin + t * (end - begin) - bend * t * (1.0 - t)
        low = np.minimum(np.minimum(begin, end), turn)
        high = np.maximum(np.maximum(begin, end), turn)
    below = low < workspace.lower[:, None] - CONTACT_TOL
    above = high > workspace.upper[:, None] + CONTACT_TOL
    return np.asarray(np.any(below | above, axis=(0, 1)))


def _squared(vectors: Tensor) -> Tensor:
    """Return squared lengths over the axis in the middle."""
    return np.asarray(np.einsum("pds,pds->ps", vectors, vectors))


def _flagged(samples: Indices, count: int) -> Flags:
    """Return a mask with the given samples set."""
    flags = np.zeros(count, dtype=bool)
    flags[samples] = True
    return flags
