"""Deviations of a whole fleet, seen along the normals of what is watched."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array

from radmpc.arrays import Indices, Matrix
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass
from radmpc.referee.motion import FleetMotion
from radmpc.referee.sampling import Sampler
from radmpc.referee.saturation import Cutoff
from radmpc.referee.simulation.watch import OBSTACLE, Watch

__all__ = ["FleetProjections", "Projections", "projections_of"]

Flags = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Projections:
    """What the rows of a window see of the stacked deviations.

    Attributes
    ----------
    own : sparse (M, width) array
        Component of the (relative) position along each row's normal.
    bent : sparse (M, width) array or None
        That of what feedback held over the window makes of it; None where nobody's path bends.
    held_back : sparse (M, R) array or None
        What controls that are cut off take back from it.
    """

    own: csr_array
    bent: csr_array | None
    held_back: csr_array | None

    def leaves(
        self, margins: Matrix, states: tuple[Matrix, Matrix], excess: Matrix | None
    ) -> Flags:
        """Return which rows' half-spaces are left in which samples, (M, S) bool.

        Parameters
        ----------
        margins : (M, E) array
            At the ends of the window [m].
        states : pair of (width, S) array
            Deviations at its begin and end.
        excess : (R, S) array or None
            Controls that were cut off in it.
        """
        here = self.own @ states[0]
        out = here < -margins[:, :1]
        if margins.shape[1] > 1:
            out |= self.own @ states[1] < -margins[:, -1:]
        if margins.shape[1] > 2 and self.bent is not None and self.held_back is not None:
            bent = self.bent @ states[0]
            if excess is not None:
                bent += self.held_back @ excess
            out |= bent < -margins[:, 1:2]
        return np.asarray(out)


@dataclass(frozen=True, slots=True, eq=False)
class FleetProjections:
    """From stacked deviations to positions, and to what controls add to them.

    Attributes
    ----------
    position_rows : (N, d) int array
        Where a vehicle's position stands among the deviations; negative where it is not drawn.
    selectors : sparse (N d, width) array
        Selects positions [-].
    bends : sparse (N d, width) array
        ``B_p K``.
    held_back : sparse (N d, R) array
        ``B_p`` for the controls that may be cut off.
    is_bent : bool
        Whether any path bends.
    track_starts : (O,) int array
        Where an obstacle's place stands among the deviations; negative where it is not drawn.
    """

    position_rows: Indices
    selectors: csr_array
    bends: csr_array
    held_back: csr_array
    is_bent: bool
    track_starts: Indices

    def onto(self, watch: Watch) -> Projections:
        """Return what the rows of a window see."""
        count, d = watch.normals.shape
        pair = np.flatnonzero(watch.are_pairs)
        rows = np.concatenate([np.repeat(np.arange(count), d), np.repeat(pair, d)])
        axes = np.arange(d)
        columns = np.concatenate(
            [
                (watch.first[:, None] * d + axes).ravel(),
                (watch.other[pair, None] * d + axes).ravel(),
            ]
        )
        values = np.concatenate([watch.normals.ravel(), -watch.normals[pair].ravel()])
        shape = (count, self.selectors.shape[0])
        normals = csr_array((values, (rows, columns)), shape=shape)
        own = csr_array(normals @ self.selectors)
        if self.track_starts.size:
            own = csr_array(own - self._of_tracks(watch))
        if not self.is_bent:
            return Projections(own, None, None)
        bent = csr_array(own - normals @ self.bends)
        return Projections(own, bent, csr_array(normals @ self.held_back))

    def _of_tracks(self, watch: Watch) -> csr_array:
        """Return what the rows of a window see of the obstacles' own deviations."""
        count, d = watch.normals.shape
        met = np.flatnonzero(watch.kinds == OBSTACLE)
        met = met[self.track_starts[watch.other[met]] >= 0]
        columns = self.track_starts[watch.other[met], None] + np.arange(d)
        where = np.repeat(met, d), columns.ravel()
        return csr_array(
            (watch.normals[met].ravel(), where), shape=(count, self.selectors.shape[1])
        )


def projections_of(
    scenario: Scenario, motion: FleetMotion, sampler: Sampler, cutoff: Cutoff
) -> FleetProjections:
    """Return the projections of a fleet whose deviations a sampler draws.

    Parameters
    ----------
    scenario : Scenario
        The plan's.
    motion : FleetMotion
        Of the fleet.
    sampler : Sampler
        What draws the deviations.
    cutoff : Cutoff
        Of any step: the vehicles that may saturate.
    """
    axes = np.array([v.system.position for v in scenario.vehicles])
    position_rows = sampler.starts[:, None] + axes
    count, d = axes.shape
    drawn = np.flatnonzero(np.repeat(sampler.starts >= 0, d))
    shape = (count * d, sampler.width)
    selectors = csr_array((np.ones(drawn.size), (drawn, position_rows.ravel()[drawn])), shape=shape)
    rows, columns = [np.zeros(0, dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
    values = [np.zeros(0)]
    straight = np.ones(count * d)
    for i, bend in enumerate(motion.bends):
        if not scenario.vehicles[i].system.is_double_integrator:
            straight[i * d : (i + 1) * d] = 0.0
        if bend is None or sampler.starts[i] < 0:
            continue
        n = bend.shape[1]
        rows.append(np.repeat(i * d + np.arange(d), n))
        columns.append(np.tile(sampler.starts[i] + np.arange(n), d))
        values.append(bend.ravel())
    where = (np.concatenate(rows), np.concatenate(columns))
    bends = csr_array((np.concatenate(values), where), shape=shape)
    # A control that is cut off takes back what it does to the position over the step.
    pushed = csr_array(selectors @ cutoff.pushes)
    held_back = csr_array(pushed.multiply(straight[:, None]))
    return FleetProjections(
        position_rows, selectors, bends, held_back, motion.is_bent, sampler.track_starts
    )
