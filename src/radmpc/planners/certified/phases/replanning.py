"""Vehicles of a plan replanned one after the other on a lattice, among all others on their way."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix, Tensor
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.lattice.others import around_others
from radmpc.planners.certified.lattice.search import PathSearch, SlacksByKey
from radmpc.records import dataclass, field

__all__ = ["Replanning"]

_PRICES = (-1.0, 0.5)
"""Powers of ten between which factors of the price of risk are drawn [-]: paths that risk more or
less pass on other sides."""

_MOST_RISKS = (1.0, 12.0)
"""What one window may risk, one of these [Δ], as on the paths that first plans begin with."""


@dataclass(frozen=True, slots=True, eq=False)
class Replanning:
    """A fleet of which a few vehicles are replanned at a time, in a drawn order (MAPF-LNS).

    Unlike routes that are drawn, what a lattice search finds is timed for the others as they are,
    and tells what it costs.

    Attributes
    ----------
    fleet : Fleet
        The fleet, and when to stop.
    price : float
        Cost of risk, per unit of probability.
    rng : Generator
        Draws orders, prices, and what may be risked.
    """

    fleet: Fleet
    price: float
    rng: np.random.Generator
    _searches: dict[int, PathSearch] = field(default_factory=dict)
    _slacks: dict[int, SlacksByKey] = field(default_factory=dict)

    @property
    def is_planar(self) -> bool:
        """Whether there are lattices: in the plane."""
        return self.fleet.scenario.dimension == 2

    def places(self, vehicles: Sequence[int], means: Tensor) -> dict[int, Matrix]:
        """Replan vehicles; each keeps clear of all that are not replanned later.

        Parameters
        ----------
        vehicles : sequence of int
            Their numbers.
        means : (N, T+1, d) array
            Where everyone is at each step [m].

        Returns
        -------
        dict of int to (T+1, 2) array
            Where they are then [m]; those left out found no path.
        """
        means = means.copy()
        price = self.price * float(10.0 ** self.rng.uniform(*_PRICES))
        most_risk = float(self.rng.choice(_MOST_RISKS)) * self.fleet.scenario.risk_bound
        left, found = set(vehicles), dict[int, Matrix]()
        for i in self.rng.permutation(np.array(vehicles)).tolist():
            left.discard(i)
            search = self._search_of(i)
            if not search.is_possible:
                continue
            apart = [j for j in range(len(means)) if j != i and j not in left]
            others = around_others(
                self.fleet.programs.hazards, i, np.array(apart, dtype=np.int64), means
            )
            known = self._slacks.setdefault(i, {})
            path = search.path_among(others, price, most_risk, self.fleet.limits, known)
            if path is not None:
                means[i] = found[i] = path
        return found

    def _search_of(self, vehicle: int) -> PathSearch:
        """Return the lattice search of a vehicle alone, its avoidances laid out once."""
        if vehicle not in self._searches:
            problem, unit = self.fleet.programs.problem((vehicle,)), self.fleet.unit
            self._searches[vehicle] = PathSearch(problem.program, problem.models[0], unit)
        return self._searches[vehicle]
