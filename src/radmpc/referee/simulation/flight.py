"""One chunk of samples: draw deviations, find the few that matter, test those exactly."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from radmpc.arrays import Indices, Matrix, Tensor
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass, field
from radmpc.referee.motion import FleetMotion
from radmpc.referee.sampling import Sampler
from radmpc.referee.saturation import Cutoff
from radmpc.referee.simulation.collisions import (
    Flags,
    leaves_workspace,
    loses_range,
    meets_origin,
    meets_solid,
)
from radmpc.referee.simulation.projections import Projections
from radmpc.referee.simulation.sweep import SweepPart
from radmpc.referee.simulation.watch import OBSTACLE, PAIR, RANGE, WORKSPACE, Watch, WatchList

__all__ = ["Chunk", "SampledFleet"]


@dataclass(frozen=True, slots=True, eq=False)
class SampledFleet:
    """Everything that all chunks share; read-only, so that threads may.

    Attributes
    ----------
    scenario : Scenario
        What is flown.
    motion : FleetMotion
        Means.
    sampler : Sampler
        Draws the deviations of the vehicles that matter.
    watched : WatchList
        What to watch in each window.
    usual, wide : tuple of Projections
        Deviations along the normals of each window's rows.
    position_rows : (N, d) int array
        Where a vehicle's position stands among the deviations.
    bends : sparse (N d, width) array
        ``B_p K`` of every vehicle: what feedback held over a step adds to the position.
    held_back : sparse (N d, R) array
        ``B_p`` for the controls that may be cut off.
    parts : mapping
        Solids by obstacle, piece and (where it moves) window.
    cutoffs : tuple of Cutoff
        Controls that may saturate, per step.
    always_saturated : bool
        Whether some nominal control is above its limit already.
    """

    scenario: Scenario
    motion: FleetMotion
    sampler: Sampler
    watched: WatchList
    usual: tuple[Projections, ...]
    wide: tuple[Projections, ...]
    position_rows: Indices
    bends: csr_array
    held_back: csr_array
    parts: dict[tuple[int, int, int], tuple[SweepPart, ...]]
    cutoffs: tuple[Cutoff, ...]
    always_saturated: bool

    @property
    def overlooked(self) -> float:
        """Upper bound on the probability of what is not watched [-]."""
        return self.watched.overlooked

    def count(self, size: int, seed: np.random.SeedSequence) -> Indices:
        """Return samples with any collision, with each kind, and with saturation.

        Parameters
        ----------
        size : int
            Samples.
        seed : SeedSequence
            Of this chunk alone.

        Returns
        -------
        (6,) int array
            Any, pair, obstacle, workspace, range, saturated.
        """
        chunk = Chunk(self, size)
        chunk.fly(np.random.default_rng(seed))
        hits = chunk.hits
        counts = [hits.any(axis=0).sum(), *hits.sum(axis=1), chunk.saturated.sum()]
        return np.array(counts, dtype=np.int64)


@dataclass(slots=True, eq=False)
class Chunk:
    """Samples in the air.

    Attributes
    ----------
    flight : SampledFleet
        What is flown.
    size : int
        Samples.
    hits : (4, size) bool array
        Which samples met a vehicle, met an obstacle, left the workspace, lost a range.
    saturated : (size,) bool array
        In which some control was cut off so far.
    excess : (R, size) array or None
        What the controls of the last step asked for beyond their limits.
    """

    flight: SampledFleet
    size: int
    hits: Flags = field(init=False)
    saturated: Flags = field(init=False)
    excess: Matrix | None = None

    def __post_init__(self) -> None:
        """Begin without any hit."""
        self.hits = np.zeros((4, self.size), dtype=bool)
        self.saturated = np.full(self.size, self.flight.always_saturated)

    def fly(self, rng: np.random.Generator) -> None:
        """Draw all samples step by step, and test each window."""
        flight = self.flight
        horizon = flight.scenario.horizon
        intervals = flight.scenario.avoidance == "intervals"
        before: Matrix | None = None
        for k, here in enumerate(flight.sampler.draw(horizon, self.size, rng, self._hold_back)):
            if not intervals:
                self._test(k, (k, k), (here, here))
            elif before is not None:
                self._test(k - 1, (k - 1, k), (before, here))
            before = here

    def _hold_back(self, step: int, state: Matrix, following: Matrix) -> None:
        """Take off what saturated controls do not do."""
        cutoff = self.flight.cutoffs[step]
        self.excess = cutoff.excess(state)
        if self.excess is not None:
            self.saturated |= self.excess.any(axis=0)
            following -= cutoff.pushes @ self.excess

    def _test(self, window: int, steps: tuple[int, int], states: tuple[Matrix, Matrix]) -> None:
        """Mark the samples that collide in a window."""
        flight = self.flight
        everyone = np.arange(self.size)
        usual = flight.watched.usual[window], flight.usual[window]
        self._test_rows(window, usual, everyone, steps, states)
        wide = flight.watched.wide[window]
        strayed = np.flatnonzero(self.saturated)
        if wide.kinds.size and strayed.size:
            self._test_rows(window, (wide, flight.wide[window]), strayed, steps, states)

    def _test_rows(
        self,
        window: int,
        rows: tuple[Watch, Projections],
        samples: Indices,
        steps: tuple[int, int],
        states: tuple[Matrix, Matrix],
    ) -> None:
        """Mark those of some samples that collide with what some rows watch."""
        watch, along = rows
        if not watch.kinds.size:
            return
        if samples.size < self.size:
            states = states[0][:, samples], states[1][:, samples]
        excess = None if self.excess is None else self.excess[:, samples]
        row, sample = np.nonzero(along.leaves(watch.margins, states, excess))
        fresh = self.is_open(watch.kinds[row], samples[sample])
        row, sample = row[fresh], sample[fresh]
        if not row.size:
            return
        begin, end = (
            self._relative_positions(watch, row, sample, k, state)
            for k, state in zip(steps, states, strict=True)
        )
        sagittas = watch.sagittas[row]
        if watch.margins.shape[1] > 1:
            sagittas = sagittas + self._extra_sagittas(watch, row, sample, states[0], excess)
        met = (begin, end, sagittas)
        self._test_pairs(watch, (row, samples[sample]), met)
        self._test_solids(window, watch, (row, samples[sample]), met)
        self._test_workspace(watch, (row, samples[sample]), met)

    def is_open(self, kinds: Indices, samples: Indices) -> Flags:
        """Return whether samples are still to be tested for kinds of collisions, (M,) bool.

        Parameters
        ----------
        kinds : (M,) int array
            Kinds of collisions.
        samples : (M,) int array
            Numbers of samples.
        """
        return ~self.hits[kinds, samples]

    def mark(self, watch: Watch, rows: Indices, samples: Indices) -> None:
        """Note that rows of a window went wrong in samples.

        Parameters
        ----------
        watch : Watch
            Of the window.
        rows : (M,) int array
            Its rows that went wrong.
        samples : (M,) int array
            The samples in which they did.
        """
        self.hits[watch.kinds[rows], samples] = True

    def _relative_positions(
        self, watch: Watch, row: Indices, sample: Indices, step: int, state: Matrix
    ) -> Matrix:
        """Return the (relative) positions of some rows in some samples, (M, d)."""
        first, other = watch.first[row], watch.other[row]
        positions = self._positions(first, sample, step, state)
        pair = np.flatnonzero(watch.are_pairs[row])
        positions[pair] -= self._positions(other[pair], sample[pair], step, state)
        starts = self.flight.sampler.track_starts
        if starts.size:
            met = np.flatnonzero(watch.kinds[row] == OBSTACLE)
            met = met[starts[other[met]] >= 0]
            # As seen from the obstacle: it stands where it is expected, and the vehicle is off.
            rows = starts[other[met], None] + np.arange(positions.shape[1])
            positions[met] -= state[rows, sample[met, None]]
        return positions

    def _positions(self, who: Indices, sample: Indices, step: int, state: Matrix) -> Matrix:
        """Return the positions of some vehicles in some samples, (M, d)."""
        positions: Matrix = self.flight.motion.positions[who, step]
        return positions + state[self.flight.position_rows[who], sample[:, None]]

    def _extra_sagittas(
        self, watch: Watch, row: Indices, sample: Indices, state: Matrix, excess: Matrix | None
    ) -> Matrix:
        """Return how far feedback as flown makes paths hang off their chords, (M, d) [m]."""
        flight = self.flight
        if not flight.bends.nnz:
            return np.zeros((row.size, flight.scenario.dimension))
        used, place = np.unique(sample, return_inverse=True)
        pushed = flight.bends @ state[:, used]
        if excess is not None:
            pushed -= flight.held_back @ excess[:, used]
        by_axis: Tensor = pushed.reshape(flight.scenario.num_vehicles, -1, used.size)
        extra = by_axis[watch.first[row], :, place]
        pair = np.flatnonzero(watch.are_pairs[row])
        extra[pair] -= by_axis[watch.other[row[pair]], :, place[pair]]
        return np.asarray(extra / 4.0)

    def _test_pairs(
        self, watch: Watch, where: tuple[Indices, Indices], met: tuple[Matrix, Matrix, Matrix]
    ) -> None:
        """Mark samples in which two vehicles meet, or lose the range that they keep."""
        row, sample = where
        begin, end, sagittas = met
        for kind, judge in ((PAIR, meets_origin), (RANGE, loses_range)):
            at = np.flatnonzero(watch.kinds[row] == kind)
            found = judge(begin[at], end[at], sagittas[at], watch.reaches[row[at]])
            self.mark(watch, row[at[found]], sample[at[found]])

    def _test_solids(
        self,
        window: int,
        watch: Watch,
        where: tuple[Indices, Indices],
        met: tuple[Matrix, Matrix, Matrix],
    ) -> None:
        """Mark samples in which a vehicle hits an obstacle, piece by piece."""
        row, sample = where
        begin, end, sagittas = met
        at = np.flatnonzero(watch.kinds[row] == OBSTACLE)
        keys = np.column_stack([watch.other[row[at]], watch.piece[row[at]]])
        for obstacle, piece in np.unique(keys, axis=0).tolist():
            these = at[(keys == (obstacle, piece)).all(axis=1)]
            these = these[self.is_open(watch.kinds[row[these]], sample[these])]
            moving = self.flight.scenario.obstacles[obstacle].is_moving
            parts = self.flight.parts[obstacle, piece, window if moving else -1]
            reaches = watch.reaches[row[these]]
            found = meets_solid(begin[these], end[these], sagittas[these], reaches, parts)
            self.mark(watch, row[these[found]], sample[these[found]])

    def _test_workspace(
        self, watch: Watch, where: tuple[Indices, Indices], met: tuple[Matrix, Matrix, Matrix]
    ) -> None:
        """Mark samples in which a center leaves the workspace."""
        workspace = self.flight.scenario.workspace
        if workspace is None:
            return
        row, sample = where
        begin, end, sagittas = met
        at = np.flatnonzero(watch.kinds[row] == WORKSPACE)
        out = leaves_workspace(begin[at], end[at], sagittas[at], workspace)
        self.mark(watch, row[at[out]], sample[at[out]])
