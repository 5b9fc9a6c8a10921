"""Noise for problems that state none, and the feedback that holds it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix
from radmpc.importing.options import ImportOptions
from radmpc.importing.problem import ForeignVehicle
from radmpc.importing.rounding import rounded
from radmpc.model.dynamics import covariances, double_integrator
from radmpc.records import dataclass
from radmpc.rounding import rounded_up

__all__ = ["Noise", "choose_noise", "describe_feedback", "describe_noise"]

_LONG_HORIZON = 12
"""Steps up to which the noise stays small enough without feedback."""

_SPREAD = 0.2
"""Standard deviation of the position at the end that the noise is chosen for [radii]."""

_GAIN = (-0.3, -0.9)
"""Feedback on position and velocity, for steps of 1 s [1/s², 1/s]."""

_MOST_RESERVE = 0.25
"""Share of the control limit [-] that three standard deviations of the feedback may take."""


@dataclass(frozen=True, slots=True, eq=False)
class Noise:
    """One vehicle's noise and what holds it.

    Attributes
    ----------
    disturbance : (n, n) array
        Covariance of the disturbance of every step.
    gain : (m, n) array or None
        Feedback; None is open loop.
    std : float
        Standard deviation of the position noise per step and axis [m].
    final : float
        Standard deviation of the position at the end, per axis [m].
    """

    disturbance: Matrix
    gain: Matrix | None
    std: float
    final: float


def choose_noise(vehicle: ForeignVehicle, dt: float, horizon: int, options: ImportOptions) -> Noise:
    """Return the noise of the usual spread at the end, with feedback on long horizons.

    Parameters
    ----------
    vehicle : ForeignVehicle
        Whose radius and limits count.
    dt : float
        Step [s].
    horizon : int
        Number of steps.
    options : ImportOptions
        A standard deviation that is asked for.
    """
    system = double_integrator(dt, vehicle.start.size)
    d = system.dimension
    # Like the paper's at dt = 1 s: a tenth of the variance on the velocity.
    shape = np.diag([1.0] * d + [0.1 / dt**2] * d)
    gain: Matrix | None = None
    if horizon > _LONG_HORIZON:
        # Adding zero turns the -0.0 beside the diagonals into 0.0.
        gain = np.kron([[_GAIN[0] / dt**2, _GAIN[1] / dt]], np.eye(d)) + np.zeros((d, 2 * d))
    for candidate in (gain, None):
        growth = covariances(system, shape, shape, candidate, horizon)
        spread = float(np.sqrt(growth[-1, 0, 0]))
        std = options.noise or rounded_up(_SPREAD * vehicle.radius / spread, 3)
        if candidate is None:
            break
        effort = np.einsum("an,knm,am->ka", candidate, growth, candidate)
        # A step too short for the noise would leave the feedback no control to give.
        if 3.0 * std * np.sqrt(effort.max()) <= _MOST_RESERVE * vehicle.control_limit:
            break
    gain = None if candidate is None else rounded(candidate)
    return Noise(rounded(std**2 * shape), gain, std, std * spread)


def describe_noise(
    vehicles: Sequence[ForeignVehicle], noises: Sequence[Noise], options: ImportOptions
) -> str:
    """Return how large the noise is, in words.

    Parameters
    ----------
    vehicles : sequence of ForeignVehicle
        At least one.
    noises : sequence of Noise
        Theirs, in the same order.
    options : ImportOptions
        A standard deviation that is asked for.
    """
    stds = " or ".join(f"{std:g}" for std in sorted({noise.std for noise in noises}))
    spread = min(n.final / v.radius for v, n in zip(vehicles, noises, strict=True))
    asked = " (as asked)" if options.noise else ""
    return (
        f"standard deviation {stds} m{asked} in position per step and axis, on velocity times dt "
        f"a tenth of that variance; at the end {spread:.2g} radius"
    )


def describe_feedback(noises: Sequence[Noise], horizon: int) -> str:
    """Return what feedback there is, or why there is none, in words.

    Parameters
    ----------
    noises : sequence of Noise
        Of all vehicles.
    horizon : int
        Number of steps.
    """
    if any(noise.gain is not None for noise in noises):
        return f"gain {_GAIN[0]:g}/dt² on position, {_GAIN[1]:g}/dt on velocity"
    if horizon <= _LONG_HORIZON:
        return "none: the horizon is short"
    return f"none: it would need more than {_MOST_RESERVE:g} of the control limit in reserve"
