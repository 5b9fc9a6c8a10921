"""What feedback keeps back of the control limit, and how likely it asks for more than is left."""

from __future__ import annotations

from math import erfc, sqrt

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.model.vehicle import Vehicle
from radmpc.records import dataclass

__all__ = ["Reserve", "expected_saturation", "reserve_of", "tails"]


@dataclass(frozen=True, slots=True)
class Reserve:
    """Where feedback keeps back the largest share of a control limit.

    Attributes
    ----------
    share : float
        Of the limit [-]; above 1 nothing is left to steer with.
    kept, limit : float
        What is kept back, and the limit itself [m/s² for a double integrator].
    axis, step : int
        The control and the step.
    """

    share: float
    kept: float
    limit: float
    axis: int
    step: int


def reserve_of(vehicle: Vehicle, bounds: Matrix) -> Reserve:
    """Return where feedback keeps back the most.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    bounds : (T, m) array
        What its feedback leaves for the nominal control, see `Vehicle.control_bounds`.

    Returns
    -------
    Reserve
        Nothing, at step 0, without feedback.
    """
    kept = vehicle.control_limit - bounds
    shares = kept / vehicle.control_limit
    step, axis = (int(k) for k in np.unravel_index(shares.argmax(), shares.shape))
    return Reserve(
        float(shares[step, axis]),
        float(kept[step, axis]),
        float(vehicle.control_limit[axis]),
        axis,
        step,
    )


def expected_saturation(
    vehicle: Vehicle, covariances: Tensor, controls: Matrix, samples: int | None = None
) -> float:
    """Return how likely feedback asks for more than given nominal controls leave.

    By Boole's inequality over steps, axes and both limits, as the certificate's own bound.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    covariances : (T+1, n, n) array
        State covariances; where it measures, feedback acts on the estimate, and its own count.
    controls : (T, m) array
        Nominal controls, of either sign.
    samples : int or None
        Independent steps that covariances were estimated from; None is that they are known.

    Returns
    -------
    float
        At most 1; 0 without feedback.
    """
    if vehicle.gain is None:
        return 0.0
    if vehicle.measurement is not None:
        covariances = vehicle.spread(len(covariances) - 1).estimates
    variances = np.einsum("an,knm,am->ka", vehicle.gain, covariances[:-1], vehicle.gain)
    spread = np.sqrt(np.maximum(variances, 0.0))
    noisy = spread > 0.0
    total = 0.0
    for side in (controls, -controls):
        left = (vehicle.control_limit - side)[noisy]
        total += float(tails(left / spread[noisy], samples).sum())
    return min(total, 1.0)


def tails(clearances: Vector, samples: int | None = None) -> Vector:
    """Return the tails beyond clearances: Gaussian, or Student's.

    Parameters
    ----------
    clearances : (n,) array
        In standard deviations.
    samples : int or None
        Independent steps that covariances were estimated from; None is that they are known.

    Returns
    -------
    (n,) array
        Probabilities. From Python's own error function: scipy's takes as long to load as all else
        of a check.
    """
    if samples is not None:
        from radmpc.gaussian import Tail  # noqa: PLC0415 - loads scipy; few need it

        return Tail(samples).probability(clearances)
    return np.array([0.5 * erfc(q / sqrt(2.0)) for q in clearances.tolist()])
