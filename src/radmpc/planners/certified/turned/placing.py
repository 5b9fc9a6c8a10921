"""Attempts that begin with vehicles placed apart: on their paths, in order, or all together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from radmpc.arrays import Matrix
from radmpc.planners.certified.turned.attempt import Attempt, Begin
from radmpc.planners.certified.turned.narrow.clear import Clear
from radmpc.planners.certified.turned.narrow.knots import joint_routes
from radmpc.planners.certified.turned.narrow.pacing import Pacing
from radmpc.planners.certified.turned.narrow.prioritized import prioritized_ticks
from radmpc.planners.certified.turned.narrow.routes import (
    distinct_corners,
    pulled_routes,
    shortest_routes,
)
from radmpc.planners.certified.turned.paths import evenly
from radmpc.planners.certified.turned.straight import StandingFaces
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.solvers.solution import Limits

__all__ = ["placed_apart", "placed_in_space"]

_PLANE = 2
"""Dimension in which vehicles are placed in order, or all together."""


def placed_apart(begin: Begin, rng: np.random.Generator, limits: Limits) -> Iterator[Attempt]:
    """Place vehicles apart: on their paths, in order, or all together tick by tick.

    Parameters
    ----------
    begin : Begin
        What attempts begin with.
    rng : Generator
        Draws joint routes, and paces.
    limits : Limits
        When to stop.

    Yields
    ------
    Attempt
        Each begins with other places.
    """
    placing = _Placing(begin, rng, limits)
    yield from placing.on_shortest()
    if begin.task.hazards.count == 1 or limits.reached:
        return
    yield from placing.in_order()
    yield from placing.together()
    if not placing.ordered:
        yield from placing.in_order()
    if placing.ordered:
        yield Attempt(begin.referring(placing.ordered), TUNING.max_sweeps)
        yield from placing.as_ordered()


def placed_in_space(begin: Begin, rng: np.random.Generator, limits: Limits) -> Iterator[Attempt]:
    """Place vehicles in space on routes that are known, at a pace that takes their corners.

    Parameters
    ----------
    begin, rng, limits
        As in `placed_apart`.

    Yields
    ------
    Attempt
        Begins with these places; nothing in the plane, without obstacles in the way, or where
        visits are asked for.
    """
    hazards = begin.task.hazards
    is_space = hazards.dimension != _PLANE and not limits.reached
    vehicles = [model.vehicle for model in hazards.models]
    are_apt = all(v.system.is_double_integrator and not v.via for v in vehicles)
    if begin.routes and is_space and are_apt:
        yield from _Placing(begin, rng, limits).in_space()


class _Placing:
    """The paces of a fleet, and where prioritized planning has vehicles at each step."""

    def __init__(self, begin: Begin, rng: np.random.Generator, limits: Limits) -> None:
        self._begin, self._rng, self._limits = begin, rng, limits
        hazards = begin.task.hazards
        self._clear = Clear.of(hazards)
        self._pacing: Pacing | None = None
        if self._clear is not None:
            self._pacing = Pacing(hazards, self._clear, begin.clearance)
        self.ordered: dict[int, Matrix] = {}
        self._ticks, self._is_paced = 0, False

    def on_shortest(self) -> Iterator[Attempt]:
        """Begin on the shortest routes."""
        hazards, clearance = self._begin.task.hazards, self._begin.clearance
        if self._clear is None or self._pacing is None:
            return
        self._pacing.offer(shortest_routes(hazards, self._clear, clearance))
        yield from self._paced(self._pacing.run(range(hazards.count), self._is_stopped))

    def in_space(self) -> Iterator[Attempt]:
        """Begin on the routes that are known, others on straight lines."""
        hazards, alone = self._begin.task.hazards, self._begin.alone.paths.means
        self._pacing = Pacing(hazards, StandingFaces.of(hazards), self._begin.clearance)
        corners = {i: alone[i][[0, -1]] for i in range(hazards.count)}
        corners |= {i: route.corners for i, route in self._begin.routes.items()}
        self._pacing.offer({i: [distinct_corners(route)] for i, route in corners.items()})
        yield from self._paced(self._pacing.run(range(hazards.count), self._is_stopped))

    def in_order(self) -> Iterator[Attempt]:
        """Begin on routes planned one after the other; asked again, at full speed."""
        hazards, clearance = self._begin.task.hazards, self._begin.clearance
        placed, self._ticks = prioritized_ticks(hazards, self._is_stopped, self._ticks)
        self.ordered = {i: path[:: self._ticks] for i, path in placed.items()}
        if not placed or self._clear is None or self._pacing is None:
            return
        self._pacing.offer(pulled_routes(hazards, self._clear, placed, clearance))
        paced = self._pacing.run(tuple(placed), self._is_stopped)
        self._is_paced = bool(paced)
        yield from self._paced(paced)

    def as_ordered(self) -> Iterator[Attempt]:
        """Begin with routes that were planned in order where no pace on each fits all.

        Who is first takes the best pace, which may leave others none. As planned, all have one.
        """
        if self._pacing is not None and not (self._is_paced or self._limits.reached):
            yield from self._paced(self._pacing.mend(self.ordered, self._is_stopped))

    def together(self) -> Iterator[Attempt]:
        """Begin on routes of all, tick by tick, drawn several times."""
        hazards, clearance = self._begin.task.hazards, self._begin.clearance
        for _ in range(TUNING.joint_attempts):
            if self._clear is None or self._pacing is None or self._limits.reached:
                break
            joint = joint_routes(hazards, self._clear, self._rng.spawn(1)[0], self._is_stopped)
            if not joint:
                break
            self._pacing.offer(pulled_routes(hazards, self._clear, joint, clearance))
            places = {i: evenly(route, hazards.horizon) for i, route in joint.items()}
            yield from self._paced(self._pacing.mend(places, self._is_stopped))

    def _paced(self, places: Mapping[int, Matrix]) -> Iterator[Attempt]:
        """Begin with places at a pace, if any; then with a finer one for those who missed it."""
        if self._pacing is None or not places:
            return
        turning, hazards = self._begin.referring(places), self._begin.task.hazards
        sweeps, penalty = TUNING.paced_sweeps, TUNING.paced_penalty
        # A small fleet is through with all that follows as soon.
        mending = self._rng if hazards.count > TUNING.few else None
        yield Attempt(turning, sweeps, penalty, is_placed=True, rng=mending)
        few = TUNING.misses * float(hazards.radii.mean())
        missing = np.flatnonzero(turning.successive.missed > few).tolist()
        if not missing or self._limits.reached:
            return
        finer = self._pacing.refine(missing, self._is_stopped)
        if all(np.array_equal(finer[i], places[i]) for i in missing):
            return
        turning = self._begin.referring(finer)
        yield Attempt(turning, sweeps, penalty, is_placed=True, rng=mending)

    def _is_stopped(self) -> bool:
        return self._limits.reached
