r"""How far a vehicle strays whose noise has a memory, or that does not know its state exactly.

A disturbance of correlation ρ from step to step is a stationary first-order autoregression,

.. math:: w^{k+1} = \rho\, w^k + \sqrt{1 - \rho^2}\; \epsilon^k, \qquad
          w^0, \epsilon^k \sim N(0, W),

so that each has the covariance W, and those j steps apart have the covariance :math:`\rho^j W`. The
deviation from the mean and the disturbance that follows it are then, together, the state of a
larger linear system whose noise is new at every step. The first disturbance is drawn apart from the
first state.

Of that larger state a vehicle that measures knows a Kalman filter's estimate, which is
uncorrelated with its error: their covariances add up. The error's follows the Riccati equation
whatever the controls; what a measurement takes off the error's covariance, the estimate's gains.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor
from radmpc.model.dynamics import LinearSystem
from radmpc.model.noise.measurement import Measurement

__all__ = ["Noise", "Spread", "spread_of"]

_SINGULAR = 1e-12
"""Share of the largest eigenvalue of a measurement's covariance below which one counts as 0 [-]:
what nothing is left to learn of. Exact sensors have such eigenvalues, and rounding leaves 1e-16."""


@dataclass(frozen=True, slots=True, eq=False)
class Noise:
    """What shakes a vehicle.

    Attributes
    ----------
    initial : (n, n) array
        Covariance of the state at k = 0.
    disturbance : (n, n) array
        Covariance W of every disturbance.
    correlation : float
        ρ of consecutive disturbances, from 0 to below 1 [-].
    measurement : Measurement or None
        What is known of the state; None is all, exactly.
    """

    initial: Matrix
    disturbance: Matrix
    correlation: float
    measurement: Measurement | None


@dataclass(frozen=True, slots=True, eq=False)
class Spread:
    """Covariances of the deviation ``δ = x − x̄`` and of the disturbance w that follows it.

    Attributes
    ----------
    known : (T+1, 2n, 2n) array
        Of the estimate of both, stacked; of both where nothing is estimated.
    unknown : (T+1, 2n, 2n) array or None
        Of the estimate's error; None is none.
    """

    known: Tensor
    unknown: Tensor | None

    @property
    def num_states(self) -> int:
        """Length n of the state."""
        return int(self.known.shape[1]) // 2

    @property
    def estimates(self) -> Tensor:
        """Covariances of ``x̂ − x̄``, what feedback acts on, (T+1, n, n)."""
        n = self.num_states
        return self.known[:, :n, :n]

    @property
    def states(self) -> Tensor:
        """Covariances of the state, (T+1, n, n)."""
        n = self.num_states
        return self.estimates if self.unknown is None else (self.known + self.unknown)[:, :n, :n]

    def of_sums(
        self,
        steps: Indices | slice,
        of_state: Tensor,
        of_estimate: Tensor,
        of_disturbance: Tensor | None = None,
    ) -> Tensor:
        """Return the covariances of ``M δ + L δ̂ + N w`` at some steps, (k, r, r).

        Parameters
        ----------
        steps : slice or (k,) int array
            The steps.
        of_state, of_estimate : (r, n) or (k, r, n) array
            M and L.
        of_disturbance : (r, n) or (k, r, n) array or None
            N; None is 0.
        """
        last = np.zeros_like(of_state) if of_disturbance is None else of_disturbance
        whole = np.concatenate([of_state + of_estimate, last], axis=-1)
        found = whole @ self.known[steps] @ np.swapaxes(whole, -1, -2)
        if self.unknown is not None:
            part = np.concatenate([of_state, last], axis=-1)
            found = found + part @ self.unknown[steps] @ np.swapaxes(part, -1, -2)
        return np.asarray(found)


def spread_of(system: LinearSystem, noise: Noise, gain: Matrix | None, horizon: int) -> Spread:
    """Propagate the covariances.

    Parameters
    ----------
    system : LinearSystem
        The dynamics.
    noise : Noise
        What shakes the vehicle, and what it knows of that.
    gain : (m, n) array or None
        Feedback K; None is open loop.
    horizon : int
        Number of steps T.

    Returns
    -------
    Spread
        At k = 0..T.
    """
    n, rho = system.num_states, noise.correlation
    none = np.zeros((n, n))
    free = np.block([[system.A, np.eye(n)], [none, rho * np.eye(n)]])
    loop = free.copy()
    if gain is not None:
        loop[:n, :n] += system.B @ gain
    fresh = np.block([[none, none], [none, (1.0 - rho**2) * noise.disturbance]])
    ahead = np.block([[noise.initial, none], [none, noise.disturbance]])
    known = np.empty((horizon + 1, 2 * n, 2 * n))
    if noise.measurement is None:
        known[0] = ahead
        for k in range(horizon):
            known[k + 1] = _even(loop @ known[k] @ loop.T + fresh)
        return Spread(known, None)
    unknown = np.empty_like(known)
    before = np.zeros_like(ahead)
    for k in range(horizon + 1):
        learned = _learned(noise.measurement, ahead)
        unknown[k] = _even(ahead - learned)
        known[k] = _even(before + learned)
        before = loop @ known[k] @ loop.T
        ahead = _even(free @ unknown[k] @ free.T + fresh)
    return Spread(known, unknown)


def _learned(measurement: Measurement, covariance: Matrix) -> Matrix:
    """Return what a measurement takes off the covariance of what is not known."""
    n = measurement.matrix.shape[1]
    seen = measurement.matrix @ covariance[:n]
    surprise = _even(seen[:, :n] @ measurement.matrix.T + measurement.covariance)
    return np.asarray(seen.T @ np.linalg.pinv(surprise, _SINGULAR, hermitian=True) @ seen)


def _even(matrix: Matrix) -> Matrix:
    """Return a matrix without what rounding did to its symmetry."""
    return np.asarray(0.5 * (matrix + matrix.T))
