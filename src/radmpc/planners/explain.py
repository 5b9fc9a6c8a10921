"""Why there is no plan, in the words of whoever drew the scenario."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from radmpc.geometry import sphere_directions
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Cause
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.planners.ira import solve_under_policy
from radmpc.program.build import build_program, whole_subjects
from radmpc.program.policy import NoRisk, Policy, Sigmas
from radmpc.program.program import DisjunctiveProgram, Exposure
from radmpc.program.subject import Subject
from radmpc.solvers.branch import Branch
from radmpc.solvers.highs_lp import LpOutcome
from radmpc.solvers.lp import WarmLp
from radmpc.solvers.solution import Limits, Outcome

__all__ = ["danger", "explain_infeasible", "impossible_places", "unable_alone"]

_MAX_NODES = 2_000


def explain_infeasible(scenario: Scenario, policy: Policy, gap: float, limits: Limits) -> str:
    """Find the plainest reason why vehicles cannot be planned.

    Tried in this order: feedback that needs more control than there is, goals out of reach,
    risk at the start, things that cannot be avoided wherever the vehicles may be, single
    vehicles, pairs.

    Parameters
    ----------
    scenario : Scenario
        Vehicles that could not be planned, with their Δ.
    policy : Policy
        The risk policy they were planned under.
    gap : float
        Relative gap of the solves.
    limits : Limits
        When to stop looking.

    Returns
    -------
    str
        One or two sentences, naming vehicles, obstacles and times.
    """
    subjects = whole_subjects(scenario)
    for subject in subjects:
        reason = unable_alone(scenario, subject)
        if reason:
            return reason
    reason = impossible_places(scenario, deterministic=isinstance(policy, NoRisk | Sigmas))
    if reason:
        return reason
    is_open = False
    for size in (1, 2):
        for members in combinations(range(len(subjects)), size):
            outcome = _solved_alone(scenario, members, policy, gap, limits)
            if outcome is Outcome.INFEASIBLE:
                return _cannot_be_planned(scenario, members)
            is_open |= outcome is Outcome.LIMIT
    return _OPEN if is_open else _GENERAL


def impossible_places(scenario: Scenario, *, deterministic: bool = False) -> str | None:
    """Say if starts are too risky, or things cannot be avoided wherever the vehicles may be.

    Parameters
    ----------
    scenario : Scenario
        The vehicles, with their Δ.
    deterministic : bool
        Whether risk counts only where it means contact.

    Returns
    -------
    str or None
        The reason, naming vehicles, obstacle and time.
    """
    program = build_program(scenario, whole_subjects(scenario), risk_bound=scenario.risk_bound)
    at_start = max(program.initial_risk, sum(risk for _, risk in program.initial))
    if program.initial and at_start >= (0.5 if deterministic else program.risk_bound):
        return _start_too_risky(program, at_start)
    hopeless = np.flatnonzero(np.diff(program.avoidance_starts) == 0)
    if hopeless.size:
        return _cannot_avoid(scenario, [program.avoidances[int(i)] for i in hopeless])
    return None


_OPEN = (
    "No plan was found, and a limit ended the search for the reason: raise the time limit, "
    "the risk bound or the horizon."
)

_GENERAL = (
    "Each vehicle and each pair can be planned, but not all together within the risk bound: "
    "raise risk_bound, lengthen the horizon, or reduce the noise."
)


def unable_alone(scenario: Scenario, subject: Subject) -> str | None:
    """Say if a vehicle cannot even fly through empty space."""
    name = subject.vehicle.name
    short = np.argwhere(subject.control_bounds < 0.0)
    if short.size:
        step, axis = (int(i) for i in short[0])
        return (
            f"Vehicle {name!r}: at step {step} the feedback alone takes more than control axis "
            f"{axis} allows ({subject.vehicle.control_sigmas:g} standard deviations exceed the "
            f"limit {subject.vehicle.control_limit[axis]:g}): raise control_limit, lower the "
            "gain, the noise or control_sigmas."
        )
    empty = build_program(
        _without_dangers(scenario, subject), [subject], risk_bound=scenario.risk_bound
    )
    outcome, _ = WarmLp(empty, np.zeros(empty.rows.count)).solve()
    if outcome is LpOutcome.INFEASIBLE:
        seconds = scenario.horizon * scenario.dt
        return (
            f"Vehicle {name!r} cannot reach its goal within {scenario.horizon} steps "
            f"({seconds:g} s) under its control and speed limits, obstacles aside: lengthen the "
            "horizon or raise its limits."
        )
    return None


def _without_dangers(scenario: Scenario, subject: Subject) -> Scenario:
    """Return the scenario of one vehicle in empty space."""
    return Scenario(
        name=scenario.name,
        dt=scenario.dt,
        horizon=scenario.horizon,
        risk_bound=scenario.risk_bound,
        vehicles=(subject.vehicle,),
        avoidance=scenario.avoidance,
    )


def _start_too_risky(program: DisjunctiveProgram, at_start: float) -> str:
    """Name what is too close at k = 0."""
    ranked = sorted(program.initial, key=lambda item: -item[1])
    worst, risk = ranked[0]
    if risk >= 0.5:
        return _start_in_conflict(worst)
    parts = [f"{danger(exposure)} (risk {risk:.3g})" for exposure, risk in ranked[:3]]
    return (
        f"The starts alone carry a collision risk of {at_start:.3g} by simple bounds, above the "
        f"{program.risk_bound:.3g} granted: {'; '.join(parts)}. Move the starts apart or reduce "
        "initial_covariance."
    )


def _start_in_conflict(exposure: Exposure) -> str:
    """Name a start that is no place to be."""
    if exposure.cause == "pair":
        return (
            f"The starts of vehicles {exposure.vehicle!r} and {exposure.other!r} are too close: "
            "they touch before anything moves. Move a start."
        )
    if exposure.cause == "obstacle":
        return (
            f"The start of vehicle {exposure.vehicle!r} lies within obstacle {exposure.other!r} "
            "grown by the vehicle's radius. Move the start."
        )
    return f"The start of vehicle {exposure.vehicle!r} lies outside the workspace. Move the start."


def _cannot_avoid(scenario: Scenario, exposures: list[Exposure]) -> str:
    """Name dangers that exist wherever the vehicles may be at that time."""
    for first, second in combinations(scenario.vehicles, 2):
        if _goals_too_close(scenario, first, second):
            return (
                f"The goals of vehicles {first.name!r} and {second.name!r} are too close to each "
                "other: both cannot be in their goals at the horizon without touching. Move a goal."
            )
    for vehicle in scenario.vehicles:
        for obstacle in scenario.obstacles:
            if _goal_is_taken(scenario, vehicle, obstacle):
                return (
                    f"The goal of vehicle {vehicle.name!r} lies within obstacle "
                    f"{obstacle.name!r} grown by the vehicle's radius. Move the goal."
                )
    first_one = exposures[0]
    when = f"at step {first_one.step}"
    if scenario.avoidance == "intervals":
        when = f"between steps {first_one.step} and {first_one.step + 1}"
    return (
        f"{_capitalized(danger(first_one))} cannot be kept apart {when}: no side is left for any "
        "motion that limits and goals allow. Lengthen the horizon or shorten dt."
    )


def _capitalized(text: str) -> str:
    """Return a text with a capital at its front, names within it as they are."""
    return text[:1].upper() + text[1:]


def _goals_too_close(scenario: Scenario, first: Vehicle, second: Vehicle) -> bool:
    """Whether two vehicles touch wherever they are in their goals."""
    faces = sphere_directions(scenario.num_pair_faces, scenario.dimension)
    apart = faces @ (first.goal.center - second.goal.center)
    room = 0.5 * (first.goal.upper - first.goal.lower + second.goal.upper - second.goal.lower)
    return bool(np.max(apart + np.abs(faces) @ room) < first.radius + second.radius)


def _goal_is_taken(scenario: Scenario, vehicle: Vehicle, obstacle: Obstacle) -> bool:
    """Whether a vehicle touches an obstacle wherever it is in its goal."""
    room = 0.5 * (vehicle.goal.upper - vehicle.goal.lower)
    return any(
        np.max(p.normals @ vehicle.goal.center + np.abs(p.normals) @ room - p.offsets)
        < vehicle.radius
        for p in obstacle.at(scenario.horizon)
    )


def danger(exposure: Exposure) -> str:
    """Name a danger."""
    cause: Cause = exposure.cause
    if cause == "pair":
        return f"vehicles {exposure.vehicle!r} and {exposure.other!r}"
    if cause == "obstacle":
        return f"vehicle {exposure.vehicle!r} and obstacle {exposure.other!r}"
    return f"vehicle {exposure.vehicle!r} and the workspace border"


def _solved_alone(
    scenario: Scenario, members: tuple[int, ...], policy: Policy, gap: float, limits: Limits
) -> Outcome:
    """Return how planning some of the vehicles alone with the whole Δ ends."""
    if limits.reached:
        return Outcome.LIMIT
    alone = scenario.subset(members, scenario.risk_bound)
    program = build_program(alone, whole_subjects(alone), risk_bound=scenario.risk_bound)
    solved = solve_under_policy(
        program, policy, Branch(_MAX_NODES), gap=gap, limits=limits, stage="explain", vehicles=()
    )
    return solved.solution.outcome


def _cannot_be_planned(scenario: Scenario, members: tuple[int, ...]) -> str:
    """Name vehicles for which no plan was found even with the whole Δ to themselves."""
    names = [repr(scenario.vehicles[i].name) for i in members]
    bound = f"the risk bound {scenario.risk_bound:g}"
    if len(names) == 2:
        return (
            f"Vehicles {names[0]} and {names[1]} alone find no way past each other within "
            f"{bound} that this planner sees: raise risk_bound, lengthen the horizon, or move "
            "their goals."
        )
    alone = scenario.subset(members, scenario.risk_bound)
    program = build_program(alone, whole_subjects(alone), risk_bound=scenario.risk_bound)
    dangers = dict.fromkeys(
        repr(e.other) if e.other else "the workspace border" for e in program.exposures
    )
    return (
        f"Vehicle {names[0]} alone finds no way within {bound} that this planner sees; near are "
        f"{', '.join(dangers)}. Raise risk_bound, lengthen the horizon, reduce the noise, or "
        "widen its way."
    )
