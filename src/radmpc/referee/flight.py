"""One chunk of flights: draw deviations, find the few that matter, test those exactly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.errors import NoPlanError, ScenarioError
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.referee.claims import shape_problems
from radmpc.referee.collisions import Flags, leaves_workspace, meets_origin, meets_solid
from radmpc.referee.motion import FleetMotion, propagate
from radmpc.referee.sampling import Sampler
from radmpc.referee.saturation import Reserve, reserves
from radmpc.referee.sweep import SweepPart, resting, swept
from radmpc.referee.watch import OBSTACLE, PAIR, WORKSPACE, Watch, watch_list

__all__ = ["Flight", "prepare"]


@dataclass(frozen=True, slots=True, eq=False)
class Flight:
    """Everything that all chunks share; read-only, so that threads may.

    Attributes
    ----------
    scenario : Scenario
        What is flown.
    motion : FleetMotion
        Means.
    sampler : Sampler
        Draws the deviations of the vehicles that matter.
    watches : tuple of Watch
        Per window.
    projections : tuple of sparse (M, width) array
        Deviations along the normal of each row of each window.
    position_rows : (N, d) int array
        Where a vehicle's position stands among the deviations.
    parts : mapping
        Solids by obstacle, piece and (where it moves) window.
    reserves : tuple of Reserve
        Controls that may saturate, per step.
    overlooked : float
        Bound on the probability of what is not watched [-].
    """

    scenario: Scenario
    motion: FleetMotion
    sampler: Sampler
    watches: tuple[Watch, ...]
    projections: tuple[csr_array, ...]
    position_rows: Indices
    parts: dict[tuple[int, int, int], tuple[SweepPart, ...]]
    reserves: tuple[Reserve, ...]
    overlooked: float

    def count(self, size: int, seed: np.random.SeedSequence) -> Indices:
        """Return flights with any collision, with each kind, and with saturation.

        Parameters
        ----------
        size : int
            Flights.
        seed : SeedSequence
            Of this chunk alone.

        Returns
        -------
        (5,) int array
            Any, pair, obstacle, workspace, saturated.
        """
        rng = np.random.default_rng(seed)
        hits = np.zeros((3, size), dtype=bool)
        saturated = np.zeros(size, dtype=bool)
        intervals = self.scenario.avoidance == "intervals"
        horizon = self.scenario.horizon
        before: Matrix | None = None
        for k, here in enumerate(self.sampler.draw(horizon, size, rng)):
            if k < horizon:
                saturated |= self.reserves[k].exceeded(here)
            if not intervals:
                self._test(k, (k, k), (here, here), hits)
            elif before is not None:
                self._test(k - 1, (k - 1, k), (before, here), hits)
            before = here
        counts = [hits.any(axis=0).sum(), *hits.sum(axis=1), saturated.sum()]
        return np.array(counts, dtype=np.int64)

    def _test(
        self, window: int, steps: tuple[int, int], states: tuple[Matrix, Matrix], hits: Flags
    ) -> None:
        """Mark the flights that collide in a window."""
        watch, projection = self.watches[window], self.projections[window]
        if not watch.kinds.size:
            return
        leaves = projection @ states[0] < -watch.margins[:, :1]
        if watch.margins.shape[1] > 1:
            leaves |= projection @ states[1] < -watch.margins[:, 1:]
        row, sample = np.nonzero(leaves)
        fresh = ~hits[watch.kinds[row], sample]
        row, sample = row[fresh], sample[fresh]
        if not row.size:
            return
        begin, end = (
            self._places(watch, row, sample, k, state)
            for k, state in zip(steps, states, strict=True)
        )
        self._test_pairs(watch, (row, sample), begin, end, hits)
        self._test_solids(window, (row, sample), begin, end, hits)
        if self.scenario.workspace is not None:
            at = np.flatnonzero(watch.kinds[row] == WORKSPACE)
            out = leaves_workspace(begin[at], end[at], watch.bows[row[at]], self.scenario.workspace)
            hits[WORKSPACE, sample[at[out]]] = True

    def _places(
        self, watch: Watch, row: Indices, sample: Indices, step: int, state: Matrix
    ) -> Matrix:
        """Return the (relative) positions of some rows in some samples, (M, d)."""
        first, other = watch.first[row], watch.other[row]
        places = self._positions(first, sample, step, state)
        pair = np.flatnonzero(watch.kinds[row] == PAIR)
        places[pair] -= self._positions(other[pair], sample[pair], step, state)
        return places

    def _positions(self, who: Indices, sample: Indices, step: int, state: Matrix) -> Matrix:
        """Return the positions of some vehicles in some samples, (M, d)."""
        positions: Matrix = self.motion.positions[who, step]
        return positions + state[self.position_rows[who], sample[:, None]]

    def _test_pairs(
        self,
        watch: Watch,
        where: tuple[Indices, Indices],
        begin: Matrix,
        end: Matrix,
        hits: Flags,
    ) -> None:
        """Mark flights in which two vehicles meet."""
        row, sample = where
        at = np.flatnonzero(watch.kinds[row] == PAIR)
        met = meets_origin(begin[at], end[at], watch.bows[row[at]], watch.reaches[row[at]])
        hits[PAIR, sample[at[met]]] = True

    def _test_solids(
        self,
        window: int,
        where: tuple[Indices, Indices],
        begin: Matrix,
        end: Matrix,
        hits: Flags,
    ) -> None:
        """Mark flights in which a vehicle hits an obstacle, piece by piece."""
        watch, (row, sample) = self.watches[window], where
        at = np.flatnonzero(watch.kinds[row] == OBSTACLE)
        keys = np.column_stack([watch.other[row[at]], watch.piece[row[at]]])
        for obstacle, piece in np.unique(keys, axis=0).tolist():
            these = at[(keys == (obstacle, piece)).all(axis=1)]
            these = these[~hits[OBSTACLE, sample[these]]]
            moving = self.scenario.obstacles[obstacle].is_moving
            parts = self.parts[obstacle, piece, window if moving else -1]
            rows = row[these]
            met = meets_solid(
                begin[these], end[these], watch.bows[rows], watch.reaches[rows], parts
            )
            hits[OBSTACLE, sample[these[met]]] = True


def prepare(plan: Plan) -> Flight:
    """Return a plan ready to be flown.

    Raises
    ------
    NoPlanError
        If the plan holds no trajectories.
    ScenarioError
        If its vehicles or arrays do not fit its scenario, or overflow.
    """
    problems = shape_problems(plan)
    if problems:
        kind = ScenarioError if plan.trajectories else NoPlanError
        raise kind("; ".join(problems))
    scenario = plan.scenario
    controls = [t.controls for t in plan.trajectories]
    motion = propagate(scenario, controls)
    if motion.problems:
        raise ScenarioError("; ".join(motion.problems))
    watches, overlooked = watch_list(scenario, motion)
    limited = [i for i, v in enumerate(scenario.vehicles) if v.gain is not None]
    involved = [w.first for w in watches] + [w.other[w.kinds == PAIR] for w in watches]
    needed = np.unique(np.concatenate([*involved, np.array(limited, dtype=np.int64)]))
    sampler = Sampler.of(motion, needed)
    axes = np.array([v.system.position for v in scenario.vehicles])
    position_rows = sampler.starts[:, None] + axes
    return Flight(
        scenario,
        motion,
        sampler,
        watches,
        tuple(_projection(w, position_rows, sampler.width) for w in watches),
        position_rows,
        _solids(scenario, watches),
        reserves(scenario, motion, controls, sampler),
        overlooked,
    )


def _projection(watch: Watch, position_rows: Indices, width: int) -> csr_array:
    """Return the matrix that takes deviations to their components along each row's normal."""
    count, d = watch.normals.shape
    pair = np.flatnonzero(watch.kinds == PAIR)
    rows = np.concatenate([np.repeat(np.arange(count), d), np.repeat(pair, d)])
    columns = np.concatenate(
        [position_rows[watch.first].ravel(), position_rows[watch.other[pair]].ravel()]
    )
    values: Vector = np.concatenate([watch.normals.ravel(), -watch.normals[pair].ravel()])
    return csr_array((values, (rows, columns)), shape=(count, width))


def _solids(
    scenario: Scenario, watches: tuple[Watch, ...]
) -> dict[tuple[int, int, int], tuple[SweepPart, ...]]:
    """Return the solids that any row names."""
    parts: dict[tuple[int, int, int], tuple[SweepPart, ...]] = {}
    for window, watch in enumerate(watches):
        named = np.flatnonzero(watch.kinds == OBSTACLE)
        keys = np.column_stack([watch.other[named], watch.piece[named]])
        for number, piece in np.unique(keys, axis=0).tolist():
            obstacle = scenario.obstacles[number]
            key = (number, piece, window if obstacle.is_moving else -1)
            if key in parts:
                continue
            here = obstacle.at(window)[piece]
            if obstacle.is_moving and scenario.avoidance == "intervals":
                parts[key] = swept(here, obstacle.at(window + 1)[piece])
            else:
                parts[key] = resting(here)
    return parts
