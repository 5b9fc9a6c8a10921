"""Neighborhood search: a few vehicles of the best plan are rerouted or retimed, again and again.

Large neighborhood search (Shaw 1998; for many robots Li et al. 2021). Half-spaces that are turned
keep the order in which vehicles pass each other, and where many meet, or passages are narrow, the
search over faces takes long to find another one.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence

import numpy as np

from radmpc.arrays import Matrix
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.phases.replanning import Replanning
from radmpc.planners.certified.phases.tuning import TUNING
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.task import task_of
from radmpc.planners.certified.turned.detours import NARROW, Toll, detours
from radmpc.planners.certified.turned.grid import Grid
from radmpc.planners.certified.turned.near import first_clearance
from radmpc.planners.certified.turned.paths import Paths, arched, timed_anyhow
from radmpc.planners.certified.turned.tuning import TUNING as TURNING
from radmpc.planners.certified.turned.turning import Turning
from radmpc.planners.verdict import Judge
from radmpc.program.hazards import Hazards
from radmpc.records import dataclass, replace

__all__ = ["search_neighborhoods"]

_LOG = logging.getLogger(__name__)

_LITTLE = 0.02
"""What a vehicle counts as giving up at least: this share of what all cost [-], since who gives up
nothing may stand in the way of others, and as much effort besides, for plans that cost nothing."""

_REPLANNED = 0.6
"""Share of neighborhoods that are replanned on a lattice, not drawn [-]: `zigzag` within 60 s costs
3.96 to 4.02 (three seeds), with 1 up to 4.5, with 0 up to 4.6."""

_MANY, _MOST = 0.25, 8
"""Share of those in which many are replanned, not up to three: that leaves what three cannot; and
vehicles of them at most [-]. `zigzag` then costs 3.99 to 4.09 (six seeds, after 25 s on two loaded
cores), without 4.00 to 4.57, with 0.4 of 0.8 replanned 4.02 to 4.43."""

_TELLING = 2
"""Turns of half-spaces that tell what a neighborhood leads to [-]."""


@dataclass(frozen=True, slots=True)
class _Begin:
    """How vehicles are kept apart from where a neighborhood begins, and when that is given up.

    Attributes
    ----------
    sweeps : int
        Sweeps over the fleet, at most [-].
    penalty : float
        Of a meter missed in the first of them, see `Tuning.first_penalty` [-].
    promising : float
        Multiple of the best plan's cost above which a neighborhood is left before any turn [-].
    hopeful : float
        The same after those that tell [-].
    """

    sweeps: int
    penalty: float
    promising: float
    hopeful: float


_DRAWN = _Begin(sweeps=24, penalty=TURNING.first_penalty, promising=np.inf, hopeful=1.1)
"""Where places are drawn: what led to cheaper plans of `zigzag` missed less than half a meter after
11 to 28 sweeps. Of 18 neighborhoods those that led to a cheaper plan came to 1.07 times its cost at
most after two turns, most others to 1.1 to 1.4."""

_IN_THE_OPEN = replace(_DRAWN, promising=1.02, hopeful=1.02)
"""Where there is no obstacle: of 90 neighborhoods of `circle(8)`, `circle(16)` and LSC's
`multi_square8` and `square16` those that led to a cheaper plan were dearer than the best by 1.7 %
at most before any turn, and after two, but for one that came from 2.8 to -0.04 %."""

_PLACED = _Begin(sweeps=6, penalty=3000.0, promising=1.0, hopeful=1.0)
"""Where places are clear of each other: with a small penalty they leave them, and miss more in the
end. Of 21 neighborhoods of `zigzag` those that led to a cheaper plan were 9 % cheaper than the last
one before any turn, and 4 % after two; who was dearer ended dearer."""

_STANDS = 1e-3
"""What a vehicle moves by in a step at most where it counts as waiting [m]."""


def search_neighborhoods(
    fleet: Fleet,
    found: FleetIncumbent,
    judge: Judge,
    rng: np.random.Generator,
    on_cheaper: Callable[[FleetIncumbent], None] | None = None,
) -> FleetIncumbent:
    """Reroute or retime a few vehicles, again and again, while that makes the plan cheaper.

    All others begin with what they do in the plan. Everyone is kept apart from there, and
    half-spaces are turned.

    Parameters
    ----------
    fleet : Fleet
        The fleet, and when to stop.
    found : FleetIncumbent
        A certified plan.
    judge : callable
        The referee.
    rng : Generator
        Draws vehicles, routes and times.
    on_cheaper : callable or None
        Given every cheaper plan; None is what the fleet is asked to do with one.

    Returns
    -------
    FleetIncumbent
        The cheapest plan.
    """
    task = task_of(fleet, judge, found.controls)
    task = task if on_cheaper is None else replace(task, found=on_cheaper)
    # Dear, as for first plans: a falling price stays near what is certified.
    price = TURNING.first_dear * fleet.first_unit_price(fleet.least_budget) / fleet.unit
    hazards, limits, num_idle = task.hazards, task.limits, 0
    clearance = first_clearance(hazards, task.risk_bound)
    draws, replanning = _Draws(hazards, clearance, rng), Replanning(fleet, price, rng)
    allowed = TURNING.nearly * float(hazards.radii.mean())
    while num_idle < TUNING.idle_neighborhoods and not limits.reached:
        turning = Turning(task, found, found.sets, price)
        successive, chosen = turning.successive, draws.vehicles(found, fleet.base)
        successive.begin(found.controls)
        placed: dict[int, Matrix] = {}
        if replanning.is_planar and rng.random() < _REPLANNED:
            replanned = draws.many() if rng.random() < _MANY else chosen
            placed = replanning.places(replanned, successive.paths.means)
            chosen = replanned if placed else chosen
        for i in chosen:
            place = placed.get(i)
            successive.refer(i, draws.places(i, found.controls[i]) if place is None else place)
        begin = _PLACED if placed else draws.begin
        terms = TURNING.narrower * clearance, begin.sweeps, limits, begin.penalty
        successive.keep_apart(*terms, is_shared=bool(placed))
        least = (1.0 - TUNING.little * task.gap) * found.cost
        is_cheap = successive.paths.cost() <= begin.promising * found.cost
        if float(successive.missed.sum()) <= allowed and is_cheap:
            successive.restore(successive.paths.state())
            found = turning.run(_TELLING, found.cost)
            if successive.paths.cost() <= begin.hopeful * found.cost:
                found = turning.run(TURNING.first_rounds, found.cost)
        num_idle = 0 if found.cost < least else num_idle + 1
        _LOG.info("vehicles %s rerouted or retimed: best cost %.6g", chosen, found.cost)
    return found


@dataclass(slots=True, eq=False)
class _Draws:
    """Which vehicles are rerouted or retimed, and how.

    Attributes
    ----------
    hazards : Hazards
        The fleet.
    clearance : float
        Standard deviations that routes keep from obstacles [-].
    rng : Generator
        Draws vehicles, routes and times.
    """

    hazards: Hazards
    clearance: float
    rng: np.random.Generator
    _grid: Grid | None = None

    @property
    def begin(self) -> _Begin:
        """How vehicles are kept apart where these are drawn."""
        return _DRAWN if self.hazards.shapes.count else _IN_THE_OPEN

    def vehicles(self, plan: FleetIncumbent, alone: Sequence[float]) -> tuple[int, ...]:
        """Draw up to three vehicles, one of them for what it gives up.

        Who costs much more than alone has much to gain elsewhere.
        """
        costs = np.array([self._cost(i, controls) for i, controls in enumerate(plan.controls)])
        given_up = np.maximum(costs - np.asarray(alone), _LITTLE * costs.sum() + _LITTLE)
        first = int(self.rng.choice(costs.size, p=given_up / given_up.sum()))
        others = [i for i in range(costs.size) if i != first]
        count = int(self.rng.integers(min(len(others), TUNING.most_led - 1) + 1))
        return first, *self.rng.choice(others, count, replace=False).tolist()

    def many(self) -> tuple[int, ...]:
        """Draw as many as are replanned at most."""
        count = self.hazards.count
        return tuple(self.rng.choice(count, min(count, _MOST), replace=False).tolist())

    def _cost(self, i: int, controls: Matrix) -> float:
        """Return what a vehicle's effort costs."""
        return self.hazards.models[i].vehicle.cost_weight * float(np.abs(controls).sum())

    def places(self, i: int, controls: Matrix) -> Matrix:
        """Draw where a vehicle is at each step, (T+1, d) [m].

        On its route, on another one around obstacles, or nearly straight ahead.
        """
        own = self._corners(i, controls)
        kind = self.rng.integers(3)
        if kind == 0 and len(own) > 1:
            route = own
        elif kind == 1 and self.hazards.shapes.count:
            self._grid = self._grid or Grid.of(self.hazards)
            toll = Toll(float(self.rng.choice((NARROW, 1.0))), (own,))
            found = detours(self.hazards, (i,), self.clearance, self._grid, toll)
            route = found.get(i, own)
        else:
            route = arched(self.hazards, i, TURNING.most_arc * self.rng.uniform(-1.0, 1.0))
        return timed_anyhow(self.hazards, i, route, self.rng)

    def _corners(self, i: int, controls: Matrix) -> Matrix:
        """Return where a vehicle is without the steps at which it waits, (p, d) [m]."""
        paths = Paths(self.hazards)
        paths.fly(i, controls)
        means = paths.means[i]
        moves = np.linalg.norm(np.diff(means, axis=0), axis=1) > _STANDS
        return np.asarray(means[np.append(True, moves)])
