"""A first plan of a fleet by successive linear programs, before anything is searched."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from radmpc.arrays import Matrix
from radmpc.gaussian import CONVEX_RISK
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.turned.attempts import SIDES, Begin, attempts
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.paths import Paths
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.certified.turned.turning import Task, Turning
from radmpc.planners.components import components
from radmpc.program.condensed import CondensedModel
from radmpc.program.hazards import Hazards
from radmpc.solvers.solution import Limits

__all__ = ["first_plan"]


def first_plan(
    task: Task,
    price: float,
    rng: np.random.Generator,
    to_choose: tuple[CondensedModel, ...] | None = None,
) -> FleetIncumbent:
    """Plan a fleet one vehicle after the other, then all at a price of risk.

    Vehicles begin with what they do alone; those that an obstacle stops begin with the shortest way
    around, at times that differ from attempt to attempt. Where nothing stops them and few get in
    each other's way, searching their sets is as quick, and nothing is done.

    Parameters
    ----------
    task : Task
        What is asked.
    price : float
        First guess of what Δ is worth, as a share of what plans cost without hazards [-].
    rng : Generator
        Draws the times.
    to_choose : tuple of CondensedModel or None
        The vehicles with visits at any step of their windows; None where no step is to be chosen.

    Returns
    -------
    FleetIncumbent
        A certified plan; none where none was found.
    """
    hazards, task = task.hazards, _told_once(task)
    alone = SuccessiveLp(hazards, task.limits)
    if not alone.begin_alone():
        return FleetIncumbent()
    share = TUNING.first_share * task.risk_bound / hazards.count
    clearance = float(hazards.tail.clearance_for(min(share, CONVEX_RISK)))
    stopped = _stopped(hazards, alone.paths)
    sets = _meeting(hazards, alone.paths, clearance)
    largest = max(len(members) for members in sets)
    is_crowded = largest >= max(TUNING.many, TUNING.crowd * hazards.count)
    is_easy = not is_crowded and (not stopped.size or hazards.count > TUNING.few)
    if is_easy and (largest == 1 or hazards.count > TUNING.few):
        return FleetIncumbent()
    if is_easy and _gives_way(task, alone.paths, clearance):
        return FleetIncumbent()
    # Risk counts for more than effort at first: a falling price stays near what is certified.
    price *= TUNING.first_dear * alone.paths.cost() / task.risk_bound
    ways: dict[int, Matrix] = {}
    if stopped.size:
        from radmpc.planners.certified.turned.detours import detours  # noqa: PLC0415 - loads graphs

        ways = detours(hazards, stopped, clearance)
    time_share = TUNING.easy_share if is_easy else TUNING.first_time_share
    seconds = min(TUNING.first_seconds, time_share * task.limits.seconds_left)
    begin = Begin(task, alone.paths, ways, sets, price, clearance, to_choose)
    return _tried(begin, rng, task.limits.within(seconds))


def _tried(begin: Begin, rng: np.random.Generator, limits: Limits) -> FleetIncumbent:
    """Return the plan of the first attempt that leads to one, or the cheapest of several sides."""
    hazards = begin.task.hazards
    best, least, found, is_known = None, np.inf, FleetIncumbent(), False
    # Where nothing stands in the way, every side is turned that may lead to the cheapest plan.
    num_sides = 1 if begin.ways or hazards.count > TUNING.few else SIDES
    beginnings = attempts(begin, rng, limits)
    for number, (attempt, penalty, sweeps) in enumerate(beginnings, start=1):
        missed, other = _turned(begin, attempt, limits, (penalty, sweeps))
        if not other.controls and not is_known and _is_as_little(missed, least):
            # What attempts miss alike, at a start or a goal, no other attempt will keep.
            other, is_known = attempt.run(TUNING.first_rounds), True
        found = min(found, other, key=lambda one: one.cost)
        if missed < least:
            best, least = attempt, missed
        # Asked before the next attempt, which takes time to prepare.
        if limits.reached or (found.controls and number >= num_sides):
            break
    if found.controls or best is None:
        return found
    return best.run(TUNING.first_rounds)


def _turned(
    begin: Begin, attempt: Turning, limits: Limits, pace: tuple[float, int]
) -> tuple[float, FleetIncumbent]:
    """Keep vehicles apart, with all room or less, then turn half-spaces; return what is missed."""
    radii, successive = begin.task.hazards.radii, attempt.successive
    penalty, sweeps = pace
    begun = successive.paths.state()
    for kept in (begin.clearance, TUNING.narrower * begin.clearance):
        if penalty == TUNING.paced_penalty:
            from radmpc.planners.certified.turned.narrow.at_pace import keep_places  # noqa: PLC0415 - few need it

            successive.restore(begun)
            is_apart = keep_places(successive, kept, TUNING.paced_sweeps, penalty, limits)
        else:
            is_apart = successive.keep_apart(kept, sweeps, limits, penalty)
        missed = float(successive.missed.sum())
        if is_apart or missed <= TUNING.nearly * float(radii.mean()):
            found = attempt.run(TUNING.first_rounds)
            if found.controls:
                return missed, found
        if missed > TUNING.most_missed * float(radii.sum()):
            break
    return missed, FleetIncumbent()


def _is_as_little(missed: float, least: float) -> bool:
    """Whether an attempt misses what the best one before it did."""
    return abs(missed - least) <= TUNING.alike * least < np.inf


def _told_once(task: Task) -> Task:
    """Return the same task that hands on a plan only if it is the cheapest so far."""
    costs = [np.inf]

    def found(incumbent: FleetIncumbent) -> None:
        if incumbent.cost < costs[-1]:
            costs.append(incumbent.cost)
            task.found(incumbent)

    return replace(task, found=found)


def _gives_way(task: Task, alone: Paths, clearance: float) -> bool:
    """Whether vehicles keep apart at once, planned one after the other from their paths alone."""
    probe = SuccessiveLp(task.hazards, task.limits)
    probe.begin(alone.controls)
    return probe.keep_apart(TUNING.narrower * clearance, TUNING.quick_sweeps)


def _stopped(hazards: Hazards, paths: Paths) -> np.ndarray:
    """Return the vehicles whose paths alone run into an obstacle, noise aside."""
    everyone = tuple(range(hazards.count))
    spaces = half_spaces(hazards, paths, everyone, Near(0.0, 0.0, is_refined=False))
    is_hit = (spaces.heights < spaces.offsets).any(axis=1) & (spaces.second < 0)
    return np.unique(spaces.first[is_hit])


def _meeting(hazards: Hazards, paths: Paths, clearance: float) -> tuple[tuple[int, ...], ...]:
    """Return who get in each other's way if alone, or keep a range, also through others."""
    everyone = tuple(range(hazards.count))
    spaces = half_spaces(hazards, paths, everyone, Near(clearance, 0.0, is_refined=False))
    meets = (spaces.clearances < clearance).any(axis=1) & (spaces.second >= 0)
    one, two = spaces.first[meets].tolist(), spaces.second[meets].tolist()
    kept = [(i, j) for i, j, _ in hazards.ranges]
    return components(hazards.count, [*zip(one, two, strict=True), *kept])
