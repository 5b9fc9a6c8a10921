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

from typing import TYPE_CHECKING

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor
from radmpc.model.dynamics import LinearSystem
from radmpc.model.noise.measurement import Measurement
from radmpc.model.noise.shared import SharedDisturbance
from radmpc.model.noise.unlearned import surprised, unlearned
from radmpc.records import dataclass

if TYPE_CHECKING:
    from radmpc.model.noise.belief import Belief

__all__ = ["Chain", "Noise", "Spread"]
__all__ += ["chain_of", "known_rows", "learning", "spread_of", "stacked"]

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
    shared : tuple of SharedDisturbance
        What others meet, too, added to the disturbance.
    belief : Belief or None
        What is known at k = 0 in place of `initial`, measured there already.
    """

    initial: Matrix
    disturbance: Matrix
    correlation: float
    measurement: Measurement | None
    shared: tuple[SharedDisturbance, ...] = ()
    belief: Belief | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Spread:
    """Covariances of the deviation ``δ = x − x̄`` and of the disturbances that follow it.

    Attributes
    ----------
    mixing : (n, p) array
        What its own and shared disturbances, stacked, add to the state: ``[I, G_1, G_2, …]``.
    known : (T+1, n + p, n + p) array
        Of the estimate of all, stacked; of all where nothing is estimated.
    unknown : (T+1, n + p, n + p) array or None
        Of the estimate's error; None is none.
    """

    mixing: Matrix
    known: Tensor
    unknown: Tensor | None

    @property
    def num_states(self) -> int:
        """Length n of the state."""
        return len(self.mixing)

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
            N, of everything that is added to the state; None is 0.
        """
        whole, part = stacked(self.mixing, of_state, of_estimate, of_disturbance)
        found = whole @ self.known[steps] @ np.swapaxes(whole, -1, -2)
        if self.unknown is not None:
            found = found + part @ self.unknown[steps] @ np.swapaxes(part, -1, -2)
        return np.asarray(found)


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """A vehicle with everything that lasts: ξ holds deviation, own and shared disturbances.

    Attributes
    ----------
    mixing : (n, p) array
        See `Spread.mixing`.
    free, loop : (n + p, n + p) array
        What becomes of ξ without control, and of its estimate with feedback.
    initial, fresh : (n + p, n + p) array
        Covariance of ξ at k = 0, and of what is new at every step.
    """

    mixing: Matrix
    free: Matrix
    loop: Matrix
    initial: Matrix
    fresh: Matrix


def stacked(
    mixing: Matrix, of_state: Tensor, of_estimate: Tensor, of_disturbance: Tensor | None
) -> tuple[Tensor, Tensor]:
    """Return what ``M δ + L δ̂ + N w`` takes from ξ's estimate, and from the estimate's error.

    Parameters
    ----------
    mixing : (n, p) array
        See `Spread.mixing`.
    of_state, of_estimate, of_disturbance
        As in `Spread.of_sums`.
    """
    if of_disturbance is None:
        last = np.zeros((*of_state.shape[:-1], mixing.shape[1]))
    else:
        last = of_disturbance @ mixing
    return (
        np.concatenate([of_state + of_estimate, last], axis=-1),
        np.concatenate([of_state, last], axis=-1),
    )


def chain_of(system: LinearSystem, noise: Noise, gain: Matrix | None) -> Chain:
    """Return a vehicle with everything that lasts, as one linear system.

    Parameters
    ----------
    system : LinearSystem
        The dynamics.
    noise : Noise
        What shakes the vehicle.
    gain : (m, n) array or None
        Feedback K; None is open loop.
    """
    n = system.num_states
    mixing = np.hstack([np.eye(n), *(part.matrix for part in noise.shared)])
    sources = [(noise.disturbance, noise.correlation)]
    sources += [(part.covariance, part.correlation) for part in noise.shared]
    size = n + mixing.shape[1]
    free, initial, fresh = np.zeros((3, size, size))
    free[:n, :n], free[:n, n:] = system.A, mixing
    initial[:n, :n] = noise.initial
    at = n
    for covariance, rho in sources:
        own = slice(at, at + len(covariance))
        free[own, own] = rho * np.eye(len(covariance))
        initial[own, own] = covariance
        fresh[own, own] = (1.0 - rho**2) * covariance
        at = own.stop
    if noise.belief is not None:
        initial[: 2 * n, : 2 * n] = noise.belief.covariance
        if noise.belief.common is not None:
            rows, root = known_rows(noise), noise.belief.common
            initial[np.ix_(rows[2 * n :], rows[2 * n :])] = 0.0
            initial[np.ix_(rows, rows)] += root @ root.T
    loop = free.copy()
    if gain is not None:
        loop[:n, :n] += system.B @ gain
    return Chain(mixing, free, loop, initial, fresh)


def known_rows(noise: Noise) -> Indices:
    """Return where in ξ stands what is known together with others, (2 n + s,).

    Parameters
    ----------
    noise : Noise
        What shakes a vehicle.
    """
    end = 2 * len(noise.initial)
    rows = [np.arange(end)]
    for part in noise.shared:
        if part.correlation > 0.0:
            rows.append(np.arange(end, end + part.size))
        end += part.size
    return np.concatenate(rows)


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
    chain = chain_of(system, noise, gain)
    ahead, loop = chain.initial, chain.loop
    known = np.empty((horizon + 1, *ahead.shape))
    if noise.measurement is None:
        known[0] = ahead
        for k in range(horizon):
            known[k + 1] = _even(loop @ known[k] @ loop.T + chain.fresh)
        return Spread(chain.mixing, known, None)
    unknown = np.empty_like(known)
    before = np.zeros_like(ahead)
    for k in range(horizon + 1):
        if k == 0 and noise.belief is not None:
            learned = np.zeros_like(ahead)
        else:
            seen, gained = learning(noise.measurement, ahead)
            learned = gained @ seen
        unknown[k] = unlearned(ahead, learned)
        known[k] = _even(before + learned)
        before = loop @ known[k] @ loop.T
        ahead = _even(chain.free @ unknown[k] @ chain.free.T + chain.fresh)
    return Spread(chain.mixing, known, unknown)


def learning(measurement: Measurement, covariance: Matrix) -> tuple[Matrix, Matrix]:
    """Return what is measured, by its covariance with everything, and the filter's gain.

    Parameters
    ----------
    measurement : Measurement
        What is seen of the first part of ξ.
    covariance : (q, q) array
        Of what is not known of ξ.

    Returns
    -------
    (p, q) and (q, p) array
        Their product, the other way round, is what a measurement takes off the covariance.
    """
    n = measurement.matrix.shape[1]
    seen = measurement.matrix @ covariance[:n]
    surprise = surprised(measurement.matrix, covariance[:n, :n], measurement.covariance)
    return seen, np.asarray(seen.T @ np.linalg.pinv(surprise, _SINGULAR, hermitian=True))


def _even(matrix: Matrix) -> Matrix:
    """Return a matrix without what rounding did to its symmetry."""
    return np.asarray(0.5 * (matrix + matrix.T))
