r"""How far a vehicle strays when its noise has a memory.

A disturbance of correlation ρ from step to step is a stationary first-order autoregression,

.. math:: w^{k+1} = \rho\, w^k + \sqrt{1 - \rho^2}\; \epsilon^k, \qquad
          w^0, \epsilon^k \sim N(0, W),

so that each has the covariance W, and those j steps apart have the covariance :math:`\rho^j W`. The
deviation from the mean and the disturbance that follows it are then, together, the state of a
larger linear system whose noise is new at every step. The first disturbance is drawn apart from the
first state.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor
from radmpc.model.dynamics import LinearSystem

__all__ = ["Spread", "spread_of"]


@dataclass(frozen=True, slots=True, eq=False)
class Spread:
    """Covariances of the deviation ``δ = x − x̄`` and of the disturbance that follows it.

    Attributes
    ----------
    joint : (T+1, 2n, 2n) array
        Of both, stacked.
    """

    joint: Tensor

    @property
    def num_states(self) -> int:
        """Length n of the state."""
        return int(self.joint.shape[1]) // 2

    @property
    def states(self) -> Tensor:
        """Covariances of the state, (T+1, n, n)."""
        n = self.num_states
        return self.joint[:, :n, :n]

    def of_sums(self, steps: Indices | slice, of_state: Tensor, of_disturbance: Tensor) -> Tensor:
        """Return the covariances of ``M δ + N w`` at some steps, (k, r, r).

        Parameters
        ----------
        steps : slice or (k,) int array
            The steps.
        of_state, of_disturbance : (r, n) or (k, r, n) array
            M and N.
        """
        whole = np.concatenate([of_state, of_disturbance], axis=-1)
        return np.asarray(whole @ self.joint[steps] @ np.swapaxes(whole, -1, -2))


def spread_of(
    system: LinearSystem,
    initial: Matrix,
    disturbance: Matrix,
    correlation: float,
    gain: Matrix | None,
    horizon: int,
) -> Spread:
    """Propagate the covariances.

    Parameters
    ----------
    system : LinearSystem
        The dynamics.
    initial : (n, n) array
        Covariance of the state at k = 0.
    disturbance : (n, n) array
        Covariance W of every disturbance.
    correlation : float
        ρ of consecutive disturbances, from 0 to below 1 [-].
    gain : (m, n) array or None
        Feedback K; None is open loop.
    horizon : int
        Number of steps T.

    Returns
    -------
    Spread
        At k = 0..T.
    """
    n = system.num_states
    none = np.zeros((n, n))
    loop = system.A if gain is None else system.A + system.B @ gain
    step = np.block([[loop, np.eye(n)], [none, correlation * np.eye(n)]])
    fresh = np.block([[none, none], [none, (1.0 - correlation**2) * disturbance]])
    joint = np.empty((horizon + 1, 2 * n, 2 * n))
    joint[0] = np.block([[initial, none], [none, disturbance]])
    for k in range(horizon):
        propagated = step @ joint[k] @ step.T + fresh
        joint[k + 1] = 0.5 * (propagated + propagated.T)
    return Spread(joint)
