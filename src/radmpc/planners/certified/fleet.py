"""The fleet as sets, all searched at one price of risk and merged where they collide."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.errors import NoPlanError
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.crossing import cross_risks
from radmpc.planners.certified.nearby import Surroundings
from radmpc.planners.certified.polish import polish
from radmpc.planners.certified.problem import Order, SetProblem, SetState
from radmpc.planners.certified.working import Job, search_sets
from radmpc.program.build import controls_of, whole_subjects
from radmpc.program.program import DisjunctiveProgram
from radmpc.solvers.highs_lp import HighsLp, LpOutcome
from radmpc.solvers.risk_lp import SetBound
from radmpc.solvers.risk_nodes import Incumbent
from radmpc.solvers.solution import Limits

__all__ = ["Fleet", "Round"]

Members = tuple[int, ...]

_SET_SHARE = 0.5
"""Share of the gap that the sets' own searches may use."""

_CROSS_SHARE = 0.1
"""Share of the gap that risk between sets may cost before they are merged."""

_CROSS_BUDGET = 0.2
"""Share of the budget that risk between sets may take before they are merged."""

_RISK_TO_COST = 0.006
"""Typical value of the whole risk budget, as a share of the cost of plans."""

_TAKE_BACKS = 3

_NODES = 400
"""Nodes that a set gets per vehicle and round."""


@dataclass(frozen=True, slots=True, eq=False)
class Round:
    """The fleet at one price: every set planned, none colliding with another.

    Attributes
    ----------
    sets : tuple of tuple of int
        A partition of the fleet.
    price : float
        Price of a unit of risk.
    risk, cross : float
        What the sets run within, and about what they run between them.
    bound : float
        Lower bound on the cost of any plan of the fleet.
    open_gap : float
        What the sets' own searches leave between plans and bounds.
    is_limited : bool
        Whether a limit ended any of them.
    """

    sets: tuple[Members, ...]
    price: float
    risk: float
    cross: float
    bound: float
    open_gap: float
    is_limited: bool


@dataclass(eq=False)
class Fleet:
    """The running state: problems and searches of all sets met so far."""

    scenario: Scenario
    gap: float
    limits: Limits
    progress: Callable[[int, int], None]
    executor: Executor | None = None
    problems: dict[Members, SetProblem] = field(default_factory=dict)
    states: dict[Members, SetState] = field(default_factory=dict)
    alone: dict[Members, Scenario] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Build every vehicle's own programme."""
        self.subjects = whole_subjects(self.scenario)
        self.covariances = np.array([s.position_covariances for s in self.subjects])
        self.surroundings = Surroundings(self.scenario, self.subjects)
        # Every row may take the whole bound at most; the budget itself may be less.
        self.unit = self.scenario.risk_bound
        self.singles = tuple((i,) for i in range(self.scenario.num_vehicles))
        for members in self.singles:
            self.problem(members)
        initial = sum(max(self.problems[m].program.initial_risk, 0.0) for m in self.singles)
        self.budget = self.unit - initial
        self.base = [_cost_without_dangers(self.problems[m].program) for m in self.singles]

    def problem(self, members: Members) -> SetProblem:
        """Return a set's programme, built when first asked for."""
        if members not in self.problems:
            self.alone[members] = self.surroundings.of(members)
            self.problems[members] = SetProblem.of(
                self.alone[members], members, self.subjects, self.unit
            )
        return self.problems[members]

    def first_price(self) -> float:
        """Guess the price of the whole bound from what plans cost without dangers."""
        total = float(sum(self.base))
        return max(_RISK_TO_COST * total, 1e-6 * max(1.0, total))

    def run_round(self, price: float, effort: int) -> Round | None:
        """Plan all sets at a price, merging those that collide.

        Parameters
        ----------
        price : float
            Of one unit of risk.
        effort : int
            Multiplies the nodes that every set gets.

        Returns
        -------
        Round or None
            None where a set has no plan, or a limit was reached before all had one.
        """
        sets: tuple[Members, ...] = self.singles
        while True:
            if not self._solve(sets, price, effort):
                return None
            crossing = self.crossing(sets, [self._best(m).z for m in sets])
            cross = sum(crossing.values())
            allowed = min(self._allowed_cross(sets, price), _CROSS_BUDGET * self.budget)
            if cross <= allowed:
                return self._round(sets, price, cross)
            sets = _merged(sets, crossing, cross - allowed)

    def _round(self, sets: tuple[Members, ...], price: float, cross: float) -> Round:
        """Sum up the sets at a price."""
        plans = [self._best(m) for m in sets]
        risk = sum(plan.risk for plan in plans)
        bound = sum(self.states[m].bound for m in sets)
        value = sum(plan.cost for plan in plans) + price * risk / self.unit
        return Round(
            sets,
            price,
            risk,
            cross,
            bound - price * self.budget / self.unit,
            value - bound,
            any(self.states[m].is_limited for m in sets),
        )

    def _allowed_cross(self, sets: Sequence[Members], price: float) -> float:
        """Return the risk between sets that costs a small share of the gap."""
        cost = sum(self._best(m).cost for m in sets)
        return float(_CROSS_SHARE * self.gap * cost / price * self.unit)

    def _best(self, members: Members) -> Incumbent:
        """Return the plan of a set that has one."""
        best = self.states[members].best
        if best is None:
            raise NoPlanError("a set without a plan cannot be part of a round")
        return best

    def _solve(self, sets: Sequence[Members], price: float, effort: int) -> bool:
        """Bring every set's search to a price; tell whether all have a plan."""
        jobs = []
        for members in sets:
            state = self.states.get(members)
            wanted = _NODES * len(members) * effort
            spent = state.nodes if state is not None and state.price == price else 0
            if state is not None and (
                state.bound == float("inf") or (spent and not (state.is_limited and spent < wanted))
            ):
                continue
            base = sum(self.base[i] for i in members)
            order = Order(
                self.unit,
                price,
                _SET_SHARE * self.gap,
                price,
                wanted - spent,
                base,
                self._bounds(members, price),
            )
            self.problem(members)
            jobs.append(Job(members, self.alone[members], state, order))
        found = search_sets(jobs, self.problem, self.limits, self.executor, self.progress)
        self.states |= {job.members: state for job, state in zip(jobs, found, strict=True)}
        return all(self.states[members].best is not None for members in sets)

    def _bounds(self, members: Members, price: float) -> tuple[SetBound, ...]:
        """Return what is proven of parts of a set at this price."""
        if len(members) == 1:
            return ()
        whole = set(members)
        return tuple(
            SetBound(frozenset(members.index(i) for i in part), state.bound)
            for part, state in self.states.items()
            if len(part) < len(members) and state.price == price and whole.issuperset(part)
        )

    def fitted(self, found: Round, cross: float) -> tuple[Vector, ...] | None:
        """Return a round's plan with its risks fitted to the bound.

        Parameters
        ----------
        found : Round
            The plan at its price.
        cross : float
            Risk between sets to leave room for.

        Returns
        -------
        tuple of (n,) array or None
            A point per set; None where these sides do not fit.
        """
        problems = [self.problems[m] for m in found.sets]
        plans = [self._best(m) for m in found.sets]
        initial = sum(max(p.program.initial_risk, 0.0) for p in problems)
        budget = self.unit - initial - cross
        points = polish(problems, plans, budget)
        raw = tuple(plan.z for plan in plans)
        fits = found.risk <= budget
        if points is None:
            return raw if fits else None
        points = self._kept_apart(found, raw, points)
        risk = sum(
            float(p.program.event_risks(z, i.selection).sum())
            for p, z, i in zip(problems, points, plans, strict=True)
        )
        risk += sum(self.crossing(found.sets, points).values())
        return points if risk <= self.unit - initial else raw if fits else None

    def _kept_apart(
        self, found: Round, raw: tuple[Vector, ...], points: tuple[Vector, ...]
    ) -> tuple[Vector, ...]:
        """Take back what fitting moved into another set's way."""
        chosen = list(points)
        for _ in range(_TAKE_BACKS):
            crossing = self.crossing(found.sets, chosen)
            if (
                sum(crossing.values())
                <= 2.0 * found.cross + _CROSS_BUDGET**2 * self.gap * self.unit
            ):
                break
            for pair, risk in crossing.items():
                if risk > 0.5 * found.cross / len(crossing):
                    for number in pair:
                        chosen[number] = raw[number]
        return tuple(chosen)

    def crossing(
        self, sets: Sequence[Members], points: Sequence[Vector]
    ) -> dict[tuple[int, int], float]:
        """Estimate the risk between every two sets, numbered as given."""
        owners = np.empty(self.scenario.num_vehicles, dtype=np.int64)
        means = np.empty((self.scenario.num_vehicles, *self.subjects[0].drift_position.shape))
        for number, (members, z) in enumerate(zip(sets, points, strict=True)):
            owners[list(members)] = number
            means[list(members)] = self.problems[members].means(z)
        return cross_risks(self.scenario, means, self.covariances, owners)

    def controls(self, sets: Sequence[Members], points: Sequence[Vector]) -> tuple[Matrix, ...]:
        """Return every vehicle's controls, in the scenario's order."""
        found: dict[int, Matrix] = {}
        for members, z in zip(sets, points, strict=True):
            found |= dict(
                zip(members, controls_of(self.problems[members].subjects, z), strict=True)
            )
        return tuple(found[i] for i in range(self.scenario.num_vehicles))

    def without_plan(self) -> Members | None:
        """Return a set that was proven to have no plan."""
        for members, state in self.states.items():
            if state.bound == float("inf"):
                return members
        return None


def _cost_without_dangers(program: DisjunctiveProgram) -> float:
    """Return what a vehicle's way to its goal costs through empty space; 0 where it has none."""
    lp = HighsLp(program.cost, program.lower, program.upper)
    lp.add_rows(program.hard, program.hard_lower, program.hard_upper)
    outcome, cost = lp.solve()
    return cost if outcome is LpOutcome.OPTIMAL else 0.0


def _merged(
    sets: Sequence[Members], crossing: dict[tuple[int, int], float], excess: float
) -> tuple[Members, ...]:
    """Merge pairs of sets, worst first, each at most once, until the excess is gone."""
    taken: set[int] = set()
    result = []
    for (i, j), risk in sorted(crossing.items(), key=lambda item: (-item[1], item[0])):
        if excess <= 0.0:
            break
        excess -= risk
        if i not in taken and j not in taken:
            taken |= {i, j}
            result.append(tuple(sorted(sets[i] + sets[j])))
    return (*result, *(m for i, m in enumerate(sets) if i not in taken))
