"""What published problems lack: steps, noise, feedback, a risk bound. Chosen here, and told."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from radmpc.io.foreign import ForeignProblem, ForeignVehicle
from radmpc.io.import_noise import Noise, choose_noise, rounded_up, told_feedback, told_noise
from radmpc.io.import_options import ImportOptions
from radmpc.model.dynamics import double_integrator
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Goal, Vehicle

__all__ = ["ImportedScenario", "overlay"]

_TIME_FACTOR = 1.5  # of the minimum time: room for detours and waiting
_FEWEST_STEPS, _MOST_STEPS = 10, 30
_STRIDE = 4.0  # radii per step at full speed: finer steps multiply the choices, not the room
_RISK_BOUND = 0.05
_GOAL_HALF_WIDTH = 0.25  # in radii
_GOAL_SPEED = 0.1  # of the speed limit
_BORDER_SIGMAS = 4.0  # between starts or goals and the border: 3e-5 per step


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
    if options.radius is not None:
        choices["radius"] = f"{options.radius:g} m, as asked"
        vehicles = tuple(replace(v, radius=float(options.radius)) for v in problem.vehicles)
        problem = replace(problem, vehicles=vehicles)
    dt, horizon = _steps(problem.vehicles, options, choices, warnings)
    noises = [choose_noise(v, dt, horizon, options) for v in problem.vehicles]
    choices["noise"] = told_noise(problem.vehicles, noises, options)
    choices["feedback"] = told_feedback(noises, horizon)
    workspace = _workspace(problem, noises, choices, warnings)
    risk_bound = _RISK_BOUND if options.risk_bound is None else float(options.risk_bound)
    choices["risk bound"] = f"{risk_bound:g}" + (" (as asked)" if options.risk_bound else "")
    avoidance = options.chosen_avoidance
    choices["avoidance"] = avoidance
    choices["goals"] = (
        f"within {_GOAL_HALF_WIDTH:g} radius of the published point per axis, "
        f"at up to {_GOAL_SPEED:g} of the speed limit"
    )
    scenario = Scenario(
        name=problem.name,
        dt=dt,
        horizon=horizon,
        risk_bound=risk_bound,
        avoidance=avoidance,
        workspace=workspace,
        obstacles=problem.obstacles,
        vehicles=tuple(
            _vehicle(v, dt, noise) for v, noise in zip(problem.vehicles, noises, strict=True)
        ),
        source={
            "format": problem.format,
            "file": problem.file,
            "choices": choices,
            "warnings": warnings,
        },
    )
    return ImportedScenario(scenario, choices, tuple(warnings))


def _steps(
    vehicles: tuple[ForeignVehicle, ...],
    options: ImportOptions,
    choices: dict[str, str],
    warnings: list[str],
) -> tuple[float, int]:
    """Return dt and horizon: steps of four radii at full speed where 10 to 30 of them allow."""
    stride = min(_STRIDE * v.radius / v.speed_limit for v in vehicles)
    least = max(v.minimum_time() for v in vehicles)
    wanted = _TIME_FACTOR * least if least > 0.0 else _FEWEST_STEPS * stride
    if options.horizon is not None:
        horizon = int(options.horizon)
    elif options.dt is not None:
        horizon = min(max(math.ceil(wanted / options.dt - 1e-9), 1), 1000)
    else:
        horizon = min(max(math.ceil(wanted / stride - 1e-9), _FEWEST_STEPS), _MOST_STEPS)
    dt = rounded_up(wanted / horizon) if options.dt is None else float(options.dt)
    asked = " (as asked)"
    choices["dt"] = f"{dt:g} s" + (asked if options.dt else "")
    choices["horizon"] = (
        f"{horizon} steps{asked if options.horizon else ''}: {dt * horizon:g} s, "
        f"the least time being {least:.4g} s"
    )
    if dt * horizon < least:
        warnings.append(f"{dt * horizon:g} s are too short: a vehicle needs at least {least:.4g} s")
    return dt, horizon


def _workspace(
    problem: ForeignProblem, noises: list[Noise], choices: dict[str, str], warnings: list[str]
) -> Workspace | None:
    """Return the published bounds, moved out where vehicles start or end too close to them."""
    if problem.workspace is None:
        choices["workspace"] = "none"
        return None
    margins = np.array([[_BORDER_SIGMAS * noise.final] for noise in noises])
    points = [np.array([v.start for v in problem.vehicles])]
    points.append(np.array([v.goal for v in problem.vehicles]))
    lower = np.minimum(problem.workspace.lower, np.min([(p - margins) for p in points], (0, 1)))
    upper = np.maximum(problem.workspace.upper, np.max([(p + margins) for p in points], (0, 1)))
    moved = max(
        float((problem.workspace.lower - lower).max()),
        float((upper - problem.workspace.upper).max()),
    )
    choices["workspace"] = "as published, for the vehicles' centers"
    if moved > 0.0:
        choices["workspace"] += f", moved out by up to {moved:.3g} m"
        warnings.append(
            f"the workspace was moved out by up to {moved:.3g} m: starts or goals lie closer "
            f"to its border than {_BORDER_SIGMAS:g} standard deviations"
        )
    return Workspace(lower, upper)


def _vehicle(vehicle: ForeignVehicle, dt: float, noise: Noise) -> Vehicle:
    """Return a vehicle of the scenario."""
    d = vehicle.start.size
    half = _GOAL_HALF_WIDTH * vehicle.radius
    speed = np.maximum(_GOAL_SPEED * vehicle.speed_limit, np.abs(vehicle.goal_velocity))
    return Vehicle(
        name=vehicle.name,
        system=double_integrator(dt, d),
        start=np.concatenate([vehicle.start, vehicle.start_velocity]),
        goal=Goal(vehicle.goal - half, vehicle.goal + half, speed),
        radius=vehicle.radius,
        control_limit=np.full(d, vehicle.control_limit),
        speed_limit=np.full(d, vehicle.speed_limit),
        initial_covariance=noise.disturbance,
        disturbance_covariance=noise.disturbance,
        gain=noise.gain,
    )
