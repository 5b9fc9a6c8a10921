"""Vehicles planned one after the other, each with its visits at steps that keep it off the others.

A path in empty space with visits at the cheapest steps is kept where it is clear of what is in the
way. Else the vehicle goes the same way at another pace, found by dynamic programming: that tells
the steps of its visits, and on which side it passes everything else. Controls follow by successive
linear programs. (Prioritized planning, Erdmann and Lozano-Perez 1987.)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.planners.certified.turned.narrow.clear import Clear
from radmpc.planners.certified.turned.paths import Paths, timed_by_visits
from radmpc.planners.certified.turned.touring.crowding import crowding
from radmpc.planners.certified.turned.touring.one_by_one import Counts, Known, OneByOne
from radmpc.planners.certified.turned.touring.shifting import shifted, warped
from radmpc.planners.certified.turned.touring.tour import Tour, tour
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.program.condensed import CondensedModel
from radmpc.program.hazards import Hazards
from radmpc.program.visits.columns import windows_of
from radmpc.program.visits.steps import at_steps, steps_on
from radmpc.solvers.solution import Limits

__all__ = ["Touring"]

_ROUNDS = 8
"""Times that a vehicle is planned in a row at most [-]."""

_PENALTY = 30.0
"""First penalty of a meter missed, see `Tuning.first_penalty` [-]."""

_MOVES = 3
"""Times that one visit of a vehicle is moved at most while that is cheaper [-]."""

_TRIES = 4, TUNING.paced_penalty
"""Times that it is planned for that at most [-], and the first penalty."""

_PAYS = 0.999
"""Share of the effort that has to be enough then [-]."""

_NEARLY = 0.5
"""Share of what paths may miss to be turned at a price of risk that ends this early [-]."""

_MUCH = 0.4
"""Share of what the worst one misses from which on others are led otherwise, too [-]."""

_TINY = 1e-6
"""Distance below which corners of a way are the same [m]."""

_ENDS = 2
"""Windows at both ends in which everybody counts, planned or not [-]."""

_SWEEPS = 24
"""Times that those are planned again who miss anything, at most [-]."""

_FALLS = 0.7
"""Share of what was missed before from which on planning so again is given up [-]."""


class Touring:
    """A fleet that is planned one vehicle after the other.

    Parameters
    ----------
    hazards : Hazards
        The fleet with visits at single steps.
    models : sequence of CondensedModel
        Its vehicles, visits at any step of their windows.
    limits : Limits
        When to stop.
    clearance : float
        Standard deviations to keep [-].

    Attributes
    ----------
    successive : OneByOne
        The latest paths; its fleet makes visits when these do.
    """

    def __init__(
        self,
        hazards: Hazards,
        models: Sequence[CondensedModel],
        limits: Limits,
        clearance: float,
    ) -> None:
        self._models, self._limits, self._clearance = models, limits, clearance
        self._clear = Clear.of(hazards)
        self._alone: list[Known] = []
        self.successive = OneByOne(hazards, limits)

    def run(self, alone: Paths, ways: Mapping[int, Matrix]) -> bool:
        """Plan everyone; tell whether all vehicles were.

        Parameters
        ----------
        alone : Paths
            What vehicles do by themselves.
        ways : mapping of int to (p, 2) array
            Ways around obstacles of those that these stop [m].
        """
        if self._clear is None:
            return False
        self.successive.begin(alone.controls)
        among = _nobody(self.successive.hazards)
        for i, way in ways.items():
            if self._limits.reached:
                return False
            self._go_around(i, way, among)
        # Who is not planned yet is at its start at first and at its goal in the end in any case.
        among[:, :_ENDS] = among[:, -_ENDS:] = True
        self._alone = [self.successive.known(i) for i in range(self.successive.hazards.count)]
        self._rest_at_ends()
        for i in self._tightest_first():
            if self._limits.reached:
                return False
            self._insist(i)
            self._place(i, among)
            among[i] = True
        among[:] = True
        self._mend(among)
        self.successive.missed[:] = self.successive.missing(self._clearance)
        return True

    def improve(self) -> None:
        """Make visits a step sooner or later where that is cheaper and all others may stay."""
        among = np.ones((self.successive.hazards.count + 1, self.successive.hazards.horizon), bool)
        for i in range(self.successive.hazards.count):
            for _ in range(_MOVES):
                if self._limits.reached or not self._is_improved(i, among):
                    break

    def _is_improved(self, i: int, among: Counts) -> bool:
        """Try other steps for each visit of a vehicle; tell whether any is cheaper."""
        successive, model = self.successive, self._models[i]
        before = kept = successive.known(i)
        steps = [first for first, _ in windows_of(before.model)]
        for moved in shifted(model, steps):
            if self._limits.reached:
                break
            self._visit_at(i, before, moved)
            missed = successive.keep_clear(i, self._clearance, _TRIES, among)
            if missed <= self._few and successive.known(i).effort < _PAYS * kept.effort:
                kept = successive.known(i)
        successive.come_back(i, kept)
        return kept is not before

    def _visit_at(self, i: int, known: Known, steps: tuple[int, ...]) -> None:
        """Have a vehicle make its visits at other steps, on the way that it knows."""
        model, given = self._models[i], known.model
        arrival = None
        if model.time_cost > 0.0:
            arrival = given.vehicle.goal.window(model.horizon)[1]
        before = [first for first, _ in windows_of(given)]
        self.successive.make_visits(i, at_steps(model, steps, arrival))
        self.successive.refer(i, warped(known.means, before, steps))

    def _mend(self, among: Counts) -> None:
        """Plan those again who miss anything, a little each time; others let them pass."""
        successive, penalty = self.successive, TUNING.paced_penalty
        nearly = TUNING.nearly * float(successive.hazards.radii.mean())
        least, num_stuck = np.inf, 0
        for _ in range(_SWEEPS):
            missing = successive.missing(self._clearance)
            is_stuck = float(missing.sum()) > _FALLS * least
            if missing.sum() <= nearly * (1.0 if is_stuck else _NEARLY):
                break
            if is_stuck:
                num_stuck += 1
                self._loosen(missing, among, is_odd=num_stuck % 2 == 1)
                least = np.inf
                continue
            least = float(missing.sum())
            for i in np.flatnonzero(missing > _TINY).tolist():
                if self._limits.reached:
                    return
                successive.keep_clear(i, self._clearance, (1, penalty), among)
            penalty *= TUNING.penalty_growth

    def _loosen(self, missing: Vector, among: Counts, *, is_odd: bool) -> None:
        """Have the one that misses most go its own way, or those that do make visits otherwise."""
        if is_odd:
            self._insist(int(missing.argmax()))
            return
        most = max(_MUCH * float(missing.max()), self._few)
        for i in np.flatnonzero(missing >= most).tolist():
            if self._limits.reached:
                return
            self._place(i, among)
            self._shift(i, among)

    @property
    def _few(self) -> float:
        """What a vehicle may miss [m]."""
        return TUNING.misses * float(self.successive.hazards.radii.mean())

    def _rest_at_ends(self) -> None:
        """Have everybody wait at first, and be there early: what all can agree on."""
        paths = self.successive.paths
        for ends, place in ((slice(_ENDS + 1), 0), (slice(-_ENDS - 1, None), -1)):
            paths.means[:, ends] = paths.means[:, [place]]
        paths.sagittas[:, :_ENDS] = paths.sagittas[:, -_ENDS:] = 0.0

    def _insist(self, i: int) -> None:
        """Have a vehicle go the way it has alone: others have to keep clear of it."""
        self.successive.come_back(i, self._alone[i])

    def _tightest_first(self) -> list[int]:
        """Return all vehicles, those first that need most of what their controls can do.

        Who has time to spare can let others pass; who has none cannot.
        """
        pairs = zip(self._models, self.successive.paths.controls, strict=True)
        needs = [float(np.abs(u).sum() / max(m.control_bounds.sum(), _TINY)) for m, u in pairs]
        return sorted(range(len(needs)), key=lambda i: -needs[i])

    def _go_around(self, i: int, way: Matrix, among: Counts) -> None:
        """Plan a vehicle around obstacles, as if there were no others."""
        successive = self.successive
        successive.refer(i, timed_by_visits(successive.hazards.models[i], way))
        if self._kept(i, among) > self._few:
            self._pace(i, way, among)
        self._shift(i, among)

    def _place(self, i: int, among: Counts) -> None:
        """Plan a vehicle around obstacles and those that count."""
        way = _as_flown(self.successive.paths, i)
        if self._kept(i, among) > self._few:
            self._pace(i, way, among)

    def _kept(self, i: int, among: Counts) -> float:
        """Plan a vehicle from its latest path on; return what it misses [m]."""
        return self.successive.keep_clear(i, self._clearance, (_ROUNDS, _PENALTY), among)

    def _pace(self, i: int, way: Matrix, among: Counts) -> None:
        """Plan a vehicle on a way at the best pace, if that leads to a better path."""
        successive, model = self.successive, self._models[i]
        hazards, before = successive.hazards, successive.known(i)
        found = self._toured(i, way)
        if found is None:
            return
        counts = among[:-1].copy()
        counts[i] = False
        others = crowding(found.laid_out, hazards, successive.paths, counts, self._clearance)
        paced = found.laid_out.paced(hazards.horizon, (*found.due, others))
        if paced is None:
            return
        places = paced[0]
        steps, arrival = steps_on(model, places)
        successive.make_visits(i, at_steps(model, steps, arrival))
        successive.refer(i, places)
        if not self._kept(i, among) < before.missed:
            successive.come_back(i, before)

    def _shift(self, i: int, among: Counts) -> None:
        """Have a vehicle that misses much make one visit a step sooner or later, if that helps."""
        successive, model = self.successive, self._models[i]
        before = kept = successive.known(i)
        if not model.vehicle.via or before.missed <= self._few:
            return
        for moved in shifted(model, [first for first, _ in windows_of(before.model)]):
            self._visit_at(i, before, moved)
            if self._kept(i, among) < kept.missed:
                kept = successive.known(i)
            if kept.missed <= self._few:
                break
        successive.come_back(i, kept)

    def _toured(self, i: int, way: Matrix) -> Tour | None:
        """Lay out a way."""
        assert self._clear is not None
        kept = np.append(True, np.linalg.norm(np.diff(way, axis=0), axis=1) > _TINY)
        if kept.sum() < 2:
            return None
        known = self._clear, self._clearance
        return tour(self.successive.hazards, self._models[i], i, way[kept], known)


def _nobody(hazards: Hazards) -> Counts:
    """Return that obstacles and borders count alone."""
    counts = np.zeros((hazards.count + 1, hazards.horizon), dtype=bool)
    counts[-1] = True
    return counts


def _as_flown(paths: Paths, i: int) -> Matrix:
    """Return the places of a path at its steps and half-way between them, (2T+1, d) [m]."""
    steps = paths.means[i]
    middles = 0.5 * (steps[1:] + steps[:-1]) + paths.sagittas[i]
    way = np.empty((len(steps) + len(middles), steps.shape[1]))
    way[::2], way[1::2] = steps, middles
    return way
