r"""How a vehicle answers a disturbance that others meet, too.

A shared disturbance d is made of standard normals e that are the same for everyone: those of its
first value, and those that are new at each step. All that happens is linear in them, so a vehicle's
deviation holds a part :math:`R_i e`, with a matrix that follows from the vehicle alone; and two
vehicles have the covariance

.. math:: \Sigma_{ij} = R_i R_j^\top, \qquad
    \operatorname{cov}(p_i - p_j) = \Sigma_i + \Sigma_j - \Sigma_{ij} - \Sigma_{ij}^\top.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor
from radmpc.model.dynamics import LinearSystem
from radmpc.model.noise.shared import SharedDisturbance
from radmpc.model.noise.spread import Chain, Noise, chain_of, known_rows, learning, stacked
from radmpc.model.noise.unlearned import unlearned
from radmpc.records import dataclass

__all__ = ["Response", "response_of"]

_LEARNED = "\0"
"""Name of what was learned by all vehicles before k = 0: sources are never called that."""


@dataclass(frozen=True, slots=True, eq=False)
class Response:
    """What the normals behind shared disturbances make of a vehicle.

    Attributes
    ----------
    mixing : (n, p) array
        See `Spread.mixing`.
    columns : mapping of str to slice
        Those of each source, r (T + 1) of them, the first values' before the steps'; and those by
        which first values are known together.
    known : (T+1, n + p, E) array
        What they make of the estimate of deviation and disturbances, stacked.
    unknown : (T+1, n + p, E) array or None
        What they make of the estimate's error; None is nothing.
    """

    mixing: Matrix
    columns: Mapping[str, slice]
    known: Tensor
    unknown: Tensor | None

    def of_sums(
        self,
        steps: Indices | slice,
        of_state: Tensor,
        of_estimate: Tensor,
        of_disturbance: Tensor | None = None,
    ) -> Tensor:
        """Return what the normals make of ``M δ + L δ̂ + N w`` at some steps, (k, r, E).

        Parameters
        ----------
        steps, of_state, of_estimate, of_disturbance
            As in `Spread.of_sums`.
        """
        whole, part = stacked(self.mixing, of_state, of_estimate, of_disturbance)
        found = whole @ self.known[steps]
        return np.asarray(found if self.unknown is None else found + part @ self.unknown[steps])


def response_of(system: LinearSystem, noise: Noise, gain: Matrix | None, horizon: int) -> Response:
    """Return how a vehicle answers the disturbances that it shares.

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
    """
    chain = chain_of(system, noise, gain)
    pushes, columns = _pushes(noise, len(chain.free), horizon)
    known = np.empty((horizon + 1, *pushes.shape[1:]))
    if noise.measurement is None:
        known[0] = pushes[0]
        for k in range(horizon):
            known[k + 1] = chain.loop @ known[k] + pushes[k + 1]
        return Response(chain.mixing, columns, known, None)
    unknown = np.empty_like(known)
    carried, coming = np.zeros_like(pushes[0]), pushes[0]
    for k, learned in enumerate(_learned(chain, noise, horizon)):
        told = learned @ coming
        known[k], unknown[k] = carried + told, coming - told
        carried = chain.loop @ known[k]
        if k < horizon:
            coming = chain.free @ unknown[k] + pushes[k + 1]
    return Response(chain.mixing, columns, known, unknown)


def _pushes(noise: Noise, size: int, horizon: int) -> tuple[Tensor, dict[str, slice]]:
    """Return what the normals add to everything at k = 0 and in each step, (T+1, size, E)."""
    shared: tuple[SharedDisturbance, ...] = noise.shared
    learned = None if noise.belief is None else noise.belief.common
    total = sum(part.size for part in shared) * (horizon + 1)
    more = 0 if learned is None else learned.shape[1]
    pushes = np.zeros((horizon + 1, size, total + more))
    columns: dict[str, slice] = {}
    row, column = size - sum(part.size for part in shared), 0
    for part in shared:
        values, vectors = np.linalg.eigh(part.covariance)
        root = vectors * np.sqrt(values.clip(min=0.0))
        fresh = np.sqrt(1.0 - part.correlation**2) * root
        rows, begin = slice(row, row + part.size), column
        for k in range(horizon + 1):
            pushes[k, rows, column : column + part.size] = fresh if k else root
            column += part.size
        if learned is not None and part.correlation > 0.0:
            pushes[0, rows] = 0.0
        columns[part.name] = slice(begin, column)
        row += part.size
    if learned is not None:
        columns[_LEARNED] = slice(total, total + more)
        pushes[0, known_rows(noise), total:] = learned
    return pushes, columns


def _learned(chain: Chain, noise: Noise, horizon: int) -> list[Matrix]:
    """Return what a filter makes of surprises in everything, at k = 0..T."""
    if noise.measurement is None:
        return []
    n = noise.measurement.matrix.shape[1]
    ahead, found = chain.initial, []
    for k in range(horizon + 1):
        seen, gained = learning(noise.measurement, ahead)
        if k == 0 and noise.belief is not None:
            gained = np.zeros_like(gained)
        whole = np.zeros_like(ahead)
        whole[:, :n] = gained @ noise.measurement.matrix
        found.append(whole)
        left = chain.free @ unlearned(ahead, gained @ seen) @ chain.free.T
        ahead = 0.5 * (left + left.T) + chain.fresh
    return found
