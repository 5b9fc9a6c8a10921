"""Which controls may ask for more than there is, under feedback that nobody cuts off."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from radmpc.arrays import Matrix, Vector
from radmpc.model.scenario import Scenario
from radmpc.referee.collisions import Flags
from radmpc.referee.motion import FleetMotion
from radmpc.referee.sampling import Sampler

__all__ = ["Reserve", "reserves"]

_LIMIT_TOL = 1e-6
# Standard deviations of reserve beyond which nobody waits for saturation.
_CERTAIN = 8.0


@dataclass(frozen=True, slots=True, eq=False)
class Reserve:
    """The controls of one step that may saturate.

    Attributes
    ----------
    gains : sparse (R, width) array
        Rows of K.
    lower, upper : (R,) array
        What ``K (x − x̄)`` may be without saturation.
    always : bool
        Whether some nominal control is above its limit already.
    """

    gains: csr_array
    lower: Vector
    upper: Vector
    always: bool

    def exceeded(self, state: Matrix) -> Flags:
        """Return which samples ask for too much, (S,) bool."""
        if self.always or not self.lower.size:
            return np.full(state.shape[1], self.always)
        asked = self.gains @ state
        over = (asked > self.upper[:, None]) | (asked < self.lower[:, None])
        return np.asarray(np.any(over, axis=0))


def reserves(
    scenario: Scenario, motion: FleetMotion, controls: Sequence[Matrix], sampler: Sampler
) -> tuple[Reserve, ...]:
    """Return the reserves of all steps 0..T-1."""
    return tuple(_reserve(scenario, motion, controls, sampler, k) for k in range(scenario.horizon))


def _reserve(
    scenario: Scenario,
    motion: FleetMotion,
    controls: Sequence[Matrix],
    sampler: Sampler,
    step: int,
) -> Reserve:
    """Return the reserve of one step."""
    values: list[Vector] = [np.zeros(0)]
    columns = [np.zeros(0, dtype=np.int64)]
    sizes, lower, upper = [0], [np.zeros(0)], [np.zeros(0)]
    always = False
    for i, vehicle in enumerate(scenario.vehicles):
        nominal, limit = controls[i][step], vehicle.control_limit + _LIMIT_TOL
        always = always or bool(np.any(np.abs(nominal) > limit))
        if vehicle.gain is None:
            continue
        spread = ((vehicle.gain @ motion.covariances[i][step]) * vehicle.gain).sum(axis=1)
        near = np.flatnonzero(limit - np.abs(nominal) <= _CERTAIN * np.sqrt(spread.clip(min=0.0)))
        n = vehicle.system.num_states
        values.append(vehicle.gain[near].ravel())
        columns.append(np.tile(sampler.starts[i] + np.arange(n), near.size))
        sizes += [n] * near.size
        lower.append(-limit[near] - nominal[near])
        upper.append(limit[near] - nominal[near])
    gains = csr_array(
        (np.concatenate(values), np.concatenate(columns), np.cumsum(sizes)),
        shape=(len(sizes) - 1, sampler.width),
    )
    return Reserve(gains, np.concatenate(lower), np.concatenate(upper), always)
