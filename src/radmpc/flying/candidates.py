"""Another leg from measured states: whatever a planner returns is data, judged like any other."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from radmpc.arrays import Vector
from radmpc.errors import RadmpcError
from radmpc.flying.leg import Leg, left_of, leg_of
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.planners.presets import parse_planner
from radmpc.planning import plan
from radmpc.result import Result

__all__ = ["Candidate", "Planning", "candidate", "planning_with"]

Planning = Callable[[Scenario, "float | None"], "Result | Plan | None"]
"""From a scenario and the seconds there are (None: no limit) to a plan, or to none."""


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """What became of the search for another leg.

    Attributes
    ----------
    leg : Leg or None
        The leg, if there is one that keeps limits and goals.
    price : float or None
        Its certificate [-].
    reason : str
        Why there is none; empty where there is.
    """

    leg: Leg | None
    price: float | None
    reason: str


def planning_with(planner: str, seed: int) -> Planning:
    """Return how `radmpc.plan` makes candidates.

    Parameters
    ----------
    planner : str
        A preset's name.
    seed : int
        Of every plan.

    Raises
    ------
    ScenarioError
        If there is no such planner.
    """
    record = parse_planner(planner)

    def run(scenario: Scenario, seconds: float | None) -> Result:
        return plan(scenario, record, rng=seed, time_limit=seconds)

    return run


def candidate(
    planning: Planning,
    scenario: Scenario,
    passed: int,
    states: Sequence[Vector],
    grant: float,
    seconds: float | None,
    began: int,
) -> Candidate:
    """Return another leg from measured states, or why there is none; never raises for a planner.

    Parameters
    ----------
    planning : callable
        What plans.
    scenario : Scenario
        Of the leg in the air.
    passed : int
        Steps of it that have been flown.
    states : sequence of (n,) array
        Measured states.
    grant : float
        What the leg may risk [-].
    seconds : float or None
        What planning may take [s].
    began : int
        The mission's step at which the candidate would begin.
    """
    try:
        left = left_of(scenario, passed, states, grant)
        answer = planning(left, seconds)
    except Exception as error:
        return Candidate(None, None, f"planning failed: {type(error).__name__}: {_line(error)}")
    found = answer.record if isinstance(answer, Result) else answer
    if found is None or (isinstance(found, Plan) and not found.trajectories):
        return Candidate(None, None, "no plan was found from here")
    if not isinstance(found, Plan):
        return Candidate(None, None, f"planning returned {type(found).__name__}, no plan")
    return _judged(found, left, began)


def _judged(found: Plan, left: Scenario, began: int) -> Candidate:
    """Return the leg of a plan's controls, everything else of it told anew."""
    by_name = {path.name: path.controls for path in found.trajectories}
    try:
        controls = [by_name[vehicle.name] for vehicle in left.vehicles]
        leg = leg_of(left, controls, began)
        price, problems = leg.price, leg.problems
    except KeyError as error:
        return Candidate(None, None, f"the plan lacks vehicle {error}")
    except RadmpcError as error:
        return Candidate(None, None, f"the plan cannot be flown: {_line(error)}")
    if problems:
        return Candidate(None, price, f"the plan does not hold: {problems[0]}")
    if not np.isfinite(price):
        return Candidate(None, None, "the plan has no certificate")
    return Candidate(leg, price, "")


def _line(error: Exception) -> str:
    """Return the first line of what an error says."""
    return next(iter(str(error).splitlines()), "")
