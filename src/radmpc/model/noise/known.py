r"""What has been learned of a vehicle by the step at which a plan begins.

Under way a vehicle's disturbances have been seen, as far as its state has: of one that lasts, part
is expected to go on. The steps that are left of a mission begin with that.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Frozen, Matrix, Vector, as_covariance, as_vector
from radmpc.records import dataclass

__all__ = ["Known"]


@dataclass(frozen=True, slots=True, eq=False)
class Known(Frozen):
    """What is known at k = 0, everything measured there included.

    Attributes
    ----------
    disturbance : (n,) array
        Mean of the vehicle's own disturbance over the first step.
    covariance : (2 n, 2 n) array
        Of the state at k = 0 and the disturbance over the first step, stacked, about their means.
    """

    disturbance: Vector
    covariance: Matrix

    if TYPE_CHECKING:  # what it takes is wider than what it holds

        def __init__(self, disturbance: npt.ArrayLike, covariance: npt.ArrayLike) -> None: ...

    def __post_init__(self) -> None:
        """Freeze the arrays."""
        mean = as_vector(self.disturbance, path=("known", "disturbance"))
        object.__setattr__(self, "disturbance", mean)
        covariance = as_covariance(self.covariance, 2 * mean.size, ("known", "covariance"))
        object.__setattr__(self, "covariance", covariance)

    def pushes(
        self, correlation: float, drift: Vector | None, horizon: int
    ) -> Matrix | Vector | None:
        """Return what steps add to the mean besides control.

        Parameters
        ----------
        correlation : float
            Of the disturbance at consecutive steps [-].
        drift : (n,) array or None
            What every step adds.
        horizon : int
            Number of steps T.

        Returns
        -------
        (n,) or (T, n) array or None
            The same at every step, or one row each; None is nothing.
        """
        if not correlation or not self.disturbance.any():
            return drift
        expected: Matrix = (correlation ** np.arange(horizon))[:, None] * self.disturbance
        return expected if drift is None else expected + drift
