"""A first plan of a fleet by successive linear programs, before anything is searched."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from radmpc.arrays import Matrix
from radmpc.gaussian import CONVEX_RISK, clearance_for
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.paths import Paths, timed
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.certified.turned.turning import Task, Turning
from radmpc.planners.components import components
from radmpc.program.hazards import Hazards
from radmpc.solvers.solution import Limits

__all__ = ["first_plan"]


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
    hazards = task.hazards
    alone = SuccessiveLp(hazards, task.limits)
    if not alone.begin_alone():
        return FleetIncumbent()
    share = TUNING.first_share * task.risk_bound / hazards.count
    clearance = float(clearance_for(min(share, CONVEX_RISK)))
    stopped = _stopped(hazards, alone.paths)
    sets = _meeting(hazards, alone.paths, clearance)
    largest = max(len(members) for members in sets)
    is_crowded = largest >= max(TUNING.many, TUNING.crowd * hazards.count)
    if not is_crowded and (not stopped.size or hazards.count > TUNING.few):
        return FleetIncumbent()
    # Risk counts for more than effort at first: a falling price stays near what is certified.
    price *= TUNING.first_dear * alone.paths.cost() / task.risk_bound
    ways: dict[int, Matrix] = {}
    if stopped.size:
        from radmpc.planners.certified.turned.detours import detours  # noqa: PLC0415 - loads graphs

        ways = detours(hazards, stopped, clearance)
    best, least = None, np.inf
    nearly = TUNING.nearly * float(hazards.radii.mean())
    limits = task.limits.within(
        min(TUNING.first_seconds, TUNING.first_time_share * task.limits.seconds_left)
    )
    for attempt in _attempts(task, (alone.paths, ways), (sets, price), (rng, limits)):
        missed = np.inf
        for kept in (clearance, TUNING.narrower * clearance):
            is_apart = attempt.successive.keep_apart(kept, TUNING.max_sweeps, limits)
            missed = float(attempt.successive.missed.sum())
            if is_apart or missed <= nearly:
                found = attempt.run(TUNING.first_rounds)
                if found.controls:
                    return found
        if missed < least:
            best, least = attempt, missed
        if limits.reached:
            break
    return FleetIncumbent() if best is None else best.run(TUNING.first_rounds)


def _attempts(
    task: Task,
    begin: tuple[Paths, Mapping[int, Matrix]],
    planned: tuple[tuple[tuple[int, ...], ...], float],
    chance: tuple[np.random.Generator, Limits],
) -> Iterator[Turning]:
    """Begin with paths alone; where there are ways, with these all at once, in order, at random."""
    hazards = task.hazards
    (alone, ways), (sets, price), (rng, limits) = begin, planned, chance

    def referring(places: Mapping[int, Matrix]) -> Turning:
        turning = Turning(task, FleetIncumbent(), sets, price)
        turning.successive.begin(alone.controls)
        for i, path in places.items():
            turning.successive.refer(i, path)
        return turning

    yield referring({i: timed(way, hazards.horizon, 0.0, 1.0) for i, way in ways.items()})
    if not ways:
        return
    if hazards.count > 1:
        from radmpc.planners.certified.turned.prioritized import prioritized  # noqa: PLC0415 - few need it

        in_order = prioritized(hazards, lambda: limits.reached)
        if in_order:
            yield referring(in_order)
    for _ in range(TUNING.attempts):
        yield referring({i: _timed_anyhow(hazards, i, way, rng) for i, way in ways.items()})


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
