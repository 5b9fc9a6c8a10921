"""An approximate model of the effort of displacements from step to step, axis by axis."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Vector
from radmpc.program.condensed import CondensedModel
from radmpc.records import dataclass

__all__ = ["Motion"]

_INF = np.float32(1e9)
"""Cost of what no control does: large beside any plan's, and finite when summed over a path."""

Cells = npt.NDArray[np.int64]
Float32 = npt.NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """Displacements ``d⁺ = decay · d + drift + gain · u`` per axis.

    Attributes
    ----------
    decay : (2,) array
        1 for a double integrator, 0 for a single one.
    gain : (2,) array
        Meters per unit of control.
    drift : (2,) array
        What a displacement gains without control [m]: all that a current carries where it decays at
        once, nothing where it lasts.
    first : (2,) array
        First displacement without control [m].
    longest : (2,) array
        Longest displacement [m].
    most : (2,) array
        Largest control.
    weight : float
        Cost of a unit of control.
    """

    decay: Vector
    gain: Vector
    drift: Vector
    first: Vector
    longest: Vector
    most: Vector
    weight: float

    @classmethod
    def of(cls, model: CondensedModel) -> Motion:
        """Read the motion off a vehicle's dynamics and reach."""
        system = model.vehicle.system
        place = list(system.position)
        reply = [np.abs(system.B[place]).sum(axis=1)]
        power = system.B
        for _ in range(2):
            further = system.A @ power
            reply.append(np.abs((further - power)[place]).sum(axis=1))
            power = further
        coasts = reply[1] > 1e-9
        gain = np.where(coasts, reply[1], reply[0])
        decay = np.where(coasts, np.minimum(reply[2] / np.where(coasts, reply[1], 1.0), 1.0), 0.0)
        carried = np.zeros(len(place))
        if model.vehicle.drift is not None:
            c = model.vehicle.drift
            carried = (system.A @ c)[place] - decay * c[place]
        rise = np.diff(model.reach_upper, axis=0).max(axis=0)
        fall = -np.diff(model.reach_lower, axis=0).min(axis=0)
        longest = np.maximum(rise, fall)
        most = np.full(len(place), float(model.control_bounds.max(initial=0.0)))
        first = np.diff(model.drift_position[:2], axis=0)[0]
        return cls(decay, gain, carried, first, longest, most, float(model.vehicle.cost_weight))

    @property
    def is_planar(self) -> bool:
        """Whether it is in the plane, and moves at all."""
        return (
            self.gain.size == 2
            and bool(np.all(self.gain > 1e-9))
            and bool(np.all(np.isfinite(self.longest) & (self.longest > 1e-6)))
        )

    @property
    def start_cost(self) -> float:
        """Effort that takes a vehicle at rest to its longest displacement, along all axes."""
        return self.weight * float((self.longest / self.gain).sum())

    def first_costs(self, middle: Vector, stride: Vector, count: int) -> Float32:
        """Return the effort of every first displacement, a square around a middle one.

        Parameters
        ----------
        middle : (2,) array
            The middle one [m].
        stride : (2,) array
            Size of a cell [m].
        count : int
            Cells on each side of the middle.

        Returns
        -------
        (2 count + 1, 2 count + 1) array
            Costs.
        """
        around = np.arange(-count, count + 1)
        costs = [
            self.weight * np.abs(middle[a] + around * stride[a] - self.first[a]) / self.gain[a]
            for a in (0, 1)
        ]
        return np.asarray(costs[0][:, None] + costs[1][None, :], dtype=np.float32)

    def change_costs(
        self,
        before: npt.NDArray[np.int64],
        after: npt.NDArray[np.int64],
        stride: Vector,
        count: int,
    ) -> tuple[Float32, Float32]:
        """Return per axis the effort from one displacement to the next, [next, last].

        Parameters
        ----------
        before, after : (2,) int array
            The middle displacements, in cells.
        stride : (2,) array
            Size of a cell [m].
        count : int
            Cells on each side of the middle.

        Returns
        -------
        pair of (2 count + 1, 2 count + 1) array
            Very large where no control does it.
        """
        around = np.arange(-count, count + 1)
        tables = []
        for axis in (0, 1):
            last = stride[axis] * (before[axis] + around)
            following = stride[axis] * (after[axis] + around)
            coasted = self.decay[axis] * last + self.drift[axis]
            control = np.abs(following[:, None] - coasted[None, :])
            control = np.maximum(control - 1e-9, 0.0) / self.gain[axis]
            table = (self.weight * control).astype(np.float32)
            table[control > self.most[axis] + 0.5 * stride[axis] / self.gain[axis]] = _INF
            tables.append(table)
        return tables[0], tables[1]
