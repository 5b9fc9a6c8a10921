"""radmpc's own planners, as reference rows: the front door, certificate included in the seconds."""

from __future__ import annotations

from dataclasses import replace

from peers.protocol import Answer
from radmpc.model.scenario import Scenario
from radmpc.planners import Planner
from radmpc.planners.presets import parse_planner
from radmpc.planning import plan
from radmpc.solvers.branch.branch import Branch

PACKAGES = ("radmpc", "highspy")


def certified(scenario: Scenario, seconds: float, gap: float, seed: int) -> Answer:
    """Plan with the default."""
    return _plan(scenario, parse_planner("certified"), seconds, gap, seed)


def multi_vehicle(scenario: Scenario, seconds: float, gap: float, seed: int) -> Answer:
    """Plan with the paper's Algorithm 1."""
    return _plan(scenario, parse_planner("multi-vehicle"), seconds, gap, seed)


def uniform(scenario: Scenario, seconds: float, gap: float, seed: int) -> Answer:
    """Plan at uniform risk, the allocation of the peers, by branching instead of by big M.

    Not to the digit: radmpc drops avoidances that nobody can come near before it divides Δ.
    """
    planner = replace(parse_planner("uniform"), solver=Branch())
    return _plan(scenario, planner, seconds, gap, seed)


def _plan(scenario: Scenario, planner: Planner, seconds: float, gap: float, seed: int) -> Answer:
    """Plan, and keep the controls alone: the judge starts from them as from any other's."""
    result = plan(scenario, replace(planner, gap=gap), rng=seed, time_limit=seconds)
    if result.plan is None or not result.plan.trajectories:
        return Answer(result.status.value, note=result.explanation or "")
    controls = tuple(t.controls for t in result.plan.trajectories)
    return Answer(result.status.value, controls)
