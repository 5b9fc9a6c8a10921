"""What published problems lack: steps, noise, feedback, a risk bound. Chosen here, and reported."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from radmpc.errors import ScenarioError
from radmpc.importing.clearance import fit_hulls, free_paths
from radmpc.importing.ends import fit_ends
from radmpc.importing.free_space import FreePath, free_spaces_of
from radmpc.importing.hulls import describe_hulls
from radmpc.importing.noise import (
    Noise,
    choose_noise,
    describe_feedback,
    describe_noise,
)
from radmpc.importing.options import ImportOptions
from radmpc.importing.problem import ForeignProblem, ForeignVehicle
from radmpc.importing.relations import among_left, describe_relations
from radmpc.importing.rounding import rounded
from radmpc.importing.timing import choose_steps
from radmpc.importing.windows import arrival_steps, chosen_visits
from radmpc.io.ranges import MOST_OBSTACLES, MOST_VEHICLES, check_count
from radmpc.model.dynamics import double_integrator
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.records import dataclass, replace
from radmpc.rounding import rounded_down

__all__ = ["ImportedScenario", "overlay"]

_RISK_BOUND = 0.05
"""Risk bound where none is asked for [-]."""

_GOAL_HALF_WIDTH = 0.25
"""Half width of a goal around a published point, per axis [radii]."""

_GOAL_SPEED = 0.1
"""Largest mean speed at the goal, as a share of the speed limit [-]."""

_BORDER_SIGMAS = 4.0
"""Distance of starts and goals from the border [standard deviations]: 3e-5 per step."""

_CLEARANCE_SIGMAS = 4.0
"""Standard deviations that the clearance of a path must hold: 3e-5 per step."""

_NAMED = 4
"""Vehicles up to which they are told by name [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class ImportedScenario:
    """A scenario made of a published problem.

    Attributes
    ----------
    scenario : Scenario
        Its ``source`` holds the choices and warnings too.
    choices : mapping
        What was chosen, by name, each with its reason.
    warnings : tuple of str
        Where the scenario differs from the problem.
    """

    scenario: Scenario
    choices: Mapping[str, str]
    warnings: tuple[str, ...]


def overlay(problem: ForeignProblem, options: ImportOptions) -> ImportedScenario:
    """Return a scenario of a published problem, with what it lacks.

    Parameters
    ----------
    problem : ForeignProblem
        As its file states it.
    options : ImportOptions
        What is not to be chosen here.

    Returns
    -------
    ImportedScenario
        With every choice and its reason.

    Raises
    ------
    ScenarioError
        If the problem cannot be meant.
    """
    choices = dict(problem.reasons)
    warnings = list(problem.warnings)
    problem = _chosen(problem, options, choices, warnings)
    choices.update(describe_relations(problem.obstacles, problem.keep))
    spaces = free_spaces_of(problem)
    if spaces is not None and options.radius is None:
        problem = fit_hulls(problem, spaces, choices, warnings)
    paths = free_paths(problem, spaces, warnings)
    dt, horizon = choose_steps(problem.vehicles, paths, options, choices, warnings)
    risk_bound = _RISK_BOUND if options.risk_bound is None else float(options.risk_bound)
    noises = _noises(problem, paths, (dt, horizon), risk_bound, options, choices)
    workspace = _workspace(problem, noises, choices, warnings)
    choices["risk bound"] = f"{risk_bound:g}" + (" (as asked)" if options.risk_bound else "")
    avoidance = options.chosen_avoidance
    choices["avoidance"] = avoidance
    choices["goals"] = _describe_goals(choices.get("goals"))
    warnings += _moving_ends(problem.vehicles)
    origin = {} if problem.origin is None else {"origin": dict(problem.origin)}
    scenario = Scenario(
        name=problem.name,
        dt=dt,
        horizon=horizon,
        risk_bound=risk_bound,
        avoidance=avoidance,
        workspace=workspace,
        obstacles=problem.obstacles,
        keep=problem.keep,
        vehicles=tuple(
            _vehicle(v, dt, horizon, noise)
            for v, noise in zip(problem.vehicles, noises, strict=True)
        ),
        source={
            "format": problem.format,
            "file": problem.file,
            **origin,
            "choices": choices,
            "warnings": warnings,
        },
    )
    return ImportedScenario(scenario, choices, tuple(warnings))


def _chosen(
    problem: ForeignProblem, options: ImportOptions, choices: dict[str, str], warnings: list[str]
) -> ForeignProblem:
    """Return the problem with as many vehicles, and of the radius, as are asked for."""
    vehicles = problem.vehicles
    check_count(len(problem.obstacles), MOST_OBSTACLES, ("obstacles",))
    count = problem.usual_vehicles if options.agents is None else options.agents
    if options.agents is not None and options.agents > len(vehicles):
        raise ScenarioError(f"must be at most {len(vehicles)}, got {options.agents}", ("agents",))
    if count is not None and count < len(vehicles):
        choices["agents"] = f"the first {count} of {len(vehicles)}" + (
            "" if options.agents is None else ", as asked"
        )
        vehicles = vehicles[:count]
    check_count(len(vehicles), MOST_VEHICLES, ("vehicles",))
    warnings += describe_hulls(vehicles, options.radius)
    if options.radius is not None:
        choices["radius"] = f"{options.radius:g} m, as asked"
        vehicles = tuple(replace(v, radius=float(options.radius)) for v in vehicles)
    return among_left(replace(problem, vehicles=vehicles))


def _noises(
    problem: ForeignProblem,
    paths: list[FreePath],
    steps: tuple[float, int],
    risk_bound: float,
    options: ImportOptions,
    choices: dict[str, str],
) -> list[Noise]:
    """Return the vehicles' noise: the usual one, or less where the path is narrow."""
    noises, narrowest = [], math.inf
    dt, horizon = steps
    for vehicle, path in zip(problem.vehicles, paths, strict=True):
        noise = choose_noise(vehicle, dt, horizon, options)
        most = path.clearance / _CLEARANCE_SIGMAS
        if options.noise is None and noise.final > 1.02 * most:
            std = rounded_down(noise.std * most / noise.final, 3)
            noise = choose_noise(vehicle, dt, horizon, replace(options, noise=std))
            narrowest = min(narrowest, path.clearance)
        noises.append(noise)
    noises, close = fit_ends(problem.vehicles, noises, _GOAL_HALF_WIDTH, steps, options, risk_bound)
    choices["noise"] = describe_noise(problem.vehicles, noises, options)
    if narrowest < math.inf:
        choices["noise"] += (
            f": the narrowest way leaves {narrowest:.3g} m beside a hull, "
            f"{_CLEARANCE_SIGMAS:g} standard deviations"
        )
    if close:
        who = ", ".join(map(repr, close)) if len(close) <= _NAMED else f"{len(close)} vehicles"
        choices["noise"] += f"; less for {who}: they start or end close to each other"
    choices["feedback"] = describe_feedback(noises, horizon)
    return noises


def _describe_goals(regions: str | None) -> str:
    """Return what the goals are, in words."""
    place = f"within {_GOAL_HALF_WIDTH:g} radius of the published point per axis"
    if regions is not None:
        place = f"{regions}, {_BORDER_SIGMAS:g} standard deviations within"
    return f"{place}, at up to {_GOAL_SPEED:g} of the speed limit"


def _moving_ends(vehicles: Sequence[ForeignVehicle]) -> list[str]:
    """Return that goals' velocities become limits of speed, where any are published."""
    moving = [repr(v.name) for v in vehicles if np.any(v.goal_velocity)]
    if not moving:
        return []
    who = ", ".join(moving) if len(moving) <= _NAMED else f"{len(moving)} vehicles"
    return [
        f"velocities at the goals of {who} became limits of speed per axis, without their signs: "
        "plans may end slower, or the other way"
    ]


def _workspace(
    problem: ForeignProblem, noises: list[Noise], choices: dict[str, str], warnings: list[str]
) -> Workspace | None:
    """Return the published bounds, moved out where vehicles start or end too close to them."""
    if problem.workspace is None:
        choices["workspace"] = "none"
        return None
    inset = max(v.radius for v in problem.vehicles) if problem.bounds_hulls else 0.0
    published = problem.workspace.lower + inset, problem.workspace.upper - inset
    margins = np.array([[_BORDER_SIGMAS * noise.final] for noise in noises])
    points = [np.array([v.start for v in problem.vehicles])]
    points.append(np.array([v.goal for v in problem.vehicles]))
    lower = np.minimum(published[0], np.min([(p - margins) for p in points], (0, 1)))
    upper = np.maximum(published[1], np.max([(p + margins) for p in points], (0, 1)))
    moved = max(float((published[0] - lower).max()), float((upper - published[1]).max()))
    choices["workspace"] = "as published, for the vehicles' centers"
    if inset > 0.0:
        choices["workspace"] = f"as published, {inset:g} m within for the vehicles' centers"
    if moved > 1e-9:
        choices["workspace"] += f", moved out by up to {moved:.3g} m"
        warnings.append(
            f"the workspace was moved out by up to {moved:.3g} m: starts or goals lie closer "
            f"to its border than {_BORDER_SIGMAS:g} standard deviations"
        )
    # What is as published stays so, bit for bit.
    lower = np.where(lower == problem.workspace.lower, lower, rounded(lower))
    upper = np.where(upper == problem.workspace.upper, upper, rounded(upper))
    try:
        return Workspace(lower, upper)
    except ScenarioError as error:
        raise _cannot_be(error, "workspace") from error


def _cannot_be(error: ScenarioError, *path: str) -> ScenarioError:
    """Return the error of a part that a problem leads to: it stands nowhere in the problem."""
    return ScenarioError(f"leads to a scenario that cannot be: {error.under(*path)}")


def _vehicle(vehicle: ForeignVehicle, dt: float, horizon: int, noise: Noise) -> Vehicle:
    """Return a vehicle of the scenario."""
    d = vehicle.start.size
    half = np.full(d, _GOAL_HALF_WIDTH * vehicle.radius)
    within = arrival_steps(vehicle, dt, horizon)
    if vehicle.goal_half_width is not None:
        # The vehicle ends within the region, not only its mean.
        half = np.maximum(vehicle.goal_half_width - _BORDER_SIGMAS * noise.final, 0.0)
    usual = rounded(np.full(d, _GOAL_SPEED * vehicle.speed_limit))
    speed = np.maximum(usual, np.abs(vehicle.goal_velocity))
    try:
        goal = Goal(rounded(vehicle.goal - half), rounded(vehicle.goal + half), speed, within)
    except ScenarioError as error:
        raise _cannot_be(error, f"vehicle {vehicle.name!r}", "goal") from error
    return Vehicle(
        name=vehicle.name,
        system=double_integrator(dt, d),
        start=np.concatenate([vehicle.start, vehicle.start_velocity]),
        goal=goal,
        radius=vehicle.radius,
        control_limit=np.full(d, vehicle.control_limit),
        speed_limit=np.full(d, vehicle.speed_limit),
        initial_covariance=noise.disturbance,
        disturbance_covariance=noise.disturbance,
        gain=noise.gain,
        via=chosen_visits(vehicle, dt, horizon),
    )
