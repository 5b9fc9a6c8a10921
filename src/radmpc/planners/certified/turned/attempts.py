"""What attempts at a first plan begin with: straight paths, sides, paces, drawn times."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from radmpc.arrays import Matrix
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.turned.attempt import Attempt, Begin
from radmpc.planners.certified.turned.paths import arched, timed_anyhow
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.certified.turned.turning import Turning
from radmpc.records import replace
from radmpc.solvers.solution import Limits

__all__ = ["tried"]

_SIDES = 2
"""Beginnings that are turned where nothing stands in the way [-]."""

_WAITING = 4
"""Vehicles up to which orders of waiting are tried [-]: each is first once."""

_DEAR = 2.0
"""Multiple of what vehicles take alone above which it is [-]."""

_BEFORE_DRAWN = 3.0
"""What an attempt may miss to be turned before times are drawn [sums of radii]: six vehicles that
change sides through a window miss 2.8 and have a plan then, and none without."""

_RISKING = 5
"""Vehicles from which on paths with less clearance are taken to risk too much, where a proof
follows [-]: of 15 draws each of `paper(2)` to `(4)` four to six are certified, two of `paper(6)`,
none of `paper(8)`, one of ten of `fleet(16)`."""


def tried(begin: Begin, rng: np.random.Generator, limits: Limits) -> FleetIncumbent:
    """Return the plan of the first attempt that leads to one, or the cheapest from several starts.

    Parameters
    ----------
    begin : Begin
        What attempts begin with.
    rng : Generator
        Draws times, sides and joint routes.
    limits : Limits
        When to stop.

    Returns
    -------
    FleetIncumbent
        A certified plan; none where no attempt leads to one.
    """
    hazards = begin.task.hazards
    best, least, found, is_known = None, np.inf, FleetIncumbent(), False
    # Every side is turned that may lead to the cheapest plan, and visits at better steps.
    is_few = hazards.count <= TUNING.few and not (begin.routes or begin.is_any)
    num_sides = _SIDES if begin.to_choose is not None or is_few else 1
    beginnings = _attempts(begin, rng, limits)
    for number, begun in enumerate(beginnings, start=1):
        is_worth_it = least <= _BEFORE_DRAWN * float(hazards.radii.sum())
        if begun.is_drawn and best is not None and is_worth_it:
            found, best = best.run(), None
            if found.controls or limits.reached:
                return found
        attempt = replace(begun, rounds=0) if begin.is_quick else begun
        missed, other, was_turned = _turned(begin, attempt, limits)
        # Pairs that meet head-on miss alike, too, but far more.
        is_near = missed <= TUNING.most_missed * float(hazards.radii.sum())
        is_alike = is_near and abs(missed - least) <= TUNING.alike * least < np.inf
        if not (other.controls or is_known or was_turned) and is_alike:
            # What attempts miss alike, at a start or a goal, no other attempt will keep.
            other, is_known = attempt.run(), True
        found = min(found, other, key=lambda one: one.cost)
        if missed < least:
            # Turned again from where that ended, a large fleet takes seconds and comes no further.
            is_spent = was_turned and hazards.count > TUNING.few
            best, least = None if is_spent else attempt, missed
        # Asked before the next attempt, which takes time to prepare.
        if limits.reached or (found.controls and number >= num_sides):
            break
        # Twenty vehicles' take 100 MB, and hardly any attempt is turned again.
        attempt.turning.successive.programs.forget_all_but(())
    if found.controls or best is None:
        return found
    return best.run()


def _turned(begin: Begin, attempt: Attempt, limits: Limits) -> tuple[float, FleetIncumbent, bool]:
    """Keep vehicles apart at full clearance or less, then turn half-spaces.

    Return what is missed, the plan if any, and whether half-spaces were turned at a price at all.
    """
    radii, successive = begin.task.hazards.radii, attempt.turning.successive
    begun = successive.paths.state()
    clearances, was_turned = [begin.clearance, TUNING.narrower * begin.clearance], False
    is_maze = bool(begin.routes) and begin.task.hazards.count > TUNING.few
    if is_maze:
        # What few miss costs less risk than all coming nearer each other.
        clearances = [begin.clearance]
    elif begin.routes and not begin.is_quick:
        # Among obstacles full clearance forces wide bends, and turning shares risk better; in large
        # fleets it takes seconds, and paths with full clearance are nearly certified before it.
        clearances.reverse()
    allowed = TUNING.nearly * max(float(radii.mean()), TUNING.nearly_each * float(radii.sum()))
    for kept in clearances:
        if attempt.is_placed:
            successive.restore(begun)
        is_above = begin.is_followed and kept < begin.clearance
        attempt.turning.is_above = is_above and begin.task.hazards.count >= _RISKING
        is_apart = attempt.keep_apart(kept, limits)
        missed = float(successive.missed.sum())
        is_hopeful = is_apart or missed <= allowed
        is_near = missed <= TUNING.most_missed * float(radii.sum())
        if is_maze and is_near:
            is_hopeful = attempt.replan_jointly(kept, limits)
        if is_hopeful:
            found, was_turned = attempt.run(), True
            if found.controls:
                return missed, found, True
        if not is_near:
            break
    return missed, FleetIncumbent(), was_turned


def _attempts(begin: Begin, rng: np.random.Generator, limits: Limits) -> Iterator[Attempt]:
    """Begin with paths alone, or with paths around obstacles: at even speed, paced, drawn."""
    routes, hazards = begin.routes, begin.task.hazards
    meeting = [i for members in begin.sets if len(members) > 1 for i in members]
    usually = {i: route.places for i, route in routes.items()}
    yield from _toured(begin, limits)
    if routes and begin.is_compared and len(routes) <= TUNING.weighed:
        yield Attempt(_cheaper_begun(begin, usually, limits), TUNING.few_sweeps)
    elif routes:
        yield Attempt(begin.referring(usually), TUNING.quick_sweeps)
    else:
        for turning in _sides(begin, limits):
            yield Attempt(turning, TUNING.max_sweeps)
    from radmpc.planners.certified.turned.placing import placed_apart, placed_in_space  # noqa: PLC0415 - few need it

    yield from placed_apart(begin, rng, limits)
    if routes:
        yield Attempt(begin.referring(usually), TUNING.max_sweeps)
    # There is room in space: mostly even speeds will do, at less cost.
    yield from placed_in_space(begin, rng, limits)
    for _ in range(TUNING.attempts):
        drawn = {i: timed_anyhow(hazards, i, one.corners, rng) for i, one in routes.items()}
        for i in meeting:
            if i not in routes:
                path = arched(hazards, i, TUNING.most_arc * rng.uniform(-1.0, 1.0))
                drawn[i] = timed_anyhow(hazards, i, path, rng)
        yield Attempt(begin.referring(drawn), TUNING.max_sweeps, is_drawn=True)


def _toured(begin: Begin, limits: Limits) -> Iterator[Attempt]:
    """Begin with vehicles planned one after the other; then with visits at better steps."""
    if begin.to_choose is None:
        return
    from radmpc.planners.certified.turned.touring.touring import Touring  # noqa: PLC0415 - few visit anything

    hazards = begin.task.hazards
    touring = Touring(hazards, begin.to_choose, limits, begin.clearance)
    if not touring.run(begin.alone.paths, {i: one.corners for i, one in begin.routes.items()}):
        return
    is_apart = touring.successive.missed.sum() <= TUNING.nearly * hazards.radii.mean()
    sweeps = 0 if is_apart else TUNING.quick_sweeps
    # Steps of visits gain more than turns, which take long in large fleets.
    rounds = TUNING.first_rounds if hazards.count <= TUNING.few else 0
    yield Attempt(_begun(begin, touring.successive), sweeps, TUNING.paced_penalty, rounds=rounds)
    if is_apart:
        touring.improve()
        yield Attempt(_begun(begin, touring.successive), 0, TUNING.paced_penalty)


def _begun(begin: Begin, successive: SuccessiveLp) -> Turning:
    """Begin with paths, and the steps at which these make visits."""
    task = replace(begin.task, hazards=successive.hazards)
    turning = Turning(task, FleetIncumbent(), begin.sets, begin.price)
    turning.successive.begin(successive.paths.controls)
    turning.successive.missed[:] = successive.missed
    return turning


def _sides(begin: Begin, limits: Limits) -> Iterator[Turning]:
    """Begin with paths alone, then with all keeping right if that is cheaper to keep apart."""
    yield _straight_or_waiting(begin, limits)
    if begin.task.hazards.count > TUNING.few:
        return
    meeting = [i for members in begin.sets if len(members) > 1 for i in members]
    tried = [
        begin.referring({i: arched(begin.task.hazards, i, offset) for i in meeting})
        for offset in TUNING.arches
    ]
    yield _cheapest_apart(begin, tried, begin.clearance, TUNING.max_sweeps, limits)


def _straight_or_waiting(begin: Begin, limits: Limits) -> Turning:
    """Begin on straight lines, or where one waits for the other if that is much cheaper."""
    hazards, straight = begin.task.hazards, begin.referring({})
    if hazards.count > _WAITING or not 0 < hazards.shapes.count < TUNING.many_obstacles:
        return straight
    successive, alone = straight.successive, begin.alone.paths
    is_apart = successive.keep_apart(begin.clearance, TUNING.max_sweeps, limits, is_shared=True)
    if is_apart and successive.paths.cost() <= _DEAR * alone.cost():
        return straight
    from radmpc.planners.certified.turned.narrow.in_turn import paths_in_turn  # noqa: PLC0415 - few need it

    waiting = [
        begin.referring(places) for places in paths_in_turn(begin.task, alone.means, begin.price)
    ]
    if not waiting:
        # As far as it came, or from its beginning if that led nowhere.
        return straight if is_apart else begin.referring({})
    tried = [straight, *waiting]
    return _cheapest_apart(begin, tried, begin.clearance, TUNING.max_sweeps, limits)


def _cheaper_begun(begin: Begin, places: Mapping[int, Matrix], limits: Limits) -> Turning:
    """Begin on routes around obstacles, or on straight lines if these come apart at less cost.

    Half-spaces that give way push a path through gaps that no route alone led through; mostly it
    gets stuck in the first sweeps.
    """
    tried = [begin.referring(places), begin.referring({})]
    clearance = TUNING.narrower * begin.clearance
    return _cheapest_apart(begin, tried, clearance, TUNING.few_sweeps, limits)


def _cheapest_apart(
    begin: Begin, tried: Sequence[Turning], clearance: float, sweeps: int, limits: Limits
) -> Turning:
    """Keep vehicles apart from several beginnings; return that of the least cost."""
    nearly = TUNING.nearly * float(begin.task.hazards.radii.mean())

    def rank(turning: Turning) -> tuple[bool, float]:
        successive = turning.successive
        is_quick = sweeps < TUNING.max_sweeps
        successive.keep_apart(clearance, sweeps, limits, is_quick=is_quick)
        return float(successive.missed.sum()) > nearly, successive.paths.cost()

    return min(tried, key=rank)
