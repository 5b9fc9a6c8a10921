"""From a scenario and its motion to batches of encounters."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Literal

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Tensor
from radmpc.geometry import Polytope
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass
from radmpc.referee.common import relative
from radmpc.referee.encounters import Encounters
from radmpc.referee.motion import FleetMotion
from radmpc.referee.neighbors import (
    Balls,
    far_from_boxes,
    motion_balls,
    near_pairs,
)
from radmpc.referee.padding import padded_edges, padded_normals, padded_vertices
from radmpc.referee.pieces import boxes_of, concerned, in_windows, pieces_of
from radmpc.referee.tails import cutoff_of

__all__ = [
    "Gathered",
    "NearPiece",
    "gather_obstacles",
    "gather_pairs",
    "near_pieces",
    "relative_motion",
]

Flags = npt.NDArray[np.bool_]

_EXPLICIT = 2_000
"""Encounters up to which all are looked at one by one; beyond, an index skips the far ones."""


@dataclass(frozen=True, slots=True, eq=False)
class Gathered:
    """What to look at, and how often each vehicle was found far from something.

    Attributes
    ----------
    batches : tuple of Encounters
        To be rated.
    skipped : (N,) int array
        Encounters that are charged the cut-off in every window, charged with the first vehicle.
    """

    batches: tuple[Encounters, ...]
    skipped: Indices


@dataclass(frozen=True, slots=True, eq=False)
class NearPiece:
    """A convex piece, and the vehicles that come near it.

    Attributes
    ----------
    obstacle, piece : int
        Their numbers.
    vehicles : (n,) int array
        Those that come near.
    shapes : sequence of Polytope
        One shape, or one per step.
    spread : (T+1, d, d) array or None
        Covariances of its place; None where it is known exactly.
    """

    obstacle: int
    piece: int
    vehicles: Indices
    shapes: Sequence[Polytope]
    spread: Tensor | None


def gather_pairs(
    scenario: Scenario, motion: FleetMotion, *, intervals: bool, always: Flags | None = None
) -> Gathered:
    """Return all pairs as relative motions against the origin; far ones are left out.

    Parameters
    ----------
    scenario : Scenario
        The plan's.
    motion : FleetMotion
        Of the fleet.
    intervals : bool
        Whether collisions count between steps.
    always : (N,) bool array or None
        Vehicles whose encounters are never left out; None is none.
    """
    count = scenario.num_vehicles
    if count * (count - 1) // 2 <= _EXPLICIT or (always is not None and always.any()):
        pairs = np.column_stack(np.triu_indices(count, 1))
    else:
        pairs = near_pairs(motion_balls(motion, intervals=intervals))
    i, j = pairs[:, 0], pairs[:, 1]
    skipped = count - 1 - np.arange(count) - np.bincount(i, minlength=count)
    if not pairs.size:
        return Gathered((), skipped)
    faces = _pair_directions(scenario.num_pair_faces, scenario.dimension)
    batch = relative_motion(motion, i, j, "pair")
    walls = np.broadcast_to(faces, (len(pairs), *faces.shape))
    return Gathered((batch.against(batch.vertices, walls),), skipped)


def relative_motion(
    motion: FleetMotion, i: Indices, j: Indices, kind: Literal["pair", "range"]
) -> Encounters:
    """Return relative motions of vehicles against the origin, no directions named.

    Parameters
    ----------
    motion : FleetMotion
        Of the fleet.
    i, j : (B,) int array
        The vehicles.
    kind : {'pair', 'range'}
        Whether they keep apart, or together: then their radii do not count.
    """
    count, d = len(i), motion.positions.shape[2]
    covariances, bent = _pair_covariances(motion, i, j)
    radii = motion.radii[i] + motion.radii[j]
    return Encounters(
        kind=kind,
        first=i,
        other=j,
        piece=np.zeros(count, dtype=np.int64),
        partner=j,
        track=np.full(count, -1),
        means=motion.positions[i] - motion.positions[j],
        covariances=covariances,
        bent_covariances=bent,
        sagittas=motion.sagittas[i] - motion.sagittas[j],
        radii=radii if kind == "pair" else np.zeros(count),
        vertices=np.zeros((count, 1, 1, d)),
        directions=np.zeros((count, 0, d)),
        edges=np.zeros((count, 1, 0, 2, d)),
        samples=motion.samples,
    )


def _pair_covariances(motion: FleetMotion, i: Indices, j: Indices) -> tuple[Tensor, Tensor | None]:
    """Return the covariances of relative positions, and of those that feedback bends."""
    covariances = motion.position_covariances[i] + motion.position_covariances[j]
    bent = motion.bent_covariances[i] + motion.bent_covariances[j] if motion.is_bent else None
    if motion.common is None:
        return covariances, bent
    crossed = motion.common.positions(i, j)
    return (
        relative(covariances, crossed[0]),
        None if bent is None else relative(bent, crossed[1]),
    )


def _pair_directions(count: int, dimension: int) -> Matrix:
    """Return the axes and the directions in which planners may keep pairs apart."""
    axes = np.concatenate([np.eye(dimension), -np.eye(dimension)])
    if count == 2 * dimension:
        return axes
    if dimension == 2:
        angles = 2.0 * np.pi * np.arange(count) / count
        return np.vstack([axes, np.column_stack([np.cos(angles), np.sin(angles)])])
    half = count // 2
    height = (np.arange(half) + 0.5) / half
    turn = np.pi * (3.0 - np.sqrt(5.0)) * np.arange(half)
    flat = np.sqrt(1.0 - height**2)
    upper = np.column_stack([flat * np.cos(turn), flat * np.sin(turn), height])
    return np.vstack([axes, upper, -upper])


def gather_obstacles(
    scenario: Scenario, motion: FleetMotion, *, intervals: bool, always: Flags | None = None
) -> Gathered:
    """Return all vehicles against all convex pieces of obstacles that concern them.

    Parameters
    ----------
    scenario, motion, intervals, always
        As in `gather_pairs`.
    """
    count = scenario.num_vehicles
    skipped = np.zeros(count, dtype=np.int64)
    if not scenario.obstacles:
        return Gathered((), skipped)
    num_pieces = sum(len(o.at(0)) for o in scenario.obstacles)
    far_from = None
    if count * num_pieces > _EXPLICIT:
        balls = motion_balls(motion, intervals=intervals)
        far_from = _far_from_pieces(scenario, motion, balls, intervals=intervals)
    # Batches of one kind each: what stands still, what moves, what moves and is not known exactly.
    chosen: dict[tuple[bool, bool], list[NearPiece]] = {
        kind: [] for kind in ((False, False), (True, False), (True, True))
    }
    tracks = motion.tracks
    mine = concerned(scenario)
    for number, piece, pieces in pieces_of(scenario, 0):
        place = -1 if tracks is None else int(tracks.places[number])
        near = mine[number]
        if far_from is not None:
            far = next(far_from)
            if always is not None:
                far &= ~always
            skipped += far & near
            near = near & ~far
        if near.any():
            spread = tracks.positions[place] if tracks is not None and place >= 0 else None
            kind = len(pieces) > 1, spread is not None
            chosen[kind].append(NearPiece(number, piece, np.flatnonzero(near), pieces, spread))
    batches = tuple(_obstacle_batch(motion, group) for group in chosen.values() if group)
    return Gathered(batches, skipped)


def _far_from_pieces(
    scenario: Scenario, motion: FleetMotion, balls: Balls, *, intervals: bool
) -> Iterator[Flags]:
    """Yield who is far from each piece in every window, which may be off its track, if any."""
    boxes = []
    for number, _, pieces in pieces_of(scenario, 0):
        lower, upper = boxes_of(pieces, intervals=intervals)
        place = -1 if motion.tracks is None else int(motion.tracks.places[number])
        if motion.tracks is not None and place >= 0:
            # Deviations of two add up to less than their sum.
            cutoff, _ = cutoff_of(motion.samples)
            deviations = motion.tracks.deviations[place]
            more = cutoff * in_windows(deviations, intervals=intervals)[:, None]
            lower, upper = lower - more, upper + more
        boxes.append((lower, upper))
    yield from far_from_boxes(balls, boxes)


def near_pieces(
    scenario: Scenario, balls: Balls, step: int, reaches: Matrix | None, *, intervals: bool
) -> Iterator[NearPiece]:
    """Yield the pieces of obstacles that vehicles may come near from a step on.

    Parameters
    ----------
    scenario
        As in `gather_pairs`.
    balls : Balls
        Where vehicles are in each window from there on.
    step : int
        The first.
    reaches : (O, T+1) array or None
        How far each obstacle may be from where it is expected; None is nowhere [m].
    intervals : bool
        Whether windows are intervals, or steps.
    """
    mine, every, boxes = concerned(scenario), list(pieces_of(scenario, step)), []
    for number, _, shapes in every:
        lower, upper = boxes_of(shapes, intervals=intervals)
        if reaches is not None:
            more = in_windows(reaches[number, step:], intervals=intervals)[:, None]
            lower, upper = lower - more, upper + more
        boxes.append((lower, upper))
    for (number, piece, shapes), far in zip(every, far_from_boxes(balls, boxes), strict=True):
        yield NearPiece(number, piece, np.flatnonzero(~far & mine[number]), shapes, None)


def _obstacle_batch(motion: FleetMotion, group: Sequence[NearPiece]) -> Encounters:
    """Stack pieces of unequal size, padded by repeating a corner or a face."""
    first = np.concatenate([near.vehicles for near in group])
    sizes = [len(near.vehicles) for near in group]
    shapes = [near.shapes for near in group]
    covariances = motion.position_covariances[first]
    bent = motion.bent_covariances[first] if motion.is_bent else None
    spreads = [near.spread for near in group if near.spread is not None]
    if spreads:
        more = np.repeat(spreads, sizes, axis=0)
        covariances = covariances + more
        bent = None if bent is None else bent + more[:, :-1]
    other = np.repeat([near.obstacle for near in group], sizes)
    nobody = np.full(len(first), -1)
    return Encounters(
        kind="obstacle",
        first=first,
        other=other,
        piece=np.repeat([near.piece for near in group], sizes),
        partner=nobody,
        track=nobody if motion.tracks is None else motion.tracks.places[other],
        means=motion.positions[first],
        covariances=covariances,
        bent_covariances=bent,
        sagittas=motion.sagittas[first],
        radii=motion.radii[first],
        vertices=np.repeat(padded_vertices(shapes), sizes, axis=0),
        directions=np.repeat(padded_normals(shapes), sizes, axis=0),
        edges=np.repeat(padded_edges(shapes), sizes, axis=0),
        samples=motion.samples,
    )
