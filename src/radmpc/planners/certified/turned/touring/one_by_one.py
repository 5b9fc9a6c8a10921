"""Single vehicles planned again, visits at other steps, while all others stay."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Matrix, Vector
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.normals.spaces import HalfSpaces
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.touring.solo_plan import SoloPlan, heights_on
from radmpc.planners.certified.turned.touring.tour_lp import TourLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.program.condensed import CondensedModel
from radmpc.program.hazards import Hazards
from radmpc.records import replace
from radmpc.solvers.solution import Limits

__all__ = ["Counts", "OneByOne"]

_LITTLE = 1e-7
"""What half-spaces may be missed by in all [m]."""

_REACH, _LEAST_REACH = 0.25, 0.1
"""Room around a path within which half-spaces are turned to it, at first and at least [moves]: what
it comes near beyond gets one the next time. A linear program of 50 has a fifth of the rows."""

_TELLING = 0.05
"""Share of what the worst pair misses from which on others count [-]."""

_TIGHT = 0.3
"""Room on a path beside what is asked for below which a half-space is in its linear program from
the first [m]."""

_MORE = 4
"""Times that half-spaces are added to it at most, the first included [-]."""

_FURTHER = 2.0
"""The same in multiples of how far the path moved last [-]."""

Counts = npt.NDArray[np.bool_]
"""Who counts in which windows, (N+1, T); last, whether obstacles and borders do."""


class OneByOne(SuccessiveLp):
    """The latest paths of a fleet of double integrators that are planned one by one.

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    limits : Limits
        When to stop early.
    """

    def __init__(self, hazards: Hazards, limits: Limits) -> None:
        super().__init__(hazards, limits)
        self._tours: dict[tuple[int, ...], TourLp] = {}

    def make_visits(self, vehicle: int, model: CondensedModel) -> None:
        """Have a vehicle make its visits at other steps.

        Parameters
        ----------
        vehicle : int
            Its number.
        model : CondensedModel
            The vehicle with its visits at these steps.
        """
        models = list(self.hazards.models)
        models[vehicle] = model
        self.hazards = replace(self.hazards, models=tuple(models))
        self.programs.follow(self.hazards, vehicle)
        self.missed[vehicle] = np.inf

    def solo_plan(self, vehicle: int) -> SoloPlan:
        """Return what a vehicle does, for `come_back`.

        Parameters
        ----------
        vehicle : int
            Its number.
        """
        paths = self.paths
        return SoloPlan(
            self.hazards.models[vehicle],
            paths.controls[vehicle],
            paths.means[vehicle].copy(),
            float(self.missed[vehicle]),
        )

    def come_back(self, vehicle: int, plan: SoloPlan) -> None:
        """Have a vehicle do again what it did.

        Parameters
        ----------
        vehicle : int
            Its number.
        plan : SoloPlan
            What `solo_plan` returned.
        """
        if self.hazards.models[vehicle] is not plan.model:
            self.make_visits(vehicle, plan.model)
        self.paths.fly(vehicle, plan.controls)
        if not self._is_at(vehicle, plan.means):
            self.paths.refer(vehicle, plan.means)
        self.missed[vehicle] = plan.missed

    def keep_clear(
        self,
        vehicle: int,
        clearance: float,
        tries: tuple[int, float],
        counts: Counts,
    ) -> float:
        """Plan one vehicle again and again until it keeps a clearance; all others stay.

        Parameters
        ----------
        vehicle : int
            Its number.
        clearance : float
            Standard deviations that it keeps [-].
        tries : tuple of int and float
            Times that it is planned at most [-], and the first penalty as in `keep_apart`.
        counts : (N+1, T) bool array
            Of whom it keeps clear in which windows.

        Returns
        -------
        float
            How far half-spaces are missed [m]; inf where it does not reach its goal at all.
        """
        rounds, penalty = tries[0], tries[1] * self.meter
        most, is_flown = float(self.hazards.reaches[vehicle]), self._is_flown(vehicle)
        reach, least = most * (_REACH if is_flown else 1.0), np.inf
        self.missed[vehicle] = np.inf
        for number in range(rounds):
            spaces = self._turned_to(vehicle, clearance, reach, counts)
            if number == 0 and is_flown and self._lacks(spaces, clearance).sum() <= _LITTLE:
                self.missed[vehicle] = 0.0
                break
            before = self.paths.means[vehicle].copy()
            missed = self._solve_alone(vehicle, spaces, clearance, penalty)
            if missed is None:
                break
            moved = float(np.abs(self.paths.means[vehicle] - before).max())
            if moved > reach:
                # It may have come near what no half-space was turned to.
                self.paths.means[vehicle] = before
                spaces = self._turned_to(vehicle, clearance, most, counts)
                again = self._solve_alone(vehicle, spaces, clearance, penalty)
                missed = missed if again is None else again
            self.missed[vehicle] = missed
            if missed <= _LITTLE or not missed < TUNING.stuck_at * least:
                break
            least = missed
            reach = float(np.clip(_FURTHER * moved, _LEAST_REACH * most, most))
            penalty = min(TUNING.penalty_growth * penalty, TUNING.last_penalty * self.meter)
        return float(self.missed[vehicle])

    def _turned_to(
        self, vehicle: int, clearance: float, reach: float, counts: Counts
    ) -> HalfSpaces:
        """Return half-spaces turned to the latest path of a vehicle, as far as others count."""
        near = Near(clearance, reach, is_refined=False, is_start_given=True)
        return half_spaces(self.hazards, self.paths, (vehicle,), near, counts=counts)

    def _solve_alone(
        self, vehicle: int, spaces: HalfSpaces, clearance: float, penalty: float
    ) -> float | None:
        """Plan one vehicle between half-spaces; return how far they are missed, None if at all.

        Most half-spaces bind nowhere: those that the path is near to begin with, then those that
        the plan misses, too.
        """
        program, missed = self._tour((vehicle,)), None
        needed = spaces.offsets + clearance * spaces.deviations
        is_in = np.asarray((spaces.heights - needed < _TIGHT).any(axis=1))
        for _ in range(_MORE):
            part = spaces.of(is_in)
            found = program.solve(part, self.paths, clearance, penalty)
            if found is None:
                return missed
            controls, shortfall = found
            self.paths.fly(vehicle, controls[0])
            lacks = np.maximum(needed - heights_on(self.paths, spaces), 0.0)
            lacks[spaces.windows == 0, 0] = 0.0
            is_short = (lacks > _LITTLE).any(axis=1) & ~is_in
            missed = shortfall + float(lacks[is_short].sum())
            if not is_short.any():
                break
            is_in |= is_short
        return missed

    def _tour(self, group: tuple[int, ...]) -> TourLp:
        """Return the linear program of a group, with visits where they are made now."""
        found = self._tours.get(group)
        if found is None:
            found = TourLp(self.hazards, group)
            if len(group) == 1:
                self._tours[group] = found
        found.visit([self.hazards.models[i] for i in group])
        return found

    def lack(self, vehicle: int, clearance: float, counts: Counts) -> float:
        """Return how far half-spaces are missed by a vehicle's latest path [m].

        Parameters
        ----------
        vehicle, clearance, counts
            As in `keep_clear`.
        """
        return float(self._lacks(self._turned_to(vehicle, clearance, 0.0, counts), clearance).sum())

    def missing(self, clearance: float) -> Vector:
        """Return how far each vehicle's half-spaces are missed by the latest paths, (N,) [m].

        Parameters
        ----------
        clearance : float
            Standard deviations that everyone keeps from everything [-].
        """
        return self.conflicts(clearance)[0]

    def conflicts(self, clearance: float) -> tuple[Vector, list[tuple[int, int]]]:
        """Return how far half-spaces are missed by the latest paths, and by whom.

        Parameters
        ----------
        clearance : float
            Standard deviations that everyone keeps from everything [-].

        Returns
        -------
        (N,) array
            Of all half-spaces of each [m].
        list of tuple of int
            The pairs that miss more than a little of what the worst one does.
        """
        near = Near(clearance, 0.0, is_refined=True, is_start_given=True)
        spaces = half_spaces(self.hazards, self.paths, range(self.hazards.count), near)
        lacks, count = self._lacks(spaces, clearance), self.hazards.count
        others = spaces.second >= 0
        found = np.zeros(count)
        np.add.at(found, spaces.first, lacks)
        np.add.at(found, spaces.second[others], lacks[others])
        pairs = spaces.first[others] * count + spaces.second[others]
        sums = np.bincount(pairs, lacks[others], count**2)
        telling = np.flatnonzero(sums > _TELLING * float(sums.max(initial=0.0)))
        one, two = np.divmod(telling, count)
        return found, list(zip(one.tolist(), two.tolist(), strict=True))

    def keep_clear_together(
        self, group: tuple[int, ...], clearance: float, tries: tuple[int, float]
    ) -> None:
        """Plan several vehicles together until they keep a clearance; all others stay.

        Parameters
        ----------
        group : tuple of int
            Their numbers, ascending.
        clearance, tries
            As in `keep_clear`.
        """
        rounds, penalty = tries[0], tries[1] * self.meter
        reach = _REACH * float(self.hazards.reaches[list(group)].max())
        program = self._tour(group)
        for _ in range(rounds):
            near = Near(clearance, reach, is_refined=False, is_start_given=True)
            spaces = half_spaces(self.hazards, self.paths, group, near)
            found = program.solve(spaces, self.paths, clearance, penalty)
            if found is None:
                break
            for i, controls in zip(group, found[0], strict=True):
                self.paths.fly(i, controls)
            if found[1] <= _LITTLE:
                break
            penalty *= TUNING.penalty_growth

    def _is_flown(self, vehicle: int) -> bool:
        """Whether the latest path is that of the latest controls."""
        model = self.hazards.models[vehicle]
        flown = model.path(self.paths.controls[vehicle])
        return self._is_at(vehicle, flown)

    def _is_at(self, vehicle: int, means: Matrix) -> bool:
        """Whether the latest path is at given places."""
        return bool(np.abs(means - self.paths.means[vehicle]).max() <= _LITTLE)

    def _lacks(self, spaces: HalfSpaces, clearance: float) -> Vector:
        """Return how far the latest paths miss half-spaces, (w,) [m]; where they start is given."""
        lacks = np.maximum(spaces.offsets + clearance * spaces.deviations - spaces.heights, 0.0)
        if self.hazards.intervals:
            lacks[spaces.windows == 0, 0] = 0.0
        else:
            lacks[:, 0] = 0.0
        return np.asarray(lacks.sum(axis=1))
