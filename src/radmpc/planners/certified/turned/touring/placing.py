"""Single vehicles led past what is in their way: as they are, at another pace, a step later."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix
from radmpc.planners.certified.turned.narrow.clear import Clear
from radmpc.planners.certified.turned.paths import Paths, timed_by_visits
from radmpc.planners.certified.turned.touring.crowding import crowding
from radmpc.planners.certified.turned.touring.one_by_one import Counts, OneByOne
from radmpc.planners.certified.turned.touring.shifting import shifted, warped
from radmpc.planners.certified.turned.touring.solo_plan import SoloPlan
from radmpc.planners.certified.turned.touring.tour import Tour, tour
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.program.condensed import CondensedModel
from radmpc.program.hazards import Hazards
from radmpc.program.visits.columns import windows_of
from radmpc.program.visits.steps import at_steps, steps_on
from radmpc.solvers.solution import Limits

__all__ = ["Placing"]

_ROUNDS = 8
"""Times that a vehicle is planned in a row at most [-]."""

_PENALTY = 30.0
"""First penalty of a meter missed, see `Tuning.first_penalty` [-]."""

_TOO_MUCH = 40.0
"""What a path may miss to be mended as it is, before another pace is sought [mean radii]: at 15
first plans of 50 take 5 % less time and cost 2 % more."""

_TINY = 1e-6
"""Distance below which corners of a route are the same [m]."""


class Placing:
    """A fleet of which single vehicles are led past what is in their way.

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
        self._alone: list[SoloPlan] = []
        self.successive = OneByOne(hazards, limits)

    @property
    def _few(self) -> float:
        """What a vehicle may miss [m]."""
        return TUNING.misses * float(self.successive.hazards.radii.mean())

    @property
    def _too_much(self) -> float:
        """What a path may miss to be mended as it is [m]."""
        return _TOO_MUCH * float(self.successive.hazards.radii.mean())

    def _go_around(self, i: int, route: Matrix, among: Counts) -> None:
        """Plan a vehicle around obstacles, as if there were no others."""
        successive = self.successive
        successive.refer(i, timed_by_visits(successive.hazards.models[i], route))
        if self._kept(i, among) > self._few:
            self._pace(i, route, among)
        self._shift(i, among)

    def _place(self, i: int, among: Counts) -> None:
        """Plan a vehicle around obstacles and those that count."""
        route, successive = _as_flown(self.successive.paths, i), self.successive
        if successive.lack(i, self._clearance, among) > self._too_much:
            successive.missed[i] = np.inf
            self._pace(i, route, among)
            if successive.missed[i] < np.inf:
                return
        if self._kept(i, among) > self._few:
            self._pace(i, route, among)

    def _kept(self, i: int, among: Counts) -> float:
        """Plan a vehicle from its latest path on; return what it misses [m]."""
        return self.successive.keep_clear(i, self._clearance, (_ROUNDS, _PENALTY), among)

    def _pace(self, i: int, route: Matrix, among: Counts) -> None:
        """Plan a vehicle on a route at the best pace, if that leads to a better path."""
        successive, model = self.successive, self._models[i]
        hazards, before = successive.hazards, successive.solo_plan(i)
        found = self._toured(i, route)
        if found is None:
            return
        counts = among[:-1].copy()
        counts[i] = False
        others = crowding(found.laid_out, hazards, successive.paths, counts, self._clearance)
        paced = found.laid_out.paced(hazards.horizon, found.due, others)
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
        before = kept = successive.solo_plan(i)
        if not model.vehicle.via or before.missed <= self._few:
            return
        for moved in shifted(model, [first for first, _ in windows_of(before.model)]):
            self._visit_at(i, before, moved)
            if self._kept(i, among) < kept.missed:
                kept = successive.solo_plan(i)
            if kept.missed <= self._few:
                break
        successive.come_back(i, kept)

    def _visit_at(self, i: int, known: SoloPlan, steps: tuple[int, ...]) -> None:
        """Have a vehicle make its visits at other steps, on the route that it knows."""
        model, given = self._models[i], known.model
        arrival = None
        if model.time_cost > 0.0:
            arrival = given.vehicle.goal.window(model.horizon)[1]
        before = [first for first, _ in windows_of(given)]
        self.successive.make_visits(i, at_steps(model, steps, arrival))
        self.successive.refer(i, warped(known.means, before, steps))

    def _toured(self, i: int, route: Matrix) -> Tour | None:
        """Lay out a route."""
        assert self._clear is not None
        kept = np.append(True, np.linalg.norm(np.diff(route, axis=0), axis=1) > _TINY)
        if kept.sum() < 2:
            return None
        known = self._clear, self._clearance
        return tour(self.successive.hazards, self._models[i], i, route[kept], known)


def _as_flown(paths: Paths, i: int) -> Matrix:
    """Return the places of a path at its steps and half-way between them, (2T+1, d) [m]."""
    steps = paths.means[i]
    middles = 0.5 * (steps[1:] + steps[:-1]) + paths.sagittas[i]
    route = np.empty((len(steps) + len(middles), steps.shape[1]))
    route[::2], route[1::2] = steps, middles
    return route
