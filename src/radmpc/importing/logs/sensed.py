"""What measurement noise does to a vehicle whose feedback acts on the measured states."""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigh

from radmpc.arrays import Matrix
from radmpc.identification.estimate import Estimate
from radmpc.identification.model import StepModel
from radmpc.identification.sharing import nearest_covariance
from radmpc.identification.unknown import safe_constant

__all__ = ["feeds_measurement", "steered_by_noise"]

_MOST_REST = 0.5
"""Share [-] of what measurement noise asks of the feedback that may be missing in the commands:
with feedback to a filter's estimate, or to the true state, all of it is."""

_STEPS = 200
"""Steps over which deviations are compared: those of any loop that settles at all have."""


def feeds_measurement(one: Estimate) -> bool:
    """Whether the feedback acts on the states as they are measured, noise included.

    Parameters
    ----------
    one : Estimate
        With commands.
    """
    if one.gain is None or one.measurement is None or not np.isfinite(one.unexplained):
        return False
    gain = one.gain.value
    asked = float(np.trace(gain @ nearest_covariance(one.measurement.value) @ gain.T))
    return bool(one.gain.excludes_zero) and one.unexplained < _MOST_REST * asked


def steered_by_noise(one: Estimate, model: StepModel) -> Matrix:
    """Return what measurement noise adds to the disturbance by way of the feedback.

    Noise m of the sensors moves the vehicle by B K m in every step: a white disturbance. One with
    the memory of the vehicle's own is returned that leads to positions at least as uncertain, at
    every step.

    Parameters
    ----------
    one : Estimate
        With feedback and measurement noise.
    model : StepModel
        Its dynamics.

    Returns
    -------
    (n, n) array
        A covariance [m², m²/s²].
    """
    if one.gain is None or one.measurement is None:
        return np.zeros((model.num_states, model.num_states))
    moved = model.B @ one.gain.value
    steered: Matrix = moved @ nearest_covariance(one.measurement.value) @ moved.T
    if one.time_constant is None:
        return steered
    color = float(np.exp(-model.dt / safe_constant(one.time_constant)))
    return steered * _growth(model.A + moved, steered, color, model)


def _growth(loop: Matrix, steered: Matrix, color: float, model: StepModel) -> float:
    """Return by what factor noise with memory must be larger for no smaller positions."""
    d, n = model.dimension, model.num_states
    white, colored, cross = np.zeros((3, n, n))
    least = 1.0
    for _ in range(_STEPS):
        white = loop @ white @ loop.T + steered
        colored = loop @ colored @ loop.T + loop @ cross + (loop @ cross).T + steered
        cross = color * (loop @ cross + steered)
        sizes = np.sqrt(np.maximum(np.diag(colored)[:d], 1e-300))
        sizes = np.outer(sizes, sizes)
        # Along axes without noise both are 0: a small part keeps the comparison possible.
        parts = white[:d, :d] / sizes, colored[:d, :d] / sizes + 1e-9 * np.eye(d)
        least = max(least, float(eigh(*parts, eigvals_only=True)[-1]))
    return least
