"""Cheaper plans by half-spaces turned to the plan at hand, again and again."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.planners.certified.best import Best
from radmpc.planners.certified.fleet import Fleet, Members
from radmpc.planners.certified.verdict import Judge
from radmpc.program.build import build_program, controls_of
from radmpc.program.turned import Turned
from radmpc.solvers.risk_nodes import Incumbent
from radmpc.solvers.risk_tree import RiskTree

__all__ = ["turn_half_spaces"]

_LOG = logging.getLogger(__name__)

_ROUNDS = 12
_NODES = 400
"""Nodes per set and round: every danger has one side, so that nodes only add what comes near."""

_NEAR = 12.0
"""Standard deviations up to which a danger counts from the first."""

_AIM = 0.97
"""Share of Δ that the price aims at by the referee."""

_MOST_MOVE = 30.0
"""Factor by which a price changes at most between rounds."""

_DAMPING = 0.8
"""Power of the ratio that the price follows: risk answers to price a little more than inversely."""

_ENOUGH = 0.1
"""Share of the gap below which a round gains too little to go on."""

_MAX_STALLS = 2
_NOTHING = 1e-300
_STILL = 0.1
"""Share of the gap below which what a set's controls change by is nothing."""

_SAME_PRICE = 0.3
"""Relative difference of prices up to which a set that stood still is left alone."""


def turn_half_spaces(fleet: Fleet, best: Best, judge: Judge) -> None:
    """Improve the best plan by half-spaces of any direction, until little is gained.

    Every danger keeps the side on which the plan passes it, by a half-space turned to where it
    separates best along the plan. With one side for each danger the least effort at a price of risk
    is a linear program with tangents; its plan turns the half-spaces anew.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    best : Best
        With a plan; takes cheaper ones. What was proven stays as it is.
    judge : callable
        The referee.
    """
    granted, limits = fleet.scenario.risk_bound, fleet.limits
    sets = best.sets
    points = _points(fleet, sets, best.controls)
    price = best.rounds[-1][1] if best.rounds else fleet.first_price()
    num_stalls, settled = 0, _Settled()
    for number in range(_ROUNDS):
        if limits.reached or num_stalls >= _MAX_STALLS:
            break
        points = [settled.turned(fleet, m, z, price) for m, z in zip(sets, points, strict=True)]
        spent = sum(settled.risks.get(m, 0.0) for m in sets)
        controls = fleet.controls(sets, points)
        certified = judge(controls).certified
        cost = _cost(fleet, sets, points)
        _LOG.info(
            "turn %d: price of risk %.3g, cost %.6g, certificate %.3g",
            number + 1, price, cost, certified,
        )  # fmt: skip
        if certified <= granted:
            is_little = best.cost - cost < _ENOUGH * fleet.gap * abs(best.cost)
            num_stalls = num_stalls + 1 if is_little else 0
            if cost < best.cost:
                best.controls, best.cost, best.certified = controls, cost, certified
                best.turned_price = price / fleet.unit * spent / max(certified, _NOTHING)
        ratio = float(np.clip(certified / (_AIM * granted), 1.0 / _MOST_MOVE, _MOST_MOVE))
        price *= ratio**_DAMPING


@dataclass(slots=True, eq=False)
class _Settled:
    """Which sets no longer change, and at what price that was; what each risks by its rows."""

    prices: dict[Members, float] = field(default_factory=dict)
    risks: dict[Members, float] = field(default_factory=dict)

    def turned(self, fleet: Fleet, members: Members, z: Vector, price: float) -> Vector:
        """Return a set's plan with its half-spaces turned anew, unless it has settled."""
        known = self.prices.get(members)
        if known is not None and abs(price / known - 1.0) < _SAME_PRICE:
            return z
        found = _turned(fleet, members, z, price)
        if found is None:
            return z
        new, self.risks[members] = found.z, found.risk
        moved = float(np.abs(fleet.problem(members).program.cost @ np.abs(new - z)))
        if moved <= _STILL * fleet.gap * float(fleet.problem(members).program.cost @ new):
            self.prices[members] = price
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
    return sum(float(fleet.problem(m).program.cost @ z) for m, z in zip(sets, points, strict=True))


def _turned(fleet: Fleet, members: Members, z: Vector, price: float) -> Incumbent | None:
    """Return the best plan of a set whose half-spaces are turned to a given one."""
    problem = fleet.problem(members)
    intervals = fleet.scenario.avoidance == "intervals"
    turned = Turned(problem.subjects, problem.means(z), controls_of(problem.subjects, z), intervals)
    alone = fleet.alone[members]
    program = build_program(alone, problem.subjects, risk_bound=alone.risk_bound, turned=turned)
    tree = RiskTree(program, fleet.unit, price, gap=1e-5, scale=price, limits=fleet.limits)
    if tree.rater.is_hopeless:
        return None
    rating = tree.rater.rate(z)
    clearances = rating.clearances
    near = tuple(
        side
        for side in rating.selection.tolist()
        if clearances[program.rows_of(side)].min(initial=np.inf) < _NEAR
    )
    tree.resume(((-np.inf, near),), price, None)
    tree.run(_NODES)
    return tree.best
