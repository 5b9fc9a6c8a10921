"""Control saturation: a bound on its probability, and the part of a control that is cut off."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, TypeVar

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array

from radmpc.arrays import Matrix, Vector
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass
from radmpc.referee.claims.norms import allowed_beyond, norm_excess
from radmpc.referee.motion import FleetMotion
from radmpc.referee.tails import exceeding

if TYPE_CHECKING:
    from radmpc.referee.sampling import Sampler

__all__ = ["Cutoff", "cutoffs", "may_saturate", "saturation_bound"]

Flags = npt.NDArray[np.bool_]
_Limits = TypeVar("_Limits", float, Vector)

_LIMIT_TOL = 1e-6
"""What a nominal control may exceed its limit by, as solvers' tolerances let it: a share of limits
below one [-], and so much of larger ones [m/s²]. Limits of slow vehicles are less than that."""

_CERTAIN = 1e-12
"""Probability below which a vehicle is taken never to saturate in samples [-]."""


def saturation_bound(scenario: Scenario, motion: FleetMotion, controls: Sequence[Matrix]) -> Vector:
    """Return upper bounds on the probability that each vehicle's feedback ever saturates.

    By Boole's inequality over steps, axes, both limits and the norm, if any; the deviation is that
    of the control as asked for, which is the one flown until something saturates for the first
    time.

    Parameters
    ----------
    scenario : Scenario
        Gains and limits.
    motion : FleetMotion
        Covariances.
    controls : sequence of (T, m) array
        Nominal controls.

    Returns
    -------
    (N,) array
        At most 1 each; 0 without feedback.
    """
    bounds = np.zeros(scenario.num_vehicles)
    for i, vehicle in enumerate(scenario.vehicles):
        limit = vehicle.control_limit
        if vehicle.control_norm is not None:
            from radmpc.referee.claims.norms import saturation_of_norm  # noqa: PLC0415 - few have any

            seen = motion.seen[i][:-1]
            slack = _let_pass(vehicle.control_norm)
            bounds[i] = saturation_of_norm(vehicle, controls[i], seen, slack, motion.samples)
            # What exceeds the norm along an axis was counted.
            limit = np.where(vehicle.control_limit < vehicle.control_norm, limit, np.inf)
        if vehicle.gain is None:
            beyond = np.abs(controls[i]) > limit + _let_pass(vehicle.control_limit)
            bounds[i] = max(bounds[i], float(np.any(beyond)))
            continue
        variances = ((vehicle.gain @ motion.seen[i][:-1]) * vehicle.gain).sum(axis=2)
        spread = np.sqrt(variances.clip(min=0.0))
        noisy = spread > 0.0
        total = bounds[i]
        held = limit + allowed_beyond(spread, _let_pass(vehicle.control_limit))
        for room in (held - controls[i], held + controls[i]):
            tails = exceeding(room / np.where(noisy, spread, 1.0), motion.samples)
            total += float(np.where(noisy, tails, (room < 0.0).astype(np.float64)).sum())
        bounds[i] = min(total, 1.0)
    return bounds


def _let_pass(limit: _Limits) -> _Limits:
    """Return what nominal controls may exceed limits by."""
    return _LIMIT_TOL * np.minimum(limit, 1.0)  # type: ignore[no-any-return] # of the kind given


def may_saturate(bounds: Vector) -> Flags:
    """Return whose controls simulation has to watch, (N,) bool."""
    return np.asarray(bounds > _CERTAIN)


@dataclass(frozen=True, slots=True, eq=False)
class Cutoff:
    """The controls of one step that may saturate, as an autopilot cuts them off.

    Attributes
    ----------
    gains : sparse (R, width) array
        Rows of K: what the feedback asks for.
    lower, upper : (R,) array
        What it gets at least and at most, the nominal control taken off.
    pushes : sparse (width, R) array
        Columns of B: what a unit of control does to the state.
    discs : tuple of (slice, (m,) array, float)
        Controls of vehicles whose norm is limited, too: their rows, nominal control, limit.
    """

    gains: csr_array
    lower: Vector
    upper: Vector
    pushes: csr_array
    discs: tuple[tuple[slice, Vector, float], ...] = ()

    def excess(self, state: Matrix) -> Matrix | None:
        """Return what is asked for beyond what there is, (R, S); None where nothing is."""
        if not self.lower.size:
            return None
        asked = self.gains @ state
        held = np.clip(asked, self.lower[:, None], self.upper[:, None])
        over = asked - held
        for rows, nominal, limit in self.discs:
            over[rows] += norm_excess(held[rows] + nominal[:, None], limit)
        return over if over.any() else None


def cutoffs(
    scenario: Scenario,
    motion: FleetMotion,
    loose: Flags,
    controls: Sequence[Matrix],
    sampler: Sampler,
) -> tuple[Cutoff, ...]:
    """Return the cut-offs of all steps 0..T-1 for the vehicles that may saturate.

    Parameters
    ----------
    scenario : Scenario
        The plan's.
    motion : FleetMotion
        Of the fleet.
    loose : (N,) bool array
        Vehicles that may saturate.
    controls : sequence of (T, m) array
        Nominal controls of all vehicles.
    sampler : Sampler
        What draws their deviations.
    """
    chosen = [i for i in np.flatnonzero(loose).tolist() if scenario.vehicles[i].gain is not None]
    normed = []
    rows, columns, gains = [], [], [np.zeros(0)]
    pushed_rows, pushing, pushes = [], [], [np.zeros(0)]
    first = 0
    for i in chosen:
        vehicle = scenario.vehicles[i]
        m, n = vehicle.system.num_controls, vehicle.system.num_states
        if vehicle.control_norm is not None:
            normed.append(
                (i, slice(first, first + m), vehicle.control_norm + _let_pass(vehicle.control_norm))
            )
        seen = motion.seen_rows[i]
        own = np.repeat(np.arange(first, first + m), n)
        rows.append(own)
        columns.append(np.tile(sampler.starts[i] + seen + np.arange(n), m))
        gains.append(np.asarray(vehicle.gain).ravel())
        # An estimate takes the control into account as it was given.
        for at in {0, seen}:
            pushed_rows.append(np.tile(sampler.starts[i] + at + np.arange(n), m))
            pushing.append(own)
            pushes.append(vehicle.system.B.T.ravel())
        first += m
    none = np.zeros(0, dtype=np.int64)
    where = (np.concatenate([none, *rows]), np.concatenate([none, *columns]))
    asked = csr_array((np.concatenate(gains), where), shape=(first, sampler.width))
    where = (np.concatenate([none, *pushed_rows]), np.concatenate([none, *pushing]))
    pushed = csr_array((np.concatenate(pushes), where), shape=(sampler.width, first))
    found = []
    for k in range(scenario.horizon):
        limits = [scenario.vehicles[i].control_limit for i in chosen]
        limit = np.concatenate([np.zeros(0), *limits])
        limit += _let_pass(limit)
        nominal = np.concatenate([np.zeros(0), *(controls[i][k] for i in chosen)])
        discs = tuple((rows, controls[i][k], norm) for i, rows, norm in normed)
        found.append(Cutoff(asked, -limit - nominal, limit - nominal, pushed, discs))
    return tuple(found)
