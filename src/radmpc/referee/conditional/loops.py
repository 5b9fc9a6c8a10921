"""The closed loops of a fleet, stacked, and the noise that has come in since a step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from radmpc.arrays import Tensor
from radmpc.errors import ArgumentError, ScenarioError
from radmpc.referee.motion import FleetMotion

__all__ = ["Loops", "Since", "loops_of", "since"]


@dataclass(frozen=True, slots=True, eq=False)
class Loops:
    """Closed loops of all vehicles, padded with zeros to the longest state n.

    Attributes
    ----------
    transitions : (N, n, n) array
        ``F = A + B K``.
    initial, disturbance : (N, n, n) array
        Covariances at k = 0 and of every step.
    picks : (N, d, n) array
        P, rows that pick the position.
    bends : (N, d, n) array
        ``G = B_p K`` where feedback bends the path between steps, else 0.
    """

    transitions: Tensor
    initial: Tensor
    disturbance: Tensor
    picks: Tensor
    bends: Tensor

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
        Of what noise has added to the state since.
    """

    step: int
    powers: Tensor
    covariances: Tensor


def loops_of(motion: FleetMotion) -> Loops:
    """Return the closed loops of a fleet.

    Parameters
    ----------
    motion : FleetMotion
        Of the fleet.

    Raises
    ------
    ScenarioError
        If a loop remembers more than its vehicle's state, which alone is measured, or vehicles
        have noise in common, or covariances are known up to a factor only.
    """
    if motion.common is not None:
        raise ScenarioError("what is left of a plan is valued under noise that nobody shares")
    if motion.samples is not None:
        raise ScenarioError("what is left of a plan is valued under covariances that are known")
    count, _, d = motion.positions.shape
    n = max(len(states[0]) for states in motion.states)
    if any(
        group.transitions.shape[-1] > n or group.transitions.shape[1] > 1 for group in motion.groups
    ):
        raise ScenarioError(
            "what is left of a plan is valued under noise that is new at every step"
        )
    square = (count, n, n)
    transitions, initial, disturbance = np.zeros(square), np.zeros(square), np.zeros(square)
    picks, bends = np.zeros((count, d, n)), np.zeros((count, d, n))
    for group in motion.groups:
        size = group.transitions.shape[-1]
        at = np.ix_(group.members, np.arange(size), np.arange(size))
        transitions[at], initial[at] = group.transitions[:, 0], group.initial
        disturbance[at] = group.disturbances[:, 0]
        for member, axes in zip(group.members.tolist(), group.position.tolist(), strict=True):
            picks[member, np.arange(d), axes] = 1.0
            bend = motion.bends[member]
            if bend is not None:
                bends[member, :, :size] = bend
    return Loops(transitions, initial, disturbance, picks, bends)


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
    turned = loops.transitions.transpose(0, 2, 1)
    powers = np.empty((horizon - step + 1, *loops.transitions.shape))
    covariances = np.empty_like(powers)
    powers[0] = np.eye(loops.transitions.shape[1])
    covariances[0] = 0.0 if is_measured else loops.initial
    for k in range(horizon - step):
        powers[k + 1] = loops.transitions @ powers[k]
        covariances[k + 1] = loops.transitions @ covariances[k] @ turned + loops.disturbance
    return Since(step, powers, 0.5 * (covariances + covariances.transpose(0, 1, 3, 2)))
