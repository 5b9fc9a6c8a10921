"""The fleet: programs and searches of all sets met so far.

Three quantities of risk are used throughout this package. Δ is the scenario's risk bound, which the
referee's certificate must not exceed. The *budget* is what the union (Boole) bounds of the chosen
rows of the fleet may sum to beyond the risk of the starts; it may exceed Δ, because they sum
to more than the referee finds.

The *unit* is the risk that 1 stands for in the programs: a fixed multiple of Δ, chosen once per
fleet. The rows of one set may sum to one unit at most, and no row may take more than the smaller of
the unit and `CONVEX_RISK`: its row risk cap. The budget never exceeds the unit.

The Lagrange multiplier (shadow price) of the risk bound comes in two scales. A ``unit_price`` is
the cost of one unit of risk; a ``price`` is the cost per unit of probability:
``price = unit_price / unit``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field

from radmpc.arrays import Vector
from radmpc.errors import NoPlanError
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.merging import Members, Merging
from radmpc.planners.certified.problem import Order, SetState
from radmpc.planners.certified.programs import SetPrograms
from radmpc.planners.certified.set_searches import SetSearch, search_sets
from radmpc.planners.endpoint_risk import start_hazards
from radmpc.program.program import DisjunctiveProgram
from radmpc.solvers.lp.highs_lp import HighsLp, LpOutcome
from radmpc.solvers.priced.lp import SetBound
from radmpc.solvers.priced.nodes import Incumbent
from radmpc.solvers.solution import Limits

__all__ = ["Fleet"]

_SET_SHARE = 0.5
"""Share of the gap that the sets' own searches may use [-]; the rest is for the price."""

_SLACK = {"steps": (4.0, 1.5), "intervals": (12.0, 4.0)}
"""The unit, and the budget to begin with, in multiples of Δ [-]. Union bounds sum to 1.3 to 2.5
times the certificate on `paper(8)` at steps, often to 10 times along intervals."""

_FILL = 0.9
"""Share of the unit up to which the budget may grow [-]."""

_LITTLE = 1e-2
"""Least budget as a share of Δ [-]: starts may risk less by the referee than by union bounds."""

_RISK_TO_COST = 0.006
"""Value of the whole risk budget as a share of what plans cost without hazards [-]: the first guess
of the price."""

_NODES = 400
"""Nodes of the search tree that a set gets per vehicle and round [-], multiplied by the effort."""

_TRIAL = 60
"""Nodes per vehicle of a set of several until an initial plan was tried [-]: beyond it a set counts
as hard."""

_TRIAL_ALONE = 150
"""Nodes of a vehicle alone until an initial plan was tried [-]."""


@dataclass(eq=False)
class Fleet:
    """The running state: programs and searches of all sets met so far.

    Attributes
    ----------
    scenario : Scenario
        The fleet.
    gap : float
        The relative gap asked for [-].
    limits : Limits
        When to stop early.
    progress : callable
        Told how many sets are searched, of how many.
    executor : Executor or None
        Where sets are searched; None searches here.
    programs : SetPrograms
        The program of every set met so far.
    states : dict
        How far the search of each set has come.
    incumbent_parts : dict of int to (n,) array
        What every vehicle does in some plan of the whole fleet; empty until there is one.
    merging : Merging
        Which vehicles must be planned together.
    has_tried_initial_plan : bool
        Whether sets get their full number of nodes; until then the first set that proves hard calls
        for an initial plan of the whole fleet.
    is_costless : bool
        Whether effort counts for nothing, so that at a unit price of 1 only risk is minimized.
    unit : float
        The risk that 1 stands for in programs [-], see above.
    budget : float
        What union bounds may sum to beyond the starts [-].
    initial : float
        What the starts risk, whatever the plan [-].
    """

    scenario: Scenario
    gap: float
    limits: Limits
    progress: Callable[[int, int], None]
    executor: Executor | None = None
    states: dict[Members, SetState] = field(default_factory=dict)
    incumbent_parts: dict[int, Vector] = field(default_factory=dict)
    has_tried_initial_plan: bool = False
    is_costless: bool = False

    def __post_init__(self) -> None:
        """Build every vehicle's own program."""
        self.merging = Merging(self.scenario)
        # Union bounds may sum to more than the referee finds, by a factor that is not known yet.
        risk_bound = self.scenario.risk_bound
        # Where only risk is minimized, Δ itself is the scale.
        most, begin = (1.0, 1.0) if self.is_costless else _SLACK[self.scenario.avoidance]
        self.unit = most * risk_bound
        self.programs = SetPrograms(self.scenario, self.unit, is_costless=self.is_costless)
        self.singles = tuple((i,) for i in range(self.scenario.num_vehicles))
        # Under intervals the start is part of what plans choose, and is charged there.
        at_start = self.scenario.avoidance == "steps"
        self.start_hazards = start_hazards(self.scenario, self.programs.models) if at_start else ()
        # Presolved avoidances are not charged here: what they run at most is no part of a bound,
        # and what they run in a plan is for the referee to say.
        self.initial = sum(hazard.risk for hazard in self.start_hazards)
        self.budget = max(risk_bound, min(begin * risk_bound, _FILL * self.unit)) - self.initial
        self.base = [_cost_without_hazards(self.programs.problem(m).program) for m in self.singles]

    def set_budget(self, budget: float) -> None:
        """Set what union bounds may sum to beyond the starts: Δ at least, the unit at most."""
        self.budget = max(self.least_budget, min(budget, self.most_budget))

    @property
    def least_budget(self) -> float:
        """What the union bounds of the starts leave of Δ; a little where they exceed it."""
        risk_bound = self.scenario.risk_bound
        return max(risk_bound - self.initial, _LITTLE * risk_bound)

    @property
    def most_budget(self) -> float:
        """The most that union bounds may sum to beyond the starts."""
        return _FILL * self.unit - self.initial

    def first_unit_price(self) -> float:
        """Guess the price of one unit of risk from what plans cost without hazards."""
        total = float(sum(self.base))
        guess = max(_RISK_TO_COST * total, 1e-6 * max(1.0, total))
        return guess * self.unit / (self.budget + self.initial)

    def best(self, members: Members) -> Incumbent:
        """Return the incumbent of a set that has one."""
        best = self.states[members].best
        if best is None:
            raise NoPlanError("a set without a plan cannot be part of a round")
        return best

    def solve(
        self, sets: Sequence[Members], unit_price: float, effort: int, *, is_rough: bool = False
    ) -> bool:
        """Bring every set's search to a price.

        Parameters
        ----------
        sets : sequence of tuple of int
            Sets that have no vehicle in common.
        unit_price : float
            Cost of one unit of risk.
        effort : int
            Multiplies the nodes that every set gets [-].
        is_rough : bool
            Whether plans are only to tell the price, so that the lattice is not searched.

        Returns
        -------
        bool
            Whether all have a plan.
        """
        searches = []
        for members in sets:
            state = self.states.get(members)
            nodes = _NODES
            if not self.has_tried_initial_plan:
                nodes = _TRIAL_ALONE if len(members) == 1 else _TRIAL
            target = nodes * effort * len(members)
            spent = state.nodes if state is not None and state.unit_price == unit_price else 0
            if state is not None and (
                state.bound == float("inf") or (spent and not (state.is_limited and spent < target))
            ):
                continue
            base = sum(self.base[i] for i in members)
            order = Order(
                self.unit,
                unit_price,
                _SET_SHARE * self.gap,
                unit_price,
                target - spent,
                base,
                self._bounds(members, unit_price),
                self.hint(members),
                is_rough,
            )
            self.programs.problem(members)
            searches.append(SetSearch(members, self.programs.alone[members], state, order))
        states = search_sets(
            searches, self.programs.problem, self.limits, self.executor, self.progress
        )
        self.states |= {
            search.members: state for search, state in zip(searches, states, strict=True)
        }
        return all(self.states[members].best is not None for members in sets)

    def is_hard(self, sets: Sequence[Members]) -> bool:
        """Whether a limit other than time ended the search of any set."""
        return not self.limits.reached and any(self.states[m].is_limited for m in sets)

    def hint(self, members: Members) -> Vector | None:
        """Return a set's point in the incumbent of the whole fleet, if there is one."""
        if not self.incumbent_parts or len(members) == 1:
            return None
        return self.programs.assembled(members, self.incumbent_parts)

    def _bounds(self, members: Members, unit_price: float) -> tuple[SetBound, ...]:
        """Return the lower bounds proven for subsets of a set at this price."""
        if len(members) == 1:
            return ()
        whole = set(members)
        return tuple(
            SetBound(frozenset(members.index(i) for i in part), state.bound)
            for part, state in self.states.items()
            if len(part) < len(members)
            and state.unit_price == unit_price
            and whole.issuperset(part)
        )

    def without_plan(self) -> Members | None:
        """Return a set that was proven to have no plan."""
        for members, state in self.states.items():
            if state.bound == float("inf"):
                return members
        return None


def _cost_without_hazards(program: DisjunctiveProgram) -> float:
    """Return the least cost of a vehicle in empty space; 0 where it cannot reach its goal."""
    lp = HighsLp(program.cost, program.lower, program.upper)
    lp.add_rows(program.hard, program.hard_lower, program.hard_upper)
    outcome, cost = lp.solve()
    return cost if outcome is LpOutcome.OPTIMAL else 0.0
