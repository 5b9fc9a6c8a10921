"""Drift, disturbance and measurement as files state them, to and from a vehicle's."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from radmpc.arrays import Matrix, Vector, as_covariance, as_vector
from radmpc.errors import ScenarioError
from radmpc.io.native.schema import DriftSpec, MeasurementSpec, VehicleSpec
from radmpc.model.dynamics import LinearSystem

if TYPE_CHECKING:
    from radmpc.model.noise.measurement import Measurement

__all__ = [
    "build_disturbance",
    "build_drift",
    "build_measurement",
    "correlation_of",
    "encode_correlation",
    "encode_drift",
    "encode_sensor",
]


def build_disturbance(spec: VehicleSpec, num_states: int, dt: float) -> tuple[Matrix, float]:
    """Return the covariance of the disturbance, and its correlation from step to step.

    Parameters
    ----------
    spec : VehicleSpec
        What the file gives, defaults included.
    num_states : int
        Length n of the state.
    dt : float
        Step [s].

    Returns
    -------
    (n, n) array
        Covariance W.
    float
        Correlation ρ [-]; 0 where each step's disturbance is new.

    Raises
    ------
    ScenarioError
        If two descriptions are given, or one is not allowed.
    """
    given = spec.disturbance
    if given is None:
        path: tuple[str, ...] = ("disturbance_covariance",)
        return as_covariance(spec.disturbance_covariance, num_states, path), 0.0
    if "disturbance_covariance" in spec.model_fields_set:
        text = "needs only one of: disturbance, disturbance_covariance; got both"
        raise ScenarioError(text, ("disturbance",))
    covariance = as_covariance(given.covariance, num_states, ("disturbance", "covariance"))
    try:
        return covariance, correlation_of(given.time_constant, given.correlation, dt)
    except ScenarioError as error:
        raise error.under("disturbance") from error


def correlation_of(time_constant: float | None, correlation: float | None, dt: float) -> float:
    """Return the correlation of consecutive steps that either number states, 0 without any.

    Parameters
    ----------
    time_constant : float or None
        τ [s], above 0.
    correlation : float or None
        ρ itself [-].
    dt : float
        Step [s].

    Raises
    ------
    ScenarioError
        If both are given, or the time constant is not above 0.
    """
    if time_constant is None:
        return 0.0 if correlation is None else correlation
    if correlation is not None:
        raise ScenarioError("needs only one of: time_constant, correlation; got both", ())
    if time_constant <= 0.0:
        raise ScenarioError(f"must be > 0 s, got {time_constant}", ("time_constant",))
    return math.exp(-dt / time_constant)


def encode_correlation(correlation: float, dt: float) -> dict[str, object]:
    """Return a correlation as a time constant where that loses nothing, else as it is.

    Parameters
    ----------
    correlation : float
        ρ from step to step, above 0 [-].
    dt : float
        Step [s].
    """
    constant = round(-dt / math.log(correlation), 9)
    if 0.0 < constant <= 1e9 and math.exp(-dt / constant) == correlation:
        return {"time_constant": constant}
    return {"correlation": correlation}


def build_drift(spec: DriftSpec | None, system: LinearSystem, dt: float) -> Vector | None:
    """Return what is added to the state at every step, (n,).

    Parameters
    ----------
    spec : DriftSpec or None
        What the file gives; None is no drift.
    system : LinearSystem
        The vehicle's dynamics.
    dt : float
        Step [s].

    Returns
    -------
    (n,) array or None
        None is none.

    Raises
    ------
    ScenarioError
        If neither or both are given, or one has another length.
    """
    if spec is None:
        return None
    if spec.state is not None and spec.velocity is None:
        return as_vector(spec.state, system.num_states, ("drift", "state"))
    if spec.velocity is not None and spec.state is None:
        velocity = as_vector(spec.velocity, system.dimension, ("drift", "velocity"))
        state = np.zeros(system.num_states)
        state[list(system.position)] = velocity * dt
        return state
    got = "both" if spec.state is not None else "none of them"
    raise ScenarioError(f"needs exactly one of: velocity, state; got {got}", ("drift",))


def encode_drift(drift: Vector, system: LinearSystem, dt: float) -> dict[str, object]:
    """Return a drift as a velocity where that loses nothing, else as what is added to the state.

    Parameters
    ----------
    drift : (n,) array
        Added to the state at every step.
    system : LinearSystem
        The vehicle's dynamics.
    dt : float
        Step [s].
    """
    axes = list(system.position)
    velocity = np.round(drift[axes] / dt, 12) + 0.0
    state = np.zeros(drift.size)
    state[axes] = velocity * dt
    if state.tobytes() == drift.tobytes():
        return {"velocity": velocity.tolist()}
    return {"state": drift.tolist()}


def build_measurement(spec: MeasurementSpec | None, num_states: int) -> Measurement | None:
    """Return what a vehicle measures.

    Parameters
    ----------
    spec : MeasurementSpec or None
        What the file gives; None is that the state is known exactly.
    num_states : int
        Length n of the state.

    Returns
    -------
    Measurement or None
        None as above.

    Raises
    ------
    ScenarioError
        If neither or both of states and matrix are given, or one is not allowed.
    """
    if spec is None:
        return None
    from radmpc.model.noise.measurement import Measurement  # noqa: PLC0415 - few measure

    try:
        if spec.of is not None and spec.matrix is None:
            return Measurement.of(spec.of, num_states, spec.covariance)
        if spec.matrix is not None and spec.of is None:
            return Measurement(spec.matrix, spec.covariance)
    except ScenarioError as error:
        raise error.under("measurement") from error
    got = "both" if spec.of is not None else "none of them"
    raise ScenarioError(f"needs exactly one of: of, matrix; got {got}", ("measurement",))


def encode_sensor(measurement: Measurement) -> dict[str, object]:
    """Return what is measured: states where it is states, else the matrix.

    Parameters
    ----------
    measurement : Measurement
        Whose matrix is written.
    """
    matrix = measurement.matrix
    states = matrix.argmax(axis=1).tolist()
    if len(set(states)) == len(states):
        again = np.eye(matrix.shape[1])[states]
        if again.tobytes() == matrix.tobytes():
            return {"of": states}
    return {"matrix": matrix.tolist()}
