"""The closed loops of a fleet, stacked, and the noise that has come in since a step."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Tensor
from radmpc.errors import ArgumentError, ScenarioError
from radmpc.records import dataclass, replace
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
    pushes : (N, n, R) array or None
        What standard normals that several vehicles meet add at every step; None is nothing.
    """

    transitions: Tensor
    initial: Tensor
    disturbance: Tensor
    picks: Tensor
    bends: Tensor
    unknown: Tensor | None = None
    pushes: Tensor | None = None

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
    """

    step: int
    powers: Tensor
    covariances: Tensor
    crossed: Tensor | None = None


def loops_of(motion: FleetMotion) -> Loops:
    """Return the closed loops of a fleet.

    Parameters
    ----------
    motion : FleetMotion
        Of the fleet.

    Raises
    ------
    ScenarioError
        If vehicles share noise that lasts or measure under it.
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
    pushes = _pushes(motion, n)
    return Loops(transitions, initial, disturbance, picks, bends, _unknown(motion, n), pushes)


def _unknown(motion: FleetMotion, n: int) -> Tensor | None:
    """Return what measurements leave open of loops at every step, (T+1, N, n, n)."""
    if all(each is None for each in motion.unknown):
        return None
    result = np.zeros((motion.positions.shape[1], len(motion.unknown), n, n))
    for i, each in enumerate(motion.unknown):
        if each is not None:
            result[:, i, : each.shape[1], : each.shape[1]] = each
    return result


def _pushes(motion: FleetMotion, n: int) -> Tensor | None:
    """Return what noise that several vehicles meet adds at every step, (N, n, R)."""
    common = motion.common
    if common is None:
        return None
    remember = [each is not None for each in motion.unknown]
    if common.first.any() or common.pushes[remember].any():
        raise ScenarioError(
            "what is left of a plan is valued under shared noise that is new at every step, with "
            "states known exactly"
        )
    pushes = np.zeros((len(common.pushes), n, common.pushes.shape[-1]))
    pushes[:, : common.pushes.shape[2]] = common.pushes[:, 0]
    return pushes


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
    met = loops.pushes[first] @ loops.pushes[other].transpose(0, 2, 1)
    mine, theirs = loops.transitions[first, 0], loops.transitions[other, 0].transpose(0, 2, 1)
    crossed = np.zeros((len(noise.powers), *met.shape))
    for k in range(len(crossed) - 1):
        crossed[k + 1] = mine @ crossed[k] @ theirs + met
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
    """
    if not 0 <= step <= horizon:
        raise ArgumentError(f"step must be from 0 to {horizon}, got {step}")
    if not is_measured and step:
        raise ArgumentError(f"without measured states step must be 0, got {step}")
    powers = np.empty((horizon - step + 1, *loops.initial.shape))
    covariances = np.empty_like(powers)
    powers[0] = np.eye(loops.initial.shape[1])
    covariances[0] = loops.initial
    if is_measured:
        covariances[0] = 0.0 if loops.unknown is None else loops.unknown[step]
    last = loops.transitions.shape[1] - 1
    for k in range(horizon - step):
        at = min(step + k, last)
        onward = loops.transitions[:, at]
        powers[k + 1] = onward @ powers[k]
        moved = onward @ covariances[k] @ onward.transpose(0, 2, 1)
        covariances[k + 1] = moved + loops.disturbance[:, at]
    return Since(step, powers, 0.5 * (covariances + covariances.transpose(0, 1, 3, 2)))
