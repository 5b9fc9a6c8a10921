"""A first plan of a fleet by successive linear programs, before anything is searched."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from radmpc.arrays import distinct
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.task import Task
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.near import Near, first_clearance
from radmpc.planners.certified.turned.paths import Paths, arched
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.components import components
from radmpc.program.hazards import Hazards
from radmpc.solvers.compiled_code import is_compiled

if TYPE_CHECKING:
    from radmpc.planners.certified.turned.narrow.route import Route
    from radmpc.planners.certified.turned.touring.visiting import GoodVisits

__all__ = ["first_plan"]

_COASTING = 1e-3
"""Share of full effort that plans are taken to cost at least [-]: at a price of 0 risk is free."""


def first_plan(
    task: Task,
    price: float,
    rng: np.random.Generator,
    visits: GoodVisits | None = None,
    *,
    is_needed: bool = False,
) -> FleetIncumbent:
    """Plan a fleet one vehicle after the other, then all at a price of risk.

    Vehicles begin with what they do alone; those that an obstacle stops begin with the shortest
    route around, at times that differ from attempt to attempt. Where nothing stops them and few get
    in each other's way, searching their sets is as quick, and nothing is done, unless steps of
    visits are to be chosen.

    Parameters
    ----------
    task : Task
        What is asked.
    price : float
        First guess of what Δ is worth, as a share of what plans cost without hazards [-].
    rng : Generator
        Draws the times.
    visits : GoodVisits or None
        At which steps the fleet makes visits to begin with; None where no step is to be chosen.
    is_needed : bool
        Whether a plan is asked for even where searching sets is as quick.

    Returns
    -------
    FleetIncumbent
        A certified plan; none where none was found.
    """
    hazards = task.hazards if visits is None else visits.hazards
    task = replace(_told_once(task), hazards=hazards)
    is_large = hazards.count > TUNING.few
    # A large fleet's first round may take all the time there is, and end without a plan.
    is_short = _is_short(task)
    if not (is_needed or is_short) and _is_easy_along_lines(task):
        return FleetIncumbent()
    alone = _paths_alone(task, visits)
    if alone is None or task.limits.reached:
        return FleetIncumbent()
    paths, stopped = alone.paths, _stopped(hazards, alone.paths)
    is_blocked = _are_many_stopped(hazards, stopped)
    is_maze = is_large and is_blocked
    clearance = _clearance(task, is_maze=is_maze)
    sets = _meeting(hazards, paths, clearance)
    largest = max(len(members) for members in sets)
    is_easy = not (_is_crowded(hazards, largest) or is_blocked)
    # Which steps visits are made at the search may not know for long.
    if is_easy and largest == 1 and (is_needed or visits is not None):
        found = _alone(task, paths)
        if found.controls:
            return found
    is_searched = is_easy and not (is_needed or is_short)
    if is_searched and (is_large or (largest == 1 and visits is None)):
        return FleetIncumbent()
    apart = _given_way(task, paths, clearance, sets) if is_searched else None
    if apart is not None and apart.controls:
        return apart
    from radmpc.planners.certified.turned import attempt, attempts  # noqa: PLC0415 - few need any

    price *= _dear(is_maze=is_maze) * _worth(hazards, paths) / task.risk_bound
    is_compared = not is_needed and _is_among_many(hazards, largest)
    sought = clearance, price if is_compared else None
    routes = _routes(task, alone, stopped, *sought, is_quick=is_needed)
    seconds = _seconds(task, is_aside=is_searched, is_maze=is_maze)
    to_choose = None if visits is None else visits.to_choose
    is_hard = bool(routes) and largest >= TUNING.many
    flags = (is_easy and is_needed, is_easy and is_short, is_hard, is_compared, is_needed)
    begin = attempt.Begin(task, alone, routes, sets, price, clearance, to_choose, *flags)
    return attempts.tried(begin, rng, task.limits.within(seconds))


def _is_easy_along_lines(task: Task) -> bool:
    """Whether few of a large fleet would get in each other's way, or be stopped, on straight lines.

    What vehicles do alone is nearly that, and takes a linear program each.
    """
    hazards = task.hazards
    if hazards.count <= TUNING.few or any(model.vehicle.via for model in hazards.models):
        return False
    paths = Paths(hazards)
    for i in range(hazards.count):
        paths.refer(i, arched(hazards, i, 0.0))
    if _are_many_stopped(hazards, _stopped(hazards, paths)):
        return False
    sets = _meeting(hazards, paths, _clearance(task, is_maze=False))
    return not _is_crowded(hazards, max(len(members) for members in sets))


def _are_many_stopped(hazards: Hazards, stopped: np.ndarray) -> bool:
    """Whether obstacles stop so many vehicles that their routes are planned first."""
    is_large = hazards.count > TUNING.few
    return stopped.size > (TUNING.stopped * hazards.count if is_large else 0)


def _is_crowded(hazards: Hazards, largest: int) -> bool:
    """Whether so many vehicles get in each other's way that these are planned first."""
    return largest >= max(TUNING.many, TUNING.crowd * hazards.count)


def _clearance(task: Task, *, is_maze: bool) -> float:
    """Return how far vehicles keep apart at first [standard deviations]."""
    share = TUNING.first_share_in_mazes if is_maze else TUNING.first_share
    return first_clearance(task.hazards, task.risk_bound, share)


def _dear(*, is_maze: bool) -> float:
    """Return how much dearer risk begins: a falling price stays near what is certified."""
    return TUNING.first_dear_in_mazes if is_maze else TUNING.first_dear


def _worth(hazards: Hazards, paths: Paths) -> float:
    """Return about what a plan costs: coasting and staying cost nothing until a conflict."""
    most = sum(m.vehicle.cost_weight * float(m.control_bounds.sum()) for m in hazards.models)
    return max(paths.cost(), _COASTING * most)


def _seconds(task: Task, *, is_aside: bool, is_maze: bool) -> float:
    """Return after how long no other attempt is begun [s]."""
    left = task.limits.seconds_left
    # Where many share narrow ways, the search among faces has led to no plan.
    most = np.inf if is_maze else TUNING.first_seconds
    share = TUNING.first_time_share * left
    if is_aside:
        share = max(TUNING.easy_share * left, min(TUNING.easy_seconds, TUNING.easy_most * left))
    return float(min(most, share))


def _is_among_many(hazards: Hazards, largest: int) -> bool:
    """Whether many obstacles are in the way rather than other vehicles.

    Where many vehicles meet, the order of passing matters more than what each would do alone.
    """
    return hazards.shapes.count >= TUNING.many_obstacles and largest < TUNING.many


def _routes(
    task: Task,
    alone: SuccessiveLp,
    stopped: np.ndarray,
    clearance: float,
    price: float | None,
    *,
    is_quick: bool,
) -> dict[int, Route]:
    """Return routes around obstacles of those that these stop."""
    if not stopped.size:
        return {}
    from radmpc.planners.certified.turned.narrow.cheapest import cheapest_routes  # noqa: PLC0415 - loads graphs

    return cheapest_routes(task, alone, stopped, clearance, price, is_quick=is_quick)


def _is_short(task: Task) -> bool:
    """Whether there is little time per vehicle of a large fleet."""
    each = TUNING.short_along if task.hazards.intervals else TUNING.short
    if not is_compiled():
        each = TUNING.short_by_highs
    count = task.hazards.count
    return count > TUNING.few and task.limits.seconds_left < each * count


def _paths_alone(task: Task, visits: GoodVisits | None) -> SuccessiveLp | None:
    """Return what vehicles do by themselves; None where one reaches no goal, or not in time."""
    successive = SuccessiveLp(task.hazards, task.limits)
    if visits is not None and visits.alone is not None:
        successive.begin(visits.alone)
    elif not successive.begin_alone():
        return None
    return successive


def _alone(task: Task, paths: Paths) -> FleetIncumbent:
    """Return what vehicles do by themselves, if that is certified: nothing is cheaper."""
    return _certified(task, paths, tuple((i,) for i in range(task.hazards.count)))


def _certified(task: Task, paths: Paths, sets: tuple[tuple[int, ...], ...]) -> FleetIncumbent:
    """Return paths as a plan, if the referee certifies them."""
    controls = tuple(paths.controls)
    certified = task.judge(controls).certified
    if certified > task.risk_bound:
        return FleetIncumbent()
    found = FleetIncumbent(controls, paths.cost(), sets, certified=certified)
    task.found(found)
    return found


def _told_once(task: Task) -> Task:
    """Return the same task that hands on a plan only if it is the cheapest so far."""
    costs = [np.inf]

    def found(incumbent: FleetIncumbent) -> None:
        if incumbent.cost < costs[-1]:
            costs.append(incumbent.cost)
            task.found(incumbent)

    return replace(task, found=found)


def _given_way(
    task: Task, alone: Paths, clearance: float, sets: tuple[tuple[int, ...], ...]
) -> FleetIncumbent | None:
    """Return the plan, if any, of vehicles that keep apart at once, planned one after the other.

    None where they do not. The search finds a cheaper plan soon, as a rule; it may take long.
    """
    probe = SuccessiveLp(task.hazards, task.limits)
    probe.begin(alone.controls)
    sweeps = TUNING.quick_sweeps
    if not probe.keep_apart(TUNING.narrower * clearance, sweeps, is_quick=True):
        return None
    found = _certified(task, probe.paths, sets)
    if not found.controls and probe.keep_apart(clearance, sweeps, is_quick=True):
        found = _certified(task, probe.paths, sets)
    return found


def _stopped(hazards: Hazards, paths: Paths) -> np.ndarray:
    """Return the vehicles whose paths alone run into an obstacle, noise aside."""
    everyone = tuple(range(hazards.count))
    spaces = half_spaces(hazards, paths, everyone, Near(0.0, 0.0, is_refined=False))
    is_hit = (spaces.heights < spaces.offsets).any(axis=1) & (spaces.second < 0)
    return distinct(spaces.first[is_hit])


def _meeting(hazards: Hazards, paths: Paths, clearance: float) -> tuple[tuple[int, ...], ...]:
    """Group vehicles in conflict if planned alone, or keeping a range, also through others."""
    everyone = tuple(range(hazards.count))
    spaces = half_spaces(hazards, paths, everyone, Near(clearance, 0.0, is_refined=False))
    meets = (spaces.clearances < clearance).any(axis=1) & (spaces.second >= 0)
    one, two = spaces.first[meets].tolist(), spaces.second[meets].tolist()
    kept = [(i, j) for i, j, _ in hazards.ranges]
    return components(hazards.count, [*zip(one, two, strict=True), *kept])
