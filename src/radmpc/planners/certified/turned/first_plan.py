"""A first plan of a fleet by successive linear programs, before anything is searched."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from radmpc.arrays import Matrix
from radmpc.gaussian import CONVEX_RISK, clearance_for
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.paths import Paths, evenly, timed
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.certified.turned.turning import Task, Turning
from radmpc.planners.components import components
from radmpc.program.hazards import Hazards
from radmpc.solvers.solution import Limits

if TYPE_CHECKING:
    from radmpc.planners.certified.turned.pacing import Pacing

__all__ = ["first_plan"]

_SIDES = 2
"""Beginnings that are turned where nothing stands in the way [-]."""

_TINY = 1e-9
"""Stands for a length of 0 where one divides by it [m]."""


def first_plan(task: Task, price: float, rng: np.random.Generator) -> FleetIncumbent:
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
    clearance = float(clearance_for(min(share, CONVEX_RISK)))
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
    begin = _Begin(task, alone.paths, ways, sets, price, clearance)
    return _tried(begin, rng, task.limits.within(seconds))


def _tried(begin: _Begin, rng: np.random.Generator, limits: Limits) -> FleetIncumbent:
    """Return the plan of the first attempt that leads to one, or the cheapest of several sides."""
    hazards = begin.task.hazards
    best, least, found = None, np.inf, FleetIncumbent()
    # Where nothing stands in the way, every side is turned that may lead to the cheapest plan.
    num_sides = 1 if begin.ways or hazards.count > TUNING.few else _SIDES
    attempts = _attempts(begin, rng, limits)
    for number, (attempt, penalty, sweeps) in enumerate(attempts, start=1):
        missed, other = _turned(begin, attempt, limits, (penalty, sweeps))
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
    begin: _Begin, attempt: Turning, limits: Limits, pace: tuple[float, int]
) -> tuple[float, FleetIncumbent]:
    """Keep vehicles apart, with all room or less, then turn half-spaces; return what is missed."""
    radii, successive = begin.task.hazards.radii, attempt.successive
    penalty, sweeps = pace
    for kept in (begin.clearance, TUNING.narrower * begin.clearance):
        is_apart = successive.keep_apart(kept, sweeps, limits, penalty)
        missed = float(successive.missed.sum())
        if is_apart or missed <= TUNING.nearly * float(radii.mean()):
            found = attempt.run(TUNING.first_rounds)
            if found.controls:
                return missed, found
        if missed > TUNING.hopeless * float(radii.sum()):
            break
    return missed, FleetIncumbent()


def _told_once(task: Task) -> Task:
    """Return the same task that tells a cost only if it is the least so far."""
    costs = [np.inf]

    def found(cost: float) -> None:
        if cost < costs[-1]:
            costs.append(cost)
            task.found(cost)

    return replace(task, found=found)


@dataclass(frozen=True, slots=True, eq=False)
class _Begin:
    """What attempts begin with.

    Attributes
    ----------
    task : Task
        What is asked.
    alone : Paths
        What vehicles do by themselves.
    ways : mapping of int to (p, d) array
        The shortest ways around obstacles of those that these stop [m].
    sets : tuple of tuple of int
        Who get in each other's way.
    price : float
        Shadow price of the risk, per unit of probability.
    clearance : float
        Standard deviations to keep [-].
    """

    task: Task
    alone: Paths
    ways: Mapping[int, Matrix]
    sets: tuple[tuple[int, ...], ...]
    price: float
    clearance: float

    def referring(self, places: Mapping[int, Matrix]) -> Turning:
        """Return half-spaces turned to given positions, for all others to their paths alone."""
        turning = Turning(self.task, FleetIncumbent(), self.sets, self.price)
        turning.successive.begin(self.alone.controls)
        for i, path in places.items():
            turning.successive.refer(i, path)
        return turning


def _attempts(
    begin: _Begin, rng: np.random.Generator, limits: Limits
) -> Iterator[tuple[Turning, float, int]]:
    """Begin with paths alone; where there are ways, with these at even speed, paced, at random.

    With each come the penalty of a meter missed in the first sweep, high for places that keep off
    each other already, and how many sweeps to try.
    """
    ways, hazards, usual = begin.ways, begin.task.hazards, TUNING.first_penalty
    meeting = [i for members in begin.sets if len(members) > 1 for i in members]
    usually = {i: timed(way, hazards.horizon, 0.0, 1.0) for i, way in ways.items()}
    if ways:
        yield begin.referring(usually), usual, TUNING.quick_sweeps
    else:
        for turning in _sides(begin, limits):
            yield turning, usual, TUNING.max_sweeps
    for turning, penalty in _kept_apart(begin, rng, limits):
        yield turning, penalty, TUNING.max_sweeps
    if ways:
        yield begin.referring(usually), usual, TUNING.max_sweeps
    for _ in range(TUNING.attempts):
        drawn = {i: _timed_anyhow(hazards, i, way, rng) for i, way in ways.items()}
        for i in meeting:
            if i not in ways:
                path = _bowed(hazards, i, TUNING.most_bow * rng.uniform(-1.0, 1.0))
                drawn[i] = _timed_anyhow(hazards, i, path, rng)
        yield begin.referring(drawn), usual, TUNING.max_sweeps


def _sides(begin: _Begin, limits: Limits) -> list[Turning]:
    """Begin with paths alone, or all bowed to the right, by what it costs to keep apart."""
    straight = begin.referring({})
    if begin.task.hazards.count > TUNING.few:
        return [straight]
    tried = [straight]
    meeting = [i for members in begin.sets if len(members) > 1 for i in members]
    for bow in TUNING.bows:
        tried.append(begin.referring({i: _bowed(begin.task.hazards, i, bow) for i in meeting}))
    nearly = TUNING.nearly * float(begin.task.hazards.radii.mean())

    def rank(turning: Turning) -> tuple[bool, float]:
        successive = turning.successive
        successive.keep_apart(begin.clearance, TUNING.max_sweeps, limits)
        return float(successive.missed.sum()) > nearly, successive.paths.cost()

    return sorted(tried, key=rank)[:_SIDES]


def _kept_apart(
    begin: _Begin, rng: np.random.Generator, limits: Limits
) -> Iterator[tuple[Turning, float]]:
    """Place vehicles clear of each other: on their ways, all together tick by tick, or in order."""
    from radmpc.planners.certified.turned.clear import Clear  # noqa: PLC0415 - few need it
    from radmpc.planners.certified.turned.knots import joint_ways  # noqa: PLC0415 - few need it
    from radmpc.planners.certified.turned.pacing import Pacing  # noqa: PLC0415 - few need it
    from radmpc.planners.certified.turned.prioritized import prioritized_ticks  # noqa: PLC0415 - few need it
    from radmpc.planners.certified.turned.ways import pulled_ways, shortest_ways  # noqa: PLC0415 - few need it

    hazards, clearance = begin.task.hazards, begin.clearance
    clear, pacing = Clear.of(hazards), None

    def is_stopped() -> bool:
        return limits.reached

    if clear is not None:
        pacing = Pacing(hazards, clear, clearance)
        pacing.offer(shortest_ways(hazards, clear, clearance))
        yield from _paced(begin, pacing, pacing.run(range(hazards.count), is_stopped), limits)
    if hazards.count == 1 or limits.reached:
        return
    placed, ticks = prioritized_ticks(hazards, is_stopped)
    if placed and clear is not None and pacing is not None:
        pacing.offer(pulled_ways(hazards, clear, placed, clearance))
        yield from _paced(begin, pacing, pacing.run(tuple(placed), is_stopped), limits)
    if clear is not None and pacing is not None and not limits.reached:
        joint = joint_ways(hazards, clear, rng.spawn(1)[0], is_stopped)
        if joint:
            pacing.offer(pulled_ways(hazards, clear, joint, clearance))
            places = {i: evenly(way, hazards.horizon) for i, way in joint.items()}
            yield from _paced(begin, pacing, pacing.mend(places, is_stopped), limits)
    if placed:
        in_order = {i: path[::ticks] for i, path in placed.items()}
        yield begin.referring(in_order), TUNING.first_penalty


def _paced(
    begin: _Begin, pacing: Pacing, places: Mapping[int, Matrix], limits: Limits
) -> Iterator[tuple[Turning, float]]:
    """Begin with places at a pace, if any; then with a finer one for those who missed it."""
    if not places:
        return
    turning = begin.referring(places)
    yield turning, TUNING.paced_penalty
    few = TUNING.misses * float(begin.task.hazards.radii.mean())
    missing = np.flatnonzero(turning.successive.missed > few).tolist()
    if missing and not limits.reached:
        finer = pacing.refine(missing, lambda: limits.reached)
        yield begin.referring(finer), TUNING.paced_penalty


def _gives_way(task: Task, alone: Paths, clearance: float) -> bool:
    """Whether vehicles keep apart at once, planned one after the other from their paths alone."""
    probe = SuccessiveLp(task.hazards, task.limits)
    probe.begin(alone.controls)
    return probe.keep_apart(TUNING.narrower * clearance, TUNING.quick_sweeps)


def _bowed(hazards: Hazards, i: int, bow: float) -> Matrix:
    """Return places at even speed on a bow to the right of the straight way, in largest radii."""
    model = hazards.models[i]
    start = model.drift_position[0]
    goal = 0.5 * (model.vehicle.goal.lower + model.vehicle.goal.upper)
    share = np.linspace(0.0, 1.0, hazards.horizon + 1)[:, None]
    right = np.zeros(start.size)
    right[:2] = (goal - start)[1], (start - goal)[0]
    right *= bow * float(hazards.radii.max()) / max(float(np.linalg.norm(right)), _TINY)
    return np.asarray(start + share * (goal - start) + np.sin(np.pi * share) * right)


def _timed_anyhow(hazards: Hazards, i: int, way: Matrix, rng: np.random.Generator) -> Matrix:
    """Return where a vehicle is at each step on a way that begins and ends at drawn times."""
    length = float(np.linalg.norm(np.diff(way, axis=0), axis=1).sum())
    least = min(length / (float(hazards.moves[i]) * hazards.horizon), TUNING.fastest)
    taken = least + (1.0 - least) * rng.random()
    first = (1.0 - taken) * rng.random()
    return timed(way, hazards.horizon, first, first + taken)


def _stopped(hazards: Hazards, paths: Paths) -> np.ndarray:
    """Return the vehicles whose paths alone run into an obstacle, noise aside."""
    everyone = tuple(range(hazards.count))
    spaces = half_spaces(hazards, paths, everyone, Near(0.0, 0.0, is_refined=False))
    is_hit = (spaces.heights < spaces.offsets).any(axis=1) & (spaces.second < 0)
    return np.unique(spaces.first[is_hit])


def _meeting(hazards: Hazards, paths: Paths, clearance: float) -> tuple[tuple[int, ...], ...]:
    """Return who get in each other's way if alone, directly or through others: a partition."""
    everyone = tuple(range(hazards.count))
    spaces = half_spaces(hazards, paths, everyone, Near(clearance, 0.0, is_refined=False))
    meets = (spaces.clearances < clearance).any(axis=1) & (spaces.second >= 0)
    one, two = spaces.first[meets].tolist(), spaces.second[meets].tolist()
    return components(hazards.count, zip(one, two, strict=True))
