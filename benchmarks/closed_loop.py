"""Missions under way by several rules of accounting, the wrong ones among them; and tick times.

    python benchmarks/closed_loop.py --missions 75 --scenes slalom
    python benchmarks/closed_loop.py --missions 1000 --planner warm --scenes slalom
    python benchmarks/closed_loop.py --missions 25 --scenes paper --rules plus kept
    python benchmarks/closed_loop.py --missions 1000 --planner warm --rules plus --scenes circle16

Every rule flies the same noise. Of each: how many missions collide, with the 95 % interval of
Clopper and Pearson; effort as flown, by how much goals are missed, the share of ticks at which a
candidate was adopted, the share of ticks with wealth below 1e-4, and milliseconds of processor that
a tick takes: the median, 99 of 100, 999 of 1,000, and the most.

`kept` flies the first plan to its end, `plus` is the rule of `radmpc.Mission`; `all` lets
candidates cost all of the wealth and begins without a bank; `anew` grants Δ at each tick; `pool`
takes the larger of the tail and of what a pool still holds from which every step's risk was taken;
`paper` plans within that pool alone and flies whatever was found, as the paper's scheme does.
`orca` and `dmpc` keep no account at all (`closed_loop_peers.py`).
`--planner warm` makes candidates by kept linear programs, else `certified` is asked on the spot.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np
from rich.console import Console
from rich.table import Table
from scipy.special import betaincinv

from closed_loop_peers import PEERS, flown_by
from radmpc.experiments.families import circle, fleet, paper
from radmpc.flying import deciding
from radmpc.flying.account import Account
from radmpc.flying.flight import Flight, fly
from radmpc.flying.leg import miss_of
from radmpc.flying.mission import Mission
from radmpc.flying.model import Model
from radmpc.model.dynamics import LinearSystem
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planning import plan
from radmpc.result import Result

RULES = ("plus", "kept", "all", "anew", "pool", "paper")
"""Of accounting; all of them by default."""

SECONDS = 60.0
"""What the first plan may take [s]."""

QUANTILES = (0.5, 0.99, 0.999, 1.0)

STARVED = 1e-4
"""Wealth below which a mission starves [-]."""


def slalom(risk_bound: float = 0.1) -> Scenario:
    """Return a vehicle without inertia between blocks on both sides, under dead-beat feedback."""
    eye = np.eye(2)
    gates = []
    for number in range(3):
        x = 1.5 + 2.0 * number
        low, high = (-40.0, 0.25) if number % 2 == 0 else (-0.25, 40.0)
        gates.append(Obstacle.box(f"g{number}", [x - 0.6, low], [x + 0.6, high]))
    vehicle = Vehicle(
        name="skier",
        system=LinearSystem(eye, eye, (0, 1), None),
        start=[0.0, 0.0],
        goal=Goal.at([7.0, 0.0], 0.05, None),
        radius=0.2,
        control_limit=1.6,
        initial_covariance=0.0,
        disturbance_covariance=0.12**2,
        gain=-eye,
        control_sigmas=2.0,
    )
    return Scenario("slalom", 1.0, 8, risk_bound, (vehicle,), tuple(gates), avoidance="steps")


def noisy_paper(seed: int) -> Scenario:
    """Return a problem of the paper's kind with four times its deviations and Δ = 0.1."""
    scenario = paper(3, seed)
    louder = tuple(
        replace(
            v,
            initial_covariance=16.0 * v.initial_covariance,
            disturbance_covariance=16.0 * v.disturbance_covariance,
        )
        for v in scenario.vehicles
    )
    return replace(scenario, vehicles=louder, risk_bound=0.1)


SCENES = {
    "slalom": slalom,
    "paper": lambda: noisy_paper(3),
    "circle8": lambda: circle(8),
    "circle16": lambda: circle(16),
    "fleet64": lambda: fleet(64, 0),
}


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


@dataclass(frozen=True)
class Outcome:
    """What a mission came to."""

    flight: Flight
    miss: float


def flown(result: Result, rule: str, seed: int, planner: str) -> Outcome:
    """Fly one mission by a rule, or by a peer."""
    scenario = result.record.scenario
    if rule in PEERS:
        return _outcome(scenario, flown_by(rule, scenario, seed))
    pool = Pool(scenario.risk_bound)
    options: dict[str, object] = {"clock": time.process_time}
    if rule == "kept" or planner == "warm":
        options["planner"] = None
    options["warm"] = rule != "kept" and planner == "warm"
    if rule in {"all", "anew", "paper"}:
        options["share"] = 1.0
    with rule_of(rule, pool):
        mission = Mission(result, **options)
        if rule == "all":
            mission.set_risk_bound(mission.balance.risk_bound - 0.999 * mission.balance.bank)
        flight = fly(mission, _Counting(Model(scenario, seed), mission, pool))
    return _outcome(scenario, flight)


def _outcome(scenario: Scenario, flight: Flight) -> Outcome:
    """Return what a flight came to."""
    miss = 0.0
    for vehicle, state in zip(scenario.vehicles, flight.states[-1], strict=True):
        miss += miss_of(vehicle, state, scenario.dt) / scenario.num_vehicles
    return Outcome(flight, miss)


class _Counting:
    """A model that takes from the pool what each step risks."""

    def __init__(self, model: Model, mission: Mission, pool: Pool) -> None:
        self.model, self.mission, self.pool = model, mission, pool
        self.reset = model.reset

    def advance(self, segments):
        spent = self.mission.ticks[-1].next_step if self.mission.ticks else None
        self.pool.left = max(self.pool.left - (spent or 0.0), 0.0)
        return self.model.advance(segments)


def row(name: str, outcomes: list[Outcome]) -> list[str]:
    """Return a row of the table."""
    count = len(outcomes)
    hits = sum(o.flight.has_collided for o in outcomes)
    low = float(betaincinv(hits, count - hits + 1, 0.025)) if hits else 0.0
    high = float(betaincinv(hits + 1, count - hits, 0.975)) if hits < count else 1.0
    ticks = [t for o in outcomes for t in o.flight.ticks if t.segments]
    return [
        name,
        f"{hits / count:.3f} [{low:.3f}, {high:.3f}]",
        f"{np.mean([o.flight.effort for o in outcomes]):.2f}",
        f"{np.mean([o.miss for o in outcomes]):.3f}",
        f"{np.mean([t.choice == 'candidate' for t in ticks]):.2f}",
        f"{np.mean([t.wealth < STARVED for t in ticks]):.3f}",
        " / ".join(f"{1e3 * np.quantile([t.seconds for t in ticks], q):.1f}" for q in QUANTILES),
    ]


def main() -> None:
    """Fly all missions and print a table per scene."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--missions", type=int, default=75)
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--rules", nargs="+", choices=[*RULES, *PEERS], default=list(RULES))
    parser.add_argument("--planner", choices=("certified", "warm"), default="certified")
    parser.add_argument("--seconds", type=float, default=600.0, help="per scene, at most")
    options = parser.parse_args()
    console = Console()
    for name in options.scenes:
        result = plan(SCENES[name](), rng=0, time_limit=SECONDS)
        if result.plan is None or result.certificate is None:
            console.print(f"{name}: {result.explanation}")
            continue
        bound, certified = result.record.scenario.risk_bound, result.certificate.certified
        outcomes: dict[str, list[Outcome]] = {rule: [] for rule in options.rules}
        end = time.monotonic() + options.seconds
        for seed in range(options.missions):
            if time.monotonic() > end:
                break
            for rule in options.rules:
                outcomes[rule].append(flown(result, rule, seed, options.planner))
        flights = len(outcomes[options.rules[0]])
        title = (
            f"{name}: {flights} missions, Δ = {bound:g}, certificate {certified:.4f}, "
            f"effort {result.cost:.2f}"
        )
        table = Table(title=title)
        for heading in ("rule", "collide", "effort", "miss [m]", "adopted", "starved", "ms / tick"):
            table.add_column(heading)
        for rule in options.rules:
            table.add_row(*row(rule, outcomes[rule]))
        console.print(table)


if __name__ == "__main__":
    main()
