"""How two vehicles meet: where they are to each other, and along what they are kept apart."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.planners.certified.turned.directions import around_approach, closest_approach, refined
from radmpc.planners.certified.turned.encounter import Encounter, ends_of, noise_of
from radmpc.planners.certified.turned.paths import Paths
from radmpc.program.hazards import Hazards

__all__ = ["Meeting", "goal_normals", "meeting_encounter", "meeting_normals", "start_normals"]

_TINY = 1e-12
"""Stands for a length of 0 where one divides by it [m]."""

Meeting = tuple[Indices, ...]
"""Two vehicles and a window, (w,) each."""


def meeting_normals(
    hazards: Hazards,
    both: tuple[Paths, Paths],
    meeting: Meeting,
    distance: Vector,
    *,
    is_refined: bool,
) -> Matrix:
    """Return the lines of closest approach, or the best directions by clearance, (w, d).

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    both : tuple of Paths
        The latest, and where they are expected to move.
    meeting : Meeting
        Who meets whom when.
    distance : (w,) array
        Distance to keep [m].
    is_refined : bool
        Whether the best are asked for.
    """
    paths, ahead = both
    first, second, window = meeting
    relative = paths.means[first, window] - paths.means[second, window]
    end = paths.means[first, window + 1] - paths.means[second, window + 1]
    pairs = np.stack([relative, end], axis=1)
    closest = closest_approach(pairs)[:, 0] if hazards.intervals else end
    signs = np.where(first < second, 1.0, -1.0)
    tried = around_approach(closest, end - relative, distance, signs, many=is_refined)
    if not (is_refined and first.size):
        return np.asarray(tried[:, 0])
    each = tuple(meeting_encounter(hazards, latest, meeting, distance) for latest in (paths, ahead))
    return refined((each[0], each[1]), tried)


def meeting_encounter(
    hazards: Hazards, paths: Paths, meeting: Meeting, distance: Vector
) -> Encounter:
    """Return where two vehicles are to each other at both ends of windows.

    Parameters
    ----------
    hazards, paths : Hazards and Paths
        The fleet, and its paths.
    meeting, distance
        As in `meeting_normals`.
    """
    first, second, window = meeting

    def supports(directions: Tensor) -> tuple[Vector, Vector]:
        reach = np.broadcast_to(distance[:, None], directions.shape[:2])
        return reach, reach

    start = paths.means[first, window] - paths.means[second, window]
    end = paths.means[first, window + 1] - paths.means[second, window + 1]
    return Encounter(
        ends_of(hazards, start, end),
        noise_of(hazards, window, first, second),
        paths.sagittas[first, window] - paths.sagittas[second, window],
        supports,
    )


def goal_normals(
    hazards: Hazards, encounter: Encounter, meeting: Meeting, normals: Matrix, clearance: float
) -> Matrix:
    """Turn normals of the last window no farther from where goals are than keeps clear there.

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    encounter : Encounter
        Windows of two ends.
    meeting : tuple of (w,) int array
        Who meets whom, in which windows.
    normals : (w, d) array
        Unit normals.
    clearance : float
        Standard deviations to keep [-].

    Returns
    -------
    (w, d) array
        As given, but where a direction cuts through what goals leave of the last window.
    """
    one, two, window = meeting
    last = window == hazards.horizon - 1
    if not last.any():
        return normals
    goals = np.array([model.vehicle.goal.center for model in hazards.models])
    turned, _ = start_normals(encounter, normals, clearance, goals[one] - goals[two])
    return np.where(last[:, None], turned, normals)


def start_normals(
    encounter: Encounter, normals: Matrix, clearance: float, start: Matrix | None = None
) -> tuple[Matrix, npt.NDArray[np.bool_]]:
    """Turn normals no farther from where two start than keeps a clearance there.

    Parameters
    ----------
    encounter : Encounter
        Windows of two ends, the first given.
    normals : (w, d) array
        Unit normals.
    clearance : float
        Standard deviations to keep [-].
    start : (w, d) array or None
        Where one is from the other [m]; None is at the first end.

    Returns
    -------
    (w, d) array
        Unit normals along which both ends may rest where the first one is: the nearest to those
        given. The line between the two where they start too near each other for any.
    (w,) bool array
        Where there are such.
    """
    start = encounter.ends[0] if start is None else start
    length = np.maximum(np.linalg.norm(start, axis=1), _TINY)
    straight = start / length[:, None]
    tried = straight[:, None]
    spread = np.maximum.reduce(encounter.deviations(tried))[:, 0]
    least = (encounter.supports(tried)[0][:, 0] + clearance * spread) / length
    along = np.einsum("wd,wd->w", normals, straight)
    across = normals - along[:, None] * straight
    width = np.linalg.norm(across, axis=1)
    is_kept = least < 1.0
    sine = np.sqrt(1.0 - np.square(np.minimum(least, 1.0)))
    turned = least[:, None] * straight + (sine / np.maximum(width, _TINY))[:, None] * across
    turned[~is_kept | (width <= _TINY)] = straight[~is_kept | (width <= _TINY)]
    return np.where((along >= least)[:, None], normals, turned), is_kept
