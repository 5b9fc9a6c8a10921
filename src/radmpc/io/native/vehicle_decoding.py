"""From a vehicle's entry in a scenario file to a `Vehicle`."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Vector, as_axes, as_covariance, as_matrix, as_vector
from radmpc.errors import ScenarioError, all_checked
from radmpc.io.native.boxes import box_of, build_visits
from radmpc.io.native.noise import build_disturbance, build_drift, build_measurement
from radmpc.io.native.schema import (
    DynamicsSpec,
    FeedbackSpec,
    GoalSpec,
    LqrSpec,
    NormSpec,
    ScenarioSpec,
    VehicleSpec,
)
from radmpc.model.dynamics import LinearSystem, double_integrator, lqr_gain
from radmpc.model.numbers import check_vehicle_numbers
from radmpc.model.states import as_state
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.ranges import check_range

__all__ = ["Shared", "build_goal", "build_vehicle", "check_step"]

_REQUIRED = ("name", "start", "radius", "control_limit")


def check_step(spec: ScenarioSpec) -> None:
    """Refuse a length of steps that is none, or too long for the double integrators there are.

    Parameters
    ----------
    spec : ScenarioSpec
        What the file gives.

    Raises
    ------
    ScenarioError
        With what is allowed.
    """
    dt = check_range(spec.dt, "s", ("dt",))
    usual = spec.defaults.dynamics
    own = (v.dynamics if "dynamics" in v.model_fields_set else usual for v in spec.vehicles)
    if any(dynamics.model is not None for dynamics in own):
        double_integrator(dt, 2)


class Shared:
    """Dynamics and gains made once for all vehicles that take them from the defaults.

    Parameters
    ----------
    dt : float
        Step [s].
    """

    def __init__(self, dt: float) -> None:
        self.dt = dt
        # By identity: what comes from the defaults is the same object for every vehicle. The
        # file's content outlives this, so no identity is used twice.
        self._systems: dict[tuple[int, int], LinearSystem] = {}
        self._gains: dict[tuple[int, int], Matrix] = {}

    def system(self, spec: DynamicsSpec, dimension: int) -> LinearSystem:
        """Return the dynamics; a double integrator has the goal's number of axes.

        Parameters
        ----------
        spec : DynamicsSpec
            What the file gives.
        dimension : int
            Number of axes, 2 or 3.
        """
        key = (id(spec), dimension)
        if key not in self._systems:
            self._systems[key] = _system(spec, self.dt, dimension)
        return self._systems[key]

    def gain(self, spec: FeedbackSpec | None, system: LinearSystem) -> Matrix | None:
        """Return the feedback gain, None in open loop.

        Parameters
        ----------
        spec : FeedbackSpec or None
            What the file gives; None is open loop.
        system : LinearSystem
            The vehicle's dynamics.
        """
        if spec is None:
            return None
        key = (id(spec), id(system))
        if key not in self._gains:
            self._gains[key] = _gain(spec, system)
        return self._gains[key]


def build_vehicle(spec: VehicleSpec, shared: Shared) -> Vehicle:
    """Return a vehicle.

    Parameters
    ----------
    spec : VehicleSpec
        What the file gives for it, defaults included.
    shared : Shared
        What vehicles have in common.

    Returns
    -------
    Vehicle
        Checked.

    Raises
    ------
    ScenarioError
        With a path within the vehicle.
    """
    for name in _REQUIRED:
        if name not in spec.model_fields_set:
            raise _missing(name)
    if spec.goal is None:
        raise _missing("goal")
    goal_spec = spec.goal
    numbers = (spec.radius, spec.control_sigmas, spec.cost_weight)
    all_checked(lambda: box_of(goal_spec, "goal"), lambda: check_vehicle_numbers(*numbers))
    lower, _ = box_of(goal_spec, "goal")
    system = shared.system(spec.dynamics, lower.size)
    d, n, m = system.dimension, system.num_states, system.num_controls
    control_limit, control_norm = _limit(spec.control_limit)
    speed_limit, speed_norm = (None, None) if spec.speed_limit is None else _limit(spec.speed_limit)
    disturbance, correlation = build_disturbance(spec, n, shared.dt)
    return Vehicle(
        name=spec.name,
        system=system,
        start=as_state(spec.start, system),
        goal=build_goal(goal_spec, system, "goal"),
        radius=spec.radius,
        control_limit=as_axes(control_limit, m, ("control_limit",)),
        initial_covariance=as_covariance(spec.initial_covariance, n, ("initial_covariance",)),
        disturbance_covariance=disturbance,
        speed_limit=(None if speed_limit is None else as_axes(speed_limit, d, ("speed_limit",))),
        gain=shared.gain(spec.feedback, system),
        control_sigmas=spec.control_sigmas,
        cost_weight=spec.cost_weight,
        drift=build_drift(spec.drift, system, shared.dt),
        disturbance_correlation=correlation,
        measurement=build_measurement(spec.measurement, n),
        via=build_visits(spec.via, spec.survey, d),
        control_norm=control_norm,
        speed_norm=speed_norm,
    )


def _limit(
    spec: float | list[float] | NormSpec,
) -> tuple[float | list[float], float | None]:
    """Return limits per axis, and the one of the norm."""
    if not isinstance(spec, NormSpec):
        return spec, None
    return (spec.norm if spec.axes is None else spec.axes), spec.norm


def _missing(name: str) -> ScenarioError:
    """Return the error of a field that stands nowhere."""
    return ScenarioError("is required, here or in defaults", (name,))


def build_goal(spec: GoalSpec, system: LinearSystem, *path: str | int) -> Goal:
    """Return a goal; where a velocity exists, the speed is 0 unless stated.

    Parameters
    ----------
    spec : GoalSpec
        What the file gives.
    system : LinearSystem
        Dynamics of the vehicles that go there.
    *path : str or int
        Where it stands.

    Raises
    ------
    ScenarioError
        If it is no goal for them.
    """
    lower, upper = box_of(spec, *path)
    is_given = "speed" in spec.model_fields_set
    if system.velocity is None and spec.speed is not None:
        raise ScenarioError("needs dynamics whose velocity indices are given", (*path, "speed"))
    speed: Vector | None = None
    if system.velocity is not None and not is_given:
        speed = np.zeros(lower.size)
    elif spec.speed is not None:
        speed = as_axes(spec.speed, lower.size, (*path, "speed"))
    try:
        return Goal(lower, upper, speed, spec.within)
    except ScenarioError as error:
        raise error.under(*path) from error


def _system(spec: DynamicsSpec, dt: float, dimension: int) -> LinearSystem:
    """Return the dynamics of a named model or of matrices."""
    names = ("A", "B", "position", "velocity")
    given = [name for name in names if getattr(spec, name) is not None]
    if spec.model is not None and not given:
        return double_integrator(dt, dimension)
    if spec.model is None and spec.A is not None and spec.B is not None and spec.position:
        try:
            velocity = None if spec.velocity is None else tuple(spec.velocity)
            return LinearSystem(
                as_matrix(spec.A, path=("A",)),
                as_matrix(spec.B, path=("B",)),
                tuple(spec.position),
                velocity,
            )
        except ScenarioError as error:
            raise error.under("dynamics") from error
    raise ScenarioError(
        "needs either model, or A, B and position (and velocity); "
        f"got {' and '.join((['model'] if spec.model else []) + given) or 'none of them'}",
        ("dynamics",),
    )


def _gain(spec: FeedbackSpec, system: LinearSystem) -> Matrix:
    """Return the gain as given or as the regulator's."""
    if spec.gain is not None and spec.lqr is None:
        return as_matrix(spec.gain, (system.num_controls, system.num_states), ("feedback", "gain"))
    if spec.lqr is not None and spec.gain is None:
        try:
            return _regulator(spec.lqr, system)
        except ScenarioError as error:
            raise error.under("feedback", "lqr") from error
    got = "both" if spec.gain is not None else "none of them"
    raise ScenarioError(f"needs exactly one of: gain, lqr; got {got}", ("feedback",))


def _regulator(spec: LqrSpec, system: LinearSystem) -> Matrix:
    """Return the regulator's gain."""
    Q = _square(spec.Q, system.num_states, ("Q",))
    R = _square(spec.R, system.num_controls, ("R",))
    return lqr_gain(system, Q, R)


def _square(
    value: float | list[float] | list[list[float]], size: int, path: tuple[str | int, ...]
) -> Matrix:
    """Return a matrix from a scalar, a diagonal or itself."""
    array = np.array(value)
    if array.ndim == 2:
        return as_matrix(array, (size, size), path)
    diagonal = np.full(size, array) if array.ndim == 0 else as_vector(array, size, path)
    return np.diag(diagonal)
