"""How far the search for a fleet's plan has come: one value, which no phase changes.

Every phase takes the state and returns the next one. What is not in it is the fleet's problem
(`fleet`), which stays the same throughout.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from radmpc.arrays import Vector
from radmpc.errors import NoPlanError
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.merging import Members, Merging
from radmpc.planners.certified.problem import SetState
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.draft import Step
from radmpc.records import dataclass, field
from radmpc.solvers.priced.nodes import Incumbent

__all__ = ["SearchState"]


@dataclass(frozen=True, slots=True, eq=False)
class SearchState:
    """What is known at some moment of a search; `dataclasses.replace` makes the next one.

    From one state to the next the incumbent never becomes dearer, bounds and rejected pairs are
    only added, and the budget stays within `Fleet.least_budget` and `Fleet.most_budget` once the
    referee was asked.

    Attributes
    ----------
    budget : float
        What union bounds may sum to beyond the starts [-].
    merging : Merging
        Which vehicles must be planned together, and why others were.
    set_states : mapping of tuple of int to SetState
        How far the search of each set met so far has come.
    incumbent_parts : mapping of int to (n,) array
        What every vehicle does in some plan of the whole fleet; empty until there is one.
    has_tried_initial_plan : bool
        Whether sets get their full number of nodes; until then the first set that proves hard calls
        for an initial plan of the whole fleet.
    unit_price : float
        Cost of one unit of risk in the next round; 0 before the first.
    effort : int
        Multiplies the nodes that every set gets [-].
    tried : tuple of (float, float)
        Unit prices, and the risk at them [-].
    incumbent : FleetIncumbent
        The best certified plan.
    rejected_budget : float
        The least budget for which the referee rejected the plan of a round [-].
    has_failed : bool
        Whether the referee rejected the last round at every budget tried.
    round_bounds : tuple of (float, float)
        Of each round, the least cost plus priced risk of any plan, and the unit price.
    budget_bounds : tuple of (float, float)
        Budgets [-], and the least cost of any plan of the programs within each.
    outside_bounds : tuple of (float, float)
        The same of plans that keep norms, not polytopes within these; of Δ less the starts.
    steps : tuple of Step
        The record of the rounds.
    """

    budget: float
    merging: Merging
    set_states: Mapping[Members, SetState] = field(default_factory=dict)
    incumbent_parts: Mapping[int, Vector] = field(default_factory=dict)
    has_tried_initial_plan: bool = False
    unit_price: float = 0.0
    effort: int = 1
    tried: tuple[tuple[float, float], ...] = ()
    incumbent: FleetIncumbent = field(default_factory=FleetIncumbent)
    rejected_budget: float = float("inf")
    has_failed: bool = False
    round_bounds: tuple[tuple[float, float], ...] = ()
    budget_bounds: tuple[tuple[float, float], ...] = ()
    outside_bounds: tuple[tuple[float, float], ...] = ()
    steps: tuple[Step, ...] = ()

    @classmethod
    def of(cls, fleet: Fleet) -> SearchState:
        """Return the state before anything is known of a fleet."""
        return cls(fleet.first_budget, Merging.of(fleet.scenario))

    @property
    def has_plan(self) -> bool:
        """Whether there is a certified plan."""
        return bool(self.incumbent.controls)

    def best(self, members: Members) -> Incumbent:
        """Return the incumbent of a set that has one."""
        best = self.set_states[members].best
        if best is None:
            raise NoPlanError("a set without a plan cannot be part of a round")
        return best

    def is_planned(self, sets: Sequence[Members]) -> bool:
        """Whether all sets, each searched before, have a plan."""
        return all(self.set_states[members].best is not None for members in sets)

    def is_hard(self, fleet: Fleet, sets: Sequence[Members]) -> bool:
        """Whether a limit other than time ended the search of any set.

        Parameters
        ----------
        fleet : Fleet
            The fleet.
        sets : sequence of tuple of int
            Sets, each searched before.
        """
        return not fleet.limits.reached and any(self.set_states[m].is_limited for m in sets)

    def without_plan(self) -> Members | None:
        """Return a set that was proven to have no plan."""
        for members, state in self.set_states.items():
            if state.bound == float("inf"):
                return members
        return None

    def hint(self, fleet: Fleet, members: Members) -> Vector | None:
        """Return a set's point in some plan of the whole fleet.

        Parameters
        ----------
        fleet : Fleet
            The fleet.
        members : tuple of int
            The set.

        Returns
        -------
        (n,) array or None
            None where there is no such plan, or the set is one vehicle.
        """
        if not self.incumbent_parts or len(members) == 1:
            return None
        return fleet.programs.assembled(members, self.incumbent_parts)

    def last_unit_price(self, fleet: Fleet) -> float:
        """Return the unit price of the last round; before any, the first guess."""
        if self.round_bounds:
            return self.round_bounds[-1][1]
        return fleet.first_unit_price(self.budget)
