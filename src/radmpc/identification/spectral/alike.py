r"""Whether spectra of several vehicles' residuals are those of the same noise.

Rao's score test: at what is the likeliest for all vehicles together, the gradient of each one's own
log-likelihood is chance if they are alike. Unlike covariances fitted to every vehicle, of which
one often hides the other, gradients are nearly normal however little a vehicle tells, and whether
or not measurement noise was noticed in it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import chdtrc

from radmpc.arrays import Matrix, Vector
from radmpc.identification.model import StepModel
from radmpc.identification.segments import moving_axes
from radmpc.identification.spectral.mixture import Mixture
from radmpc.identification.spectral.spectra import LEAST_RUN
from radmpc.records import replace

__all__ = ["chance_of_spectra"]


def chance_of_spectra(
    vehicles: Sequence[Sequence[Matrix]], model: StepModel, color: float, looseness: float
) -> float:
    """Return the chance of such spectra if all vehicles have the same disturbance and sensors.

    Parameters
    ----------
    vehicles : sequence of sequence of (k, n) array
        Residuals with mean zero of every vehicle, a piece per run without a gap.
    model : StepModel
        Their dynamics.
    color : float
        Autocorrelation of the disturbance from step to step [-].
    looseness : float
        By how much heavy tails make variances of products larger than Gaussian ones [-].

    Returns
    -------
    float
        1 where fewer than two vehicles have runs that are long enough.
    """
    runs = [[piece for piece in pieces if len(piece) >= LEAST_RUN] for pieces in vehicles]
    runs = [pieces for pieces in runs if pieces]
    if len(runs) < 2:
        return 1.0
    axes = moving_axes(np.concatenate([piece for pieces in runs for piece in pieces]), model)
    states = model.states_along(axes)
    runs = [[piece[:, states] for piece in pieces] for pieces in runs]
    every = [piece for pieces in runs for piece in pieces]
    mixture = Mixture(every, replace(model, dimension=len(axes)))
    together = mixture.at(color)
    total, size = np.zeros_like(together.entries), np.zeros(2 * together.entries.shape)
    statistic, losses = 0.0, []
    for pieces in runs:
        own = mixture.part(together, pieces)
        gradient, information = own.slopes(together.entries)
        statistic += _square(gradient, information)
        total, size = total + gradient, size + information
        losses.append(own.seen.loss)
    statistic -= _square(total, size)
    scale = looseness * float(np.mean(losses))
    return float(chdtrc((len(runs) - 1) * total.size, max(statistic / scale, 0.0)))


def _square(gradient: Vector, information: Matrix) -> float:
    """Return a gradient's square in units of its covariance."""
    # With a unit diagonal a pseudo-inverse does not take small entries for rounding.
    scale = np.sqrt(np.maximum(np.diag(information), 1e-300))
    inverse = np.linalg.pinv(information / np.outer(scale, scale), hermitian=True)
    return float(gradient / scale @ inverse @ (gradient / scale))
