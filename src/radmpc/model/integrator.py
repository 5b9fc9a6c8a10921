"""Which linear systems are double integrators, and closed loops of any from what users write."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.arguments import value_text
from radmpc.arrays import Matrix, as_covariance, as_matrix
from radmpc.errors import ScenarioError

__all__ = ["check_stated", "closed_loop", "integrator_rates"]

_SAME = 1e-9
"""Relative difference below which two matrix entries are one: what files lose to rounding."""


def integrator_rates(
    A: Matrix, B: Matrix, position: tuple[int, ...]
) -> tuple[tuple[int, ...], float] | None:
    """Return velocity indices and step of a double integrator in any order of its states.

    Parameters
    ----------
    A : (n, n) array
        State matrix.
    B : (n, m) array
        Control matrix.
    position : tuple of int
        State indices of the position, one per axis.

    Returns
    -------
    tuple or None
        State index of the velocity of each axis, and the step [s]; None for any other system.
    """
    place = list(position)
    rest = [i for i in range(len(A)) if i not in place]
    if len(rest) != len(place):
        return None
    link = A[np.ix_(place, rest)]
    step = float(np.abs(link).max())
    order = np.abs(link).argmax(axis=1)
    velocity = [rest[i] for i in order]
    expected = np.eye(len(A))
    expected[place, velocity] = step
    if step <= 0.0 or len(set(velocity)) < len(rest):
        return None
    is_same = np.allclose(A, expected, rtol=_SAME, atol=_SAME * max(step, 1.0))
    half = 0.5 * step * B[velocity]
    if not is_same or not np.allclose(B[place], half, rtol=_SAME, atol=_SAME * np.abs(half).max()):
        return None
    return tuple(velocity), step


def check_stated(stated: object, rates: object) -> None:
    """Refuse what says wrongly that a system is a double integrator, or says nothing.

    Parameters
    ----------
    stated : object
        Whether it is said to be one.
    rates : tuple or None
        What `integrator_rates` found.

    Raises
    ------
    ScenarioError
        If it is not as stated.
    """
    if not isinstance(stated, (bool, np.bool_)):
        text = f"must be true or false, got {value_text(stated)}"
        raise ScenarioError(text, ("is_double_integrator",))
    if stated and rates is None:
        raise ScenarioError(
            "A and B are not those of a double integrator: positions must be carried by their "
            "velocities, and velocities by the controls, each held over the step",
            ("is_double_integrator",),
        )


def closed_loop(
    A: Matrix,
    B: Matrix,
    initial: npt.ArrayLike,
    disturbance: npt.ArrayLike,
    gain: npt.ArrayLike | None,
) -> tuple[Matrix, Matrix, Matrix]:
    """Return both covariances as matrices, and what a step makes of a deviation, ``A + B K``.

    Parameters
    ----------
    A, B : (n, n) and (n, m) array
        The dynamics.
    initial, disturbance : (n, n) array_like
        Covariance at k = 0, and of the disturbance; one number or a diagonal is taken as well.
    gain : (m, n) array_like or None
        Feedback K; None is open loop.

    Raises
    ------
    ScenarioError
        If one is no covariance, or does not fit the dynamics.
    """
    n, m = B.shape
    first = as_covariance(initial, n, ("initial",), np.inf)
    added = as_covariance(disturbance, n, ("disturbance",), np.inf)
    if gain is None:
        return first, added, A
    return first, added, A + B @ as_matrix(gain, (m, n), ("gain",))
