r"""Process and measurement noise told apart by how residuals follow each other.

With states measured as :math:`x_k + m_k`, what the dynamics leave unexplained is
:math:`w_k + m_{k+1} - A m_k`: white disturbances have the same power at all frequencies, those with
memory most of it at low ones, measurement noise where the state changes its direction every step.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import chdtrc, chdtri

from radmpc.arrays import Matrix
from radmpc.identification.intervals import LEVEL, Interval
from radmpc.identification.least_squares.regression import Fit
from radmpc.identification.model import StepModel
from radmpc.identification.spectral.mixture import Mixture
from radmpc.identification.spectral.spectra import LEAST_RUN
from radmpc.identification.whiteness import whitened
from radmpc.records import dataclass, replace

__all__ = ["Measured", "measured_noise", "with_memory"]

_LAGS = 5
"""Steps over which residuals are looked at for being white."""

_DOUBT = 0.01
"""Probability [-] of such correlations of white residuals below which they are not."""

_SIGN = 1.64
"""Standard deviations [-] of a variance that are a sign of measurement noise: what is small
and not noticed would make the time constant too short, what is looked for in vain makes
intervals wider only."""


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """Disturbance and measurement noise.

    Attributes
    ----------
    disturbance, measurement : Interval
        Their covariances W and R, (n, n).
    color : Interval or None
        Autocorrelation of the disturbance from step to step [-]; None if it is white.
    """

    disturbance: Interval
    measurement: Interval
    color: Interval | None

    def time_constant(self, dt: float) -> Interval | None:
        """Return the time constant of the disturbance [s], None if it is white.

        Parameters
        ----------
        dt : float
            Step [s].
        """
        if self.color is None:
            return None
        parts = (self.color.value, self.color.low, self.color.high)
        return Interval(*(np.asarray(-dt / np.log(part)) for part in parts))


def measured_noise(
    pieces: Sequence[Matrix],
    offsets: Sequence[Matrix | None],
    model: StepModel,
    repeated: float = 1.0,
) -> Measured | None:
    """Return disturbance and measurement noise where there is a sign of the latter.

    Parameters
    ----------
    pieces : sequence of (k, n) array
        Residuals with mean zero, a piece per run without a gap.
    offsets : sequence of (k, d) array or None
        For each piece the first sensor less the second at the beginning of every step [m]; None
        where there was no second one.
    model : StepModel
        Dynamics.
    repeated : float
        How many times vehicles tell the same [-].
    """
    known = [offset for offset in offsets if offset is not None]
    has_second = bool(known) and len(known) == len(offsets)
    if not has_second and _whiteness(pieces, repeated) >= _DOUBT:
        return None
    if has_second:
        mean = np.concatenate(known).mean(axis=0)
        pieces = [np.hstack([y, o - mean]) for y, o in zip(pieces, known, strict=True)]
    runs = [piece for piece in pieces if len(piece) >= LEAST_RUN]
    if not runs:
        return None
    mixture = Mixture(runs, model, repeated)
    white = mixture.at(0.0)
    best = mixture.best()
    # By either likelihood: where one covariance is nearly none, one of them says too much.
    gain = min(best.value - white.value, best.peak - white.peak)
    has_memory = 2.0 * gain > float(chdtri(1.0, 1.0 - LEVEL)) * white.loss
    found = best if has_memory else white
    if not np.any(mixture.scores(found) > _SIGN):
        return None
    return Measured(*mixture.intervals(found, has_memory=has_memory))


def with_memory(found: Fit, measured: Measured) -> Fit:
    """Return a fit whose drift is as unsure as the memory of the disturbance leaves it.

    Parameters
    ----------
    found : Fit
        Without memory.
    measured : Measured
        What residuals are made of.
    """
    if measured.color is None:
        return found
    color, variances = float(measured.color.value), np.diag(measured.disturbance.value)
    lasting = variances * (1.0 + color) / (1.0 - color) / len(found.noise)
    return replace(
        found, color=color, drift_deviation=np.hypot(found.drift_deviation, lasting**0.5)
    )


def _whiteness(pieces: Sequence[Matrix], repeated: float) -> float:
    """Return the chance of such correlations over a few steps of white residuals."""
    white = whitened(np.concatenate(pieces))
    ends = np.cumsum([len(piece) for piece in pieces])[:-1]
    parts = np.split(white, ends)
    statistic, freedom = 0.0, 0
    for lag in range(1, _LAGS + 1):
        pairs = sum(max(len(part) - lag, 0) for part in parts)
        if not pairs or not white.size:
            continue
        products = sum(part[lag:].T @ part[:-lag] for part in parts if len(part) > lag)
        statistic += float(np.sum(np.square(products))) / pairs
        freedom += white.shape[1] ** 2
    return float(chdtrc(freedom, statistic / repeated)) if freedom else 1.0
