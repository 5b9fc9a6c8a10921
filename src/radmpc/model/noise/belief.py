r"""What has been learned of a vehicle by the step at which a plan begins.

Under way a vehicle's disturbances have been seen, as far as its state has: of one that lasts, part
is expected to go on. The steps that are left of a mission begin with that.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Frozen, Matrix, Vector, as_covariance, as_matrix, as_vector
from radmpc.model.noise.shared import SharedDisturbance, lasting_parts
from radmpc.records import dataclass

__all__ = ["Belief"]

_MOST = 1e40
"""Largest covariance: what was allowed at the beginning, after all growth that is."""


@dataclass(frozen=True, slots=True, eq=False)
class Belief(Frozen):
    """What is known at k = 0, everything measured there included.

    Attributes
    ----------
    disturbance : (n,) array
        Mean of the vehicle's own disturbance over the first step.
    covariance : (2 n, 2 n) array
        Of the state at k = 0 and the disturbance over the first step, stacked, about their means;
        of a vehicle that others tell of, what comes on top of `common`.
    lasting : (s,) array or None
        Means over the first step of the shared disturbances that last, stacked; None is 0.
    common : (2 n + s, E) array or None
        What E standard normals, the same for all vehicles of a scenario, make of the state, the
        vehicle's own disturbance and the shared ones that last, stacked; None where no others tell
        of the vehicle.
    """

    disturbance: Vector
    covariance: Matrix
    lasting: Vector | None = None
    common: Matrix | None = None

    if TYPE_CHECKING:  # what it takes is wider than what it holds

        def __init__(
            self,
            disturbance: npt.ArrayLike,
            covariance: npt.ArrayLike,
            lasting: npt.ArrayLike | None = None,
            common: npt.ArrayLike | None = None,
        ) -> None: ...

    def __post_init__(self) -> None:
        """Freeze the arrays."""
        mean = as_vector(self.disturbance, path=("belief", "disturbance"))
        object.__setattr__(self, "disturbance", mean)
        covariance = as_covariance(self.covariance, 2 * mean.size, ("belief", "covariance"), _MOST)
        object.__setattr__(self, "covariance", covariance)
        if self.lasting is not None:
            lasting = as_vector(self.lasting, path=("belief", "lasting"))
            object.__setattr__(self, "lasting", lasting)
        if self.common is not None:
            size = 2 * mean.size + (0 if self.lasting is None else self.lasting.size)
            common = as_matrix(self.common, (size, None), ("belief", "common"))
            object.__setattr__(self, "common", common)

    def pushes(
        self,
        noise: tuple[float, Sequence[SharedDisturbance]],
        drift: Vector | None,
        horizon: int,
    ) -> Matrix | Vector | None:
        """Return what steps add to the mean besides control.

        Parameters
        ----------
        noise : tuple of float and sequence of SharedDisturbance
            Correlation of the vehicle's own disturbance at consecutive steps [-], and what it
            shares.
        drift : (n,) array or None
            What every step adds.
        horizon : int
            Number of steps T.

        Returns
        -------
        (n,) or (T, n) array or None
            The same at every step, or one row each; None is nothing.
        """
        (correlation, shared), steps = noise, np.arange(horizon)
        expected: list[Matrix] = []
        if correlation and self.disturbance.any():
            expected.append((correlation**steps)[:, None] * self.disturbance)
        start, lasting = 0, self.lasting
        if lasting is not None and lasting.any():
            for part in lasting_parts(shared):
                mean = part.matrix @ lasting[start : start + part.size]
                expected.append((part.correlation**steps)[:, None] * mean)
                start += part.size
        if not expected:
            return drift
        total = sum(expected[1:], expected[0])
        return total if drift is None else total + drift
