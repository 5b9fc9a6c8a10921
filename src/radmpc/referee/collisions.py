"""Which sampled paths collide: at a step, or on the way to the next.

The path between two steps is ``x(t) = p + t (p' − p) − 4 b t (1 − t)`` with t from 0 to 1 and b the
bow of the control that is flown, feedback and all. It is split into chords
whose own bow is below a millimeter, each tested exactly. At a step both ends coincide.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Matrix, Vector
from radmpc.model.scenario import Workspace
from radmpc.referee.contact import origin_distances, solid_distances
from radmpc.referee.reserve import CONTACT_TOL
from radmpc.referee.sweep import SweepPart
from radmpc.referee.turning import TurningSolid, comes_within

__all__ = ["Flags", "leaves_workspace", "meets_origin", "meets_solid"]

Flags = npt.NDArray[np.bool_]

_FINENESS = 1e-3


def meets_origin(begin: Matrix, end: Matrix, bows: Matrix, reaches: Vector) -> Flags:
    """Return which relative paths come closer to the origin than the radii allow, (M,) bool.

    Parameters
    ----------
    begin, end : (M, d) array
        Relative positions at the ends [m].
    bows : (M, d) array
        Bows of the relative mean curves [m].
    reaches : (M,) array
        Sums of radii [m].
    """
    return _curves_hit(begin, end, bows, reaches, origin_distances)


def meets_solid(
    begin: Matrix, end: Matrix, bows: Matrix, reaches: Vector, parts: Sequence[SweepPart]
) -> Flags:
    """Return which paths come closer to a solid than their radius, (M,) bool.

    Parameters
    ----------
    begin, end : (M, d) array
        Positions at the ends [m].
    bows : (M, d) array
        Bows of the mean curves [m].
    reaches : (M,) array
        Radii [m].
    parts : sequence of SweepPart
        The solid at rest, in the frame it moves with, or turning.
    """
    hits = np.zeros(len(begin), dtype=bool)
    for part in parts:
        left = np.flatnonzero(~hits)
        ways = (begin[left], end[left] - part.drift, bows[left], reaches[left])
        if isinstance(part.solid, TurningSolid):
            hits[left] = _curves_hit_turning(*ways, part.solid)
        else:
            hits[left] = _curves_hit(*ways, partial(solid_distances, solid=part.solid))
    return hits


def _curves_hit_turning(
    begin: Matrix, end: Matrix, bows: Matrix, reaches: Vector, solid: TurningSolid
) -> Flags:
    """Return which curves come closer to a turning solid than their reach, chord by chord."""
    sags = np.linalg.norm(bows, axis=1)
    hits = np.zeros(len(begin), dtype=bool)
    # One chord for the whole curve, its bow in reserve, rules most of them out.
    near = np.flatnonzero(comes_within(begin, end, reaches + sags, solid))
    count = max(1, int(np.ceil(np.sqrt(sags[near].max(initial=0.0) / _FINENESS))))
    for here, there in pairwise(np.linspace(0.0, 1.0, count + 1).tolist()):
        left = near[~hits[near]]
        chord = (begin[left], end[left], bows[left])
        hits[left] = comes_within(
            _on_curve(*chord, here),
            _on_curve(*chord, there),
            reaches[left] - CONTACT_TOL,
            solid.during(here, there),
        )
    return hits


def _curves_hit(
    begin: Matrix,
    end: Matrix,
    bows: Matrix,
    reaches: Vector,
    distances: Callable[[Matrix, Matrix], Vector],
) -> Flags:
    """Return which curves come closer than their reach, chord by chord."""
    sag = float(np.linalg.norm(bows, axis=1).max(initial=0.0))
    count = max(1, int(np.ceil(np.sqrt(sag / _FINENESS))))
    times = np.linspace(0.0, 1.0, count + 1)
    hits = np.zeros(len(begin), dtype=bool)
    if count > 1:
        # One chord for the whole curve, its bow in reserve, rules most of them out.
        whole = distances(begin, end)
        near = np.flatnonzero(whole < reaches + np.linalg.norm(bows, axis=1))
        begin, end, bows, reaches = begin[near], end[near], bows[near], reaches[near]
    else:
        near = np.arange(len(begin))
    found = np.zeros(len(near), dtype=bool)
    for here, there in pairwise(times):
        left = np.flatnonzero(~found)
        if not left.size:
            break
        chord = (begin[left], end[left], bows[left])
        gaps = distances(_on_curve(*chord, here), _on_curve(*chord, there))
        found[left] = gaps < reaches[left] - CONTACT_TOL
    hits[near] = found
    return hits


def _on_curve(begin: Matrix, end: Matrix, bows: Matrix, t: float) -> Matrix:
    """Return the points of curves at a share of the interval."""
    return begin + t * (end - begin) - (4.0 * t * (1.0 - t)) * bows


def leaves_workspace(begin: Matrix, end: Matrix, bows: Matrix, workspace: Workspace) -> Flags:
    """Return which paths leave a box, (M,) bool.

    Each axis is a parabola: its extreme is at an end or where its slope vanishes.

    Parameters
    ----------
    begin, end : (M, d) array
        Positions at the ends [m].
    bows : (M, d) array
        Bows of the mean curves [m].
    workspace : Workspace
        The box.
    """
    bend = 4.0 * bows
    t = np.clip((bend - (end - begin)) / np.where(bend == 0.0, 1.0, 2.0 * bend), 0.0, 1.0)
    turn = begin + t * (end - begin) - bend * t * (1.0 - t)
    low = np.minimum(np.minimum(begin, end), turn)
    high = np.maximum(np.maximum(begin, end), turn)
    outside = (low < workspace.lower - CONTACT_TOL) | (high > workspace.upper + CONTACT_TOL)
    return np.asarray(np.any(outside, axis=1))
