"""Drift as files state it, to and from a vehicle's."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Vector, as_vector
from radmpc.errors import ScenarioError
from radmpc.io.native.schema import DriftSpec
from radmpc.model.dynamics import LinearSystem

__all__ = ["build_drift", "encode_drift"]


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
