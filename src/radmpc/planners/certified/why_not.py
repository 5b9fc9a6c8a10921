"""Why a fleet has no plan within its bound: who is stuck, what bound would do, what to change."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil, floor, log10

from radmpc.arrays import Matrix
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.least_risk import LeastRisk, least_risk
from radmpc.planners.certified.problem import SetProblem
from radmpc.planners.explain import danger, impossible_places, unable_alone
from radmpc.program.build import whole_subjects
from radmpc.solvers.risk_tree import RiskTree
from radmpc.solvers.solution import Limits

__all__ = ["WhyNot", "why_not"]

_UNIT = 0.49
_NODES = 400
"""Nodes to find out whether leaving one thing out opens a way."""

_QUIET = 1e-6
"""Factor of covariances that leaves next to nothing of them."""

_NAMED = 3
_MAX_CONFLICTS = 8


@dataclass(frozen=True, slots=True, eq=False)
class WhyNot:
    """What stands in the way of a plan.

    Attributes
    ----------
    explanation : str
        In sentences, naming vehicles, obstacles and times.
    is_proven : bool
        Whether no plan is within the bound; otherwise none was found.
    controls : tuple of (T, m) array
        The safest plan met on the way, for the referee to judge; empty without one.
    sets : tuple of tuple of int
        Who was planned together in it.
    """

    explanation: str
    is_proven: bool
    controls: tuple[Matrix, ...] = ()
    sets: tuple[tuple[int, ...], ...] = ()


def why_not(scenario: Scenario, limits: Limits) -> WhyNot:
    """Find out why a fleet has no plan within its bound.

    Vehicles that cannot be planned at any risk are named and left out, until the rest can be:
    what is wrong with some never hides what the others could do.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    limits : Limits
        When to stop looking.

    Returns
    -------
    WhyNot
        The reasons.
    """
    subjects = whole_subjects(scenario)
    reasons: list[str] = []
    rest: list[int] = []
    for i, subject in enumerate(subjects):
        reason = unable_alone(scenario, subject)
        if reason is None:
            rest.append(i)
        elif len(reasons) < _MAX_CONFLICTS:
            reasons.append(reason)
    is_proven = bool(reasons)
    while rest:
        part = scenario.subset(tuple(rest), scenario.risk_bound)
        found = least_risk(part, limits)
        if not found.stuck:
            return _of_the_rest(scenario, found, reasons, len(rest), is_proven)
        reasons.append(_stuck(part, found.stuck, limits))
        is_proven = True
        rest = [i for place, i in enumerate(rest) if place not in found.stuck]
        if len(reasons) >= _MAX_CONFLICTS:
            break
    return WhyNot(" ".join(reasons), is_proven)


def _of_the_rest(
    scenario: Scenario, found: LeastRisk, reasons: Sequence[str], count: int, is_proven: bool
) -> WhyNot:
    """Say what those can do who are not stuck."""
    bound = scenario.risk_bound
    if not reasons:
        # Above Δ by simple bounds, the safest plan may still be within it by the referee's.
        reason = "" if found.risk <= bound else _too_little_risk(scenario, found)
        return WhyNot(reason, found.bound > bound, found.controls, found.sets)
    others = f"The other {count} vehicles" if count > 1 else "The other vehicle"
    if found.risk <= bound:
        can = f"{others} can be planned within the risk bound."
    elif found.bound > bound:
        can = f"{others}: {_too_little_risk(scenario, found)}"
    else:
        can = f"{others}: no plan was found, and none was ruled out."
    return WhyNot(" ".join([*reasons, can]), is_proven)


def _too_little_risk(scenario: Scenario, found: LeastRisk) -> str:
    """Say what bound would do, and what takes it."""
    bound = f"risk_bound {scenario.risk_bound:g}"
    if not found.controls:
        return (
            f"No plan was found at any risk within the limits, and none was ruled out: raise the "
            f"time limit, {bound} or the horizon."
        )
    takers = "; ".join(
        f"{danger(exposure)} around step {exposure.step} ({risk:.2g})"
        for exposure, risk in found.takers[:_NAMED]
    )
    if found.bound > scenario.risk_bound:
        head = (
            f"No plan is within {bound} by simple bounds: every plan runs at least "
            f"{_down(found.bound)}."
        )
    else:
        head = f"No plan within {bound} was found, and none was ruled out."
    return (
        f"{head} The safest found runs {_up(found.risk)}, most of it {takers}. Raise risk_bound "
        f"to {_up(found.risk)}, lengthen the horizon, reduce the noise, or ease these."
    )


def _stuck(scenario: Scenario, members: tuple[int, ...], limits: Limits) -> str:
    """Say who cannot be planned at any risk, and what stands in the way."""
    reason = impossible_places(scenario.subset(members, scenario.risk_bound))
    if reason is not None:
        return reason
    members = _smallest(scenario, members, limits)
    part = scenario.subset(members, scenario.risk_bound)
    names = [repr(v.name) for v in part.vehicles]
    who = f"Vehicle {names[0]}" if len(names) == 1 else f"Vehicles {' and '.join(names)} together"
    verb = "has" if len(names) == 1 else "have"
    if _has_plan(_without_noise(part), limits):
        return (
            f"{who} {verb} no way on which the noise leaves room (without noise there is one): "
            "reduce the noise, add feedback, or make room where it is narrow."
        )
    blockers = _blockers(part, limits)
    if not blockers:
        what = "their goals, or start them apart" if len(names) > 1 else "its goal"
        return f"{who} {verb} no plan at any risk: lengthen the horizon, move {what}."
    return (
        f"{who} {verb} no plan at any risk: {' or '.join(blockers)} stands in the way (without it "
        "there is one). Move or shrink it, lengthen the horizon, or move a goal."
    )


def _smallest(scenario: Scenario, members: tuple[int, ...], limits: Limits) -> tuple[int, ...]:
    """Leave out vehicles without whom the others are stuck all the same."""
    kept = list(members)
    for i in members:
        fewer = [j for j in kept if j != i]
        if fewer and _is_stuck(scenario.subset(tuple(fewer), scenario.risk_bound), limits):
            kept = fewer
    return tuple(kept)


def _blockers(scenario: Scenario, limits: Limits) -> list[str]:
    """Return the obstacles without which there is a plan."""
    found = []
    for i, obstacle in enumerate(scenario.obstacles):
        others = scenario.obstacles[:i] + scenario.obstacles[i + 1 :]
        if _has_plan(replace(scenario, obstacles=others), limits):
            found.append(f"obstacle {obstacle.name!r}")
    if scenario.workspace is not None and _has_plan(replace(scenario, workspace=None), limits):
        found.append("the workspace border")
    return found


def _without_noise(scenario: Scenario) -> Scenario:
    """Return the same fleet with next to no noise."""
    quiet = [
        replace(
            vehicle,
            initial_covariance=_QUIET * vehicle.initial_covariance,
            disturbance_covariance=_QUIET * vehicle.disturbance_covariance,
        )
        for vehicle in scenario.vehicles
    ]
    return replace(scenario, vehicles=tuple(quiet))


def _search(scenario: Scenario, limits: Limits) -> RiskTree:
    """Search for any plan, whatever its risk."""
    subjects = whole_subjects(scenario)
    everyone = tuple(range(len(subjects)))
    problem = SetProblem.of(scenario, everyone, subjects, _UNIT).without_cost()
    tree = RiskTree(
        problem.program, _UNIT, 1.0, gap=1.0, scale=1.0, limits=limits, rater=problem.rater
    )
    tree.run(_NODES * len(everyone))
    return tree


def _has_plan(scenario: Scenario, limits: Limits) -> bool:
    """Whether a plan is found."""
    return _search(scenario, limits).best is not None


def _is_stuck(scenario: Scenario, limits: Limits) -> bool:
    """Whether it is proven that there is no plan."""
    return _search(scenario, limits).bound == float("inf")


def _up(risk: float) -> str:
    """Return a risk in two digits, not below it."""
    unit = 10.0 ** (floor(log10(max(risk, 1e-12))) - 1)
    return f"{ceil(risk / unit * (1.0 - 1e-9)) * unit:.2g}"


def _down(risk: float) -> str:
    """Return a risk in two digits, not above it."""
    unit = 10.0 ** (floor(log10(max(risk, 1e-12))) - 1)
    return f"{floor(risk / unit * (1.0 + 1e-9)) * unit:.2g}"
