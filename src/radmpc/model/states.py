"""States of vehicles from what users write."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Vector, as_vector, frozen
from radmpc.errors import ScenarioError
from radmpc.model.dynamics import LinearSystem
from radmpc.ranges import sized

__all__ = ["as_state"]


def as_state(value: npt.ArrayLike, system: LinearSystem) -> Vector:
    """Return a full state from one, or from a position, at rest elsewhere.

    Parameters
    ----------
    value : (n,) or (d,) array_like
        A state, or a position [m].
    system : LinearSystem
        The vehicle's dynamics.

    Raises
    ------
    ScenarioError
        If it is neither, or too large.
    """
    given = sized(as_vector(value, path=("start",)), ("start",))
    d, n = system.dimension, system.num_states
    if given.size == n:
        return given
    if given.size != d:
        allowed = f"{d} numbers (a position)" + (f" or {n} (a full state)" if n != d else "")
        raise ScenarioError(f"must have {allowed}, got {given.size}", ("start",))
    state = np.zeros(n)
    state[list(system.position)] = given
    return frozen(state)
