"""What published problems lack: steps, noise, feedback, a risk bound. Chosen here, and told."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from radmpc.arrays import Matrix
from radmpc.errors import ScenarioError
from radmpc.io.foreign import ForeignProblem, ForeignVehicle
from radmpc.model.dynamics import covariances, double_integrator
from radmpc.model.scenario import Avoidance, Scenario, Workspace
from radmpc.model.vehicle import Goal, Vehicle

__all__ = ["ImportOptions", "ImportedScenario", "overlay"]

_TIME_FACTOR = 1.5  # of the minimum time: room for detours and waiting
_FEWEST_STEPS, _MOST_STEPS = 10, 30
_LONG_HORIZON = 12  # steps from which noise is held by feedback
_SPREAD = 0.2  # least standard deviation at the end, in radii
_RISK_BOUND = 0.05
_GOAL_HALF_WIDTH = 0.25  # in radii
_GOAL_SPEED = 0.1  # of the speed limit
_BORDER_SIGMAS = 4.0  # between starts or goals and the border: 3e-5 per step
_GAIN = (-0.3, -0.9)  # on position and velocity, for steps of 1 s
_MOST_RESERVE = 0.25  # of the control limit, for the feedback


@dataclass(frozen=True, slots=True)
class ImportOptions:
    """What the user has decided; None leaves it to `overlay`.

    Attributes
    ----------
    dt : float or None
        Step [s].
    horizon : int or None
        Number of steps.
    noise : float or None
        Standard deviation of the position noise added at every step [m].
    risk_bound : float or None
        Joint bound, 0 < Δ < 0.5.
    radius : float or None
        Of every vehicle [m].
    avoidance : {'intervals', 'steps'} or None
        Whether collisions count between steps.
    """

    dt: float | None = None
    horizon: int | None = None
    noise: float | None = None
    risk_bound: float | None = None
    radius: float | None = None
    avoidance: str | None = None

    def __post_init__(self) -> None:
        """Refuse values that no scenario can have."""
        for name, unit in (("dt", "s"), ("noise", "m"), ("radius", "m")):
            value = getattr(self, name)
            if value is not None and not (math.isfinite(value) and 0.0 < value <= 1e6):
                raise ScenarioError(f"must be > 0 {unit}, got {value}", (name,))
        if self.horizon is not None and not 1 <= self.horizon <= 1000:
            raise ScenarioError(f"must be 1 to 1000 steps, got {self.horizon}", ("horizon",))
        if self.risk_bound is not None and not 0.0 < self.risk_bound < 0.5:
            raise ScenarioError(
                f"must lie between 0 and 0.5, both excluded, got {self.risk_bound}",
                ("risk_bound",),
            )
        _avoidance(self)


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


@dataclass(frozen=True, slots=True, eq=False)
class _Noise:
    """One vehicle's noise and what holds it.

    ``std`` is that of the position noise per step [m], ``final`` that of the position at the
    end [m].
    """

    disturbance: Matrix
    gain: Matrix | None
    std: float
    final: float


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
    noises = [_noise(v, dt, horizon, options) for v in problem.vehicles]
    _tell_noise(problem.vehicles, noises, options, choices)
    workspace = _workspace(problem, noises, choices, warnings)
    risk_bound = _RISK_BOUND if options.risk_bound is None else float(options.risk_bound)
    choices["risk bound"] = f"{risk_bound:g}" + (" (as asked)" if options.risk_bound else "")
    avoidance = _avoidance(options)
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
        source={"format": problem.format, "choices": choices, "warnings": warnings},
    )
    return ImportedScenario(scenario, choices, tuple(warnings))


def _avoidance(options: ImportOptions) -> Avoidance:
    """Return where collisions count."""
    if options.avoidance is None or options.avoidance == "intervals":
        return "intervals"
    if options.avoidance == "steps":
        return "steps"
    raise ScenarioError(
        f"must be 'steps' or 'intervals', got {options.avoidance!r}", ("avoidance",)
    )


def _steps(
    vehicles: tuple[ForeignVehicle, ...],
    options: ImportOptions,
    choices: dict[str, str],
    warnings: list[str],
) -> tuple[float, int]:
    """Return dt and horizon: steps of two radii at full speed where 10 to 30 of them allow."""
    stride = min(2.0 * v.radius / v.speed_limit for v in vehicles)
    least = max(v.minimum_time() for v in vehicles)
    wanted = _TIME_FACTOR * least if least > 0.0 else _FEWEST_STEPS * stride
    if options.horizon is not None:
        horizon = int(options.horizon)
    elif options.dt is not None:
        horizon = min(max(math.ceil(wanted / options.dt - 1e-9), 1), 1000)
    else:
        horizon = min(max(math.ceil(wanted / stride - 1e-9), _FEWEST_STEPS), _MOST_STEPS)
    dt = _rounded_up(wanted / horizon) if options.dt is None else float(options.dt)
    asked = " (as asked)"
    choices["dt"] = f"{dt:g} s" + (asked if options.dt else "")
    choices["horizon"] = (
        f"{horizon} steps{asked if options.horizon else ''}: {dt * horizon:g} s, "
        f"the least time being {least:.4g} s"
    )
    if dt * horizon < least:
        warnings.append(f"{dt * horizon:g} s are too short: a vehicle needs at least {least:.4g} s")
    return dt, horizon


def _noise(vehicle: ForeignVehicle, dt: float, horizon: int, options: ImportOptions) -> _Noise:
    """Return the noise whose spread at the end is wanted, with feedback on long horizons."""
    system = double_integrator(dt, vehicle.start.size)
    d = system.dimension
    # Like the paper's at dt = 1 s: a tenth of the variance on the velocity.
    shape = np.diag([1.0] * d + [0.1 / dt**2] * d)
    gain: Matrix | None = None
    if horizon > _LONG_HORIZON:
        # Adding zero turns the -0.0 beside the diagonals into 0.0.
        gain = np.kron([[_GAIN[0] / dt**2, _GAIN[1] / dt]], np.eye(d)) + np.zeros((d, 2 * d))
    for candidate in (gain, None):
        growth = covariances(system, shape, shape, candidate, horizon)
        spread = float(np.sqrt(growth[-1, 0, 0]))
        std = options.noise or _rounded_up(_SPREAD * vehicle.radius / spread, 3)
        if candidate is None:
            break
        effort = np.einsum("an,knm,am->ka", candidate, growth, candidate)
        # A step too short for the noise would leave the feedback no control to give.
        if 3.0 * std * np.sqrt(effort.max()) <= _MOST_RESERVE * vehicle.control_limit:
            break
    return _Noise(std**2 * shape, candidate, std, std * spread)


def _tell_noise(
    vehicles: tuple[ForeignVehicle, ...],
    noises: list[_Noise],
    options: ImportOptions,
    choices: dict[str, str],
) -> None:
    """Say how large the noise is and what holds it."""
    stds = " or ".join(f"{std:g}" for std in sorted({noise.std for noise in noises}))
    spreads = sorted({n.final / v.radius for v, n in zip(vehicles, noises, strict=True)})
    choices["noise"] = (
        f"standard deviation {stds} m in position per step{' (as asked)' if options.noise else ''}"
        f", {spreads[0]:.2g} radius at the end; per axis, a tenth of the variance on "
        "velocity times dt"
    )
    if any(noise.gain is not None for noise in noises):
        choices["feedback"] = f"gain {_GAIN[0]:g}/dt² on position, {_GAIN[1]:g}/dt on velocity"
    else:
        choices["feedback"] = "none: the horizon is short"


def _workspace(
    problem: ForeignProblem, noises: list[_Noise], choices: dict[str, str], warnings: list[str]
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


def _vehicle(vehicle: ForeignVehicle, dt: float, noise: _Noise) -> Vehicle:
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


def _rounded_up(value: float, num_digits: int = 2) -> float:
    """Return the next larger number of so many digits."""
    digits = num_digits - 1 - math.floor(math.log10(value))
    return round(math.ceil(value * 10.0**digits - 1e-9) / 10.0**digits, digits)
