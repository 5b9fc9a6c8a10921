"""Sets of a large fleet planned at a price of risk at once, here or on an executor.

Sets that cost much to keep apart are merged, so that one set hardly moves another's half-spaces:
each is planned as if all others stayed, and none waits for another. What it saves: half-spaces
are turned for all of them together, and their linear programs may be solved anywhere.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import closing

import numpy as np

from radmpc.arrays import Tensor
from radmpc.gaussian import Tail
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.linear.group_lp import GroupLp
from radmpc.planners.certified.turned.linear.group_plan import GroupPlan
from radmpc.planners.certified.turned.linear.margins import far_of, priced_margins
from radmpc.planners.certified.turned.linear.warm_programs import Group
from radmpc.planners.certified.turned.looks import unforeseen
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.normals.spaces import HalfSpaces
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.executing import in_order
from radmpc.program.condensed import CondensedModel
from radmpc.records import dataclass
from radmpc.solvers.solution import Limits

__all__ = ["share_risk_side_by_side"]

_AT_ONCE = 160
"""Vehicles whose half-spaces are turned together [-]: enough that NumPy's calls cost little beside
what they do (a round of `fleet(1000)` takes 0.2 s for them instead of 0.4), few enough to share."""


@dataclass(frozen=True, slots=True, eq=False)
class _Fleet:
    """As much of a fleet as the programs of some groups need; pickles.

    Attributes
    ----------
    models : mapping of int to CondensedModel
        The groups' vehicles, by their numbers.
    count, dimension : int
        Vehicles of the fleet, and coordinates.
    intervals : bool
        Whether collisions count between steps.
    """

    models: Mapping[int, CondensedModel]
    count: int
    dimension: int
    intervals: bool


@dataclass(frozen=True, slots=True, eq=False)
class _Places:
    """Where everybody is; pickles.

    Attributes
    ----------
    means : (N, T+1, d) array
        Mean positions [m].
    sagittas : (N, T, d) array
        How far each path hangs off its chords at mid-step [m].
    """

    means: Tensor
    sagittas: Tensor


@dataclass(frozen=True, slots=True, eq=False)
class _Part:
    """Some groups to be planned; pickles.

    Attributes
    ----------
    fleet : _Fleet
        Their vehicles.
    places : _Places
        Where everybody is.
    groups : tuple of tuple of int
        The groups.
    spaces : tuple of HalfSpaces
        Of each, turned to these paths.
    price, penalty : float
        Cost of a unit of probability, and of a meter that is missed.
    spacing : float
        Between the clearances around the latest at which risk is interpolated [-].
    tail : Tail
        Of what everything deviates by.
    """

    fleet: _Fleet
    places: _Places
    groups: tuple[Group, ...]
    spaces: tuple[HalfSpaces, ...]
    price: float
    penalty: float
    spacing: float
    tail: Tail


_Answers = list[tuple[GroupPlan | None, float]]
"""The plan of each group, if any, and what it took, see `ExchangeLp`."""


def share_risk_side_by_side(
    successive: SuccessiveLp,
    groups: Sequence[Group],
    costs: tuple[float, float],
    executor: Executor | None,
) -> float:
    """Plan groups at a price of risk, each as if all others stayed on their paths.

    Parameters
    ----------
    successive : SuccessiveLp
        With the latest paths, which change.
    groups : sequence of tuple of int
        Vehicles planned together.
    costs : tuple of float
        Cost of a unit of probability, and the spacing between the clearances around the latest at
        which risk is interpolated [-].
    executor : Executor or None
        Where linear programs are solved, with the same answers; None is here.

    Returns
    -------
    float
        The risk that the groups' half-spaces say they run [-].
    """
    hazards, paths, before = successive.hazards, successive.paths, successive.paths.state()
    risks: dict[Group, float] = {}
    plans: dict[Group, GroupPlan] = {}
    parts: list[_Part] = []
    found = _answers(successive, groups, costs, parts, executor)
    for number, answers in enumerate(found):
        part = parts[number]
        for group, spaces, (plan, work) in zip(part.groups, part.spaces, answers, strict=True):
            successive.work += work
            if plan is None:
                risks[group] = float(np.sum(hazards.tail.probability(spaces.clearances)))
            else:
                plans[group], risks[group] = plan, plan.risk
    for group, plan in plans.items():
        for i, controls in zip(group, plan.controls, strict=True):
            paths.fly(i, controls)
        successive.ahead.lead(paths, before, group)
    for group in _surprised(successive, tuple(plans), before[1], parts):
        # It went where nothing was near before: planned again from there, all others as they are.
        for i in group:
            paths.fly(i, before[0][i])
        risks[group] = successive.share_risk(group, *costs)
    return sum(risks.values())


def _answers(
    successive: SuccessiveLp,
    groups: Sequence[Group],
    costs: tuple[float, float],
    parts: list[_Part],
    executor: Executor | None,
) -> Iterator[_Answers]:
    """Yield the answers of part after part; these are appended to a list as they are made."""
    limits = successive.limits

    def made() -> Iterator[_Part]:
        for some in _shared_out(groups):
            if limits.reached:
                return
            parts.append(_part(successive, some, _reach(successive, groups), costs))
            yield parts[-1]

    if executor is None:
        for part in made():
            yield _planned(part, limits)
        return
    # Half-spaces of the next part are turned while workers plan those before.
    with closing(in_order(_planned, made(), limits, executor)) as found:
        for number, answers in enumerate(found):
            yield _planned(parts[number], limits) if answers is None else answers


def _shared_out(groups: Sequence[Group]) -> Iterator[tuple[Group, ...]]:
    """Yield groups in order, as many as make up the vehicles of a part."""
    some: list[Group] = []
    for group in groups:
        some.append(group)
        if sum(map(len, some)) >= _AT_ONCE:
            yield tuple(some)
            some = []
    if some:
        yield tuple(some)


def _reach(successive: SuccessiveLp, groups: Sequence[Group]) -> float:
    """Return how far the fastest gets in a step: what is nearer has a half-space [m]."""
    return float(successive.hazards.reaches[[i for group in groups for i in group]].max())


def _part(
    successive: SuccessiveLp,
    groups: tuple[Group, ...],
    reach: float,
    costs: tuple[float, float],
) -> _Part:
    """Turn half-spaces to the paths of some groups."""
    hazards, paths = successive.hazards, successive.paths
    members = sorted(i for group in groups for i in group)
    far, is_asked = far_of(hazards.tail, TUNING.compared), successive.asks_nearest
    near = Near(far, reach, is_refined=True, is_nearest_asked=is_asked)
    spaces = half_spaces(hazards, paths, members, near, successive.ahead)
    models = {i: hazards.models[i] for i in members}
    price, spacing = costs
    return _Part(
        _Fleet(models, hazards.count, hazards.dimension, hazards.intervals),
        _Places(paths.means, paths.sagittas),
        groups,
        tuple(_parted(spaces, groups, hazards.count)),
        price,
        TUNING.last_penalty * successive.meter,
        spacing,
        hazards.tail,
    )


def _parted(spaces: HalfSpaces, groups: Sequence[Group], count: int) -> Iterator[HalfSpaces]:
    """Yield the half-spaces of each group; those between two groups are both groups'."""
    owners = np.full(count + 1, -1)
    for number, group in enumerate(groups):
        owners[list(group)] = number
    # The last stands for obstacles.
    first, second = owners[spaces.first], owners[spaces.second]
    for number in range(len(groups)):
        yield spaces.of((first == number) | (second == number))


def _planned(part: _Part, limits: Limits) -> _Answers:
    """Plan the groups of a part, in any process."""
    found: list[tuple[GroupPlan | None, float]] = []
    for group, spaces in zip(part.groups, part.spaces, strict=True):
        program = GroupLp(part.fleet, group)
        latest, costs = spaces.clearances, (part.price, part.penalty)
        margins = priced_margins(spaces.deviations, latest, costs, part.spacing, part.tail)
        plan = None if limits.reached else program.solve(spaces, part.places, margins, limits)
        found.append((plan, program.work))
    return found


def _surprised(
    successive: SuccessiveLp, groups: Sequence[Group], before: Tensor, parts: Sequence[_Part]
) -> list[Group]:
    """Return the groups that came near anything that there was no half-space for."""
    members = sorted(i for group in groups for i in group)
    if not members:
        return []
    keys = np.concatenate([spaces.keys for part in parts for spaces in part.spaces])
    had = keys, _reach(successive, groups)
    new = unforeseen(successive.hazards, successive.paths, members, before, had)
    came = set() if new is None else {*new.first.tolist(), *new.second.tolist()}
    return [group for group in groups if came.intersection(group)]
