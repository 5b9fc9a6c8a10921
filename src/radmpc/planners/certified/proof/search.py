"""The search for a bound on any certified plan, or on any by faces: its parts in turn."""

from __future__ import annotations

import logging
from collections.abc import Generator, Iterator, Mapping, Sequence
from contextlib import closing

from radmpc.arrays import Matrix
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.proof.grouping import (
    PartTotals,
    Proven,
    bounds_within,
    parts_of,
    proven_within,
)
from radmpc.planners.certified.proof.next_price import better_price, risk_share
from radmpc.planners.certified.proof.part import (
    Part,
    PartAnswer,
    PartOrder,
    PartTask,
    paid_by,
    tails_for,
)
from radmpc.planners.certified.proof.part_search import search_part, search_part_elsewhere
from radmpc.planners.certified.proof.promise import (
    hidden_value,
    is_slow,
    least_worth,
    most_promising_first,
    unsearched_value,
)
from radmpc.planners.certified.proof.relaxed_plan import best_points, relaxed_plan
from radmpc.planners.certified.proof.relaxed_set import RelaxedSet
from radmpc.planners.certified.proof.symmetry import with_images
from radmpc.planners.certified.proof.tuning import TUNING
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.executing import in_order
from radmpc.program.relaxed.shared_rows import SharedCones
from radmpc.program.relaxed.tails import Tails
from radmpc.records import dataclass, field, replace
from radmpc.solvers.solution import relative_gap

__all__ = ["BoundSearch"]

_LOG = logging.getLogger(__name__)


@dataclass(slots=True, eq=False)
class BoundSearch:
    """The search for the bound: parts are searched in turn, those that promise most first.

    It exists for one bound, and only this class writes to it.

    Attributes
    ----------
    fleet : Fleet
        The fleet.
    incumbent : FleetIncumbent
        Its best certified plan.
    price : float
        Shadow price of the risk, per unit of probability.
    best : float
        The best bound so far.
    most_nodes : float
        Nodes that all parts may search together [-].
    is_by_faces : bool
        Whether it is the bound on plans by faces whose union bound is at most Δ, to the gap asked.
    below : mapping of tuple of int to mapping
        What is known of relaxations: plans by faces are charged no less.
    nodes : int
        Nodes searched so far [-].
    is_left : bool
        Whether it is left since the nodes that it has left would do too little.
    tails : Tails or None
        Tables of what a clearance is charged; None by faces.
    parts : dict of tuple of int to Part
        How far each part has come at the latest price.
    proven : dict of tuple of int to mapping of tuple of int to RelaxedSet
        What parts have built.
    order : tuple of tuple of int
        The parts, by what they pay for hazards over the time that a search takes.
    """

    fleet: Fleet
    incumbent: FleetIncumbent
    price: float
    best: float
    most_nodes: float
    is_by_faces: bool = False
    below: Proven = field(default_factory=dict)
    nodes: int = 0
    is_left: bool = False
    tails: Tails | None = field(init=False, default=None)
    parts: dict[Members, Part] = field(default_factory=dict)
    proven: dict[Members, Mapping[Members, RelaxedSet]] = field(default_factory=dict)
    order: tuple[Members, ...] = field(init=False)
    _totals: PartTotals = field(init=False)
    _cones: SharedCones = field(init=False)

    def __post_init__(self) -> None:
        """Tabulate the tails, and choose the parts."""
        self.tails = None if self.is_by_faces else tails_for(self.fleet.scenario)
        self._cones = SharedCones(keeps_rows=not self.fleet.is_large)
        self.regroup(self.incumbent.sets)

    def regroup(self, sets: tuple[Members, ...]) -> None:
        """Search these sets from now on, those that promise most for their time first.

        Large sets are parted. What was proven of parts of them is kept.

        Parameters
        ----------
        sets : tuple of tuple of int
            A partition of the fleet.
        """
        parts = parts_of(sets, len(self.fleet.scenario.obstacles))
        self.proven = {members: proven_within(members, self.proven) for members in parts}
        self._totals = PartTotals(self.proven)
        self.order = most_promising_first(parts, self._paid_for_hazards)

    def continue_from(self, incumbent: FleetIncumbent, price: float) -> None:
        """Hold the bound against another, cheaper plan from now on.

        Parameters
        ----------
        incumbent : FleetIncumbent
            That plan.
        price : float
            Its shadow price of Δ, per unit of probability; one that is nearly the same is kept.
        """
        self.incumbent, self.parts, self.is_left = incumbent, {}, False
        self._cones.forget_rows()
        if abs(price - self.price) > TUNING.same_price * self.price:
            self.go_on_at(price)

    @property
    def is_over(self) -> bool:
        """Whether the bound is good enough, or no more work is allowed."""
        has_spent = self.nodes >= self.most_nodes or self.fleet.limits.reached
        return has_spent or self.is_left or relative_gap(self.incumbent.cost, self.best) <= self.gap

    @property
    def gap(self) -> float:
        """The gap at which the bound is good enough [-]."""
        return self.fleet.gap if self.is_by_faces else max(TUNING.gap, self.fleet.gap)

    def run(self) -> None:
        """Raise the bound, by more nodes, and by another price."""
        for _ in range(TUNING.prices):
            self._search()
            _LOG.info(
                "bound on any plan%s: %.6g, %d directions, %.3g per 1 %% of risk bound, %d nodes",
                *(" by faces" * self.is_by_faces, self.best, TUNING.directions),
                *(0.01 * self.fleet.scenario.risk_bound * self.price, self.nodes),
            )
            if self.is_over or not self.moves_price():
                return

    def moves_price(self, most_step: float = TUNING.most_step) -> bool:
        """Move the price, by a factor at most, if relaxed plans risk far more or less than Δ."""
        before, risk_bound = self.price, self.fleet.scenario.risk_bound
        found = (whole for _, whole in self._found())
        self.go_on_at(better_price(before, risk_share(found, risk_bound), most_step))
        return self.price != before

    def go_on_at(self, price: float) -> None:
        """Search at another price: at a lower one less is known of relaxations, too."""
        if price != self.price:
            self.price, self.parts = price, {}

    def relaxed_controls(self) -> tuple[Matrix, ...]:
        """Return the best plan of the relaxation; nothing where it is the plan at hand."""
        points = best_points(self.proven, self.order)
        return relaxed_plan(self.fleet.programs.models, self.incumbent.controls, points)

    @property
    def value(self) -> float:
        """What the best plan of the relaxation is worth, as the bound counts it."""
        return self.bound_here() + self._left()

    def _left(self) -> float:
        """Return by how much the relaxed plans of parts at this price cost more than is proven."""
        found = ((m, whole) for m, whole in self._found() if whole.price == self.price)
        return sum(max(whole.value - self._bound_of(m), 0.0) for m, whole in found)

    def _found(self) -> Iterator[tuple[Members, RelaxedSet]]:
        """Yield the parts that were searched as a whole."""
        for members in self.order:
            if whole := self.proven.get(members, {}).get(tuple(range(len(members)))):
                yield members, whole

    def _bound_of(self, members: Members) -> float:
        """Return the bound of a part at the present price."""
        sets, part = self.proven.get(members, {}), self.parts.get(members)
        below = bounds_within(members, self.below, self.price) if part is None else part.below
        told = below, () if part is None else part.symmetries
        return self._totals.bound_of(members, sets, self.fleet.base, self.price, *told)

    def _paid_for_hazards(self, members: Members) -> float:
        """Return what a set's plan costs beyond the least in empty space."""
        return paid_by(self.fleet, self.incumbent, members)

    def _search(self) -> None:
        """Search all parts at the present price, until what is open matters no more."""
        for effort in range(TUNING.rounds):
            bound, nodes = self.bound_here(), self.nodes
            if self.is_left or not self.advance(TUNING.nodes, effort, self.order):
                return
            gain, left = self.bound_here() - bound, self.most_nodes - self.nodes
            # Of few vehicles, or while they are first searched alone, no rate is steady.
            is_steady = self.fleet.is_large and effort > 0
            self.is_left = is_steady and is_slow(gain, self.nodes - nodes, left, self._missing())
            if self.fleet.is_large and relative_gap(self.incumbent.cost, self.best) <= TUNING.near:
                self.most_nodes = min(self.most_nodes, (1.0 + TUNING.last_share) * self.nodes)

    def advance(self, nodes: int, effort: int, parts: Sequence[Members]) -> bool:
        """Search parts on at the present price; tell whether more effort promises anything.

        Parameters
        ----------
        nodes : int
            Nodes per vehicle of a set without any more effort [-].
        effort : int
            How often they are doubled, and the sets' gaps made finer [-].
        parts : sequence of tuple of int
            The parts, in order.
        """
        is_new, paid = False, map(self._paid_for_hazards, self.order)
        worth = least_worth(paid, self.gap * self.incumbent.cost)
        order = PartOrder.of_effort(effort, nodes, self.price, worth, self.most_nodes - self.nodes)
        with closing(self._answers(order, parts)) as answers:
            for members, answer in answers:
                is_new |= answer.is_new
                self.nodes += answer.nodes
                self._totals.keep_latest(self.proven, members, answer.sets)
                self.best = max(self.best, self.bound_here())
                if self.is_over:
                    return False
        return is_new and not self._is_futile(worth)

    def _missing(self) -> float:
        """Return by how much the bound has to rise."""
        return (1.0 - self.gap) * self.incumbent.cost - self.bound_here()

    def _is_futile(self, worth: float) -> bool:
        """Whether even a search to the end would not do, and leave most of the gap open."""
        found = dict(self._found())
        paid = {m: self._paid_for_hazards(m) for m in self.order if m not in found}
        left = self._left() + hidden_value(found.items(), self._paid_for_hazards)
        most = left + unsearched_value(paid, worth, self.price * self.fleet.scenario.risk_bound)
        is_little = left <= TUNING.futile * (self.incumbent.cost - self.bound_here())
        return most < self._missing() and is_little

    def _answers(
        self, order: PartOrder, parts: Sequence[Members]
    ) -> Generator[tuple[Members, PartAnswer], None, None]:
        """Yield the result of every part with an expected gain, in order; the caller keeps it."""
        done = {m for m, whole in self._found() if order.is_done(whole)}
        chosen = [m for m in parts if self._paid_for_hazards(m) > order.worth and m not in done]
        missing = self._missing()  # Now, so that workers and this process are asked the same.
        orders = [replace(order, enough=self._bound_of(m) + missing) for m in chosen]
        limits, executor = self.fleet.limits, self.fleet.executor
        if executor is None or len(chosen) < 2:
            yield from zip(chosen, map(self._answer_here, chosen, orders), strict=True)
            return
        tasks = (self._task(*each).to_be_sent() for each in zip(chosen, orders, strict=True))
        with closing(in_order(search_part_elsewhere, tasks, limits, executor)) as answers:
            for members, asked, answer in zip(chosen, orders, answers, strict=True):
                if answer is None or answer.nodes >= self._nodes_left:
                    answer = self._answer_here(members, asked)  # noqa: PLW2901 - what counts
                yield members, answer

    def _task(self, members: Members, order: PartOrder) -> PartTask:
        """Return what a part is given."""
        if members not in self.parts:
            part = Part.of(self.fleet, self.incumbent, members, self.tails)
            below = bounds_within(members, self.below, self.price)
            self.parts[members] = replace(part, below=with_images(below, part.symmetries))
        return PartTask(self.parts[members], self.proven.get(members, {}), order)

    def _answer_here(self, members: Members, order: PartOrder) -> PartAnswer:
        """Search a part in this process."""
        order = replace(order, most_nodes=min(order.most_nodes, self._nodes_left))
        return search_part(self._task(members, order), self.fleet.limits, self._cones)

    @property
    def _nodes_left(self) -> float:
        """Nodes left to a part; of a large fleet all, for two processes need no part twice then."""
        return float("inf") if self.fleet.is_large else self.most_nodes - self.nodes

    def bound_here(self) -> float:
        """Return the bound at the present price."""
        total = self._totals.bound(self.order, self.price, self._bound_of)
        # What the starts risk is no choice of a plan's, and no part of what faces are charged.
        spent = self.fleet.initial if self.is_by_faces else 0.0
        return total - self.price * (self.fleet.scenario.risk_bound - spent)
