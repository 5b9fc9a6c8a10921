"""One mission by a rule of accounting, right or wrong, or by a peer; and what it came to."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from closed_loops.adversary import staking
from closed_loops.peers import PEERS, flown_by
from radmpc.flying import deciding
from radmpc.flying.account import Account
from radmpc.flying.flight import Flight, fly
from radmpc.flying.leg import miss_of
from radmpc.flying.mission import Mission
from radmpc.flying.model import Model
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario

__all__ = ["RULES", "STARVED", "Trial", "flown"]

RULES = ("plus", "kept", "all", "anew", "pool", "paper")
"""Of accounting; all of them by default."""

STARVED = 1e-4
"""Wealth below which a mission starves [-]."""


@dataclass(frozen=True)
class Trial:
    """What a mission came to.

    Attributes
    ----------
    rule, planner, seed
        As in `flown`.
    has_collided : bool
        Whether anything was hit.
    effort, miss : float
        As flown, and by how much goals were missed, a vehicle's mean [-, m].
    adopted, starved : int
        Ticks at which a candidate was adopted, and those with next to no wealth.
    ticks : list of float
        Processor seconds that each tick took [ms].
    """

    rule: str
    planner: str
    seed: int
    has_collided: bool
    effort: float
    miss: float
    adopted: int
    starved: int
    ticks: list[float]


class Pool:
    """What a pool still holds while a mission is flown: Δ less every step's risk."""

    def __init__(self, bound: float) -> None:
        self.left = bound


@contextmanager
def rule_of(name: str, pool: Pool) -> Iterator[None]:
    """Have accounts keep a wrong rule for a while."""
    right, objection = Account.wealth, deciding.objection
    if name == "anew":
        Account.wealth = property(lambda self: self.risk_bound)
    if name == "pool":
        Account.wealth = property(lambda self: max(self.tail, pool.left))
    if name == "paper":
        Account.wealth = property(lambda self: pool.left)
        deciding.objection = lambda moment, price, scores, *, is_first: (
            "" if moment.account.affords(price) else "the pool does not hold so much"
        )
    try:
        yield
    finally:
        Account.wealth = right
        deciding.objection = objection


def flown(plan: Plan, rule: str, planner: str, seed: int) -> Trial:
    """Fly one mission by a rule, or by a peer, in the noise of a seed."""
    scenario = plan.scenario
    if rule in PEERS:
        return _trial((rule, planner, seed), scenario, flown_by(rule, plan, seed))
    pool = Pool(scenario.risk_bound)
    options: dict[str, object] = {"clock": time.process_time}
    if rule == "kept" or planner == "warm":
        options["planner"] = None
    elif planner == "staking":
        options["planner"] = staking
    options["warm"] = rule != "kept" and planner == "warm"
    if rule in {"all", "anew", "paper"} or planner == "staking":
        options["share"] = 1.0
    with rule_of(rule, pool):
        mission = Mission(plan, **options)
        if rule == "all":
            mission.set_risk_bound(mission.balance.risk_bound - 0.999 * mission.balance.bank)
        flight = fly(mission, _Counting(Model(scenario, seed), mission, pool))
    return _trial((rule, planner, seed), scenario, flight)


def _trial(key: tuple[str, str, int], scenario: Scenario, flight: Flight) -> Trial:
    """Return what a flight came to."""
    pairs = zip(scenario.vehicles, flight.states[-1], strict=True)
    ticks = [t for t in flight.ticks if t.segments]
    return Trial(
        *key,
        flight.has_collided,
        flight.effort,
        sum(miss_of(v, state, scenario.dt) for v, state in pairs) / scenario.num_vehicles,
        sum(t.choice == "candidate" for t in ticks),
        sum(bool(t.wealth < STARVED) for t in ticks),
        [round(1e3 * t.seconds, 3) for t in ticks],
    )


class _Counting:
    """A model that takes from the pool what each step risks."""

    def __init__(self, model: Model, mission: Mission, pool: Pool) -> None:
        self.model, self.mission, self.pool = model, mission, pool
        self.reset = model.reset

    def advance(self, segments):
        spent = self.mission.ticks[-1].next_step if self.mission.ticks else None
        self.pool.left = max(self.pool.left - (spent or 0.0), 0.0)
        return self.model.advance(segments)
