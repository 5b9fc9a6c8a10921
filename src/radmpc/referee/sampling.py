"""Random trajectories of a fleet, drawn in chunks whose numbers depend on nothing but the seed."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor
from radmpc.records import dataclass
from radmpc.referee.motion import FleetMotion, Group
from radmpc.referee.tracks import Tracks

__all__ = ["Sampler"]


@dataclass(frozen=True, slots=True, eq=False)
class _Block:
    """Vehicles of one group whose states stand in consecutive rows.

    ``transitions`` are (S, g, q, q), one for all steps or one for each. ``initial`` and
    ``disturbances`` are factors L with ``L Lᵀ`` the covariance, (g, q, q) and (S, g, q, q), or
    columns of deviations, (g, q, 1) and (S, g, q, 1), where all are diagonal.
    """

    rows: slice
    transitions: Tensor
    initial: Tensor
    disturbances: Tensor

    @property
    def shape(self) -> tuple[int, int, int]:
        """Vehicles, states, and as many samples as there are."""
        return (self.transitions.shape[1], self.transitions.shape[2], -1)


@dataclass(frozen=True, slots=True, eq=False)
class Sampler:
    """Draws the states of the loops of those vehicles that matter: first of each ``x − x̄``.

    Attributes
    ----------
    width : int
        Rows of the stacked states.
    starts : (N,) int array
        First row of each vehicle's state; −1 where it is not drawn.
    track_starts : (O,) int array
        The same of each obstacle, whose deviation stands there if its place is not known exactly.
    blocks : tuple
        Vehicles of one size of state, drawn together.
    first, pushes : (width, R) and (S, width, R) array, or None
        What standard normals that all meet add at k = 0 and in every step; None is nothing.
    samples : int or None
        Independent steps that covariances were estimated from; None is that they are known.
    """

    width: int
    starts: Indices
    track_starts: Indices
    blocks: tuple[_Block, ...]
    first: Matrix | None = None
    pushes: Tensor | None = None
    samples: int | None = None

    @classmethod
    def of(cls, motion: FleetMotion, needed: Indices, obstacles: Indices) -> Sampler:
        """Stack the vehicles and obstacles that are needed.

        Parameters
        ----------
        motion : FleetMotion
            Of the fleet.
        needed : int array
            Numbers of the vehicles to be drawn.
        obstacles : int array
            Numbers of the obstacles to be drawn, of those whose place is not known exactly.
        """
        starts = np.full(len(motion.states), -1, dtype=np.int64)
        blocks, row = [], 0
        for group in motion.groups:
            kept = np.flatnonzero(np.isin(group.members, needed))
            if not kept.size:
                continue
            n = group.transitions.shape[-1]
            starts[group.members[kept]] = row + n * np.arange(kept.size)
            blocks.append(_block(group, kept, slice(row, row + n * kept.size)))
            row += n * kept.size
        tracks = motion.tracks
        track_starts = np.full(0 if tracks is None else tracks.places.size, -1, dtype=np.int64)
        chosen = np.zeros(0, dtype=np.int64)
        if tracks is not None:
            chosen = np.intersect1d(obstacles, np.flatnonzero(tracks.places >= 0))
        if tracks is not None and chosen.size:
            n = len(tracks.transition)
            track_starts[chosen] = row + n * np.arange(chosen.size)
            blocks.append(_track_block(tracks, tracks.places[chosen], row))
            row += n * chosen.size
        if motion.common is None:
            return cls(row, starts, track_starts, tuple(blocks), samples=motion.samples)
        common = _common(motion, starts, row)
        return cls(row, starts, track_starts, tuple(blocks), *common, motion.samples)

    def draw(
        self,
        horizon: int,
        size: int,
        rng: np.random.Generator,
        held_back: Callable[[int, Matrix, Matrix], None],
    ) -> Iterator[Matrix]:
        """Yield the deviations at k = 0..T, (width, size).

        ``ζ⁺ = F ζ + noise`` keeps the whole correlation in time. Two arrays take turns: a
        yielded one is overwritten by the next but one.

        Parameters
        ----------
        horizon : int
            T.
        size : int
            Samples.
        rng : Generator
            Source of randomness.
        held_back : callable
            Given a step, the deviations there and those at the next; takes off from the latter
            what controls that saturate do not do.
        """
        noise, spare = np.empty((self.width, size)), np.empty((self.width, size))
        state = np.empty((self.width, size))
        rng.standard_normal(out=noise)
        for block in self.blocks:
            _scale(block.initial, noise[block.rows], state[block.rows], block.shape)
        if self.first is not None:
            state += self.first @ rng.standard_normal((self.first.shape[1], size))
        # One factor for the whole mission: by how much all deviations are larger than stated.
        factors = None
        if self.samples is not None:
            factors = np.sqrt(self.samples / rng.chisquare(self.samples, size))
            state *= factors
        yield state
        for k in range(horizon):
            rng.standard_normal(out=noise)
            for block in self.blocks:
                factor = block.disturbances[min(k, len(block.disturbances) - 1)]
                _scale(factor, noise[block.rows], spare[block.rows], block.shape)
            if self.pushes is not None:
                pushes = self.pushes[min(k, len(self.pushes) - 1)]
                spare += pushes @ rng.standard_normal((pushes.shape[1], size))
            if factors is not None:
                spare *= factors
            # The noise has been used: its array holds what the dynamics make of the state.
            for block in self.blocks:
                np.matmul(
                    block.transitions[min(k, len(block.transitions) - 1)],
                    state[block.rows].reshape(block.shape),
                    out=noise[block.rows].reshape(block.shape),
                )
            spare += noise
            held_back(k, state, spare)
            state, spare = spare, state
            yield state


def _block(group: Group, kept: Indices, rows: slice) -> _Block:
    """Take some vehicles of a group."""
    return _Block(
        rows,
        np.ascontiguousarray(group.transitions[kept].swapaxes(0, 1)),
        _factor(group.own_initial[kept]),
        _factor(group.own_disturbances[kept].swapaxes(0, 1)),
    )


def _track_block(tracks: Tracks, places: Indices, row: int) -> _Block:
    """Take some obstacles, from a row on: one draw for the whole fleet."""
    n = len(tracks.transition)
    return _Block(
        slice(row, row + n * places.size),
        np.tile(tracks.transition, (1, places.size, 1, 1)),
        _factor(tracks.initial[places]),
        _factor(tracks.disturbances[places][None]),
    )


def _common(motion: FleetMotion, starts: Indices, width: int) -> tuple[Matrix, Tensor]:
    """Return what normals that all meet add to the stacked states, at k = 0 and in every step."""
    common = motion.common
    if common is None:
        return np.zeros((width, 0)), np.zeros((1, width, 0))
    steps, num = common.pushes.shape[1], common.first.shape[2]
    first, pushes = np.zeros((width, num)), np.zeros((steps, width, num))
    for i, start in enumerate(starts.tolist()):
        if start >= 0:
            q = motion.loops[i].shape[-1]
            first[start : start + q] = common.first[i, :q]
            pushes[:, start : start + q] = common.pushes[i, :, :q]
    return first, pushes


def _factor(covariances: Tensor) -> Tensor:
    """Return factors of covariances that may be singular."""
    diagonals = np.diagonal(covariances, axis1=-2, axis2=-1)
    if np.array_equal(covariances, diagonals[..., None] * np.eye(covariances.shape[-1])):
        column: Tensor = np.sqrt(diagonals.clip(min=0.0))[..., None]
        return column
    values, vectors = np.linalg.eigh(covariances)
    return np.asarray(vectors * np.sqrt(values.clip(min=0.0))[..., None, :])


def _scale(factor: Tensor, normals: Matrix, out: Matrix, shape: tuple[int, int, int]) -> None:
    """Apply a factor to standard normals."""
    if factor.shape[2] == 1:
        np.multiply(factor, normals.reshape(shape), out=out.reshape(shape))
    else:
        np.matmul(factor, normals.reshape(shape), out=out.reshape(shape))
