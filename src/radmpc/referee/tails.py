r"""The referee's own tails: Gaussian, or Student's where covariances are known up to a factor only.

If all covariances were estimated from ν independent steps, the true ones are
:math:`\nu / \chi^2_\nu` times those stated. What a sum of noise deviates by, in deviations as
stated, is then Student's t with ν degrees of freedom: the Gaussian mixed over that factor.
"""

from __future__ import annotations

import numpy as np
from scipy.special import ndtr, stdtr, stdtrit

from radmpc.arrays import Tensor

__all__ = ["cutoff_of", "exceeding"]

_CUTOFF = 9.0
"""Distance from which an encounter is far [standard deviations]."""

_CUTOFF_RISK = 1e-13
"""Risk of one half-space from which it is far where tails fall slowly [-]."""


def exceeding(levels: Tensor, samples: int | None) -> Tensor:
    """Return the probability that deviations exceed levels.

    Parameters
    ----------
    levels : array
        In standard deviations as stated, ±inf allowed.
    samples : int or None
        Independent steps ν that covariances were estimated from; None is that they are known.
    """
    found = ndtr(-levels) if samples is None else stdtr(float(samples), -levels)
    return np.asarray(found, dtype=np.float64)


def cutoff_of(samples: int | None) -> tuple[float, float]:
    """Return from what distance an encounter is far, and the risk of one half-space there.

    Parameters
    ----------
    samples : int or None
        As in `exceeding`.

    Returns
    -------
    tuple of float
        In standard deviations, and a probability.
    """
    if samples is None:
        return _CUTOFF, float(ndtr(-_CUTOFF))
    # Twice what is asked for: the inverse is not exact.
    distance = max(_CUTOFF, -float(stdtrit(float(samples), _CUTOFF_RISK)))
    return distance, 2.0 * float(exceeding(np.array(distance), samples))
