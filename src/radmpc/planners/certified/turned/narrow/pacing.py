"""At which pace vehicles go along given routes, each clear of those placed before it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from radmpc.arrays import Matrix
from radmpc.planners.certified.turned.narrow.clear import Clear
from radmpc.planners.certified.turned.narrow.closeness import closeness, passing_by
from radmpc.planners.certified.turned.narrow.track import Closeness, Track, track
from radmpc.planners.certified.turned.narrow.tuning import TUNING
from radmpc.planners.certified.turned.straight import StandingFaces
from radmpc.program.hazards import Hazards

__all__ = ["Pacing"]


class Pacing:
    """A fleet that is placed on routes, one vehicle after the other.

    Parameters
    ----------
    hazards : Hazards
        The fleet: double integrators.
    clear : Clear or StandingFaces
        How far places are from obstacles.
    clearance : float
        Standard deviations to keep from everything [-].
    """

    def __init__(self, hazards: Hazards, clear: Clear | StandingFaces, clearance: float) -> None:
        self._hazards, self._clearance = hazards, clearance
        self._kept = clear, clearance
        self._routes: dict[int, list[Matrix]] = {}
        self._tracks: dict[int, list[tuple[Track, float]]] = {}
        self._placed: dict[int, Matrix] = {}
        self._offered: set[tuple[int, bytes, float]] = set()
        self._known: dict[tuple[int, int], tuple[Matrix, Closeness]] = {}
        self._hurry = 0.0

    def offer(self, routes: Mapping[int, Sequence[Matrix]], fineness: float = 1.0) -> None:
        """Let vehicles take routes, too, as far as there is any pace for them.

        Parameters
        ----------
        routes : mapping of int to sequence of (p, 2) array
            Corners of routes from each vehicle's start to its goal [m].
        fineness : float
            Places on the routes, in multiples of the usual number [-].
        """
        for i, choices in routes.items():
            self._routes.setdefault(i, [])
            new = [route for route in choices if self._is_new(i, route, fineness)]
            self._routes[i] += [route for route in new if fineness == 1.0]
            for route in new:
                laid_out = track(self._hazards, i, route, self._kept, fineness)
                alone = None if laid_out is None else laid_out.paced(self._hazards.horizon, ())
                if laid_out is not None and alone is not None:
                    self._tracks.setdefault(i, []).append((laid_out, alone[1]))
                    self._tracks[i].sort(key=lambda one: one[1])

    def _is_new(self, vehicle: int, route: Matrix, fineness: float) -> bool:
        """Tell whether a route is offered for the first time, with so many places."""
        key = vehicle, route.tobytes(), fineness
        if key in self._offered:
            return False
        self._offered.add(key)
        return True

    def refine(self, vehicles: Sequence[int], is_stopped: Callable[[], bool]) -> dict[int, Matrix]:
        """Return the latest places, some vehicles at the best pace of a finer choice.

        Parameters
        ----------
        vehicles : sequence of int
            Who find no controls for the pace they have.
        is_stopped : callable
            Returns True once it is time to stop.
        """
        for fineness in TUNING.finenesses:
            self.offer({i: self._routes[i] for i in vehicles if i in self._routes}, fineness)
        return self.mend(self._placed, is_stopped, vehicles)

    def run(self, order: Sequence[int], is_stopped: Callable[[], bool]) -> dict[int, Matrix]:
        """Return where vehicles are at each step, each on the best of its routes.

        At least effort a vehicle takes all the time there is: where nobody finds a pace after it,
        all of them hurry to their goals.

        Parameters
        ----------
        order : sequence of int
            Who is placed first; who finds no pace is put first, and all begin again.
        is_stopped : callable
            Returns True once it is time to stop.

        Returns
        -------
        mapping of int to (T+1, 2) array
            Positions [m]; empty where no order of those tried leads to any.
        """
        placed = self._in_order(tuple(order), is_stopped)
        if placed or is_stopped():
            return placed
        self._hurry = TUNING.hurry
        placed = self._in_order(tuple(order), is_stopped)
        self._hurry = 0.0
        return placed

    def _in_order(
        self, following: tuple[int, ...], is_stopped: Callable[[], bool]
    ) -> dict[int, Matrix]:
        """Return where vehicles are, placed in an order or one that follows from it; or nothing."""
        tried: set[tuple[int, ...]] = set()
        count = len(following)
        while (
            len(tried) < TUNING.pace_orders
            and following not in tried
            and len(self._tracks) == count
        ):
            tried.add(following)
            self._placed = {}
            for i in following:
                if is_stopped():
                    return {}
                if not self._place(i):
                    following = (i, *(j for j in following if j != i))
                    break
            else:
                return dict(self._placed)
        return {}

    def mend(
        self,
        places: Mapping[int, Matrix],
        is_stopped: Callable[[], bool],
        vehicles: Sequence[int] | None = None,
    ) -> dict[int, Matrix]:
        """Return places at a pace that vehicles can keep, as far as all others' leave one.

        Parameters
        ----------
        places : mapping of int to (T+1, 2) array
            Where everyone is at each step [m], clear of each other, at whatever speed.
        is_stopped : callable
            Returns True once it is time to stop.
        vehicles : sequence of int or None
            Who may be placed again; None for all.
        """
        self._placed = dict(places)
        for _ in range(TUNING.mends):
            for i in sorted(self._tracks) if vehicles is None else vehicles:
                if is_stopped():
                    return dict(self._placed)
                before = self._placed.pop(i)
                if not (i in self._tracks and self._place(i)):
                    self._placed[i] = before
        return dict(self._placed)

    def _place(self, vehicle: int) -> bool:
        """Place a vehicle at the best pace on any of its routes; tell whether there is one."""
        best: tuple[Matrix, float] | None = None
        placed = np.array(list(self._placed))
        paths = np.array(list(self._placed.values()))
        for each, alone in self._tracks[vehicle]:
            if best is not None and alone >= best[1]:
                # Others only make it dearer; the routes come in the order of what they cost alone.
                break
            others: list[Closeness] = []
            if placed.size:
                beside = placed[passing_by(self._hazards, each, paths, self._clearance)]
                others = [self._closeness(each, j) for j in beside.tolist()]
            found = each.paced(self._hazards.horizon, others, hurry=self._hurry)
            if found is not None and (best is None or found[1] < best[1]):
                best = found
        if best is not None:
            self._placed[vehicle] = best[0]
        return best is not None

    def _closeness(self, each: Track, other: int) -> Closeness:
        """Return what being near a placed vehicle costs; kept while that one stays on its path."""
        path, key = self._placed[other], (id(each), other)
        known = self._known.get(key)
        if known is None or not np.array_equal(known[0], path):
            known = path, closeness(self._hazards, each, other, path, self._clearance)
            self._known[key] = known
        return known[1]
