"""Cheaper plans by half-spaces turned to the plan at hand, again and again.

The price is the shadow price of the risk, per unit of probability, unless called a unit price.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from radmpc.arrays import Matrix
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.hazards import Hazards
from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.verdict import Judge
from radmpc.solvers.solution import Limits

__all__ = ["Task", "Turning", "plan_by_turning", "turn_half_spaces"]

_LOG = logging.getLogger(__name__)

_NOTHING = 1e-300
"""Stands for a certificate of 0 where one divides by it [-]."""


def turn_half_spaces(fleet: Fleet, state: SearchState, judge: Judge) -> SearchState:
    """Improve the incumbent by half-spaces of any direction, until little is gained.

    Every hazard keeps the side on which the plan passes it, by a half-space turned to where it
    separates best along the plan. Between them the least effort at a price of risk is a linear
    program; its plan turns the half-spaces anew.

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
    turning = Turning(_task(fleet, judge), incumbent, incumbent.sets, price)
    turning.successive.begin(incumbent.controls)
    return replace(state, incumbent=turning.run(TUNING.rounds))


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
    turning = Turning(_task(fleet, judge), state.incumbent, sets, price)
    turning.successive.begin(controls)
    return replace(state, incumbent=turning.run(2 * TUNING.rounds))


def _task(fleet: Fleet, judge: Judge) -> Task:
    """Return what turning is asked of a fleet."""
    risk_bound = fleet.scenario.risk_bound
    return Task(fleet.programs.hazards, judge, fleet.limits, fleet.gap, risk_bound)


@dataclass(frozen=True, slots=True, eq=False)
class Task:
    """What is asked.

    Attributes
    ----------
    hazards : Hazards
        The fleet.
    judge : callable
        The referee.
    limits : Limits
        When to stop early.
    gap : float
        Relative difference of costs below which plans count as equal [-].
    risk_bound : float
        Δ [-].
    found : callable
        Told the cost of every better plan.
    """

    hazards: Hazards
    judge: Judge
    limits: Limits
    gap: float
    risk_bound: float
    found: Callable[[float], None] = lambda cost: None


@dataclass(slots=True, eq=False)
class Turning:
    """How far the turning of a plan has come; it lives for one plan, and nobody else writes to it.

    Attributes
    ----------
    task : Task
        What is asked.
    incumbent : FleetIncumbent
        The best plan so far.
    sets : tuple of tuple of int
        Who is planned together.
    price : float
        Shadow price of the risk, per unit of probability.
    successive : SuccessiveLp
        The latest paths, and what improves them.
    groups : tuple of tuple of int
        Who shares a linear program: everyone in a small fleet, else the sets.
    risk : float
        What the half-spaces' risks sum to in the last round [-].
    num_solves : int
        Solves of groups so far.
    """

    task: Task
    incumbent: FleetIncumbent
    sets: tuple[Members, ...]
    price: float
    successive: SuccessiveLp = field(init=False)
    groups: tuple[Members, ...] = field(init=False)
    risk: float = 0.0
    num_solves: int = 0

    def __post_init__(self) -> None:
        """Choose who shares a linear program."""
        count = self.task.hazards.count
        together = count <= TUNING.most_together
        self.groups = (tuple(range(count)),) if together else self.sets
        self.successive = SuccessiveLp(self.task.hazards, self.task.limits)

    def run(self, rounds: int) -> FleetIncumbent:
        """Turn half-spaces to the latest paths and plan again, until little is gained.

        Parameters
        ----------
        rounds : int
            Turns at most [-].

        Returns
        -------
        FleetIncumbent
            The best certified plan so far.
        """
        task, paths = self.task, self.successive.paths
        risk_bound = task.risk_bound
        num_stalls, previous = 0, self._take()
        cheapest = paths.cost() if previous <= risk_bound else float("inf")
        safe = (self.successive.state(), self.price) if previous <= risk_bound else None
        last = float("inf")
        for number in range(rounds):
            has_spent = number >= TUNING.least_rounds and self.num_solves >= TUNING.most_solves
            if task.limits.reached or num_stalls >= TUNING.max_stalls or has_spent:
                break
            self._turn(max(TUNING.least_spacing, TUNING.spacing * TUNING.finer**number))
            certified, cost = self._take(), paths.cost()
            _LOG.info(
                "turn %d of half-spaces: 1 %% of the risk bound at a price of %.3g; cost %.6g, "
                "certificate %.3g of risk bound %g",
                number + 1, 0.01 * risk_bound * self.price, cost, certified, risk_bound,
            )  # fmt: skip
            little = TUNING.enough * task.gap * abs(cost)
            is_little = cheapest - cost < little
            if certified > risk_bound:
                is_little = certified > max(TUNING.less * previous, TUNING.close * risk_bound)
            elif certified < TUNING.spent * risk_bound:
                is_little = abs(last - cost) < little
            if certified <= risk_bound:
                cheapest = min(cheapest, cost)
                safe = self.successive.state(), self.price
            last = cost
            num_stalls = num_stalls + 1 if is_little else 0
            if safe is not None and certified > TUNING.lost * risk_bound:
                # So cheap a price led where half-spaces no longer lead back from.
                self.successive.restore(safe[0])
                self.price, previous = TUNING.dearer * max(self.price, safe[1]), risk_bound
                continue
            previous = certified
            ratio = certified / (TUNING.aim * risk_bound)
            ratio = float(np.clip(ratio, 1.0 / TUNING.most_fall, TUNING.most_rise))
            self.price *= ratio**TUNING.damping
        return self.incumbent

    def _turn(self, spacing: float) -> None:
        """Plan every group once."""
        self.risk = 0.0
        for group in self.groups:
            if self.task.limits.reached:
                return
            self.risk += self.successive.share_risk(group, self.price, spacing)
            self.num_solves += 1

    def _take(self) -> float:
        """Keep the latest paths if they are certified and the cheapest; return the certificate."""
        paths = self.successive.paths
        controls = tuple(paths.controls)
        certified, cost = self.task.judge(controls).certified, paths.cost()
        if certified <= self.task.risk_bound and cost < self.incumbent.cost:
            price = self.price * self.risk / max(certified, _NOTHING)
            self.incumbent = replace(
                self.incumbent,
                controls=controls,
                cost=cost,
                certified=certified,
                sets=self.sets,
                turned_price=price if self.risk else None,
            )
            self.task.found(cost)
        return certified
