r"""What measurements tell of the factor by which all covariances may be wrong.

Where covariances were estimated from ν independent steps the true ones are
:math:`\nu / \chi^2_\nu` times those stated. Given disturbances in n independent directions, whose
squared deviations as stated sum to D, that law keeps its kind: the true ones are

.. math:: \frac{\nu + D}{\nu + n} \cdot \frac{\nu + n}{\chi^2_{\nu + n}}

times those stated (the factor's inverse is a gamma variable, of which disturbances are Gaussian).
What a sum of noise to come deviates by is then Student's t with ν + n degrees of freedom, in stated
deviations times the root of the first fraction.
"""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.records import dataclass

__all__ = ["Scale", "squares_of"]

_SINGULAR = 1e-12
"""Eigenvalue of a correlation matrix up to which there is no noise along its direction [-]."""

_STILL = 1e-20
"""Share of the largest variance up to which a coordinate has no noise [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Scale:
    """What is known of the factor by which stated covariances are to be multiplied.

    Attributes
    ----------
    samples : int or None
        Degrees of freedom: the independent steps that covariances were estimated from, and the
        independent directions in which disturbances were measured since. None is that covariances
        are known.
    factor : float or (S,) array
        Times the stated covariances, those that are estimated from all of this; one for each of
        S measurements [-].
    """

    samples: int | None
    factor: float | Vector = 1.0

    def learned(self, squares: float | Vector, components: int) -> Scale:
        """Return what is known once more has been measured.

        Parameters
        ----------
        squares : float or (S,) array
            Sum of squared deviations, in deviations as stated [-].
        components : int
            Of how many independent directions.
        """
        if self.samples is None or not components:
            return self
        total = self.samples + components
        return Scale(total, (self.samples * self.factor + squares) / total)

    def since(self, earlier: Scale) -> Scale:
        """Return the same for covariances as they were estimated earlier.

        Parameters
        ----------
        earlier : Scale
            By what is stated now: its factor is in the covariances already.
        """
        return self if self.samples is None else Scale(self.samples, self.factor / earlier.factor)


def squares_of(covariance: Matrix, deviations: Matrix) -> tuple[Vector, int]:
    """Return squared deviations summed over independent directions, and how many these are.

    Which directions have noise is told by the covariance alone, so that what is measured never
    decides what counts.

    Parameters
    ----------
    covariance : (q, q) array
        As stated.
    deviations : (S, q) array
        What was measured, less what was expected.

    Returns
    -------
    (S,) array and int
        ``eᵀ Σ⁻¹ e`` of each in the directions that have noise, and their number.
    """
    variances = np.diag(covariance)
    noisy = np.flatnonzero(variances > _STILL * variances.max(initial=0.0))
    spread = np.sqrt(variances[noisy])
    # In units of its own each coordinate counts alike, be it a place or a speed.
    values, vectors = np.linalg.eigh(covariance[np.ix_(noisy, noisy)] / np.outer(spread, spread))
    kept = values > _SINGULAR
    along = (deviations[:, noisy] / spread) @ vectors[:, kept]
    return np.square(along / np.sqrt(values[kept])).sum(axis=1), int(kept.sum())
