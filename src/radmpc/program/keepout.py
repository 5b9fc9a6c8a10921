"""Convex sets to keep out of, as faces at every window: an interval, or a step alone.

With avoidance at the steps window j is step j+1 of the program. With intervals window j is
[j, j+1] and a face must hold at both ends: ``near`` is its offset at j, ``far`` at j+1.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.geometry import Polytope
from radmpc.model.obstacle import Obstacle
from radmpc.model.obstacle_track import TrackSpread
from radmpc.records import dataclass, replace

__all__ = ["KeepOut", "KeepOuts", "obstacle_keepouts", "swept_keepout"]


@dataclass(frozen=True, slots=True, eq=False)
class KeepOut:
    """The faces of one convex set at every window.

    Attributes
    ----------
    name : str
        The obstacle, or the vehicle that a temporal obstacle stands for.
    normals : (w, f, d) array
        Outward unit normals.
    near, far : (w, f) array
        Offsets at the window's start and end [m]; inf fills up windows with fewer faces.
    directions : (w, f) int array
        Equal numbers are equal normals: such faces of neighboring windows are one event.
    start : Polytope or None
        The set at the program's first step; None if that is charged elsewhere.
    shapes : tuple of Polytope
        The set at the program's first to last step, one if it does not move; empty where no
        directions but the faces are asked for.
    spread : TrackSpread or None
        How far the set is from there, from the program's first step on; None is not at all.
    """

    name: str
    normals: Tensor
    near: Matrix
    far: Matrix
    directions: Indices
    start: Polytope | None = None
    shapes: tuple[Polytope, ...] = ()
    spread: TrackSpread | None = None

    def with_directions(self, extra: Matrix, *, intervals: bool) -> KeepOut:
        """Return the same set with more half-spaces that contain it, at every window.

        Parameters
        ----------
        extra : (e, d) array
            Unit normals.
        intervals : bool
            Whether windows are intervals.
        """
        windows = len(self.near)
        supports = np.array([shape.support(extra) for shape in self.shapes])
        if len(supports) == 1:
            supports = np.repeat(supports, windows + 1, axis=0)
        first = int(self.directions.max(initial=-1)) + 1
        numbers = np.tile(first + np.arange(len(extra)), (windows, 1))
        normals = np.broadcast_to(extra, (windows, *extra.shape))
        near = supports[:-1] if intervals else supports[1:]
        return replace(
            self,
            normals=np.concatenate([self.normals, normals], axis=1),
            near=np.concatenate([self.near, near], axis=1),
            far=np.concatenate([self.far, supports[1:]], axis=1),
            directions=np.concatenate([self.directions, numbers], axis=1),
        )


def obstacle_keepouts(
    obstacle: Obstacle, first_step: int, horizon: int, *, intervals: bool
) -> list[KeepOut]:
    """Return one keep-out per convex piece of an obstacle.

    Parameters
    ----------
    obstacle : Obstacle
        Static or moving.
    first_step : int
        Absolute step at which the program starts.
    horizon : int
        Steps of the program.
    intervals : bool
        Whether windows are intervals.

    Returns
    -------
    list of KeepOut
        For a moving obstacle under intervals, the faces of both ends with their supports at
        each end: they separate from every linear interpolation of the two.
    """
    if obstacle.is_moving:
        pieces = [obstacle.at(first_step + k)[0] for k in range(horizon + 1)]
        if intervals:
            found = _moving_keepout(obstacle.name, pieces)
        else:
            found = swept_keepout(obstacle.name, pieces[1:], start=pieces[0])
        spread = None if obstacle.spread is None else obstacle.spread.since(first_step, horizon)
        return [replace(found, shapes=tuple(pieces), spread=spread)]
    return [_standing_keepout(obstacle.name, piece, horizon) for piece in obstacle.at(0)]


class KeepOuts:
    """The keep-outs of a fleet's obstacles from step 0 on, made once for all who meet them."""

    def __init__(self) -> None:
        self._known: dict[tuple[str, int, bool], list[KeepOut]] = {}

    def of(
        self, obstacles: Iterable[Obstacle], horizon: int, *, intervals: bool
    ) -> Iterator[KeepOut]:
        """Return those of some obstacles, one after the other.

        Parameters
        ----------
        obstacles : iterable of Obstacle
            Names tell them apart.
        horizon, intervals
            As in `obstacle_keepouts`.
        """
        for obstacle in obstacles:
            key = obstacle.name, horizon, intervals
            if key not in self._known:
                self._known[key] = obstacle_keepouts(obstacle, 0, horizon, intervals=intervals)
            yield from self._known[key]


def swept_keepout(name: str, pieces: Sequence[Polytope], start: Polytope | None = None) -> KeepOut:
    """Return a keep-out that is one polytope per window.

    Parameters
    ----------
    name : str
        Who or what it stands for.
    pieces : sequence of Polytope
        One per window.
    start : Polytope or None
        The set at the program's first step; None if that is charged elsewhere.
    """
    offsets = [piece.offsets for piece in pieces]
    return _assemble(name, [piece.normals for piece in pieces], offsets, offsets, start)


def _moving_keepout(name: str, pieces: Sequence[Polytope]) -> KeepOut:
    """Return the faces that separate from a shape while it moves from window end to end."""
    normals, near, far = [], [], []
    for before, after in pairwise(pieces):
        both: Matrix = np.unique(np.vstack([before.normals, after.normals]).round(12), axis=0)
        normals.append(both)
        near.append(before.support(both))
        far.append(after.support(both))
    return _assemble(name, normals, near, far, pieces[0])


def _standing_keepout(name: str, piece: Polytope, horizon: int) -> KeepOut:
    """Return the same faces at every window."""
    offsets = piece.offsets[None].repeat(horizon, axis=0)
    return KeepOut(
        name=name,
        normals=piece.normals[None].repeat(horizon, axis=0),
        near=offsets,
        far=offsets,
        directions=np.arange(len(piece.offsets))[None].repeat(horizon, axis=0),
        start=piece,
        shapes=(piece,),
    )


def _assemble(
    name: str,
    normals: list[Tensor],
    near: list[Vector],
    far: list[Vector],
    start: Polytope | None,
) -> KeepOut:
    """Stack windows with different numbers of faces and number the distinct directions."""
    num_faces = max(len(n) for n in normals)
    dimension = normals[0].shape[1]
    stacked = np.zeros((len(normals), num_faces, dimension))
    starts = np.full((len(normals), num_faces), np.inf)
    ends = np.full((len(normals), num_faces), np.inf)
    for w, n in enumerate(normals):
        stacked[w, : len(n)] = n
        starts[w, : len(n)] = near[w]
        ends[w, : len(n)] = far[w]
    flat = np.round(stacked.reshape(-1, dimension), 9)
    _, directions = np.unique(flat, axis=0, return_inverse=True)
    return KeepOut(name, stacked, starts, ends, directions.reshape(len(normals), num_faces), start)
