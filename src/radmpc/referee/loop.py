r"""The referee's own closed loop of a vehicle, as one linear system under fresh noise.

The loop's state ζ begins with the deviation :math:`\delta = x - \bar x`. A disturbance that is
correlated in time is part of it, as what will be added over the step that follows:

.. math:: \delta^+ = (A + BK)\,\delta + w, \qquad w^+ = \rho\, w + \epsilon, \quad
          \epsilon \sim N(0, (1 - \rho^2)\, W).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from radmpc.arrays import Matrix
from radmpc.model.vehicle import Vehicle

__all__ = ["Loop", "loop_of"]


@dataclass(frozen=True, slots=True, eq=False)
class Loop:
    """A vehicle's closed loop, ``ζ⁺ = F ζ + noise``.

    Attributes
    ----------
    transition : (q, q) array
        F.
    initial, disturbance : (q, q) array
        Covariance of ζ at k = 0, and of the noise of every step.
    """

    transition: Matrix
    initial: Matrix
    disturbance: Matrix


def loop_of(vehicle: Vehicle) -> Loop:
    """Return the closed loop of a vehicle.

    Parameters
    ----------
    vehicle : Vehicle
        Dynamics, feedback and noise are taken from it.
    """
    closed = vehicle.system.A
    if vehicle.gain is not None:
        closed = closed + vehicle.system.B @ vehicle.gain
    initial, fresh = vehicle.initial_covariance, vehicle.disturbance_covariance
    rho = vehicle.disturbance_correlation
    if rho == 0.0:
        return Loop(closed, initial, fresh)
    n = len(closed)
    transition, first, noise = (np.zeros((2 * n, 2 * n)) for _ in range(3))
    transition[:n, :n], transition[:n, n:] = closed, np.eye(n)
    transition[n:, n:] = rho * np.eye(n)
    first[:n, :n], first[n:, n:] = initial, fresh
    noise[n:, n:] = (1.0 - rho * rho) * fresh
    return Loop(transition, first, noise)
