"""The fleet: problems and searches of all sets met so far."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field

import numpy as np

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.errors import NoPlanError
from radmpc.model.plan import Coupling
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.inter_set_risk import by_sets, pair_risks_across_sets
from radmpc.planners.certified.nearby import Surroundings
from radmpc.planners.certified.problem import Order, SetProblem, SetState
from radmpc.planners.certified.set_searches import SetSearch, search_sets
from radmpc.planners.endpoint_risk import start_hazards
from radmpc.planners.verdict import Verdict
from radmpc.program.build import condensed_models, controls_of
from radmpc.program.program import DisjunctiveProgram
from radmpc.solvers.lp.highs_lp import HighsLp, LpOutcome
from radmpc.solvers.priced.lp import SetBound
from radmpc.solvers.priced.nodes import Incumbent
from radmpc.solvers.solution import Limits

__all__ = ["Fleet", "Members"]

Members = tuple[int, ...]

_SET_SHARE = 0.5
"""Share of the gap that the sets' own searches may use."""

_ROOM = {"steps": (4.0, 1.5), "intervals": (12.0, 4.0)}
"""What simple bounds may sum to, in multiples of the risk bound: at most, and to begin with."""

_FILL = 0.9
"""Share of the unit up to which the budget may grow."""

_LITTLE = 1e-2
"""Share of Δ that the budget is at least: by the referee the starts may risk less."""

_RISK_TO_COST = 0.006
"""Typical value of the whole risk budget, as a share of the cost of plans."""

_TELLING = 1e-3
"""Share of the worst risk between two sets below which a meeting does not explain it."""

_NODES = 400
"""Nodes that a set gets per vehicle and round."""

_TRIAL = 60
_TRIAL_ALONE = 150
"""Nodes per vehicle of a set, and of a vehicle alone, until the fleet has a plan."""


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
    incumbent_parts: dict[int, Vector] = field(default_factory=dict)
    """What every vehicle does in some plan of the whole fleet; empty until there is one."""
    coupling_risks: dict[tuple[int, int], float] = field(default_factory=dict)
    """Why vehicles were planned together: the risk between plans of them made apart."""
    rejected_pairs: dict[tuple[int, int], float] = field(default_factory=dict)
    """Pairs for whom the referee rejected plans made apart: planned together at every price."""
    has_tried_initial_plan: bool = False
    is_costless: bool = False
    """Whether effort counts for nothing, so that at a price of 1 only risk is minimized."""

    def __post_init__(self) -> None:
        """Build every vehicle's own program."""
        self.numbers = {v.name: i for i, v in enumerate(self.scenario.vehicles)}
        self.models = condensed_models(self.scenario)
        self.covariances = np.array([s.position_covariances for s in self.models])
        self.surroundings = Surroundings(self.scenario, self.models)
        # Simple bounds may sum to more than the referee finds, by a factor that is not known yet.
        risk_bound = self.scenario.risk_bound
        # Where only risk is minimized, Δ itself is the scale.
        room, begin = (1.0, 1.0) if self.is_costless else _ROOM[self.scenario.avoidance]
        self.unit = room * risk_bound
        self.singles = tuple((i,) for i in range(self.scenario.num_vehicles))
        for members in self.singles:
            self.problem(members)
        # Under intervals the start is part of what plans choose, and is charged there.
        at_start = self.scenario.avoidance == "steps"
        self.start_hazards = start_hazards(self.scenario, self.models) if at_start else ()
        # Settled avoidances are not charged here: what they run at most is no part of a bound,
        # and what they run in a plan is for the referee to say.
        self.initial = sum(danger.risk for danger in self.start_hazards)
        self.budget = max(risk_bound, min(begin * risk_bound, _FILL * self.unit)) - self.initial
        self.base = [_cost_without_hazards(self.problems[m].program) for m in self.singles]

    def problem(self, members: Members) -> SetProblem:
        """Return a set's program, built when first asked for."""
        if members not in self.problems:
            self.alone[members] = self.surroundings.of(members)
            problem_ = SetProblem.of(self.alone[members], members, self.models, self.unit)
            self.problems[members] = problem_.without_cost() if self.is_costless else problem_
        return self.problems[members]

    def set_budget(self, budget: float) -> None:
        """Set what simple bounds may sum to beyond the starts: Δ at least, the unit at most."""
        self.budget = max(self.least_budget, min(budget, self.most_budget))

    @property
    def least_budget(self) -> float:
        """What is left of Δ by simple bounds; a little where the starts alone exceed it by them."""
        risk_bound = self.scenario.risk_bound
        return max(risk_bound - self.initial, _LITTLE * risk_bound)

    @property
    def most_budget(self) -> float:
        """The most that simple bounds may sum to beyond the starts."""
        return _FILL * self.unit - self.initial

    def first_unit_price(self) -> float:
        """Guess the price of the whole bound from what plans cost without dangers."""
        total = float(sum(self.base))
        guess = max(_RISK_TO_COST * total, 1e-6 * max(1.0, total))
        return guess * self.unit / (self.budget + self.initial)

    def best(self, members: Members) -> Incumbent:
        """Return the plan of a set that has one."""
        best = self.states[members].best
        if best is None:
            raise NoPlanError("a set without a plan cannot be part of a round")
        return best

    def solve(
        self, sets: Sequence[Members], unit_price: float, effort: int, *, is_rough: bool = False
    ) -> bool:
        """Bring every set's search to a price; tell whether all have a plan."""
        searches = []
        for members in sets:
            state = self.states.get(members)
            nodes = _NODES
            if not self.has_tried_initial_plan:
                nodes = _TRIAL_ALONE if len(members) == 1 else _TRIAL
            wanted = nodes * effort * len(members)
            spent = state.nodes if state is not None and state.unit_price == unit_price else 0
            if state is not None and (
                state.bound == float("inf") or (spent and not (state.is_limited and spent < wanted))
            ):
                continue
            base = sum(self.base[i] for i in members)
            order = Order(
                self.unit,
                unit_price,
                _SET_SHARE * self.gap,
                unit_price,
                wanted - spent,
                base,
                self._bounds(members, unit_price),
                self.hint(members),
                is_rough,
            )
            self.problem(members)
            searches.append(SetSearch(members, self.alone[members], state, order))
        found = search_sets(searches, self.problem, self.limits, self.executor, self.progress)
        self.states |= {
            search.members: state for search, state in zip(searches, found, strict=True)
        }
        return all(self.states[members].best is not None for members in sets)

    def is_hard(self, sets: Sequence[Members]) -> bool:
        """Whether a limit other than time ended the search of any set."""
        return not self.limits.reached and any(self.states[m].is_limited for m in sets)

    def hint(self, members: Members) -> Vector | None:
        """Return what some vehicles do in the known plan of the fleet, if there is one."""
        if not self.incumbent_parts or len(members) == 1:
            return None
        return self.assembled(members, self.incumbent_parts)

    def assembled(self, members: Members, parts: Mapping[int, Vector]) -> Vector:
        """Return the point of a set that puts points of its vehicles together."""
        program = self.problem(members).program
        z = np.empty(program.num_columns)
        for block, i in enumerate(members):
            z[program.blocks == block] = parts[i]
        return z

    def split(self, sets: Sequence[Members], points: Sequence[Vector]) -> dict[int, Vector]:
        """Return every vehicle's part of points of sets."""
        return {
            i: z[self.problems[members].program.blocks == block]
            for members, z in zip(sets, points, strict=True)
            for block, i in enumerate(members)
        }

    def _bounds(self, members: Members, unit_price: float) -> tuple[SetBound, ...]:
        """Return what is proven of parts of a set at this price."""
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

    def inter_set_risks(
        self, sets: Sequence[Members], points: Sequence[Vector]
    ) -> dict[tuple[int, int], float]:
        """Estimate the risk between every two sets, numbered as given."""
        return by_sets(self.pair_risks(sets, points), self.owners(sets))

    def owners(self, sets: Sequence[Members]) -> Indices:
        """Return the number of every vehicle's set."""
        owners = np.empty(self.scenario.num_vehicles, dtype=np.int64)
        for number, members in enumerate(sets):
            owners[list(members)] = number
        return owners

    def pair_risks(
        self, sets: Sequence[Members], points: Sequence[Vector]
    ) -> dict[tuple[int, int], float]:
        """Estimate the risk between every two vehicles of different sets."""
        means = np.empty((self.scenario.num_vehicles, *self.models[0].drift_position.shape))
        sagittas = np.zeros((means.shape[0], means.shape[1] - 1, means.shape[2]))
        for members, z in zip(sets, points, strict=True):
            means[list(members)] = self.problems[members].means(z)
            for i, controls in zip(
                members, controls_of(self.problems[members].models, z), strict=True
            ):
                if self.scenario.vehicles[i].system.is_double_integrator:
                    sagittas[i] = self.scenario.dt**2 / 8.0 * controls
        return pair_risks_across_sets(
            self.scenario, means, self.covariances, self.owners(sets), sagittas
        )

    def merge_rejected(self, sets: Sequence[Members], verdict: Verdict) -> bool:
        """Plan pairs across sets together whom a rejected plan is to be blamed on; tell if any."""
        risk_bound = self.scenario.risk_bound
        rejected_pairs = verdict.to_blame(self.owners(sets), self.numbers, risk_bound)
        self.rejected_pairs |= rejected_pairs
        return bool(rejected_pairs)

    def to_merge(self, sets: Sequence[Members]) -> dict[tuple[int, int], float]:
        """Return the pairs of vehicles of different sets that must be planned together."""
        owners = self.owners(sets)
        return {
            pair: r for pair, r in self.rejected_pairs.items() if owners[pair[0]] != owners[pair[1]]
        }

    def remember(
        self,
        apart: Sequence[Members],
        assembled: Sequence[Members],
        pair_risks: Mapping[tuple[int, int], float],
    ) -> None:
        """Note whose meetings made sets planned apart into one."""
        old, new = self.owners(apart).tolist(), self.owners(assembled).tolist()
        inside = {pair: risk for pair, risk in pair_risks.items() if new[pair[0]] == new[pair[1]]}
        worst: dict[tuple[int, int], float] = {}
        for (i, j), risk in inside.items():
            key = (min(old[i], old[j]), max(old[i], old[j]))
            worst[key] = max(worst.get(key, 0.0), risk)
        for (i, j), risk in inside.items():
            if risk >= _TELLING * worst[min(old[i], old[j]), max(old[i], old[j])]:
                self.coupling_risks[i, j] = max(self.coupling_risks.get((i, j), 0.0), risk)

    def couplings(self, sets: Sequence[Members]) -> tuple[Coupling, ...]:
        """Return why the vehicles of these sets were planned together."""
        owner = self.owners(sets)
        names = [vehicle.name for vehicle in self.scenario.vehicles]
        return tuple(
            Coupling(names[i], names[j], "collision", risk)
            for (i, j), risk in sorted(self.coupling_risks.items())
            if owner[i] == owner[j]
        )

    def controls(self, sets: Sequence[Members], points: Sequence[Vector]) -> tuple[Matrix, ...]:
        """Return every vehicle's controls, in the scenario's order."""
        found: dict[int, Matrix] = {}
        for members, z in zip(sets, points, strict=True):
            found |= dict(zip(members, controls_of(self.problem(members).models, z), strict=True))
        return tuple(found[i] for i in range(self.scenario.num_vehicles))

    def without_plan(self) -> Members | None:
        """Return a set that was proven to have no plan."""
        for members, state in self.states.items():
            if state.bound == float("inf"):
                return members
        return None


def _cost_without_hazards(program: DisjunctiveProgram) -> float:
    """Return what a vehicle's way to its goal costs through empty space; 0 where it has none."""
    lp = HighsLp(program.cost, program.lower, program.upper)
    lp.add_rows(program.hard, program.hard_lower, program.hard_upper)
    outcome, cost = lp.solve()
    return cost if outcome is LpOutcome.OPTIMAL else 0.0
