"""Vehicles planned one after the other, each with its visits at steps that keep it off the others.

A path in empty space with visits at the cheapest steps is kept where it is clear of what is in the
way. Else the vehicle goes the same route at another pace, found by dynamic programming: that tells
the steps of its visits, and on which side it passes everything else. Controls follow by successive
linear programs. (Prioritized planning, Erdmann and Lozano-Perez 1987.)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.planners.certified.turned.paths import Paths
from radmpc.planners.certified.turned.touring.one_by_one import Counts
from radmpc.planners.certified.turned.touring.placing import Placing
from radmpc.planners.certified.turned.touring.shifting import shifted
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.components import components
from radmpc.program.hazards import Hazards
from radmpc.program.visits.columns import windows_of

__all__ = ["Touring"]

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

_MOST_TOGETHER = 6
"""Vehicles that are planned together where one by one leads no farther, at most [-]."""

_TOGETHER = 4
"""Times that these are planned in a row at most [-]."""

_WAITS = 0.05
"""Share of what the worst one misses up to which others are not planned again [-]."""

_ENDS = 2
"""Windows at both ends in which everybody counts, planned or not [-]."""

_SWEEPS = 24
"""Times that those are planned again who miss anything, at most [-]."""

_FALLS = 0.7
"""Share of what was missed before from which on planning so again is given up [-]."""


class Touring(Placing):
    """A fleet that is planned one vehicle after the other."""

    def run(self, alone: Paths, routes: Mapping[int, Matrix]) -> bool:
        """Plan everyone; tell whether all vehicles were.

        Parameters
        ----------
        alone : Paths
            What vehicles do by themselves.
        routes : mapping of int to (p, 2) array
            Routes around obstacles of those that these stop [m].
        """
        if self._clear is None:
            return False
        self.successive.begin(alone.controls)
        among = _nobody(self.successive.hazards)
        for i, route in routes.items():
            if self._limits.reached:
                return False
            self._go_around(i, route, among)
        # Who is not planned yet is at its start at first and at its goal in the end in any case.
        among[:, :_ENDS] = among[:, -_ENDS:] = True
        self._alone = [self.successive.solo_plan(i) for i in range(self.successive.hazards.count)]
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
        """Make visits a step sooner or later where that is cheaper and all others may stay.

        Who needs most beyond what it needs alone comes first.
        """
        successive = self.successive
        among = np.ones((successive.hazards.count + 1, successive.hazards.horizon), bool)
        beyond = np.array([successive.solo_plan(i).effort for i in range(successive.hazards.count)])
        if self._alone:
            beyond -= [each.effort for each in self._alone]
        for i in np.argsort(-beyond, kind="stable").tolist():
            for _ in range(_MOVES):
                if self._limits.reached or not self._is_improved(i, among):
                    break

    def _is_improved(self, i: int, among: Counts) -> bool:
        """Try other steps for each visit of a vehicle; tell whether any is cheaper."""
        successive, model = self.successive, self._models[i]
        before = kept = successive.solo_plan(i)
        steps = [first for first, _ in windows_of(before.model)]
        for moved in shifted(model, steps):
            if self._limits.reached:
                break
            self._visit_at(i, before, moved)
            missed = successive.keep_clear(i, self._clearance, _TRIES, among)
            if missed <= self._few and successive.solo_plan(i).effort < _PAYS * kept.effort:
                kept = successive.solo_plan(i)
        successive.come_back(i, kept)
        return kept is not before

    def _mend(self, among: Counts) -> None:
        """Plan those again who miss anything, a little each time; others let them pass."""
        successive, penalty = self.successive, TUNING.paced_penalty
        nearly = TUNING.nearly * float(successive.hazards.radii.mean())
        least, num_stuck = np.inf, 0
        for _ in range(_SWEEPS):
            missing, pairs = successive.conflicts(self._clearance)
            is_stuck = float(missing.sum()) > _FALLS * least
            if missing.sum() <= nearly * (1.0 if is_stuck else _NEARLY):
                break
            if is_stuck:
                num_stuck += 1
                if num_stuck % 3 == 0:
                    self._loosen(missing, among, is_odd=num_stuck % 2 == 0)
                    least = np.inf
                else:
                    self._untangle(pairs, penalty)
                continue
            least = float(missing.sum())
            # Little by little: who misses next to nothing waits until that is what is left.
            for i in np.flatnonzero(missing > _WAITS * missing.max()).tolist():
                if self._limits.reached:
                    return
                successive.keep_clear(i, self._clearance, (1, penalty), among)
            penalty = min(TUNING.penalty_growth * penalty, TUNING.last_penalty)

    def _untangle(self, pairs: Sequence[tuple[int, int]], penalty: float) -> None:
        """Plan those together that are in each other's way still."""
        successive = self.successive
        for group in components(successive.hazards.count, pairs):
            if 1 < len(group) <= _MOST_TOGETHER and not self._limits.reached:
                tries = (_TOGETHER, penalty)
                successive.keep_clear_together(group, self._clearance, tries)

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
        needs = [float(np.abs(u).sum() / max(m.control_bounds.sum(), 1e-9)) for m, u in pairs]
        return sorted(range(len(needs)), key=lambda i: -needs[i])


def _nobody(hazards: Hazards) -> Counts:
    """Return that obstacles and borders count alone."""
    counts = np.zeros((hazards.count + 1, hazards.horizon), dtype=bool)
    counts[-1] = True
    return counts
