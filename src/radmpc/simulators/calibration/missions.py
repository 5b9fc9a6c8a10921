"""A plan flown many times as it is, and how often that goes wrong."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.special import betaincinv

from radmpc.arguments import check_integer
from radmpc.arrays import Tensor
from radmpc.flying.flight import Flight, fly
from radmpc.flying.knowing import expected_start, moved
from radmpc.flying.mission import Mission
from radmpc.flying.model import Backend
from radmpc.flying.sensing.measurements import Sensing
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass

__all__ = ["Making", "Rate", "controls_of_vehicle", "flown", "rate_of", "states_of_vehicle"]

Making = Callable[[Scenario, np.random.Generator], Backend]
"""Makes what a scenario is flown with, from a source of its noise."""


@dataclass(frozen=True, slots=True)
class Rate:
    """How often missions collide.

    Attributes
    ----------
    missions, collided, doubted : int
        How many were flown, how many of them hit anything, and in how many disturbances spoke
        against the model, by the alarms of missions.
    low, high : float
        Interval of Clopper and Pearson for the probability of a collision, at 95 % [-].
    """

    missions: int
    collided: int
    doubted: int
    low: float
    high: float

    @property
    def rate(self) -> float:
        """Share of missions that hit anything [-]."""
        return self.collided / self.missions


def flown(
    plan: Plan,
    making: Making,
    missions: int,
    seed: int,
    progress: Callable[[int], None] | None = None,
) -> tuple[Flight, ...]:
    """Fly a plan as it is, feedback and all, and never plan anew.

    Parameters
    ----------
    plan : Plan
        Within its risk bound.
    making : callable
        Makes the simulator.
    missions : int
        How many, at least 1.
    seed : int
        Of all noise, at least 0.
    progress : callable or None
        Is told how many have been flown, after each.

    Raises
    ------
    ArgumentError
        If a number is out of its range.
    RiskError
        If the plan's certificate exceeds its bound.
    ScenarioError
        If a mission, or the simulator, does not take the scenario.
    """
    check_integer(missions, "missions", 1)
    check_integer(seed, "seed", 0)
    backend = making(plan.scenario, np.random.default_rng(seed))
    made = []
    try:
        for number in range(missions):
            made.append(fly(Mission(plan, planner=None), backend))
            if progress is not None:
                progress(number + 1)
    finally:
        # Also on Ctrl-C: vehicles are commanded to hold.
        if callable(close := getattr(backend, "close", None)):
            close()
    return tuple(made)


def rate_of(scenario: Scenario, missions: Sequence[Flight]) -> Rate:
    """Return how often missions collide.

    Parameters
    ----------
    scenario : Scenario
        That was flown.
    missions : sequence of Flight
        At least one.
    """
    count, hits = len(missions), sum(flight.has_collided for flight in missions)
    doubted = sum(_is_doubted(scenario, flight) for flight in missions)
    low = 0.0 if hits == 0 else float(betaincinv(hits, count - hits + 1, 0.025))
    high = 1.0 if hits == count else float(betaincinv(hits + 1, count - hits, 0.975))
    return Rate(count, hits, doubted, low, high)


def _is_doubted(scenario: Scenario, flight: Flight) -> bool:
    """Whether its disturbances are unlikely by the scenario's noise, whatever is risked."""
    sensing = Sensing.of(scenario)
    expected = [expected_start(v) for v in scenario.vehicles]
    for step, (states, tick) in enumerate(zip(flight.states, flight.ticks, strict=True)):
        known, alarms = sensing.look(step, expected, states, is_certain=True)
        if alarms:
            return True
        if tick.segments:
            pairs = zip(scenario.vehicles, known, tick.controls, strict=True)
            expected = [moved(v, x, u) for v, x, u in pairs]
    return False


def states_of_vehicle(missions: Sequence[Flight], number: int) -> Tensor:
    """Return where a vehicle was, (M, T+1, n).

    Parameters
    ----------
    missions : sequence of Flight
        Of one plan.
    number : int
        The vehicle's place in the scenario.
    """
    return np.array([[states[number] for states in flight.states] for flight in missions])


def controls_of_vehicle(missions: Sequence[Flight], number: int) -> Tensor:
    """Return what a vehicle was told, (M, T, m).

    Parameters
    ----------
    missions : sequence of Flight
        Of one plan.
    number : int
        The vehicle's place in the scenario.
    """
    return np.array(
        [[tick.controls[number] for tick in flight.ticks if tick.segments] for flight in missions]
    )
