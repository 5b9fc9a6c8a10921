"""How two vehicles meet: where they are to each other, and along what they are kept apart."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.planners.certified.turned.normals.directions import (
    around_approach,
    closest_approach,
    refined,
)
from radmpc.planners.certified.turned.normals.encounter import Encounter, ends_of, noise_of
from radmpc.planners.certified.turned.paths import Paths
from radmpc.program.hazards import Hazards

__all__ = ["PairWindows", "end_normals", "pair_encounter", "pair_normals", "start_normals"]

_TINY = 1e-12
"""Stands for a length of 0 where one divides by it [m]."""

_FEW = 256
"""Meetings up to which all directions are refined [-]."""

_CLEAR = 10.0
"""Clearance along the line of closest approach from which on they are not, where more meet
[standard deviations]."""

PairWindows = tuple[Indices, ...]
"""Two vehicles and a window, (w,) each."""


def pair_normals(
    hazards: Hazards,
    both: tuple[Paths, Paths],
    pairing: PairWindows,
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
    pairing : PairWindows
        Who meets whom when.
    distance : (w,) array
        Distance to keep [m].
    is_refined : bool
        Whether the best are asked for.
    """
    first, second, window = pairing
    if not (is_refined and first.size):
        return np.asarray(_approach(hazards, both[0], pairing, distance, many=False)[:, 0])
    tried = _approach(hazards, both[0], pairing, distance, many=True)
    near = _to_refine(hazards, both, pairing, distance, tried[:, 0])
    normals: Matrix = tried[:, 0].copy()
    some = first[near], second[near], window[near]
    each = [pair_encounter(hazards, latest, some, distance[near]) for latest in both]
    normals[near] = refined((each[0], each[1]), tried[near])
    return normals


def _approach(
    hazards: Hazards, paths: Paths, pairing: PairWindows, distance: Vector, *, many: bool
) -> Tensor:
    """Return lines of closest approach, and directions all around if asked for, (w, c, d)."""
    first, second, window = pairing
    start = paths.means[first, window] - paths.means[second, window]
    end = paths.means[first, window + 1] - paths.means[second, window + 1]
    pairs = np.stack([start, end], axis=1)
    closest = closest_approach(pairs)[:, 0] if hazards.intervals else end
    signs = np.where(first < second, 1.0, -1.0)
    return around_approach(closest, end - start, distance, signs, many=many)


def _to_refine(
    hazards: Hazards,
    both: tuple[Paths, Paths],
    pairing: PairWindows,
    distance: Vector,
    normals: Matrix,
) -> npt.NDArray[np.bool_]:
    """Return where more room is worth seeking: everywhere if few meet, else where they are near."""
    if distance.size <= _FEW:
        return np.ones(distance.size, dtype=bool)
    clearances = (
        pair_encounter(hazards, latest, pairing, distance).clearances(normals[:, None])[:, 0]
        for latest in both
    )
    return np.asarray(np.minimum(*clearances) < _CLEAR)


def pair_encounter(
    hazards: Hazards, paths: Paths, pairing: PairWindows, distance: Vector
) -> Encounter:
    """Return where two vehicles are to each other at both ends of windows.

    Parameters
    ----------
    hazards, paths : Hazards and Paths
        The fleet, and its paths.
    pairing, distance
        As in `pair_normals`.
    """
    first, second, window = pairing

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
        hazards.is_isotropic,
    )


def end_normals(
    hazards: Hazards,
    paths: Paths,
    pairing: PairWindows,
    normals: Matrix,
    near: tuple[Vector, float],
) -> tuple[Matrix, npt.NDArray[np.bool_]]:
    """Turn the normals of first and last windows as `start_normals` does, to starts and to goals.

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    paths : Paths
        The latest.
    pairing : tuple of (w,) int array
        Who meets whom, in which of these windows.
    normals : (w, d) array
        Unit normals.
    near : tuple of (w,) array and float
        The distance at which hulls touch [m], and standard deviations to keep [-].

    Returns
    -------
    (w, d) array, (w,) bool array
        As `start_normals` does.
    """
    one, two, window = pairing
    met, models = pair_encounter(hazards, paths, pairing, near[0]), hazards.models
    goals = [np.array([models[i].vehicle.goal.center for i in who.tolist()]) for who in (one, two)]
    given = np.where((window == 0)[:, None], met.ends[0], goals[0] - goals[1])
    return start_normals(met, normals, near[1], given)


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
