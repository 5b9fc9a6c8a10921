"""Cheaper plans by half-spaces turned to the plan at hand, again and again.

The price is the shadow price of the risk, per unit of probability, unless called a unit price.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.verdict import Judge
from radmpc.program.build import build_program, controls_of
from radmpc.program.turned import Turned
from radmpc.solvers.priced.nodes import Incumbent
from radmpc.solvers.priced.rating import Rater
from radmpc.solvers.priced.tree import RiskTree

__all__ = ["plan_by_turning", "turn_half_spaces"]

_LOG = logging.getLogger(__name__)

_ANY = 1e3
"""Sum of risks that is no limit [-]."""

_NOTHING = 1e-300
"""Stands for a certificate of 0 where one divides by it [-]."""


def turn_half_spaces(fleet: Fleet, state: SearchState, judge: Judge) -> SearchState:
    """Improve the incumbent by half-spaces of any direction, until little is gained.

    Every hazard keeps the side on which the plan passes it, by a half-space turned to where it
    separates best along the plan. With one alternative for each avoidance the least effort at a
    price of risk is a linear program with tangents; its plan turns the half-spaces anew.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    state : SearchState
        With a certified plan.
    judge : callable
        The referee.

    Returns
    -------
    SearchState
        With a cheaper plan where there is one. What was proven stays as it is.
    """
    incumbent, price = state.incumbent, state.last_unit_price(fleet) / fleet.unit
    turning = _Turning(fleet, state, judge, incumbent.sets, price)
    return turning.run(_points(fleet, incumbent.sets, incumbent.controls), TUNING.rounds)


def plan_by_turning(
    fleet: Fleet,
    state: SearchState,
    judge: Judge,
    sets: tuple[Members, ...],
    controls: tuple[Matrix, ...],
) -> SearchState:
    """Look for a certified plan near one that risks too much, by half-spaces turned to it.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    state : SearchState
        What is known of it.
    judge : callable
        The referee.
    sets : tuple of tuple of int
        Who is planned together.
    controls : tuple of (T, m) array
        Of a plan without collisions, noise aside, in the scenario's order.

    Returns
    -------
    SearchState
        With the plan, if it is certified and cheaper.
    """
    # Risk counts for much more than effort until the plan is certified.
    price = TUNING.dear * fleet.first_unit_price(state.budget) / fleet.unit
    turning = _Turning(fleet, state, judge, sets, price)
    return turning.run(_points(fleet, sets, controls), 2 * TUNING.rounds)


@dataclass(slots=True, eq=False)
class _Turning:
    """How far the turning of a plan has come; it lives for one plan, and nobody else writes to it.

    Attributes
    ----------
    state : SearchState
        With the best plan so far.
    price : float
        Shadow price of the risk, per unit of probability.
    prices : dict
        Sets that have converged, with the price at which they did.
    risks : dict
        What the rows of each set sum to [-].
    num_solves : int
        Solves of sets so far.
    """

    fleet: Fleet
    state: SearchState
    judge: Judge
    sets: tuple[Members, ...]
    price: float
    prices: dict[Members, float] = field(default_factory=dict)
    risks: dict[Members, float] = field(default_factory=dict)
    num_solves: int = 0

    def run(self, points: Sequence[Vector], rounds: int) -> SearchState:
        """Turn half-spaces to the plan and plan again, until little is gained or nothing helps."""
        fleet, sets = self.fleet, self.sets
        risk_bound = fleet.scenario.risk_bound
        num_stalls, least = 0, self._take(points)
        cheapest = _cost(fleet, sets, points) if least <= risk_bound else float("inf")
        for number in range(rounds):
            has_spent = number >= TUNING.least_rounds and self.num_solves >= TUNING.most_solves
            if fleet.limits.reached or num_stalls >= TUNING.max_stalls or has_spent:
                break
            points = [self._turned(m, z) for m, z in zip(sets, points, strict=True)]
            certified = self._take(points)
            cost = _cost(fleet, sets, points)
            _LOG.info(
                "turn %d of half-spaces: 1 %% of the risk bound at a price of %.3g; cost %.6g, "
                "certificate %.3g of risk bound %g",
                number + 1, 0.01 * risk_bound * self.price, cost, certified, risk_bound,
            )  # fmt: skip
            is_little = cheapest - cost < TUNING.enough * fleet.gap * abs(cost)
            if certified <= risk_bound:
                cheapest = min(cheapest, cost)
            else:
                # Little above Δ, a price so near the last may do that converged sets would skip it.
                self.prices.clear()
                is_little = certified > max(TUNING.less * least, TUNING.close * risk_bound)
            num_stalls = num_stalls + 1 if is_little else 0
            least = min(least, certified)
            ratio, most = certified / (TUNING.aim * risk_bound), TUNING.most_move
            ratio = float(np.clip(ratio, 1.0 / most, most))
            self.price *= ratio**TUNING.damping
        return self.state

    def _take(self, points: Sequence[Vector]) -> float:
        """Keep a plan if it is certified and the cheapest; return its certificate."""
        fleet, incumbent, sets = self.fleet, self.state.incumbent, self.sets
        controls = fleet.programs.controls(sets, points)
        certified, cost = self.judge(controls).certified, _cost(fleet, sets, points)
        if certified <= fleet.scenario.risk_bound and cost < incumbent.cost:
            spent = sum(self.risks.get(m, 0.0) for m in sets)
            better = replace(
                incumbent,
                controls=controls,
                cost=cost,
                certified=certified,
                sets=sets,
                turned_price=self.price * spent / max(certified, _NOTHING) if spent else None,
            )
            self.state = replace(self.state, incumbent=better)
        return certified

    def _turned(self, members: Members, z: Vector) -> Vector:
        """Return a set's plan with its half-spaces turned anew, unless it has converged."""
        price = self.prices.get(members)
        has_converged = price is not None and abs(self.price / price - 1.0) < TUNING.same_price
        if has_converged or self.fleet.limits.reached:
            return z
        self.num_solves += 1
        found = _turned(self.fleet, members, z, self.price)
        if found is None:
            return z
        new, self.risks[members] = found.z, found.risk
        cost = self.fleet.programs.problem(members).program.cost
        if float(cost @ np.abs(new - z)) <= TUNING.still * self.fleet.gap * float(cost @ new):
            self.prices[members] = self.price
        return new


def _points(fleet: Fleet, sets: Sequence[Members], controls: Sequence[Matrix]) -> list[Vector]:
    """Return a plan as points of its sets."""
    points = []
    for members in sets:
        halves = [(np.maximum(controls[i], 0.0), np.maximum(-controls[i], 0.0)) for i in members]
        points.append(np.concatenate([half.ravel() for pair in halves for half in pair]))
    return points


def _cost(fleet: Fleet, sets: Sequence[Members], points: Sequence[Vector]) -> float:
    """Return the effort of a plan."""
    return sum(
        float(fleet.programs.problem(m).program.cost @ z) for m, z in zip(sets, points, strict=True)
    )


def _turned(fleet: Fleet, members: Members, z: Vector, price: float) -> Incumbent | None:
    """Return the best plan of a set whose half-spaces are turned to a given one."""
    problem = fleet.programs.problem(members)
    intervals = fleet.scenario.avoidance == "intervals"
    turned = Turned(problem.models, problem.means(z), controls_of(problem.models, z), intervals)
    alone = fleet.programs.alone(members)
    program = build_program(alone, problem.models, risk_bound=alone.risk_bound, turned=turned)
    rater = Rater(program, _ANY)
    if rater.is_infeasible:
        return None
    rating = rater.rate(z)
    # A plan that risks too much must be allowed to, or it could not become better step by step.
    unit = max(fleet.unit, min(TUNING.slack * rating.risk, _ANY))
    if unit < _ANY:
        rater = Rater(program, unit)
    tree = RiskTree(
        program, unit, price * unit, gap=1e-5, scale=price * unit, limits=fleet.limits, rater=rater
    )
    near = tuple(
        a
        for a in rating.selection.tolist()
        if rating.clearances[program.rows_of(a)].min(initial=np.inf) < TUNING.near
    )
    tree.resume(((-np.inf, near),), price * unit, None)
    tree.run(TUNING.nodes)
    return tree.best
