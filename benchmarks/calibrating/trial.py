"""One trial of the calibration: draw, plan, certify, fly; and its line in the table."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, replace

import numpy as np

from calibrating.noise import with_noise
from calibrating.overlap import measure_overlap
from calibrating.scenes import random_planner, random_scenario
from calibrating.world import world_collisions
from hunting.catch import clock
from radmpc.model.plan import Plan
from radmpc.planners import Ira, Planner
from radmpc.planners.presets import parse_planner
from radmpc.planning import plan
from radmpc.referee import Certificate, simulate
from radmpc.result import Result

__all__ = ["COLUMNS", "Trial", "run_trial", "trial_of"]

# Below this certificate a few ten thousand flights show nothing, let alone repetitions.
_OVERLAP_FROM = 1e-3

# Flown in plain loops, which take a second for as many among a few obstacles.
_MISSIONS = 4_000


@dataclass(frozen=True, slots=True)
class Trial:
    """One line of the table; numbers are nan where there is no plan or no such number.

    Attributes
    ----------
    seed, index, samples : int
        With the code's version and the machine's speed, all that decides the rest.
    planner, avoidance, status : str
        As in the plan.
    dimension, vehicles, obstacles, horizon : int
        Size of the scenario.
    bound : float
        Δ.
    problems : int
        What the referee finds wrong besides the risk.
    certified, certified_pair, certified_obstacle, certified_workspace : float
        The certificate, and its parts.
    certified_later : float
        Its part from step 1 on: the risk at step 0 is no plan's fault.
    own : float
        The planner's own sum over its chosen rows, steps 1 to T, vehicles of other sets left out.
    num_sets : int
        Sets planned apart from each other.
    hits, hits_pair, hits_obstacle, hits_workspace : int
        Flights with a collision, and by cause; -1 without a plan.
    overlap_joint, overlap_encounters, overlap_events : int
        See `Overlap`; -1 where not measured.
    plan_seconds, certify_seconds, fly_seconds : float
        Time taken.
    noise : str
        What was added of the world as it is measured, see `calibrating.noise`; empty for nothing.
    world_samples, world_hits : int
        Missions flown in that world without the referee, and those with a collision.
    """

    seed: int
    index: int
    samples: int
    planner: str
    avoidance: str
    status: str
    dimension: int
    vehicles: int
    obstacles: int
    horizon: int
    bound: float
    problems: int = 0
    certified: float = float("nan")
    certified_pair: float = float("nan")
    certified_obstacle: float = float("nan")
    certified_workspace: float = float("nan")
    certified_later: float = float("nan")
    own: float = float("nan")
    num_sets: int = 0
    hits: int = -1
    hits_pair: int = -1
    hits_obstacle: int = -1
    hits_workspace: int = -1
    overlap_joint: int = -1
    overlap_encounters: int = -1
    overlap_events: int = -1
    plan_seconds: float = float("nan")
    certify_seconds: float = float("nan")
    fly_seconds: float = float("nan")
    noise: str = ""
    world_samples: int = 0
    world_hits: int = -1

    @property
    def has_plan(self) -> bool:
        """Whether there was anything to certify."""
        return self.hits >= 0

    @property
    def rate(self) -> float:
        """Share of flights that collide."""
        return self.hits / self.samples

    @property
    def holds(self) -> bool:
        """Whether the certificate is within Δ."""
        return self.has_plan and self.problems == 0 and self.certified <= self.bound

    def as_row(self) -> dict[str, str]:
        """Return the line as text that reads back to the same numbers."""
        return {
            name: f"{value:.9g}" if isinstance(value, float) else str(value)
            for name, value in asdict(self).items()
        }


COLUMNS = tuple(field.name for field in fields(Trial))


def trial_of(row: Mapping[str, str]) -> Trial:
    """Return the trial that a line of the table stands for."""
    kinds = {"int": int, "float": float, "str": str}
    known = [f for f in fields(Trial) if f.name in row]
    return Trial(**{f.name: kinds[str(f.type)](row[f.name]) for f in known})


def run_trial(
    seed: int,
    index: int,
    samples: int,
    time_limit: float,
    *,
    noise: bool = False,
    by_processor: bool = False,
) -> Trial:
    """Draw a scenario and a planner, plan, certify and fly.

    Parameters
    ----------
    seed, index : int
        Decide everything but what the time limit cuts off.
    samples : int
        Flights.
    time_limit : float
        Seconds for planning.
    noise : bool
        Whether the world is as it is measured: currents, gusts, receivers, freighters, winds.
    by_processor : bool
        Whether seconds are the processor's, which other jobs do not stretch.

    Returns
    -------
    Trial
        Also where no plan was found.
    """
    rng = np.random.default_rng([seed, index])
    scenario = random_scenario(rng, f"calibration-{seed}-{index}")
    name, planner = random_planner(rng, scenario.num_vehicles)
    features = ""
    if noise:
        scenario, features = with_noise(np.random.default_rng([seed, index, 1]), scenario)
    if scenario.has_shared and not planner.decomposition.takes_shared:
        name, planner = "certified", parse_planner("certified")
    with clock(by_processor):
        result = plan(scenario, planner, rng=index, time_limit=time_limit)
    trial = Trial(
        seed=seed,
        index=index,
        samples=samples,
        planner=name,
        avoidance=scenario.avoidance,
        status=result.status.value,
        dimension=scenario.dimension,
        vehicles=scenario.num_vehicles,
        obstacles=len(scenario.obstacles),
        horizon=scenario.horizon,
        bound=scenario.risk_bound,
        plan_seconds=result.seconds["total"] - result.seconds["certificate"],
        certify_seconds=result.seconds["certificate"],
        noise=features,
    )
    if result.plan is None or result.certificate is None:
        return trial
    trial = _with_certificate(trial, result, result.certificate, planner)
    trial = _with_flights(trial, result.plan)
    if not noise:
        return trial
    missions = min(samples, _MISSIONS)
    found = world_collisions(result.plan, missions, seed=index)
    return replace(trial, world_samples=missions, world_hits=found)


def _with_certificate(
    trial: Trial, result: Result, certificate: Certificate, planner: Planner
) -> Trial:
    """Add what the referee and the planner say."""
    parts = {"pair": 0.0, "obstacle": 0.0, "workspace": 0.0}
    for row in certificate.ledger:
        parts[row.cause] += row.risk
    return replace(
        trial,
        problems=len(certificate.problems),
        certified=certificate.certified,
        certified_pair=parts["pair"],
        certified_obstacle=parts["obstacle"],
        certified_workspace=parts["workspace"],
        certified_later=sum(row.risk for row in certificate.ledger if row.step > 0),
        own=_own_bound(result) if isinstance(planner.policy, Ira) else float("nan"),
        num_sets=len(result.sets),
    )


def _own_bound(result: Result) -> float:
    """Return the risk that IRA counts for the plan: the cheapest solve of every set is flown."""
    used: dict[tuple[str, ...], tuple[float, float]] = {}
    for step in result.steps:
        if step.stage in {"sets", "centralized"}:
            best = used.get(step.vehicles, (float("inf"), 0.0))
            used[step.vehicles] = min(best, (step.cost, step.used), key=lambda pair: pair[0])
    return sum(risk for _, risk in used.values())


def _with_flights(trial: Trial, record: Plan) -> Trial:
    """Add what happens when the plan is flown."""
    begun = time.perf_counter()
    flown = simulate(record, trial.samples, rng=trial.index)
    trial = replace(
        trial,
        hits=flown.collisions,
        hits_pair=flown.pair_collisions,
        hits_obstacle=flown.obstacle_collisions,
        hits_workspace=flown.workspace_exits,
        fly_seconds=time.perf_counter() - begun,
    )
    if trial.certified < _OVERLAP_FROM:
        return trial
    # Flights of their own: the same ones would tie both measurements to one set of numbers.
    overlap = measure_overlap(record, trial.samples, trial.index + 1_000_000)
    return replace(
        trial,
        overlap_joint=overlap.joint,
        overlap_encounters=overlap.encounters,
        overlap_events=overlap.events,
    )
