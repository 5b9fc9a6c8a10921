"""Cheaper plans by half-spaces turned to the plan at hand, again and again.

The price is the shadow price of the risk, per unit of probability, unless called a unit price.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from radmpc.arrays import Matrix
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.incumbent import FleetIncumbent
from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.turned.hazards import Hazards
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.verdict import Judge

__all__ = ["plan_by_turning", "turn_half_spaces"]

_LOG = logging.getLogger(__name__)

_ROUNDS = 30
"""Turns at most [-], twice as many from a plan that risks too much. The families of the benchmarks
mostly stop earlier, when little is gained; the first few often exceed Δ and are lost."""

_MOST_SOLVES, _LEAST_ROUNDS = 400, 2
"""Solves of groups after which no round is begun [-], but for so many rounds of all: large fleets
gain little by the solve, and a count, unlike a clock, gives the same plan on any machine."""

_TOGETHER = 48
"""Vehicles up to which the whole fleet is planned together [-]; the sets of the plan beyond. One
linear program of 20 vehicles takes 30 ms."""

_SPACING, _FINER, _LEAST_SPACING = 0.12, 0.7, 0.01
"""Between clearances at which risk is interpolated around the latest: at first, its factor from round
to round, and at least [standard deviations]."""

_AIM = 0.985
"""Share of Δ that the certificate is to come to at the next price [-]."""

_MOST_MOVE = 30.0
"""Ratio of certificate to aim that a price follows at most, either way [-]."""

_DAMPING = 0.8
"""Power of that ratio that the price follows [-]: risk falls a little faster than in proportion."""

_ENOUGH = 0.1
"""Share of the gap below which a round gains too little to go on [-]."""

_MAX_STALLS = 3
"""Rounds in a row that gain too little, after which none follows [-]."""

_LESS = 0.9
"""Share of the least certificate so far that a round must come below while far above Δ [-]."""

_CLOSE = 2.0
"""Multiple of Δ up to which a certificate above it is left for the price to repair [-]."""

_DEAR = 10.0
"""Multiple of the first price at which turning begins from a plan that risks too much [-]."""

_NOTHING = 1e-300
"""Stands for a certificate of 0 where one divides by it [-]."""


def turn_half_spaces(fleet: Fleet, incumbent: FleetIncumbent, judge: Judge) -> None:
    """Improve the incumbent by half-spaces of any direction, until little is gained.

    Every hazard keeps the side on which the plan passes it, by a half-space turned to where it
    separates best along the plan. Between them the least effort at a price of risk is a linear
    program; its plan turns the half-spaces anew.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    incumbent : FleetIncumbent
        Has a plan, and takes cheaper ones. What was proven stays as it is.
    judge : callable
        The referee.
    """
    rounds = incumbent.round_bounds
    unit_price = rounds[-1][1] if rounds else fleet.first_unit_price()
    turning = _Turning(fleet, incumbent, judge, incumbent.sets, unit_price / fleet.unit)
    turning.run(incumbent.controls, _ROUNDS)


def plan_by_turning(
    fleet: Fleet,
    incumbent: FleetIncumbent,
    judge: Judge,
    sets: tuple[Members, ...],
    controls: tuple[Matrix, ...],
) -> None:
    """Look for a certified plan near one that risks too much, by half-spaces turned to it.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    incumbent : FleetIncumbent
        Takes the plan, if one is certified.
    judge : callable
        The referee.
    sets : tuple of tuple of int
        Who is planned together.
    controls : tuple of (T, m) array
        Of a plan without collisions, noise aside, in the scenario's order.
    """
    # Risk counts for much more than effort until the plan is certified.
    price = _DEAR * fleet.first_unit_price() / fleet.unit
    turning = _Turning(fleet, incumbent, judge, sets, price)
    turning.run(controls, 2 * _ROUNDS)


@dataclass(slots=True, eq=False)
class _Turning:
    """How far the turning of a plan has come.

    Attributes
    ----------
    sets : tuple of tuple of int
        Who was planned together.
    price : float
        Shadow price of the risk, per unit of probability.
    risk : float
        What the half-spaces' risks sum to in the last round [-].
    num_solves : int
        Solves of groups so far.
    """

    fleet: Fleet
    incumbent: FleetIncumbent
    judge: Judge
    sets: tuple[Members, ...]
    price: float
    risk: float = 0.0
    num_solves: int = 0
    successive: SuccessiveLp = field(init=False)
    groups: tuple[Members, ...] = field(init=False)

    def __post_init__(self) -> None:
        """Lay out the fleet."""
        fleet = self.fleet
        hazards = Hazards.of(fleet.scenario, fleet.programs.models)
        self.successive = SuccessiveLp(hazards, fleet.limits)
        together = hazards.count <= _TOGETHER
        self.groups = (tuple(range(hazards.count)),) if together else self.sets

    def run(self, controls: Sequence[Matrix], rounds: int) -> None:
        """Turn half-spaces to the plan and plan again, until little is gained or nothing helps."""
        fleet, paths = self.fleet, self.successive.paths
        self.successive.begin(controls)
        risk_bound = fleet.scenario.risk_bound
        num_stalls, least = 0, self._take()
        cheapest = paths.cost() if least <= risk_bound else float("inf")
        for number in range(rounds):
            has_spent = number >= _LEAST_ROUNDS and self.num_solves >= _MOST_SOLVES
            if fleet.limits.reached or num_stalls >= _MAX_STALLS or has_spent:
                break
            self._turn(max(_LEAST_SPACING, _SPACING * _FINER**number))
            certified, cost = self._take(), paths.cost()
            _LOG.info(
                "turn %d of half-spaces: 1 %% of the risk bound at a price of %.3g; cost %.6g, "
                "certificate %.3g of risk bound %g",
                number + 1, 0.01 * risk_bound * self.price, cost, certified, risk_bound,
            )  # fmt: skip
            is_little = cheapest - cost < _ENOUGH * fleet.gap * abs(cost)
            if certified <= risk_bound:
                cheapest = min(cheapest, cost)
            else:
                is_little = certified > max(_LESS * least, _CLOSE * risk_bound)
            num_stalls = num_stalls + 1 if is_little else 0
            least = min(least, certified)
            ratio = float(np.clip(certified / (_AIM * risk_bound), 1.0 / _MOST_MOVE, _MOST_MOVE))
            self.price *= ratio**_DAMPING

    def _turn(self, spacing: float) -> None:
        """Plan every group once."""
        self.risk = 0.0
        for group in self.groups:
            if self.fleet.limits.reached:
                return
            self.risk += self.successive.share_risk(group, self.price, spacing)
            self.num_solves += 1

    def _take(self) -> float:
        """Keep a plan if it is certified and the cheapest; return its certificate."""
        incumbent, paths = self.incumbent, self.successive.paths
        controls = tuple(paths.controls)
        certified, cost = self.judge(controls).certified, paths.cost()
        if certified <= self.fleet.scenario.risk_bound and cost < incumbent.cost:
            incumbent.controls, incumbent.cost = controls, cost
            incumbent.certified, incumbent.sets = certified, self.sets
            incumbent.turned_price = (
                self.price * self.risk / max(certified, _NOTHING) if self.risk else None
            )
        return certified
