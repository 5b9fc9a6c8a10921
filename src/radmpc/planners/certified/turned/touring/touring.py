"""Vehicles planned one after the other, each with its visits at steps that keep it off the others.

A path in empty space with visits at the cheapest steps is kept where it is clear of what is in the
way. Else the vehicle goes the same way at another pace, found by dynamic programming: that tells
the steps of its visits, and on which side it passes everything else. Controls follow by successive
linear programs. (Prioritized planning, Erdmann and Lozano-Perez 1987.)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from radmpc.arrays import Matrix
from radmpc.planners.certified.turned.narrow.clear import Clear
from radmpc.planners.certified.turned.paths import Paths, timed_by_visits
from radmpc.planners.certified.turned.touring.crowding import crowding
from radmpc.planners.certified.turned.touring.one_by_one import Counts, OneByOne
from radmpc.planners.certified.turned.touring.tour import Tour, tour
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.program.condensed import CondensedModel
from radmpc.program.hazards import Hazards
from radmpc.program.visits.steps import at_steps, steps_on
from radmpc.solvers.solution import Limits

__all__ = ["Touring"]

_ROUNDS = 8
"""Times that a vehicle is planned in a row at most [-]."""

_PENALTY = 30.0
"""First penalty of a meter missed, see `Tuning.first_penalty` [-]."""

_TINY = 1e-6
"""Distance below which corners of a way are the same [m]."""

_ENDS = 2
"""Windows at both ends in which everybody counts, planned or not [-]."""

_MENDS = 2
"""Times that those are planned again who miss anything [-]."""


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
        before = list(self.successive.paths.controls)
        self._rest_at_ends()
        for i in self._tightest_first():
            if self._limits.reached:
                return False
            self.successive.paths.fly(i, before[i])
            self._place(i, among)
            among[i] = True
        for _ in range(_MENDS):
            missing = np.flatnonzero(self.successive.missed > self._few)
            for i in missing.tolist():
                if self._limits.reached:
                    return False
                self._place(i, among)
        return True

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
        hazards, before = successive.hazards, successive.paths.state()
        missed, fixed = float(successive.missed[i]), hazards.models[i]
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
        if not self._kept(i, among) < missed:
            successive.make_visits(i, fixed)
            successive.restore(before)
            successive.missed[i] = missed

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
