"""The bound on any certified plan, set by set, at the shadow price of the plan at hand."""

from __future__ import annotations

import logging
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from radmpc.arrays import Matrix
from radmpc.gaussian import Tail
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.proof.relaxed_set import RelaxedSet
from radmpc.planners.certified.proof.tubes import within_tube
from radmpc.planners.certified.proof.tuning import TUNING
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.program.build import controls_of, cost_of_time, point_of
from radmpc.program.relaxed.tails import Tails, tails_of
from radmpc.solvers.priced.lp import SetBound
from radmpc.solvers.solution import relative_gap

__all__ = ["Proof", "bound_on_any"]

_LOG = logging.getLogger(__name__)

_SAME = 1e-6
"""Difference of controls up to which two plans are one [in the units of controls]."""


@dataclass(frozen=True, slots=True, eq=False)
class Proof:
    """What the relaxation says.

    Attributes
    ----------
    bound : float
        No plan that the referee would certify costs less; at most the cost of the plan at hand.
    controls : tuple of (T, m) array
        The best plan of the relaxation, in the scenario's order: it risks too much, by a little,
        but its sides may be better ones. Empty where it is the plan at hand.
    """

    bound: float
    controls: tuple[Matrix, ...] = ()


def bound_on_any(
    fleet: Fleet, incumbent: FleetIncumbent, price: float | None, most_nodes: float = float("inf")
) -> Proof:
    """Return a lower bound on the cost of any plan that the referee would certify.

    Parameters
    ----------
    fleet : Fleet
        The fleet, with the limits that end the proof.
    incumbent : FleetIncumbent
        The plan at hand.
    price : float or None
        Its shadow price of Δ, per unit of probability; None where it is not known.
    most_nodes : float
        Nodes after which no set is searched on [-].

    Returns
    -------
    Proof
        Its bound is what the vehicles cost alone in empty space, at least.
    """
    base = float(sum(fleet.base))
    cost = incumbent.cost
    if relative_gap(cost, base) <= TUNING.gap:
        return Proof(min(base, cost))
    search = _Search(fleet, incumbent, price or 0.0, base, most_nodes)
    search.run()
    return Proof(min(search.best, cost), search.relaxed_controls())


@dataclass(slots=True, eq=False)
class _Search:
    """The search for the bound: sets are searched in turn, those that promise most first."""

    fleet: Fleet
    incumbent: FleetIncumbent
    price: float
    best: float
    most_nodes: float
    nodes: int = 0
    tails: Tails = field(init=False)
    parts: tuple[Members, ...] = field(init=False)
    sets: dict[Members, RelaxedSet] = field(default_factory=dict)

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
        self.parts = tuple(sorted(parts, key=self._paid_for_hazards, reverse=True))

    @property
    def is_over(self) -> bool:
        """Whether the bound is good enough, or no more work is allowed."""
        gap = max(TUNING.gap, self.fleet.gap)
        return relative_gap(self.incumbent.cost, self.best) <= gap or self._has_spent

    @property
    def _is_narrowed(self) -> bool:
        """Whether reach is narrowed to that of plans that matter."""
        return len(self.fleet.scenario.obstacles) >= TUNING.many_obstacles

    @property
    def _has_spent(self) -> bool:
        """Whether time is up, or all nodes are spent."""
        return self.nodes >= self.most_nodes or self.fleet.limits.reached

    def run(self) -> None:
        """Raise the bound, by more nodes, by another price, by more directions."""
        for num_directions in TUNING.directions:
            self.sets = {}
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
        for members, known in self.sets.items():
            if members not in self.parts or known.best is None:
                continue
            models = [self.fleet.programs.models[i] for i in members]
            for i, found in zip(members, controls_of(models, known.best.z), strict=True):
                is_other |= bool(np.abs(found - controls[i]).max() > _SAME)
                controls[i] = found
        return tuple(controls) if is_other else ()

    def _paid_for_hazards(self, members: Members) -> float:
        """Return what a set's plan costs beyond the least in empty space."""
        vehicles = self.fleet.scenario.vehicles
        return sum(
            vehicles[i].cost_weight * float(np.abs(self.incumbent.controls[i]).sum())
            + cost_of_time(self.fleet.programs.models[i], self.incumbent.controls[i])
            - self.fleet.base[i]
            for i in members
        )

    def _relaxed(self, members: Members, num_directions: int, most: float) -> RelaxedSet:
        """Build a set's relaxation; among many obstacles with the reach of plans up to a value.

        The other vehicles cost at least what they do in empty space. What a fleet dearer than the
        plan at hand may do is of no interest either: no bound is above its cost.
        """
        fleet = self.fleet
        models = [fleet.programs.models[i] for i in members]
        if self._is_narrowed:
            most_over = most - sum(fleet.base[i] for i in members)
            most_over = min(most_over, self.incumbent.cost - sum(fleet.base))
            programs = [fleet.programs.problem((i,)).program for i in members]
            models = [
                within_tube(model, program, fleet.base[i] + most_over, fleet.limits)
                for i, model, program in zip(members, models, programs, strict=True)
            ]
        return RelaxedSet.of(fleet, members, models, self.tails, num_directions, most)

    def _next_most(self, known: RelaxedSet, gap: float) -> float | None:
        """Return the value up to which a set is searched next; None to go on as it is.

        A search up to a lower value is over much sooner: reach is narrower. So after a first try
        such values are proven one after the other, each a share of what is left above the last.
        """
        if not self._is_narrowed or known.is_trivial:
            return None
        final = self._most_value(known.members)
        if known.widenings == 0:
            is_over = known.nodes >= TUNING.try_nodes * len(known.members)
        else:
            is_over = known.most < final and known.bound >= known.most * (1.0 - 1.01 * gap)
        left = min(known.value, final) - known.bound
        if not is_over or left <= gap * final:
            return None
        step = TUNING.stage * left
        if step > 2.0 * gap * final and left > TUNING.last_stage * (final - known.base):
            return known.bound + step
        return final if known.most < final else None

    def _most_value(self, members: Members) -> float:
        """Return what a set's value is at most at any price tried: its plan risks Δ at most."""
        paid = self._paid_for_hazards(members) + sum(self.fleet.base[i] for i in members)
        dearest = self.price * TUNING.most_move ** (TUNING.prices - 1)
        return paid + dearest * self.fleet.scenario.risk_bound

    def _search(self, num_directions: int) -> None:
        """Search all sets at the present price, until what is open matters no more."""
        gap, nodes = TUNING.set_gap, TUNING.nodes
        for _ in range(TUNING.rounds):
            worth = TUNING.worth * max(self.incumbent.cost - self.best, 0.0)
            is_new = False
            for members in self.parts:
                is_new |= self._advance(members, num_directions, gap, nodes, worth)
                self._note()
                if self.is_over:
                    return
            if not is_new:
                return
            gap, nodes = gap * TUNING.finer, 2 * nodes

    def _advance(
        self, members: Members, num_directions: int, gap: float, nodes: int, worth: float
    ) -> bool:
        """Search a set on, its vehicles alone before; tell whether there was anything to do."""
        known = self.sets.get(members)
        if self._has_spent:
            return False
        if known is None and self._paid_for_hazards(members) <= worth:
            return False
        if known is None:
            most = self._most_value(members) if self._is_narrowed else float("inf")
            known = self._relaxed(members, num_directions, most)
        is_here = known.price == self.price
        if is_here and (known.is_trivial or known.value - known.bound <= worth):
            return False
        bounds: list[SetBound] = []
        for size in range(1, min(len(members), 3)):
            for blocks in combinations(range(len(members)), size):
                part = tuple(members[block] for block in blocks)
                self._advance(part, num_directions, gap, nodes, worth)
                if part in self.sets and self.sets[part].price == self.price:
                    bounds.append(SetBound(frozenset(blocks), self.sets[part].bound))
        share = int(min(nodes * len(members), max(self.most_nodes - self.nodes, 1)))
        self._search_on(known, tuple(bounds), num_directions, gap, share)
        return True

    def _search_on(
        self,
        known: RelaxedSet,
        bounds: tuple[SetBound, ...],
        num_directions: int,
        gap: float,
        share: int,
    ) -> None:
        """Search a set for so many nodes, up to one value after the other."""
        members, last = known.members, known.nodes + share
        models = [self.fleet.programs.models[i] for i in members]
        hint = point_of(models, [self.incumbent.controls[i] for i in members])
        is_over = False
        while not is_over:
            most = self._next_most(known, gap)
            if most is not None:
                known = self._relaxed(members, num_directions, most).continued(known)
            nodes = last - known.nodes
            first = TUNING.try_nodes * len(members) - known.nodes
            if self._is_narrowed and known.widenings == 0 and first > 0:
                nodes = min(nodes, first)
            found = known.searched(self.fleet, self.price, bounds, gap, nodes, hint)
            self.nodes += found.nodes - known.nodes
            known = self.sets[members] = found
            is_done = known.nodes >= last or self.fleet.limits.reached
            is_over = is_done or self._next_most(known, gap) is None

    def _note(self) -> None:
        """Keep the bound at the present price if it is the best."""
        total = sum(self.fleet.base)
        for members in self.parts:
            known = self.sets.get(members)
            if known is not None and known.price == self.price:
                total += known.bound - known.base
        self.best = max(self.best, total - self.price * self.fleet.scenario.risk_bound)

    def _has_moved_price(self) -> bool:
        """Choose a better price where the relaxed plans risk far more or less than Δ."""
        found = [self.sets.get(members) for members in self.parts]
        risk = sum(s.best.risk for s in found if s is not None and s.best is not None)
        ratio = risk / self.fleet.scenario.risk_bound
        if self.price <= 0.0 or 1.0 / TUNING.off < ratio < TUNING.off:
            return False
        self.price *= min(max(ratio, 1.0 / TUNING.most_move), TUNING.most_move)
        return True
