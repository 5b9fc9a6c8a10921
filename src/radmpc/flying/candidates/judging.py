"""Another leg from measured states: whatever a planner returns is data, judged like any other."""

from __future__ import annotations

import pkgutil
from collections.abc import Callable, Sequence
from dataclasses import replace
from importlib import import_module

import numpy as np

from radmpc import planners
from radmpc.arguments import check_callable
from radmpc.arrays import Matrix, Vector
from radmpc.errors import RadmpcError
from radmpc.flying.leg import Leg, leg_of
from radmpc.model.plan import Plan, Status
from radmpc.model.scenario import Scenario
from radmpc.planners.planner import Planner
from radmpc.planners.presets import parse_planner
from radmpc.planning import unjudged_plan
from radmpc.records import dataclass
from radmpc.referee.conditional.scales import Scale
from radmpc.result import Result

__all__ = [
    "NOT_IN_TIME",
    "Candidate",
    "Order",
    "Planning",
    "answered",
    "failed",
    "judged",
    "leg_judged",
    "load_planning",
    "planning_with",
]

Planning = Callable[[Scenario, "float | None"], "Result | Plan | None"]
"""From a scenario and the seconds there are (None: no limit) to a plan, or to none."""


NOT_IN_TIME = "no plan was found within the deadline"
"""Why there is no candidate where a deadline ended the search: there may be one."""

_IMPORTED_LATE = (
    "radmpc.planners.certified",
    "radmpc.planners.certified.infeasible",
    "radmpc.planners.certified.phases",
    "radmpc.planners.certified.turned",
    "radmpc.planners.certified.turned.narrow",
    "radmpc.solvers.branch",
)
"""Packages of which planning imports most when it first needs it: 0.2 s where all is."""


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """The outcome of the search for another leg.

    Attributes
    ----------
    leg : Leg or None
        The leg, if there is one that keeps limits and goals.
    price : float or None
        Its certificate, given what was measured [-].
    reason : str
        Why there is none; empty where there is.
    next_step : float or None
        What of the price is run until the next step [-].
    """

    leg: Leg | None
    price: float | None
    reason: str
    next_step: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Order:
    """What a planner is asked to do.

    Attributes
    ----------
    left : Scenario
        The steps that are left, under the bound that is allowed.
    asked : Scenario
        The same, with goals as wide as limits make them.
    began : int
        The mission's step at which it begins.
    scale : Scale or None
        What both take for known of the factor of covariances; None where they are known.
    is_timed : bool
        Whether planning has a deadline.
    """

    left: Scenario
    asked: Scenario
    began: int
    scale: Scale | None = None
    is_timed: bool = False


@dataclass(frozen=True, slots=True)
class _Preset:
    """How `radmpc.plan` makes candidates; goes to other processes."""

    planner: Planner
    seed: int

    def __call__(self, scenario: Scenario, seconds: float | None) -> Plan:
        """Plan; what comes of it is judged from what is measured."""
        return unjudged_plan(scenario, self.planner, seed=self.seed, time_limit=seconds)


def planning_with(planner: str | Planning | None, seed: int) -> Planning | None:
    """Return what makes candidates.

    Parameters
    ----------
    planner : str, callable or None
        The name of a preset of `radmpc.plan`, a planner, or None.
    seed : int
        Of every plan of a preset.

    Raises
    ------
    ArgumentTypeError
        If it is of another kind.
    ScenarioError
        If there is no such preset.
    """
    if isinstance(planner, str):
        return _Preset(_without_bound(parse_planner(planner)), seed)
    check_callable(planner, "planner")
    return planner


def _without_bound(planner: Planner) -> Planner:
    """Return a planner that proves no bound on any certified plan: it is not used under way."""
    if str(planner.decomposition) != "certified":
        return planner
    return replace(planner, decomposition=planners.Certified(0.0))


def load_planning(planning: Planning | None) -> None:
    """Import what a preset's plans may need: within a tick there is no time for that.

    Parameters
    ----------
    planning : callable or None
        What plans; anything but a preset imports what it likes.
    """
    if not isinstance(planning, _Preset):
        return
    for name in _IMPORTED_LATE:
        package = import_module(name)
        for module in pkgutil.iter_modules(package.__path__, f"{name}."):
            import_module(module.name)


def answered(
    planning: Planning,
    order: Order,
    seconds: float | None,
    states: Sequence[Vector],
) -> Candidate:
    """Return a planner's answer to an order; errors of the planner are part of it.

    Parameters
    ----------
    planning : callable
        What plans.
    order : Order
        From where, within what.
    seconds : float or None
        What planning may take [s].
    states : sequence of (n,) array
        Measured states.
    """
    try:
        answer = planning(order.asked, seconds)
    except Exception as error:
        return failed(error)
    return judged(answer, order, order.began, states, order.scale)


def failed(error: BaseException) -> Candidate:
    """Return the candidate of a planner that broke."""
    return Candidate(None, None, f"planning failed: {type(error).__name__}: {_line(error)}")


def judged(
    answer: object, order: Order, step: int, states: Sequence[Vector], scale: Scale | None = None
) -> Candidate:
    """Return the leg of a planner's answer, with everything but its controls recomputed.

    Parameters
    ----------
    answer : object
        Whatever it returned.
    order : Order
        What was asked of it.
    step : int
        Of the mission, at which states were measured: that of the order or a later one.
    states : sequence of (n,) array
        Measured states.
    scale : Scale or None
        What is known of the factor of covariances by then.
    """
    found = answer.record if isinstance(answer, Result) else answer
    if found is None or (isinstance(found, Plan) and not found.trajectories):
        return Candidate(None, None, _why_none(found, order))
    if not isinstance(found, Plan):
        return Candidate(None, None, f"planning returned {type(found).__name__}, no plan")
    by_name = {path.name: path.controls for path in found.trajectories}
    try:
        controls = [by_name[vehicle.name] for vehicle in order.left.vehicles]
    except KeyError as error:
        return Candidate(None, None, f"the plan lacks vehicle {error}")
    return leg_judged(controls, order, step, states, scale)


def _why_none(found: Plan | None, order: Order) -> str:
    """Return why a planner answers with no plan: a search that was cut short rules nothing out."""
    if found is None or found.status is not Status.LIMIT:
        return "no plan was found from here"
    return NOT_IN_TIME if order.is_timed else "no plan was found within the planner's own limit"


def leg_judged(
    controls: Sequence[Matrix],
    order: Order,
    step: int,
    states: Sequence[Vector],
    scale: Scale | None = None,
) -> Candidate:
    """Return the leg that flies given controls, or why there is none.

    Parameters
    ----------
    controls : sequence of (T, m) array
        Of all vehicles.
    order, step, states, scale
        As in `judged`.
    """
    try:
        leg = leg_of(order.left, controls, order.began, order.scale)
        value, problems = leg.value(step, leg.begun(states), scale), leg.problems(order.asked)
    except RadmpcError as error:
        return Candidate(None, None, f"the plan cannot be flown: {_line(error)}")
    if problems:
        return Candidate(None, value.total, f"the plan does not hold: {problems[0]}")
    if not np.isfinite(value.total):
        return Candidate(None, None, "the plan has no certificate")
    return Candidate(leg, value.total, "", value.next_step)


def _line(error: BaseException) -> str:
    """Return the first line of what an error says."""
    return next(iter(str(error).splitlines()), "")
