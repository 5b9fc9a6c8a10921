"""At which pace vehicles go along given ways, one after the other, each clear of those before it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from radmpc.arrays import Matrix
from radmpc.planners.certified.turned.clear import Clear
from radmpc.planners.certified.turned.detours import detours, ways_beside
from radmpc.planners.certified.turned.grid import Grid
from radmpc.planners.certified.turned.track import Closeness, Track, track
from radmpc.program.hazards import Hazards

__all__ = ["Pacing", "clear_of", "pulled_ways", "shortest_ways"]

_TRIES = 16
"""Orders that are tried at most [-]."""

_POINTS = 160
"""Points of the grid along its longest axis [-]."""

_COARSE = 1.5
"""Spacing of the grid up to which ways on it tell corners apart [radii of the smallest]."""

_FREE = 6.0
"""Standard deviations from an obstacle that are worth a corner [-]."""

_BESIDE = 2.8
"""How far ways are sought beside those on a coarser grid [radii of the largest]."""

_LITTLE = 1e-6
"""Distance below which points of a way are the same [m]."""


class Pacing:
    """A fleet that is placed on ways, one vehicle after the other.

    Parameters
    ----------
    hazards : Hazards
        The fleet: double integrators in the plane.
    clear : Clear
        How far places are from obstacles.
    clearance : float
        Standard deviations to keep from everything [-].
    """

    def __init__(self, hazards: Hazards, clear: Clear, clearance: float) -> None:
        self._hazards, self._clear, self._clearance = hazards, clear, clearance
        self._tracks: dict[int, list[tuple[Track, float]]] = {}
        self._placed: dict[int, Matrix] = {}
        self._known: dict[tuple[int, int], tuple[Matrix, Closeness]] = {}

    def offer(self, vehicle: int, way: Matrix) -> None:
        """Let a vehicle take a way, too, if there is any pace for it.

        Parameters
        ----------
        vehicle : int
            Its number.
        way : (p, 2) array
            Corners of the way from its start to its goal [m].
        """
        laid_out = track(self._hazards, vehicle, way, self._clear, self._clearance)
        alone = None if laid_out is None else laid_out.paced(self._hazards.horizon, ())
        if laid_out is not None and alone is not None:
            self._tracks.setdefault(vehicle, []).append((laid_out, alone[1]))
            self._tracks[vehicle].sort(key=lambda one: one[1])

    def run(self, order: Sequence[int], is_stopped: Callable[[], bool]) -> Mapping[int, Matrix]:
        """Return where vehicles are at each step, each on the best of its ways.

        Parameters
        ----------
        order : sequence of int
            Who is placed first; who finds no pace is put first, and all begin again.
        is_stopped : callable
            Returns True once it is time to stop.

        Returns
        -------
        mapping of int to (T+1, 2) array
            Positions [m]; empty where no order of those tried leads to any.
        """
        tried: set[tuple[int, ...]] = set()
        following = tuple(order)
        while len(tried) < _TRIES and following not in tried and len(self._tracks) == len(order):
            tried.add(following)
            self._placed = {}
            for i in following:
                if is_stopped():
                    return {}
                if not self._place(i):
                    following = (i, *(j for j in following if j != i))
                    break
            else:
                return self._placed
        return {}

    def _place(self, vehicle: int) -> bool:
        """Place a vehicle at the best pace on any of its ways; tell whether there is one."""
        best: tuple[Matrix, float] | None = None
        for each, alone in self._tracks[vehicle]:
            if best is not None and alone >= best[1]:
                # Others only make it dearer; the ways come in the order of what they cost alone.
                break
            others = [self._closeness(each, j) for j in self._placed]
            found = each.paced(self._hazards.horizon, others)
            if found is not None and (best is None or found[1] < best[1]):
                best = found
        if best is not None:
            self._placed[vehicle] = best[0]
        return best is not None

    def _closeness(self, each: Track, other: int) -> Closeness:
        """Return what being near a placed vehicle costs; kept while that one stays on its path."""
        path, key = self._placed[other], (id(each), other)
        known = self._known.get(key)
        if known is None or not np.array_equal(known[0], path):
            known = path, each.closeness(self._hazards, other, path, self._clearance)
            self._known[key] = known
        return known[1]


def clear_of(hazards: Hazards) -> Clear | None:
    """Return how far places are from obstacles; None where a grid would be too coarse for it."""
    are_double = all(m.vehicle.system.is_double_integrator for m in hazards.models)
    if hazards.dimension != 2 or not are_double:
        return None
    grid = Grid.of(hazards, _POINTS)
    if grid.spacing > _COARSE * float(hazards.radii.min()):
        return None
    return Clear.of(hazards, grid)


def shortest_ways(hazards: Hazards, clear: Clear, clearance: float) -> Mapping[int, Matrix]:
    """Return the corners of each vehicle's shortest way around obstacles.

    Parameters
    ----------
    hazards, clear, clearance
        As in `Pacing`.
    """
    found = detours(hazards, range(hazards.count), clearance, clear.grid)
    return {i: _distinct(clear.pulled(way, _room(hazards, i))) for i, way in found.items()}


def pulled_ways(
    hazards: Hazards, clear: Clear, paths: Mapping[int, Matrix], clearance: float
) -> Mapping[int, Sequence[Matrix]]:
    """Return the corners of the ways that paths take between places of rest, and of ways beside.

    Parameters
    ----------
    hazards, clear, clearance
        As in `Pacing`.
    paths : mapping of int to (K+1, 2) array
        Positions, tick by tick [m].
    """
    parts = {i: _parts(path) for i, path in paths.items()}
    far = _BESIDE * float(hazards.radii.max())
    beside = ways_beside(hazards, clear.grid, parts, clearance, far)
    found = {}
    for i in paths:
        goal = hazards.models[i].vehicle.goal
        ends = hazards.models[i].drift_position[:1], 0.5 * (goal.lower + goal.upper)
        found[i] = [
            _distinct(np.vstack([ends[0], *(clear.pulled(p, _room(hazards, i)) for p in way), ends[1]]))
            for way in (parts[i], beside[i])
        ]
    return found


def _parts(path: Matrix) -> list[Matrix]:
    """Return the pieces of a path between places of rest.

    Whoever waits does so for a reason: pulled straight across, a way would lead through others.
    """
    is_rest = np.append(False, ~np.diff(path, axis=0).any(axis=1))
    moving = path[~is_rest]
    waits = np.cumsum(~is_rest)[is_rest] - 1
    marks = np.unique(np.concatenate([[0], waits, [len(moving) - 1]]))
    return [moving[a : b + 1] for a, b in zip(marks[:-1], marks[1:], strict=True)]


def _room(hazards: Hazards, i: int) -> float:
    """Return the distance from obstacles that is worth a corner [m]."""
    spread = float(np.sqrt(hazards.variances[i].max() / hazards.dimension))
    return float(hazards.radii[i]) + _FREE * spread


def _distinct(way: Matrix) -> Matrix:
    """Return a way without points that repeat the one before."""
    moved = np.linalg.norm(np.diff(way, axis=0), axis=1) > _LITTLE
    if not moved.any():
        return np.asarray(np.vstack([way[:1], way[:1] + [[_LITTLE, 0.0]]]))
    return np.asarray(way[np.append(True, moved)])
