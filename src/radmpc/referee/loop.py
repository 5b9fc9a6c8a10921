r"""The referee's own closed loop of a vehicle, as one linear system under fresh noise.

The loop's state ζ begins with the deviation :math:`\delta = x - \bar x`. A disturbance that is
correlated in time is part of it, as what will be added over the step that follows:

.. math:: \delta^+ = (A + BK)\,\delta + w, \qquad w^+ = \rho\, w + \epsilon, \quad
          \epsilon \sim N(0, (1 - \rho^2)\, W).

Of a vehicle that measures, ζ holds all that once more: as estimated, by a Kalman filter that sees
:math:`y = C x + v` at every step before the control is chosen. With ξ for what there is and
:math:`\hat\xi` for the estimate of it, G for what happens without control and L for the gain of the
step that follows,

.. math:: \xi^+ = G\,\xi + BK\,\hat\xi + \epsilon, \qquad
          \hat\xi^+ = (G + BK)\,\hat\xi + L\,\bigl(H\,(G\,(\xi - \hat\xi) + \epsilon) + v\bigr).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from radmpc.arrays import Matrix, Tensor
from radmpc.model.vehicle import Vehicle

__all__ = ["Loop", "loop_of"]

_NOTHING = 1e-12
"""Share of the largest eigenvalue of what a sensor sees below which one is rounding [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Loop:
    """A vehicle's closed loop, ``ζ⁺ = F ζ + noise``.

    Attributes
    ----------
    transitions, disturbances : (S, q, q) array
        F, and the covariance of the noise, at every step; one for all where S is 1.
    initial : (q, q) array
        Covariance of ζ at k = 0.
    seen : int
        Where in ζ the deviation begins that feedback acts on: 0 where it is known exactly.
    """

    transitions: Tensor
    disturbances: Tensor
    initial: Matrix
    seen: int


def loop_of(vehicle: Vehicle, horizon: int) -> Loop:
    """Return the closed loop of a vehicle.

    Parameters
    ----------
    vehicle : Vehicle
        Dynamics, feedback and noise are taken from it.
    horizon : int
        Number of steps T.
    """
    n = vehicle.system.num_states
    initial, fresh = vehicle.initial_covariance, vehicle.disturbance_covariance
    free, pushed = vehicle.system.A, np.zeros((n, n))
    if vehicle.gain is not None:
        pushed = vehicle.system.B @ vehicle.gain
    rho = vehicle.disturbance_correlation
    if rho > 0.0:
        free = _stacked(free, np.eye(n), rho * np.eye(n))
        none = np.zeros((n, n))
        pushed = _stacked(pushed, none, none)
        initial = _stacked(initial, none, fresh)
        fresh = _stacked(none, none, (1.0 - rho * rho) * fresh)
    if vehicle.measurement is not None:
        return _filtered(vehicle, (free, pushed), (initial, fresh), horizon)
    closed = free if vehicle.gain is None else free + pushed
    return Loop(closed[None], fresh[None], initial, 0)


def _stacked(first: Matrix, second: Matrix, last: Matrix) -> Matrix:
    """Return an upper block triangle."""
    return np.block([[first, second], [np.zeros_like(second), last]])


def _filtered(
    vehicle: Vehicle, acts: tuple[Matrix, Matrix], noises: tuple[Matrix, Matrix], horizon: int
) -> Loop:
    """Return the loop of a vehicle and its filter.

    Parameters
    ----------
    vehicle : Vehicle
        With a measurement.
    acts : pair of (p, p) array
        What becomes of ξ without control, and what feedback on its estimate adds.
    noises : pair of (p, p) array
        Covariance of ξ at k = 0, and of the noise of every step.
    horizon : int
        Number of steps T.
    """
    (free, pushed), (initial, fresh) = acts, noises
    size = len(free)
    H, R = _sensor(vehicle, size)
    error, gains = initial, []
    for _ in range(horizon + 1):
        gain = error @ H.T @ _inverse(H @ error @ H.T + R)
        gains.append(gain)
        left = np.eye(size) - gain @ H
        error = free @ (left @ error @ left.T + gain @ R @ gain.T) @ free.T + fresh
    transitions, disturbances = np.empty((2, horizon, 2 * size, 2 * size))
    for k, gain in enumerate(gains[1:]):
        corrected = gain @ H @ free
        transitions[k] = np.block([[free, pushed], [corrected, free + pushed - corrected]])
        disturbances[k] = _told(gain, H, R, fresh)
    return Loop(transitions, disturbances, _told(gains[0], H, R, initial), size)


def _sensor(vehicle: Vehicle, size: int) -> tuple[Matrix, Matrix]:
    """Return what a vehicle's sensor sees of a longer state, and its noise."""
    if vehicle.measurement is None:
        return np.zeros((0, size)), np.zeros((0, 0))
    C = vehicle.measurement.matrix
    return np.hstack([C, np.zeros((len(C), size - C.shape[1]))]), vehicle.measurement.covariance


def _told(gain: Matrix, H: Matrix, R: Matrix, noise: Matrix) -> Matrix:
    """Return the joint covariance of a noise, and of what a filter makes of it and of its own."""
    both = np.vstack([np.eye(len(noise)), gain @ H])
    own = np.vstack([np.zeros_like(gain), gain])
    return np.asarray(both @ noise @ both.T + own @ R @ own.T)


def _inverse(matrix: Matrix) -> Matrix:
    """Return the inverse of a covariance where it has one, 0 along all other directions."""
    values, vectors = np.linalg.eigh(0.5 * (matrix + matrix.T))
    seen = values > _NOTHING * max(values.max(initial=0.0), 0.0)
    return np.asarray((vectors[:, seen] / values[seen]) @ vectors[:, seen].T)
