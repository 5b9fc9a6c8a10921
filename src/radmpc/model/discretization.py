"""Noise in continuous time as the covariance of a step: what a scenario's file asks for.

A power spectral density (two-sided) says how fast a variance grows: white noise of density q [x²/s]
adds q t to the variance of x in t seconds. Unlike a covariance per step it does not change with dt.
"""

from __future__ import annotations

from math import ceil, log2

import numpy as np
import numpy.typing as npt

from radmpc.arguments import field_integer, field_number, value_text
from radmpc.arrays import Matrix, as_axes, as_covariance, as_matrix
from radmpc.errors import ScenarioError
from radmpc.ranges import check_range, check_size, sized

__all__ = ["double_integrator_noise", "step_covariance", "white_density"]


def white_density(std: float, time_constant: float) -> float:
    """Return the density of white noise that stands for a disturbance that lasts.

    A disturbance whose autocorrelation is ``std² exp(−|t| / time_constant)``, as of gusts and
    waves, does the same to what it drives over times that are long against its own.

    Parameters
    ----------
    std : float
        Standard deviation of the disturbance, >= 0 [x].
    time_constant : float
        After which it has changed to 37 %, >= 0 [s].

    Returns
    -------
    float
        ``2 std² time_constant`` [x² s].

    Raises
    ------
    ScenarioError
        If a number is negative or not finite.

    Examples
    --------
    >>> white_density(0.5, 10.0)
    5.0
    """
    spread = _not_negative(std, "std", "")
    seconds = _not_negative(time_constant, "time_constant", " s")
    return 2.0 * spread**2 * seconds


def step_covariance(drift: npt.ArrayLike, density: npt.ArrayLike, dt: float) -> Matrix:
    r"""Return the covariance that white noise adds to a state in one step, by Van Loan's method.

    .. math:: W = \int_0^{dt} e^{F s}\, Q\, e^{F^\top s}\, ds

    Parameters
    ----------
    drift : (n, n) array_like
        F of the continuous dynamics ``dx = F x dt + …`` [1/s].
    density : (n, n) array_like, or a number or n numbers for a diagonal
        Q, the power spectral density of what drives each state [x²/s], positive semi-definite.
    dt : float
        Step [s], > 0.

    Returns
    -------
    (n, n) array
        W, what ``disturbance_covariance`` takes [x²].

    Raises
    ------
    ScenarioError
        If a shape does not fit, Q is no covariance, or the step is not above zero.

    Examples
    --------
    >>> import numpy as np
    >>> A = np.array([[0.0, 1.0], [0.0, 0.0]])  # position and velocity
    >>> step_covariance(A, np.diag([0.0, 0.01]), 1.0).round(4)
    array([[0.0033, 0.005 ],
           [0.005 , 0.01  ]])
    """
    step = _above_zero(dt)
    F = sized(as_matrix(drift, path=("drift",)), ("drift",))
    n = len(F)
    F = as_matrix(F, (n, n), ("drift",))
    Q = as_covariance(density, n, ("density",))
    from scipy.linalg import expm  # noqa: PLC0415 - loads slowly

    # What decays within the step grows in the method's other block: halve until neither does much.
    halvings = max(0, ceil(log2(max(step * float(np.abs(F).sum(axis=1).max()), 1.0))))
    part = step / 2**halvings
    blocks = expm(part * np.block([[-F, Q], [np.zeros((n, n)), F.T]]))
    carried = blocks[n:, n:].T
    W = carried @ blocks[:n, n:]
    for _ in range(halvings):
        W = W + carried @ W @ carried.T
        carried = carried @ carried
    return np.asarray(0.5 * (W + W.T))


def double_integrator_noise(
    dt: float,
    dimension: int,
    acceleration: npt.ArrayLike = 0.0,
    velocity: npt.ArrayLike = 0.0,
) -> Matrix:
    """Return the covariance of a step of `double_integrator` under white noise, in closed form.

    Parameters
    ----------
    dt : float
        Step [s], > 0.
    dimension : int
        2 or 3 axes.
    acceleration : number or (d,) array_like
        Density of a random acceleration, as of gusts and waves, per axis [m²/s³].
    velocity : number or (d,) array_like
        Density of a random velocity that moves the position alone, as of eddies in a current, per
        axis [m²/s].

    Returns
    -------
    (2d, 2d) array
        W, what ``disturbance_covariance`` takes [m², m²/s, m²/s²]: positions before velocities.

    Raises
    ------
    ScenarioError
        If a number is negative or not finite, or there are neither 2 nor 3 axes.

    Examples
    --------
    >>> double_integrator_noise(2.0, 2, acceleration=0.03)[[0, 0, 2], [0, 2, 2]]
    array([0.08, 0.06, 0.06])
    """
    step = _above_zero(dt)
    if field_integer(dimension, ("dimension",)) not in (2, 3):
        raise ScenarioError(f"must be 2 or 3, got {value_text(dimension)}", ("dimension",))
    densities = []
    for name, given in (("acceleration", acceleration), ("velocity", velocity)):
        density = sized(as_axes(given, dimension, (name,)), (name,))
        if np.any(density < 0.0):
            raise ScenarioError(f"must be >= 0, got {density.tolist()}", (name,))
        densities.append(np.diag(density))
    pushed, carried = densities
    return np.block(
        [
            [pushed * step**3 / 3.0 + carried * step, pushed * step**2 / 2.0],
            [pushed * step**2 / 2.0, pushed * step],
        ]
    )


def _above_zero(dt: float) -> float:
    """Return a step, or refuse it."""
    return check_range(dt, "s", ("dt",))


def _not_negative(value: float, name: str, unit: str) -> float:
    """Return a number of at least zero, or refuse it."""
    number = field_number(value, (name,))
    if not (np.isfinite(number) and number >= 0.0):
        raise ScenarioError(f"must be >= 0{unit}, got {number}", (name,))
    check_size(number, (name,))
    return number
