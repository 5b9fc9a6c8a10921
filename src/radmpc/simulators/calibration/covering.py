r"""Noise that explains missions, deviations and all.

What a step leaves unexplained, ``x⁺ − A x − B u``, is identified as from any log. That is not
enough to plan with: simulators lag and gust, their residuals are colored and depend on the
maneuver, and missions take noise that is new at every step. So the covariance is made larger twice.

1. White noise of :math:`W (1 + \rho) / (1 - \rho)` has at every frequency at least the power of
   noise of covariance W and autocorrelation ρ, so no linear feedback makes more of the latter.
2. The positions' deviations from the plan, as flown, are held against those that the noise leads
   to: W is multiplied by the largest ratio of the two, over all directions and steps. Of n missions
   in d directions the upper end of a variance's one-sided 95 % interval is taken,
   :math:`n d / \chi^2_{0.05}(n d)` times its estimate: few missions tell little.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import chdtri

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.identification.estimate import Estimate
from radmpc.identification.sharing import nearest_covariance
from radmpc.model.dynamics import covariances
from radmpc.model.vehicle import Vehicle
from radmpc.records import dataclass

__all__ = ["Cover", "Strays", "covering", "deviation_ratio", "white_covariance"]

_SURE = 0.95
"""How sure it is that the variance of deviations is not larger than what is planned with [-]."""

_LEAST = 1e-12
"""Variance [m², m²/s²] below which nothing is divided by it."""


@dataclass(frozen=True, slots=True, eq=False)
class Cover:
    """Noise of a group of vehicles that explains their missions.

    Attributes
    ----------
    vehicles : tuple of int
        Their places in the scenario.
    covariance : (n, n) array
        W, positions before velocities [m², m²/s²].
    drift : (n,) array or None
        What every step adds, likewise [m, m/s]; None is nothing beyond chance.
    color : float
        Autocorrelation of the residuals from step to step [-].
    ratio : float
        By which W was multiplied for the deviations, at least 1 [-].
    """

    vehicles: tuple[int, ...]
    covariance: Matrix
    drift: Vector | None
    color: float
    ratio: float


@dataclass(frozen=True, slots=True, eq=False)
class Strays:
    """How far one vehicle was from its plan.

    Attributes
    ----------
    number : int
        Its place in the scenario.
    vehicle : Vehicle
        For dynamics, feedback, start and the drift that was planned with.
    order : tuple of int
        Where positions, then velocities, stand in its state.
    deviations : (M, T+1, n) array
        From the plan's mean, flight by flight.
    """

    number: int
    vehicle: Vehicle
    order: tuple[int, ...]
    deviations: Tensor


def white_covariance(one: Estimate, drift: Vector | None) -> Matrix:
    """Return the covariance of white noise that leads to deviations at least as large, (n, n).

    Parameters
    ----------
    one : Estimate
        From commands; what looks like noise of measurement is a lag, for states are exact.
    drift : (n,) array or None
        What is planned with; the rest of its mean counts as noise.
    """
    rest = one.drift.value if drift is None else one.drift.value - drift
    rows = np.concatenate([piece for _, _, piece in one.noise]) + rest
    second = rows.T @ rows / max(len(rows) - 1, 1)
    color = max(one.color, 0.0)
    return nearest_covariance(second) * (1.0 + color) / (1.0 - color)


def covering(one: Estimate, strays: Sequence[Strays], drift: Vector | None) -> Cover:
    """Return noise that explains what was flown.

    Parameters
    ----------
    one : Estimate
        Of a group of vehicles.
    strays : sequence of Strays
        Of all of the group.
    drift : (n,) array or None
        What is planned with, positions before velocities; None is nothing.
    """
    white = white_covariance(one, drift)
    count = white.shape[0] // 2 * sum(len(stray.deviations) for stray in strays)
    ratio = max(1.0, deviation_ratio(strays, white, drift)) * count / float(chdtri(count, _SURE))
    return Cover(
        tuple(stray.number for stray in strays), ratio * white, drift, max(one.color, 0.0), ratio
    )


def deviation_ratio(strays: Sequence[Strays], covariance: Matrix, drift: Vector | None) -> float:
    """Return how much larger position deviations are than noise makes them, as a variance [-].

    Of few missions some direction always has more than its share. The largest eigenvalue of the
    covariance of n independent samples in d directions is about (1 + √(d/n))² where the truth is 1,
    by which the ratio is divided.

    Parameters
    ----------
    strays : sequence of Strays
        Of vehicles with the same noise.
    covariance : (n, n) array
        W of the noise, positions before velocities.
    drift : (n,) array or None
        What every step adds, likewise; None is nothing.

    Returns
    -------
    float
        Largest over steps and directions; at most 0 if the start alone explains everything.
    """
    scaled = np.mean([_scaled(stray, covariance, drift) for stray in strays], axis=0)
    count = sum(len(stray.deviations) for stray in strays)
    by_chance = (1.0 + np.sqrt(scaled.shape[-1] / count)) ** 2
    return float(np.linalg.eigvalsh(scaled)[:, -1].max()) / float(by_chance)


def _scaled(stray: Strays, covariance: Matrix, drift: Vector | None) -> Tensor:
    """Return covariances of positions at steps 1..T where noise would make them 1, (T, d, d)."""
    vehicle, missions, places = stray.vehicle, stray.deviations, np.argsort(stray.order)
    W = covariance[np.ix_(places, places)]
    extra = _extra(vehicle, None if drift is None else drift[places])
    horizon = missions.shape[1] - 1
    system, gain, none = vehicle.system, vehicle.gain, np.zeros_like(W)
    F = system.A if gain is None else system.A + system.B @ gain
    start = covariances(system, vehicle.initial_covariance, none, gain, horizon)
    noise = covariances(system, none, W, gain, horizon)
    axes, found, mean = list(system.position), [], np.zeros(len(F))
    for k in range(1, horizon + 1):
        mean = F @ mean + extra
        off = (missions[:, k] - mean)[:, axes]
        seen = off.T @ off / len(off) - start[k][np.ix_(axes, axes)]
        values, vectors = np.linalg.eigh(noise[k][np.ix_(axes, axes)])
        root = (vectors / np.sqrt(np.maximum(values, _LEAST))) @ vectors.T
        found.append(root @ seen @ root)
    return np.array(found)


def _extra(vehicle: Vehicle, drift: Vector | None) -> Vector:
    """Return what a step adds beyond what was planned with."""
    planned = np.zeros(vehicle.system.num_states) if vehicle.drift is None else vehicle.drift
    return -planned if drift is None else drift - planned
