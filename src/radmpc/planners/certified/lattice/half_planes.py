"""The avoidances of a vehicle, window by window, as half-planes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.program.program import DisjunctiveProgram
from radmpc.records import dataclass

__all__ = ["AvoidanceHalfPlanes", "gap_middles", "half_planes_of", "limits_at"]


@dataclass(frozen=True, slots=True, eq=False)
class AvoidanceHalfPlanes:
    """One avoidance over a window: half-planes at its start and at its end, per alternative.

    Attributes
    ----------
    here, ahead : (s, 3) array
        Normal [-] and offset [m] per alternative; 0 and inf where nothing is asked.
    deviation : float
        The largest standard deviation of its rows [m].
    """

    here: Matrix
    ahead: Matrix
    deviation: float

    @property
    def key(self) -> tuple[bytes, bytes]:
        """Equal for two windows of an avoidance of something that does not move."""
        return self.here.tobytes(), self.ahead.tobytes()


def half_planes_of(
    program: DisjunctiveProgram, horizon: int, own: slice
) -> list[list[AvoidanceHalfPlanes]]:
    """Return the avoidances of each window; where others are placed is part of the offsets.

    Parameters
    ----------
    program : DisjunctiveProgram
        Of one vehicle in the plane, others in place.
    horizon : int
        Windows, T.
    own : slice
        The outputs that are the vehicle's positions, step by step.

    Returns
    -------
    list of list of AvoidanceHalfPlanes
        Those of each window.
    """
    rows = program.rows
    others = program.constant[: program.num_positions].copy()
    others[own] = 0.0
    offsets = rows.offsets - rows.normals[:, : program.num_positions] @ others
    places = rows.normals[:, own].tocoo()
    normals = np.zeros((rows.count, 2))
    normals[places.row, places.col % 2] = places.data
    steps = np.full(rows.count, -1)
    steps[places.row] = places.col // 2
    is_interval = bool(np.any(np.diff(program.alternative_starts) >= 2))
    found: list[list[AvoidanceHalfPlanes]] = [[] for _ in range(horizon)]
    known: dict[tuple[bytes, bytes], tuple[Matrix, Matrix]] = {}
    for index, label in enumerate(program.avoidances):
        k = label.step - (0 if is_interval else 1)
        alternatives = program.alternatives_of(index)
        here, ahead = (np.tile([0.0, 0.0, np.inf], (len(alternatives), 1)) for _ in range(2))
        deviation = 1e-9
        for number, alternative in enumerate(alternatives):
            for row in program.rows_of(alternative):
                plane = here if steps[row] == k else ahead
                plane[number] = [*normals[row], offsets[row]]
                deviation = max(deviation, float(rows.deviations[row]))
        # What stands still is held once, not once a window.
        here, ahead = known.setdefault((here.tobytes(), ahead.tobytes()), (here, ahead))
        found[k].append(AvoidanceHalfPlanes(here, ahead, deviation))
    return found


def gap_middles(
    avoidances: Sequence[Sequence[AvoidanceHalfPlanes]], axis: int, widest: float
) -> list[float]:
    """Return the middles of gaps between parallel half-planes along an axis.

    Parameters
    ----------
    avoidances : sequence of sequence of AvoidanceHalfPlanes
        Those of each window.
    axis : int
        0 or 1.
    widest : float
        The widest gap that counts [m].

    Returns
    -------
    list of float
        Coordinates [m], that of the narrowest gap last.
    """
    lower, upper = set[float](), set[float]()
    for avoidance in {avoidance.key: avoidance for at in avoidances for avoidance in at}.values():
        for plane in (*avoidance.here, *avoidance.ahead):
            limit = _limit(plane, axis)
            if limit is not None:
                (upper if plane[axis] > 0.0 else lower).add(round(limit, 6))
    pairs = [(high - low, 0.5 * (high + low)) for low in lower for high in upper]
    return [middle for width, middle in sorted(pairs, reverse=True) if 0.0 < width <= widest]


def limits_at(avoidances: Sequence[Sequence[AvoidanceHalfPlanes]]) -> tuple[Matrix, Matrix]:
    """Return the box that avoidances of one alternative, as of borders, leave at each step.

    Returns
    -------
    pair of (T+1, 2) array
        Corners [m], infinite where there is no border.
    """
    lower = np.full((len(avoidances) + 1, 2), -np.inf)
    upper = np.full((len(avoidances) + 1, 2), np.inf)
    for k, at in enumerate(avoidances):
        for avoidance in at:
            if len(avoidance.here) != 1:
                continue
            for step, plane in ((k, avoidance.here[0]), (k + 1, avoidance.ahead[0])):
                for axis in (0, 1):
                    limit = _limit(plane, axis)
                    if limit is not None and plane[axis] > 0.0:
                        upper[step, axis] = min(upper[step, axis], limit)
                    elif limit is not None:
                        lower[step, axis] = max(lower[step, axis], limit)
    return lower, upper


def _limit(plane: Vector, axis: int) -> float | None:
    """Return where a half-plane ends along an axis, if it is parallel to the other."""
    if abs(plane[axis]) < 1e-9 or abs(plane[1 - axis]) > 1e-9 or not np.isfinite(plane[2]):
        return None
    return float(plane[2] / plane[axis])
