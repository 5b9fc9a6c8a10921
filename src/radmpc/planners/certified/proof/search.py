"""The search for a bound on any certified plan: its parts in turn, until it is good enough."""

from __future__ import annotations

import logging
from collections.abc import Generator, Iterator, Mapping
from contextlib import closing

import numpy as np

from radmpc.arrays import Matrix
from radmpc.gaussian import Tail
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.proof.part import (
    Part,
    PartAnswer,
    PartOrder,
    PartTask,
    paid_for_hazards,
)
from radmpc.planners.certified.proof.part_search import search_part
from radmpc.planners.certified.proof.relaxed_set import RelaxedSet
from radmpc.planners.certified.proof.tuning import TUNING
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.executing import in_order
from radmpc.program.build import controls_of
from radmpc.program.relaxed.tails import Tails, tails_of
from radmpc.records import dataclass, field, replace
from radmpc.solvers.solution import relative_gap

__all__ = ["BoundSearch"]

_LOG = logging.getLogger(__name__)

_SAME = 1e-6
"""Difference of controls up to which two plans are one [in the units of controls]."""


@dataclass(slots=True, eq=False)
class BoundSearch:
    """The search for the bound: parts are searched in turn, those that promise most first.

    It lives for one bound, and nobody else writes to it.

    Attributes
    ----------
    fleet : Fleet
        The fleet.
    incumbent : FleetIncumbent
        Its best certified plan.
    price : float
        Shadow price of the risk, per unit of probability.
    best : float
        The best bound so far on the cost of any certified plan.
    most_nodes : float
        Nodes that all parts may search together [-].
    nodes : int
        Nodes searched so far [-].
    tails : Tails
        Tables of what a clearance is charged.
    parts : dict of tuple of int to Part
        How far each part has come at the latest price.
    known : dict of tuple of int to mapping of tuple of int to RelaxedSet
        Relaxations that parts have built.
    order : tuple of tuple of int
        The parts, those that pay most for hazards first.
    """

    fleet: Fleet
    incumbent: FleetIncumbent
    price: float
    best: float
    most_nodes: float
    nodes: int = 0
    tails: Tails = field(init=False)
    parts: dict[Members, Part] = field(default_factory=dict)
    known: dict[Members, Mapping[Members, RelaxedSet]] = field(default_factory=dict)
    order: tuple[Members, ...] = field(init=False)

    def __post_init__(self) -> None:
        """Tabulate the tails, and put sets whose plans cost most beyond the least first.

        Large sets are parted: any parting of the fleet gives a bound.
        """
        scenario = self.fleet.scenario
        are_integrated = scenario.avoidance == "steps" and scenario.dimension == 2
        tail = Tail(scenario.covariance_samples)
        are_integrated = are_integrated and tail.is_gaussian
        self.tails = tails_of(scenario.risk_bound, tail, are_integrated=are_integrated)
        parts: list[Members] = []
        for members in self.incumbent.sets:
            is_small = len(members) <= TUNING.most_together
            parts += [tuple(sorted(members))] if is_small else [(i,) for i in members]
        self.order = tuple(sorted(parts, key=self._paid_for_hazards, reverse=True))

    @property
    def is_over(self) -> bool:
        """Whether the bound is good enough, or no more work is allowed."""
        gap = max(TUNING.gap, self.fleet.gap)
        return relative_gap(self.incumbent.cost, self.best) <= gap or self._has_spent

    @property
    def _has_spent(self) -> bool:
        """Whether time is up, or all nodes are spent."""
        return self.nodes >= self.most_nodes or self.fleet.limits.reached

    def run(self) -> None:
        """Raise the bound, by more nodes, by another price, by more directions."""
        for num_directions in TUNING.directions:
            self.known = {}
            for _ in range(TUNING.prices):
                self._search(num_directions)
                _LOG.info(
                    "bound on any certified plan: %.6g with %d directions at a price of %.3g, %d "
                    "nodes",
                    self.best,
                    num_directions,
                    self.price,
                    self.nodes,
                )
                if self.is_over or not self._has_moved_price():
                    break
            if self.is_over:
                return

    def relaxed_controls(self) -> tuple[Matrix, ...]:
        """Return the best plan of the relaxation; nothing where it is the plan at hand."""
        controls = list(self.incumbent.controls)
        is_other = False
        for members, whole in self._found():
            if whole.best is None:
                continue
            models = [self.fleet.programs.models[i] for i in members]
            for i, found in zip(members, controls_of(models, whole.best.z), strict=True):
                is_other |= bool(np.abs(found - controls[i]).max() > _SAME)
                controls[i] = found
        return tuple(controls) if is_other else ()

    def _found(self) -> Iterator[tuple[Members, RelaxedSet]]:
        """Yield the parts that were searched as a whole."""
        for members in self.order:
            whole = self._whole(members)
            if whole is not None:
                yield members, whole

    def _whole(self, members: Members) -> RelaxedSet | None:
        """Return what is known of a part as a whole, if anything."""
        return self.known.get(members, {}).get(tuple(range(len(members))))

    def _bound_of(self, members: Members) -> float:
        """Return the bound of a part at the present price."""
        whole = self._whole(members)
        if whole is None or whole.price != self.price:
            return sum(self.fleet.base[i] for i in members)
        return whole.bound

    def _paid_for_hazards(self, members: Members) -> float:
        """Return what a set's plan costs beyond the least in empty space."""
        fleet, controls = self.fleet, self.incumbent.controls
        return sum(
            paid_for_hazards(fleet.programs.models[i], controls[i], fleet.base[i]) for i in members
        )

    def _search(self, num_directions: int) -> None:
        """Search all parts at the present price, until what is open matters no more."""
        gap, nodes = TUNING.set_gap, TUNING.nodes
        worth = TUNING.worth * self._allowed
        for _ in range(TUNING.rounds):
            left = self.most_nodes - self.nodes
            order = PartOrder(self.price, num_directions, gap, nodes, worth, left)
            is_new = False
            with closing(self._answers(order)) as answers:
                for members, answer in answers:
                    is_new |= answer.is_new
                    self.nodes += answer.nodes
                    self.known[members] = answer.sets
                    self._note()
                    if self.is_over:
                        return
            if not is_new or self._is_futile(worth):
                return
            gap, nodes = gap * TUNING.finer, 2 * nodes

    @property
    def _allowed(self) -> float:
        """The difference of cost and bound with which the bound is good enough."""
        return max(TUNING.gap, self.fleet.gap) * abs(self.incumbent.cost)

    def _missing(self) -> float:
        """Return by how much the bound at the present price has to rise to be good enough."""
        return self.incumbent.cost - self._allowed - self._bound_here()

    def _is_futile(self, worth: float) -> bool:
        """Whether even a search to the end would not do, and little is left of it."""
        still = [m for m in self.order if self._whole(m) is None]
        found = [whole for _, whole in self._found() if whole.price == self.price]
        left = sum(whole.value - whole.bound for whole in found)
        most = left + sum(min(self._paid_for_hazards(m), worth) for m in still)
        return most < self._missing() and left <= TUNING.futile * self._allowed

    def _answers(self, order: PartOrder) -> Generator[tuple[Members, PartAnswer], None, None]:
        """Yield what came of every part that promises anything, in order; who asks keeps it.

        Elsewhere parts are begun before it is known what those before them leave of the nodes:
        what took more than that is done again within it.
        """
        chosen = [m for m in self.order if self._paid_for_hazards(m) > order.worth]
        # Of what is known now, so that workers and this process are asked the same.
        missing = self._missing()
        orders = [replace(order, enough=self._bound_of(m) + missing) for m in chosen]
        if self.fleet.executor is None or len(chosen) < 2:
            for members, asked in zip(chosen, orders, strict=True):
                yield members, self._answer_here(members, asked)
            return
        tasks = [self._task(members, asked) for members, asked in zip(chosen, orders, strict=True)]
        limits, executor = self.fleet.limits, self.fleet.executor
        with closing(in_order(search_part, tasks, limits, executor)) as answers:
            for members, asked, answer in zip(chosen, orders, answers, strict=True):
                if answer is None or answer.nodes >= self.most_nodes - self.nodes:
                    answer = self._answer_here(members, asked)  # noqa: PLW2901 - what counts
                yield members, answer

    def _task(self, members: Members, order: PartOrder) -> PartTask:
        """Return what a part is given."""
        if members not in self.parts:
            self.parts[members] = Part.of(self.fleet, self.incumbent, members, self.tails)
        return PartTask(self.parts[members], self.known.get(members, {}), order)

    def _answer_here(self, members: Members, order: PartOrder) -> PartAnswer:
        """Search a part in this process, within the nodes that are left."""
        left = self.most_nodes - self.nodes
        return search_part(self._task(members, replace(order, most_nodes=left)), self.fleet.limits)

    def _note(self) -> None:
        """Keep the bound at the present price if it is the best."""
        self.best = max(self.best, self._bound_here())

    def _bound_here(self) -> float:
        """Return the bound at the present price."""
        total = sum(self.fleet.base)
        for _, whole in self._found():
            if whole.price == self.price:
                total += whole.bound - whole.base
        return total - self.price * self.fleet.scenario.risk_bound

    def _has_moved_price(self) -> bool:
        """Choose a better price where the relaxed plans risk far more or less than Δ."""
        risk = sum(whole.best.risk for _, whole in self._found() if whole.best is not None)
        ratio = risk / self.fleet.scenario.risk_bound
        if self.price <= 0.0 or 1.0 / TUNING.off < ratio < TUNING.off:
            return False
        self.price *= min(max(ratio, 1.0 / TUNING.most_move), TUNING.most_move)
        return True
