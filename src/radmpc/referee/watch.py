"""Who has to be watched when: everything whose half-space bound is not negligible.

Each row of a window is a half-space without which nothing happens: only samples that leave it are
looked at with exact geometry. A sparse product finds them for all rows at once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.model.scenario import Scenario
from radmpc.referee.bounds import window_halfspaces
from radmpc.referee.encounters import Encounters
from radmpc.referee.gather import gather_obstacles, gather_pairs
from radmpc.referee.motion import FleetMotion
from radmpc.referee.neighbors import CUTOFF_RISK

__all__ = ["OBSTACLE", "PAIR", "WATCH_RISK", "WORKSPACE", "Watch", "watch_list"]

# Encounters below this risk are not simulated: a million samples would not show them.
WATCH_RISK = 1e-12

PAIR, OBSTACLE, WORKSPACE = 0, 1, 2


@dataclass(frozen=True, slots=True, eq=False)
class Watch:
    """What to watch in one window, a step or an interval, row by row.

    Attributes
    ----------
    kinds : (M,) int array
        `PAIR`, `OBSTACLE` or `WORKSPACE`.
    first : (M,) int array
        The vehicle.
    other : (M,) int array
        The other vehicle, the obstacle, or 0.
    piece : (M,) int array
        The obstacle's convex piece.
    normals : (M, d) array
        Only who deviates along −normal can collide [-].
    margins : (M, E) array
        By more than this, at one end of the window [m].
    reaches : (M,) array
        Radius, or sum of radii [m].
    bows : (M, d) array
        Bow of the (relative) mean curve [m].
    """

    kinds: Indices
    first: Indices
    other: Indices
    piece: Indices
    normals: Matrix
    margins: Matrix
    reaches: Vector
    bows: Matrix


@dataclass(frozen=True, slots=True, eq=False)
class _Rows:
    """Candidates of one kind over all windows: (B, K, ...) arrays, as in `Watch`."""

    kind: int
    first: Indices
    other: Indices
    piece: Indices
    normals: Tensor
    margins: Tensor
    reaches: Vector
    bows: Tensor
    risks: Vector


def watch_list(scenario: Scenario, motion: FleetMotion) -> tuple[tuple[Watch, ...], float]:
    """Return what to watch in each window, and a bound on what is not watched.

    Returns
    -------
    watches : tuple of Watch
        One per window: T+1 steps, or T intervals.
    overlooked : float
        Upper bound on the probability of a collision among all that is left out [-].
    """
    intervals = scenario.avoidance == "intervals"
    num_windows = scenario.horizon + (0 if intervals else 1)
    ends = 2 if intervals else 1
    tables: list[_Rows] = []
    overlooked = 0.0
    for kind, gather in ((PAIR, gather_pairs), (OBSTACLE, gather_obstacles)):
        found = gather(scenario, motion, intervals=intervals)
        overlooked += float(found.skipped.sum()) * num_windows * ends * CUTOFF_RISK
        tables += [_encounter_rows(kind, batch, intervals=intervals) for batch in found.batches]
    if scenario.workspace is not None:
        tables += _workspace_rows(scenario, motion, intervals=intervals)
    overlooked += sum(float(t.risks[t.risks < WATCH_RISK].sum()) for t in tables)
    return tuple(
        _watch(tables, k, scenario.dimension, ends) for k in range(num_windows)
    ), overlooked


def _encounter_rows(kind: int, batch: Encounters, *, intervals: bool) -> _Rows:
    """Return the rows of a batch of encounters."""
    best = window_halfspaces(batch, intervals=intervals)
    return _Rows(
        kind,
        batch.first,
        batch.other,
        batch.piece,
        best.normals,
        best.margins,
        batch.radii,
        batch.bows if intervals else np.zeros(best.normals.shape),
        best.risks,
    )


def _workspace_rows(scenario: Scenario, motion: FleetMotion, *, intervals: bool) -> list[_Rows]:
    """Return a table of rows per face of the workspace."""
    workspace = scenario.workspace
    if workspace is None:
        return []
    count, steps, d = motion.positions.shape
    shape = (count, steps - 1 if intervals else steps, d)
    bows = motion.bows if intervals else np.zeros(shape)
    none = np.zeros(count, dtype=np.int64)
    tables = []
    for axis in range(d):
        deviations = np.sqrt(motion.position_covariances[:, :, axis, axis].clip(min=0.0))
        for sign, face in ((1.0, workspace.lower[axis]), (-1.0, workspace.upper[axis])):
            slack = sign * (motion.positions[:, :, axis] - face)
            noisy = deviations > 0.0
            chance = ndtr(-slack / np.where(noisy, deviations, 1.0))
            risks = np.where(noisy, chance, (slack < 0.0).astype(np.float64))
            margins = slack[:, :, None]
            if intervals:
                sag = np.maximum(sign * bows[:, :, axis], 0.0)
                margins = np.stack([slack[:, :-1] - sag, slack[:, 1:] - sag], axis=2)
                pair = np.stack([deviations[:, :-1], deviations[:, 1:]], axis=2)
                noisy = pair > 0.0
                chance = ndtr(-margins / np.where(noisy, pair, 1.0))
                risks = np.where(noisy, chance, (margins < 0.0).astype(np.float64)).sum(axis=2)
            normals = np.zeros(shape)
            normals[:, :, axis] = sign
            reaches = np.zeros(count)
            tables.append(
                _Rows(
                    WORKSPACE, np.arange(count), none, none, normals, margins, reaches, bows, risks
                )
            )
    return tables


def _watch(tables: Sequence[_Rows], window: int, dimension: int, ends: int) -> Watch:
    """Collect the rows of one window."""
    chosen = [(t, np.flatnonzero(t.risks[:, window] >= WATCH_RISK)) for t in tables]
    ints, empty = np.zeros(0, dtype=np.int64), np.zeros((0, dimension))
    return Watch(
        kinds=np.concatenate([ints, *(np.full(rows.size, t.kind) for t, rows in chosen)]),
        first=np.concatenate([ints, *(t.first[rows] for t, rows in chosen)]),
        other=np.concatenate([ints, *(t.other[rows] for t, rows in chosen)]),
        piece=np.concatenate([ints, *(t.piece[rows] for t, rows in chosen)]),
        normals=np.concatenate([empty, *(t.normals[rows, window] for t, rows in chosen)]),
        margins=np.concatenate(
            [np.zeros((0, ends)), *(t.margins[rows, window] for t, rows in chosen)]
        ),
        reaches=np.concatenate([np.zeros(0), *(t.reaches[rows] for t, rows in chosen)]),
        bows=np.concatenate([empty, *(t.bows[rows, window] for t, rows in chosen)]),
    )
