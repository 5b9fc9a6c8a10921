"""Who has to be watched when: everything whose half-space bound is not negligible.

Each row of a window is a half-space without which nothing happens: only samples that leave it are
looked at with exact geometry. A sparse product finds them for all rows at once.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.model.relations.keep import keep_pairs
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass, replace
from radmpc.referee.bound.bounds import window_halfspaces
from radmpc.referee.bound.halfspace import end_margins, end_risks
from radmpc.referee.bound.persistence import best_shares
from radmpc.referee.bound.workspace import faces_of
from radmpc.referee.encounters import Encounters, instant_sites, interval_sites
from radmpc.referee.gather import gather_obstacles, gather_pairs
from radmpc.referee.motion import FleetMotion
from radmpc.referee.tails import cutoff_of

__all__ = [
    "OBSTACLE",
    "PAIR",
    "RANGE",
    "WATCH_RISK",
    "WORKSPACE",
    "Watch",
    "WatchList",
    "watch_list",
]

Flags = npt.NDArray[np.bool_]

WATCH_RISK = 1e-12
"""Risk below which encounters are not simulated [-]: a million samples would not show them."""

PAIR, OBSTACLE, WORKSPACE, RANGE = 0, 1, 2, 3


@dataclass(frozen=True, slots=True, eq=False)
class Watch:
    """What to watch in one window, a step or an interval, row by row.

    Attributes
    ----------
    kinds : (M,) int array
        `PAIR`, `OBSTACLE`, `WORKSPACE` or `RANGE`.
    first : (M,) int array
        The vehicle.
    other : (M,) int array
        The other vehicle, the obstacle, or 0.
    piece : (M,) int array
        The obstacle's convex piece.
    normals : (M, d) array
        Only who deviates along −normal can collide [-].
    margins : (M, E) array
        By more than this, at one end of the window: near, bent near (if feedback bends any path),
        far [m].
    reaches : (M,) array
        Radius, sum of radii, or range [m].
    sagittas : (M, d) array
        Sagitta of the (relative) mean curve [m].
    """

    kinds: Indices
    first: Indices
    other: Indices
    piece: Indices
    normals: Matrix
    margins: Matrix
    reaches: Vector
    sagittas: Matrix

    @property
    def are_pairs(self) -> Flags:
        """Whether each row is about the position of one vehicle relative to another, (M,) bool."""
        return np.isin(self.kinds, (PAIR, RANGE))


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
    sagittas: Tensor
    risks: Vector


@dataclass(frozen=True, slots=True, eq=False)
class WatchList:
    """What to watch in each window: T+1 steps, or T intervals.

    Attributes
    ----------
    usual : tuple of Watch
        What may happen while controls stay within their limits.
    wide : tuple of Watch
        All other encounters of vehicles whose controls may saturate: those drift off further than
        any covariance says.
    overlooked : float
        Upper bound on the probability of a collision among all that is in neither [-].
    """

    usual: tuple[Watch, ...]
    wide: tuple[Watch, ...]
    overlooked: float


def watch_list(scenario: Scenario, motion: FleetMotion, may_saturate: Flags) -> WatchList:
    """Return what to watch in each window.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    motion : FleetMotion
        Its motion.
    may_saturate : (N,) bool array
        Whose controls may reach their limits.
    """
    intervals = scenario.avoidance == "intervals"
    num_windows = scenario.horizon + (0 if intervals else 1)
    ends = (3 if motion.is_bent else 2) if intervals else 1
    tables: list[_Rows] = []
    overlooked = 0.0
    for kind, gather in ((PAIR, gather_pairs), (OBSTACLE, gather_obstacles)):
        found = gather(scenario, motion, intervals=intervals, always=may_saturate)
        overlooked += float(found.skipped.sum()) * num_windows * ends * cutoff_of(motion.samples)[1]
        tables += [_encounter_rows(kind, batch, intervals=intervals) for batch in found.batches]
    if scenario.workspace is not None:
        faces = faces_of(scenario.workspace, motion)
        tables += [_face_rows(WORKSPACE, *face, intervals=intervals) for face in faces]
    if scenario.keep:
        from radmpc.referee.bound.ranges import range_faces  # noqa: PLC0415 - few keep a range

        faces = range_faces(scenario, motion)[-1]
        names = [vehicle.name for vehicle in scenario.vehicles]
        reaches = np.array([within for _, _, within in keep_pairs(scenario.keep, names)])
        for face in faces:
            rows = _face_rows(RANGE, *face, intervals=intervals)
            tables.append(replace(rows, reaches=reaches))
    overlooked += sum(float(t.risks[t.risks < WATCH_RISK].sum()) for t in tables)
    usual = [[np.flatnonzero(r >= WATCH_RISK) for r in t.risks.T] for t in tables]
    wide = []
    for table in tables:
        loose = may_saturate[table.first]
        if table.kind in {PAIR, RANGE}:
            loose = loose | may_saturate[table.other]
        wide.append([np.flatnonzero(loose & (r < WATCH_RISK)) for r in table.risks.T])
    shape = (ends, scenario.dimension)
    return WatchList(
        tuple(_watch(tables, [rows[k] for rows in usual], k, shape) for k in range(num_windows)),
        tuple(_watch(tables, [rows[k] for rows in wide], k, shape) for k in range(num_windows)),
        overlooked,
    )


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
        batch.sagittas if intervals else np.zeros(best.normals.shape),
        best.risks,
    )


def _face_rows(kind: int, normal: Matrix, batch: Encounters, *, intervals: bool) -> _Rows:
    """Return the rows of a face of the workspace, or of a polytope within a range."""
    sites = interval_sites(batch) if intervals else instant_sites(batch)
    count = len(batch.means)
    flat = np.broadcast_to(normal, (len(sites.means), normal.size))
    shares = best_shares(sites, flat)[:, None]
    margins = end_margins(sites, flat[:, None], shares)
    risks = end_risks(sites, flat[:, None], shares).sum(axis=2)
    normals = flat.reshape(count, -1, normal.size)
    return _Rows(
        kind,
        batch.first,
        batch.other,
        batch.piece,
        normals,
        margins.reshape(*normals.shape[:2], -1),
        batch.radii,
        batch.sagittas if intervals else np.zeros(normals.shape),
        risks.reshape(normals.shape[:2]),
    )


def _watch(
    tables: Sequence[_Rows], rows_of: Sequence[Indices], window: int, shape: tuple[int, int]
) -> Watch:
    """Collect chosen rows of one window."""
    ends, dimension = shape
    chosen = list(zip(tables, rows_of, strict=True))
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
        sagittas=np.concatenate([empty, *(t.sagittas[rows, window] for t, rows in chosen)]),
    )
