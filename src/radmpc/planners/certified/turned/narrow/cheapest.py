"""Of several routes around obstacles, for each vehicle the one of the least effort alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from radmpc.arrays import Indices, Matrix
from radmpc.planners.certified.state.task import Task
from radmpc.planners.certified.turned.detours import NARROW, Toll, detours
from radmpc.planners.certified.turned.grid import Grid, finest
from radmpc.planners.certified.turned.narrow.route import Route
from radmpc.planners.certified.turned.straight import StandingFaces, pulled
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.program.hazards import Hazards
from radmpc.records import dataclass, field

__all__ = ["cheapest_routes"]

_MOST_ROUTES = 4
"""Routes of a vehicle on a grid that are compared at most [-]: the shortest that keeps clear of
gaps where it can, that through gaps, and both again beside all before."""

_GOOD = 1.3
"""Effort of a route, in multiples of what it would take without obstacles, at which no other is
sought [-]."""

_WORK = 18_000
"""Obstacles times steps of the vehicles for which paths of least effort are sought, those with the
dearest routes first [-]: six vehicles of `clutter(10, 100)` take 0.9 s, all ten made first plans no
cheaper."""

_STUCK = 0.25
"""Share of the vehicles that are stuck on all of their routes above which no path is sought [-]: so
many are in narrow ways, where paces decide. Half of ten robots among 204 boxes are, one of ten in
`clutter(10, 100, 0)`."""

_SWEEPS = 6
"""Times that a vehicle is planned on a route, at most [-]: most take one to three."""

_MISSED, _MOST_MISSED, _LACKING = 0.02, 0.2, 10.0
"""What a vehicle may miss there at no charge, and at most, to count as a route all the same, since
turning half-spaces gains that [m]; and what is charged for the rest of it [effort per m]. Among the
nine boxes of db-CBS `forest` cheap routes miss 0.03 to 0.09 m, and those that miss nothing cost
twice as much."""

_PLANE = 2
"""Dimension in which paces are sought beside, on a grid of their own."""

_ENOUGH = 0.1
"""What a vehicle may miss on a path of least effort for none with less risk to be sought [m]."""


def cheapest_routes(
    task: Task,
    alone: SuccessiveLp,
    stopped: Sequence[int] | Indices,
    clearance: float,
    price: float | None,
    *,
    is_quick: bool = False,
) -> dict[int, Route]:
    """Return routes around obstacles: the shortest, or others where these take less effort.

    What is short on a grid may wind, and whoever keeps clear of all gaps may go far around. Two or
    three linear programs of one vehicle tell what a route takes: 2 to 5 ms among a hundred boxes.
    Where all routes are dear, the path of least effort is sought on a lattice.

    Parameters
    ----------
    task : Task
        What is asked.
    alone : SuccessiveLp
        What vehicles do by themselves, and their linear programs.
    stopped : sequence of int
        Those that obstacles stop.
    clearance : float
        Standard deviations that they keep [-].
    price : float or None
        Cost of risk, per unit of probability; None where no path is sought on a lattice: those of
        many in conflict are better described by the order of passing.
    is_quick : bool
        Whether the relaxation tells better sides soon: the shortest routes will do then. Plans of
        `paper(8)` come after 0.95 of the time, and end as cheap.

    Returns
    -------
    dict of int to Route
        The routes of those for which there is one.
    """
    hazards = task.hazards
    grid = Grid.of(hazards)
    shortest = _shortest(hazards, stopped, clearance, grid)
    if is_quick or len(shortest) > TUNING.weighed:
        return {i: Route.evenly(hazards.models[i], corners) for i, corners in shortest.items()}
    comparison = _Comparison(task, alone, clearance)
    comparison.compare_routes(grid, shortest)
    if price is not None:
        comparison.seek(price)
    # A vehicle that was not planned on any in time takes the shortest.
    return {
        i: comparison.best.get(i) or Route.evenly(hazards.models[i], corners)
        for i, corners in shortest.items()
    }


def _shortest(
    hazards: Hazards, stopped: Sequence[int] | Indices, clearance: float, grid: Grid
) -> dict[int, Matrix]:
    """Return the shortest routes; of those without one, on a grid that tells narrower ways.

    Between points of a coarse grid an obstacle may stand.
    """
    found = detours(hazards, stopped, clearance, grid)
    around = None if hazards.dimension == _PLANE else StandingFaces.of(hazards)
    left = [
        int(i)
        for i in stopped
        if i not in found or not (around is None or _is_open(around, found[int(i)]))
    ]
    count = finest(hazards)[0] if left else 0
    if count <= max(grid.shape):
        return found
    finer = None if around is None else Grid.beside_faces(hazards, clearance)
    if around is None or finer is None:
        return found | detours(hazards, left, clearance, Grid.of(hazards, count))
    others = detours(hazards, left, clearance, finer)
    for i, route in others.items():
        # Pulled straight it would lead past visits.
        is_straight = not hazards.models[i].vehicle.via
        found[i] = pulled(around, route, _room(hazards, i, clearance)) if is_straight else route
    return found


def _room(hazards: Hazards, i: int, clearance: float) -> float:
    """Return how far a vehicle's center keeps from obstacles [m]."""
    spread = float(np.sqrt(hazards.variances[i].max() / hazards.dimension))
    return float(hazards.radii[i]) + clearance * spread


def _is_open(around: StandingFaces, route: Matrix) -> bool:
    """Whether a route leads through no obstacle."""
    return bool(around.are_open(route[:-1], route[1:]).all())


@dataclass(slots=True, eq=False)
class _Comparison:
    """The cheapest routes so far.

    Attributes
    ----------
    task : Task
        What is asked.
    alone : SuccessiveLp
        What vehicles do by themselves, and their linear programs.
    clearance : float
        Standard deviations that they keep [-].
    best : dict of int to Route
        The cheapest route of each.
    costs : dict of int to (bool, float)
        Whether that misses too much, and its effort with what is charged for the rest.
    """

    task: Task
    alone: SuccessiveLp
    clearance: float
    best: dict[int, Route] = field(default_factory=dict)
    costs: dict[int, tuple[bool, float]] = field(default_factory=dict)
    _trial: SuccessiveLp = field(init=False)

    def __post_init__(self) -> None:
        """Begin without a vehicle on any route."""
        self._trial = SuccessiveLp(self.task.hazards, self.task.limits, self.alone.programs)

    def compare_routes(self, grid: Grid, shortest: Mapping[int, Matrix]) -> None:
        """Compare the shortest ways over a grid, until one is good enough."""
        hazards, limits = self.task.hazards, self.task.limits
        direct = detours(hazards, list(shortest), self.clearance, grid, Toll(1.0))
        for i, first in shortest.items():
            known = [first, direct.get(i, first)]
            for number in range(_MOST_ROUTES):
                if limits.reached:
                    return
                if number >= len(known):
                    toll = Toll((NARROW, 1.0)[number % 2], tuple(known))
                    other = detours(hazards, [i], self.clearance, grid, toll)
                    known.append(other.get(i, first))
                if any(np.array_equal(known[number], one) for one in known[:number]):
                    continue
                missed = self._offer(i, Route.evenly(hazards.models[i], known[number]))
                if missed <= _MISSED and self._ratio(i) <= _GOOD:
                    break

    def seek(self, price: float) -> None:
        """Seek paths of the least effort at a price of risk for those whose routes are dear."""
        dear = [i for i in self.best if self._ratio(i) > _GOOD]
        num_stuck = sum(misses for misses, _ in self.costs.values())
        if not dear or num_stuck > _STUCK * len(self.costs):
            return
        from radmpc.planners.certified.turned.narrow.least_effort import least_effort_paths  # noqa: PLC0415 - few need it

        hazards = self.task.hazards
        count = _WORK // (max(hazards.shapes.count, 1) * hazards.horizon)
        for i in sorted(dear, key=self._ratio, reverse=True)[: max(count, 1)]:
            for path in least_effort_paths(self.task, i, price):
                if self.task.limits.reached:
                    return
                if self._offer(i, Route(path, path)) <= _ENOUGH:
                    break

    def _ratio(self, vehicle: int) -> float:
        """Return the cost of a vehicle's best route over what it takes without obstacles [-]."""
        misses, cost = self.costs[vehicle]
        least = float(np.abs(self.alone.paths.controls[vehicle]).sum())
        if misses or cost > least == 0.0:
            return np.inf
        return cost / least if cost > 0.0 else 1.0

    def _offer(self, vehicle: int, route: Route) -> float:
        """Keep a route if it is the cheapest of a vehicle; return what is missed there [m]."""
        self._trial.restore(self.alone.paths.state())
        self._trial.refer(vehicle, route.places)
        best = self.costs.get(vehicle, (True, np.inf))
        missed, effort = self._planned(vehicle, np.inf if best[0] else best[1])
        cost = missed > _MOST_MISSED, effort + _LACKING * max(missed - _MISSED, 0.0)
        if cost < best:
            self.best[vehicle], self.costs[vehicle] = route, cost
        return missed

    def _planned(self, vehicle: int, enough: float) -> tuple[float, float]:
        """Return what a vehicle misses once planned where it was referred to, and its effort.

        It is planned until it misses nothing and no longer moves past what it was not kept clear
        of, or its effort is enough to know that others are better: effort grows with what a miss
        costs.
        """
        trial, missed, effort = self._trial, np.inf, np.inf
        penalty, reach = TUNING.first_penalty, float(self.task.hazards.reaches[vehicle])
        for _ in range(_SWEEPS):
            before = trial.paths.means[vehicle].copy()
            trial.plan_alone(vehicle, self.clearance, penalty)
            moved = float(np.abs(trial.paths.means[vehicle] - before).max())
            missed = float(trial.missed[vehicle])
            effort = float(np.abs(trial.paths.controls[vehicle]).sum())
            is_there = missed <= _MISSED and moved <= reach
            if is_there or effort >= enough or self.task.limits.reached:
                break
            penalty = min(TUNING.penalty_growth * penalty, TUNING.last_penalty)
        return missed, effort
