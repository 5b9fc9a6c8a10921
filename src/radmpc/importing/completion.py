"""What published problems lack: steps, noise, feedback, a risk bound. Chosen here, and told."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from radmpc.errors import ScenarioError
from radmpc.importing.free_space import Lattice, Way, lattice_of
from radmpc.importing.noise import Noise, choose_noise, rounded_up, told_feedback, told_noise
from radmpc.importing.options import ImportOptions
from radmpc.importing.problem import ForeignProblem, ForeignVehicle
from radmpc.importing.rounding import rounded
from radmpc.importing.waiting import waiting_times
from radmpc.io.ranges import MOST_OBSTACLES, MOST_VEHICLES, check_count
from radmpc.model.dynamics import double_integrator
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Goal, Vehicle

__all__ = ["ImportedScenario", "overlay"]

_TIME_FACTOR = 1.5  # of the least time with nothing in the way: room for detours and waiting
_WAY_FACTOR = 1.3  # of the least time around obstacles: room for waiting
_TIGHT_FACTOR = 1.5  # the same where ways are narrow or vehicles take turns
_FEWEST_STEPS, _MOST_STEPS = 10, 30
_STRIDE = 4.0  # radii per step at full speed: finer steps multiply the choices, not the room
_RISK_BOUND = 0.05
_GOAL_HALF_WIDTH = 0.25  # in radii
_GOAL_SPEED = 0.1  # of the speed limit
_BORDER_SIGMAS = 4.0  # between starts or goals and the border: 3e-5 per step
_ROOM_SIGMAS = 4.0  # between a vehicle and what stands beside its way, the same
_WANTED_ROOM = 0.8  # radii: four standard deviations of the usual noise
_LEAST_ROOM = 0.05  # radii: less is none
_FITTING = 0.8  # of the widest radius that passes: some room is left beside it


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
    problem = _chosen(problem, options, choices)
    lattice = lattice_of(problem)
    if lattice is not None and options.radius is None:
        problem = _fitting(problem, lattice, choices, warnings)
    ways = _ways(problem, lattice, warnings)
    dt, horizon = _steps(problem.vehicles, ways, options, choices, warnings)
    noises = _noises(problem, ways, dt, horizon, options, choices)
    workspace = _workspace(problem, noises, choices, warnings)
    risk_bound = _RISK_BOUND if options.risk_bound is None else float(options.risk_bound)
    choices["risk bound"] = f"{risk_bound:g}" + (" (as asked)" if options.risk_bound else "")
    avoidance = options.chosen_avoidance
    choices["avoidance"] = avoidance
    choices["goals"] = _told_goals(problem.vehicles, choices.get("goals"))
    origin = {} if problem.origin is None else {"origin": dict(problem.origin)}
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
            **origin,
            "choices": choices,
            "warnings": warnings,
        },
    )
    return ImportedScenario(scenario, choices, tuple(warnings))


def _chosen(
    problem: ForeignProblem, options: ImportOptions, choices: dict[str, str]
) -> ForeignProblem:
    """Return the problem with as many vehicles as wanted, of the radius that is asked for."""
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
    if options.radius is not None:
        choices["radius"] = f"{options.radius:g} m, as asked"
        vehicles = tuple(replace(v, radius=float(options.radius)) for v in vehicles)
    return replace(problem, vehicles=vehicles)


def _fitting(
    problem: ForeignProblem, lattice: Lattice, choices: dict[str, str], warnings: list[str]
) -> ForeignProblem:
    """Return the problem with hulls that leave room for noise where the published ones do not."""
    share = 1.0
    for v in problem.vehicles:
        way = lattice.way(v, _WANTED_ROOM * v.radius)
        if way is None or way.room < _LEAST_ROOM * v.radius:
            share = min(share, _FITTING * lattice.widest(v) / v.radius)
    if share <= 0.0 or share >= 1.0:
        return problem
    radii = {v.radius: float(f"{share * v.radius:.2g}") for v in problem.vehicles}
    told = ", ".join(f"{old:g} m to {new:g} m" for old, new in radii.items())
    warnings.append(
        f"hulls were reduced from {told}: some way is so narrow that the published ones leave no "
        "room for noise (a radius that is asked for is kept)"
    )
    choices["radius"] = f"reduced from {told}, so that noise has room beside the narrowest way"
    vehicles = tuple(replace(v, radius=radii[v.radius]) for v in problem.vehicles)
    return replace(problem, vehicles=vehicles)


def _ways(problem: ForeignProblem, lattice: Lattice | None, warnings: list[str]) -> list[Way]:
    """Return the vehicles' ways around obstacles; straight ones where there is none to be found."""
    ways = []
    for v in problem.vehicles:
        straight = Way(0.0, wanted := _WANTED_ROOM * v.radius)
        way = straight if lattice is None else lattice.way(v, wanted)
        if lattice is not None and (way is None or way.room < _LEAST_ROOM * v.radius):
            widest = lattice.widest(v)
            hint = f", of {_FITTING * widest:.2g} m it might" if widest > 0.0 else ""
            warnings.append(
                f"between start and goal of {v.name!r} a hull of {v.radius:g} m finds no way "
                f"with room for noise{hint}"
            )
            way = Way(0.0 if way is None else way.detour, wanted)
        ways.append(straight if way is None else way)
    if lattice is not None:
        waits = waiting_times(lattice, problem.vehicles, [way.room for way in ways])
        ways = [replace(way, waiting=wait) for way, wait in zip(ways, waits, strict=True)]
    return ways


def _steps(
    vehicles: tuple[ForeignVehicle, ...],
    ways: list[Way],
    options: ImportOptions,
    choices: dict[str, str],
    warnings: list[str],
) -> tuple[float, int]:
    """Return dt and horizon: steps of four radii at full speed where 10 to 30 of them allow.

    Steps are half as long where ways are narrow or vehicles take turns: corners, and places to
    wait, must fall on some.
    """
    is_tight = any(
        way.waiting > 0.0 or way.room < 0.99 * _WANTED_ROOM * v.radius
        for v, way in zip(vehicles, ways, strict=True)
    )
    stride = min(_STRIDE * v.radius / v.speed_limit for v in vehicles) * (0.5 if is_tight else 1.0)
    straight = max(v.minimum_time() for v in vehicles)
    least = max(
        v.minimum_time() + way.detour / v.speed_limit + way.waiting
        for v, way in zip(vehicles, ways, strict=True)
    )
    factor = _TIGHT_FACTOR if is_tight else _WAY_FACTOR
    wanted = max(_TIME_FACTOR * straight, factor * least) or _FEWEST_STEPS * stride
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


def _noises(
    problem: ForeignProblem,
    ways: list[Way],
    dt: float,
    horizon: int,
    options: ImportOptions,
    choices: dict[str, str],
) -> list[Noise]:
    """Return the vehicles' noise: the usual one, or less where the way is narrow."""
    noises, narrowest = [], math.inf
    for vehicle, way in zip(problem.vehicles, ways, strict=True):
        noise = choose_noise(vehicle, dt, horizon, options)
        most = way.room / _ROOM_SIGMAS
        if options.noise is None and noise.final > 1.02 * most:
            std = _rounded_down(noise.std * most / noise.final)
            noise = choose_noise(vehicle, dt, horizon, replace(options, noise=std))
            narrowest = min(narrowest, way.room)
        noises.append(noise)
    choices["noise"] = told_noise(problem.vehicles, noises, options)
    if narrowest < math.inf:
        choices["noise"] += (
            f": the narrowest way leaves {narrowest:.3g} m beside a hull, "
            f"{_ROOM_SIGMAS:g} standard deviations"
        )
    choices["feedback"] = told_feedback(noises, horizon)
    return noises


def _rounded_down(value: float) -> float:
    """Return the next smaller number of three digits; the value is > 0."""
    digits = 2 - math.floor(math.log10(value))
    return round(math.floor(value * 10.0**digits + 1e-9) / 10.0**digits, digits)


def _told_goals(vehicles: tuple[ForeignVehicle, ...], regions: str | None) -> str:
    """Return what the goals are, in words."""
    place = f"within {_GOAL_HALF_WIDTH:g} radius of the published point per axis"
    if regions is not None:
        place = f"{regions}, {_BORDER_SIGMAS:g} standard deviations within"
    return f"{place}, at up to {_GOAL_SPEED:g} of the speed limit"


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
    return Workspace(lower, upper)


def _vehicle(vehicle: ForeignVehicle, dt: float, noise: Noise) -> Vehicle:
    """Return a vehicle of the scenario."""
    d = vehicle.start.size
    half = np.full(d, _GOAL_HALF_WIDTH * vehicle.radius)
    if vehicle.goal_half_width is not None:
        # The vehicle ends within the region, not only its mean.
        half = np.maximum(vehicle.goal_half_width - _BORDER_SIGMAS * noise.final, 0.0)
    usual = rounded(np.full(d, _GOAL_SPEED * vehicle.speed_limit))
    speed = np.maximum(usual, np.abs(vehicle.goal_velocity))
    return Vehicle(
        name=vehicle.name,
        system=double_integrator(dt, d),
        start=np.concatenate([vehicle.start, vehicle.start_velocity]),
        goal=Goal(rounded(vehicle.goal - half), rounded(vehicle.goal + half), speed),
        radius=vehicle.radius,
        control_limit=np.full(d, vehicle.control_limit),
        speed_limit=np.full(d, vehicle.speed_limit),
        initial_covariance=noise.disturbance,
        disturbance_covariance=noise.disturbance,
        gain=noise.gain,
    )
