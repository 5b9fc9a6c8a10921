r"""What pushes bodies about: Ornstein-Uhlenbeck processes, exact at any step.

.. math:: g(t + h) = e^{-h/\tau} g(t) + \sigma \sqrt{1 - e^{-2h/\tau}}\; \epsilon

has the deviation σ and the time constant τ from the first sample on, however long h is.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Matrix

__all__ = ["Gusts"]


class Gusts:
    """Independent gusts, stationary from the start.

    Parameters
    ----------
    deviations : (N, p) array
        σ of every component, in its own unit.
    time_constant : float
        τ, above 0 [s].
    rng : Generator
        Source of all draws.
    """

    def __init__(
        self, deviations: npt.ArrayLike, time_constant: float, rng: np.random.Generator
    ) -> None:
        self._deviations = np.asarray(deviations, dtype=np.float64)
        self._time_constant = time_constant
        self._rng = rng
        self.values: Matrix = self._drawn()

    def reset(self) -> None:
        """Draw anew."""
        self.values = self._drawn()

    def advance(self, seconds: float) -> Matrix:
        """Return the gusts after some time, (N, p).

        Parameters
        ----------
        seconds : float
            Since they were last asked for, at least 0 [s].
        """
        kept = math.exp(-seconds / self._time_constant)
        self.values = kept * self.values + math.sqrt(1.0 - kept**2) * self._drawn()
        return self.values

    def _drawn(self) -> Matrix:
        """Return independent draws."""
        return self._deviations * self._rng.standard_normal(self._deviations.shape)
