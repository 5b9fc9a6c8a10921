"""The closed loops of a fleet, stacked, and the noise that has come in since a step."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Indices, Tensor
from radmpc.errors import ArgumentError
from radmpc.model.vehicle import Vehicle
from radmpc.records import dataclass, replace
from radmpc.referee.conditional.gusts import Gusts, gusts_of
from radmpc.referee.motion import FleetMotion

__all__ = ["Loops", "Since", "loops_of", "since", "together"]


@dataclass(frozen=True, slots=True, eq=False)
class Loops:
    """Closed loops of all vehicles, padded with zeros to the longest state n.

    A loop's state is the vehicle's and what lasts of its disturbance; with a filter, all of that as
    it is estimated, too.

    Attributes
    ----------
    transitions : (N, S, n, n) array
        ``F = A + B K`` at every step; one for all where S is 1.
    initial : (N, n, n) array
        Covariances at k = 0.
    disturbance : (N, S, n, n) array
        Covariances of the noise of every step.
    picks : (N, d, n) array
        P, rows that pick the position.
    bends : (N, d, n) array
        ``G = B_p K`` where feedback bends the path between steps, else 0.
    unknown : (T+1, N, n, n) array or None
        Covariances given all that is measured up to each step; None is nothing left open.
    pushes : (N, S, n, R) array or None
        What standard normals that several vehicles meet add at every step, one for all where S is
        1; None is nothing.
    first : (N, n, R) array or None
        What those behind first values make of loops at k = 0; None is nothing.
    gusts : Gusts or None
        What measurements leave open of vehicles that share disturbances; None is nothing.
    """

    transitions: Tensor
    initial: Tensor
    disturbance: Tensor
    picks: Tensor
    bends: Tensor
    unknown: Tensor | None = None
    pushes: Tensor | None = None
    first: Tensor | None = None
    gusts: Gusts | None = None

    def has_spread(self, noise: Since) -> bool:
        """Whether states are known better than when a leg begins, at the noise's first step."""
        return not np.array_equal(noise.covariances[0], self.initial)


@dataclass(frozen=True, slots=True, eq=False)
class Since:
    """What is known and what is not of the steps from one on.

    Attributes
    ----------
    step : int
        The one at which states were measured, or 0 where none were.
    powers : (T − step + 1, N, n, n) array
        ``F^(k − step)`` for k from that step on.
    covariances : (T − step + 1, N, n, n) array
        Of what noise has added to the state since, and of what the measurement left open.
    crossed : (T − step + 1, B, n, n) array or None
        Covariances of the two vehicles of each encounter by noise that both meet; None is none.
    roots : (N, n, R) array or None
        What standard normals that vehicles have in common make of what is not known of them at that
        step; None is nothing.
    """

    step: int
    powers: Tensor
    covariances: Tensor
    crossed: Tensor | None = None
    roots: Tensor | None = None


def loops_of(motion: FleetMotion, vehicles: Sequence[Vehicle]) -> Loops:
    """Return the closed loops of a fleet.

    Parameters
    ----------
    motion : FleetMotion
        Of the fleet.
    vehicles : sequence of Vehicle
        The fleet.
    """
    count, _, d = motion.positions.shape
    n = max(group.transitions.shape[-1] for group in motion.groups)
    steps = max(group.transitions.shape[1] for group in motion.groups)
    transitions, disturbance = np.zeros((2, count, steps, n, n))
    initial = np.zeros((count, n, n))
    picks, bends = np.zeros((count, d, n)), np.zeros((count, d, n))
    for group in motion.groups:
        size = group.transitions.shape[-1]
        at = np.ix_(group.members, np.arange(size), np.arange(size))
        initial[at] = group.initial
        each = np.ix_(group.members, np.arange(steps), np.arange(size), np.arange(size))
        transitions[each], disturbance[each] = group.transitions, group.disturbances
        for member, axes in zip(group.members.tolist(), group.position.tolist(), strict=True):
            picks[member, np.arange(d), axes] = 1.0
            bend = motion.bends[member]
            if bend is not None:
                bends[member, :, :size] = bend
    pushes, first = _pushes(motion, n)
    gusts = None if pushes is None else gusts_of(vehicles, n)
    unknown = _unknown(motion, n, () if gusts is None else gusts.members)
    return Loops(transitions, initial, disturbance, picks, bends, unknown, pushes, first, gusts)


def _unknown(motion: FleetMotion, n: int, tied: tuple[int, ...]) -> Tensor | None:
    """Return what their own measurements leave open of loops at every step, (T+1, N, n, n)."""
    if all(each is None for each in motion.unknown):
        return None
    result = np.zeros((motion.positions.shape[1], len(motion.unknown), n, n))
    for i, each in enumerate(motion.unknown):
        if each is not None and i not in tied:
            result[:, i, : each.shape[1], : each.shape[1]] = each
    return result


def _pushes(motion: FleetMotion, n: int) -> tuple[Tensor | None, Tensor | None]:
    """Return what noise that several meet adds at every step, and what it made of k = 0."""
    common = motion.common
    if common is None:
        return None, None
    count, steps, size, width = common.pushes.shape
    pushes = np.zeros((count, steps, n, width))
    pushes[:, :, :size] = common.pushes
    if not common.first.any():
        return pushes, None
    first = np.zeros((count, n, width))
    first[:, : common.first.shape[1]] = common.first
    return pushes, first


def together(noise: Since, loops: Loops, first: Indices, other: Indices) -> Since:
    """Return the same with covariances of vehicles that meet the same noise.

    Parameters
    ----------
    noise : Since
        Of the steps since the measurement.
    loops : Loops
        Of the fleet.
    first, other : (B,) int array
        The vehicles of each encounter.
    """
    if loops.pushes is None:
        return noise
    size = loops.transitions.shape[-1]
    crossed = np.zeros((len(noise.powers), len(first), size, size))
    if noise.roots is not None:
        crossed[0] = noise.roots[first] @ noise.roots[other].transpose(0, 2, 1)
    # One for all steps, or one each: what is the same at all of them is made once.
    last = loops.transitions.shape[1] - 1
    for k in range(len(crossed) - 1):
        if k == 0 or noise.step + k <= last:
            at = min(noise.step + k, last)
            mine, theirs = loops.transitions[first, at], loops.transitions[other, at]
            pushed, others = loops.pushes[first, at], loops.pushes[other, at]
            met = pushed @ others.transpose(0, 2, 1)
        crossed[k + 1] = mine @ crossed[k] @ theirs.transpose(0, 2, 1) + met
    return replace(noise, crossed=crossed)


def since(loops: Loops, horizon: int, step: int, *, is_measured: bool) -> Since:
    """Return what noise adds from a step on.

    Parameters
    ----------
    loops : Loops
        Of the fleet.
    horizon : int
        T.
    step : int
        Where states were measured, 0..T.
    is_measured : bool
        Whether they were; if not, step 0 has its initial covariance.

    Returns
    -------
    Since
        Without covariances of two vehicles: see `together`.
    """
    if not 0 <= step <= horizon:
        raise ArgumentError(f"step must be from 0 to {horizon}, got {step}")
    if not is_measured and step:
        raise ArgumentError(f"without measured states step must be 0, got {step}")
    powers = np.empty((horizon - step + 1, *loops.initial.shape))
    covariances = np.empty_like(powers)
    powers[0] = np.eye(loops.initial.shape[1])
    covariances[0], roots = loops.initial, loops.first
    if is_measured:
        covariances[0] = 0.0 if loops.unknown is None else loops.unknown[step]
        roots = None
        if loops.gusts is not None:
            roots = loops.gusts.left_open(step)
            covariances[0] += roots @ roots.transpose(0, 2, 1)
    last = loops.transitions.shape[1] - 1
    for k in range(horizon - step):
        at = min(step + k, last)
        onward = loops.transitions[:, at]
        powers[k + 1] = onward @ powers[k]
        moved = onward @ covariances[k] @ onward.transpose(0, 2, 1)
        covariances[k + 1] = moved + loops.disturbance[:, at]
    covariances = 0.5 * (covariances + covariances.transpose(0, 1, 3, 2))
    return Since(step, powers, covariances, None, roots)
