r"""The referee's own closed loop of a vehicle, as one linear system under fresh noise.

The loop's state ζ begins with the deviation :math:`\delta = x - \bar x`. A disturbance that is
correlated in time is part of it, as what will be added over the step that follows:

.. math:: \delta^+ = (A + BK)\,\delta + w, \qquad w^+ = \rho\, w + \epsilon, \quad
          \epsilon \sim N(0, (1 - \rho^2)\, W).

Of a vehicle that measures, ζ holds all that once more: as estimated, by a Kalman filter that sees
:math:`y = C x + v` at every step before the control is chosen. With ξ for what there is and
:math:`\hat\xi` for the estimate of it, G for what happens without control and L for the gain of the
step that follows,

.. math:: \xi^+ = G\,\xi + BK\,\hat\xi + \epsilon, \qquad
          \hat\xi^+ = (G + BK)\,\hat\xi + L\,\bigl(H\,(G\,(\xi - \hat\xi) + \epsilon) + v\bigr).

A disturbance that others meet, too, is part of ζ if it lasts, and of the noise if it does not. What
is new in it is made of standard normals that are the same for all, and kept apart from the rest.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from radmpc.arrays import Matrix, Tensor, frozen
from radmpc.model.noise.contents import Keyed, contents
from radmpc.model.noise.shared import SharedDisturbance
from radmpc.model.vehicle import Vehicle
from radmpc.records import dataclass, field, replace

__all__ = ["Common", "Loop", "loop_of"]

_LEARNED = "\0"
"""Stands for no source but for what all vehicles learned before k = 0."""

_NOTHING = 1e-12
"""Share of the largest eigenvalue of what a sensor sees below which one is rounding [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Common:
    """What a loop has of the noise that others meet, too, and what it has alone.

    Attributes
    ----------
    columns : mapping of str to slice
        Those of each source in what follows.
    first : (q, R) array
        What the sources' first standard normals make of ζ at k = 0.
    pushes : (S, q, R) array
        What those of every step add.
    own_initial, own_disturbances : (q, q) and (S, q, q) array
        Covariances of all other noise.
    """

    columns: Mapping[str, slice]
    first: Matrix
    pushes: Tensor
    own_initial: Matrix
    own_disturbances: Tensor


@dataclass(frozen=True, slots=True, eq=False)
class Loop:
    """A vehicle's closed loop, ``ζ⁺ = F ζ + noise``.

    Attributes
    ----------
    transitions, disturbances : (S, q, q) array
        F, and the covariance of the noise, at every step; one for all where S is 1.
    initial : (q, q) array
        Covariance of ζ at k = 0.
    seen : int
        Where in ζ the deviation begins that feedback acts on: 0 where it is known exactly.
    common : Common or None
        The noise that others meet, too; None is none.
    unknown : (T+1, q, q) array or None
        Covariance of ζ given all that is measured up to each step: the state itself, or what the
        filter makes of it. None is that nothing is left open but shared noise.
    """

    transitions: Tensor
    disturbances: Tensor
    initial: Matrix
    seen: int
    common: Common | None = None
    unknown: Tensor | None = None

    def __post_init__(self) -> None:
        """Freeze what is kept for later."""
        for array in (self.transitions, self.disturbances, self.initial, self.unknown):
            if array is not None:
                frozen(array)


@dataclass(slots=True, eq=False)
class _Open:
    """What there is, ξ: what becomes of it freely and by feedback, and its noise.

    ``first`` and ``pushes``, (p, R) arrays, are those of `Common`; ``initial`` and ``fresh`` the
    covariances of all other noise.
    """

    free: Matrix
    pushed: Matrix
    initial: Matrix
    fresh: Matrix
    first: Matrix
    pushes: Matrix
    columns: dict[str, slice] = field(default_factory=dict)

    def total(self) -> tuple[Matrix, Matrix]:
        """Return the covariances of ξ at k = 0 and of the noise of every step."""
        if not self.columns:
            return self.initial, self.fresh
        return (
            self.initial + self.first @ self.first.T,
            self.fresh + self.pushes @ self.pushes.T,
        )


@lru_cache(maxsize=64)
def loop_of(vehicle: Vehicle, horizon: int) -> Loop:
    """Return the closed loop of a vehicle, the same again for it and for all with an equal one.

    A planner has plan after plan of one fleet judged, and a filter takes long.

    Parameters
    ----------
    vehicle : Vehicle
        Dynamics, feedback and noise are taken from it.
    horizon : int
        Number of steps T.
    """
    noise = vehicle.initial_covariance, vehicle.disturbance_covariance
    lasting = vehicle.disturbance_correlation, vehicle.shared, vehicle.belief
    alike = contents((vehicle.system, noise, lasting, vehicle.measurement, vehicle.gain))
    return _loop_of_alike(Keyed(vehicle, alike), horizon)


@lru_cache(maxsize=64)
def _loop_of_alike(one: Keyed, horizon: int) -> Loop:
    """Return the closed loop of any of the vehicles with equal dynamics, feedback and noise."""
    vehicle: Vehicle = one.value
    n = vehicle.system.num_states
    initial, fresh = vehicle.initial_covariance, vehicle.disturbance_covariance
    free, pushed = vehicle.system.A, np.zeros((n, n))
    if vehicle.gain is not None:
        pushed = vehicle.system.B @ vehicle.gain
    rho = vehicle.disturbance_correlation
    if rho > 0.0:
        free = _stacked(free, np.eye(n), rho * np.eye(n))
        none = np.zeros((n, n))
        pushed = _stacked(pushed, none, none)
        initial = _stacked(initial, none, fresh)
        if vehicle.belief is not None:
            initial = vehicle.belief.covariance
        fresh = _stacked(none, none, (1.0 - rho * rho) * fresh)
    elif vehicle.belief is not None:
        initial = vehicle.belief.covariance[:n, :n]
    nothing = np.zeros((len(free), 0))
    xi = _Open(free, pushed, initial, fresh, nothing, nothing)
    for part in vehicle.shared:
        xi = _widened(xi, part)
    if vehicle.belief is not None and vehicle.belief.common is not None:
        xi = _learned(xi, vehicle, vehicle.belief.common)
    if vehicle.measurement is not None:
        return _filtered(vehicle, xi, horizon)
    closed = xi.free if vehicle.gain is None else xi.free + xi.pushed
    initial, fresh = xi.total()
    unknown = None
    if rho > 0.0 and all(part.correlation == 0.0 for part in vehicle.shared):
        # A state tells of disturbances that have come in, never of the one that follows it.
        unknown = np.zeros((horizon + 1, *initial.shape))
        unknown[0, n:, n:], unknown[1:] = initial[n:, n:], fresh
    if not xi.columns:
        return Loop(closed[None], fresh[None], initial, 0, None, unknown)
    common = Common(xi.columns, xi.first, xi.pushes[None], xi.initial, xi.fresh[None])
    return Loop(closed[None], fresh[None], initial, 0, common, unknown)


def _widened(xi: _Open, part: SharedDisturbance) -> _Open:
    """Return what there is with one more disturbance that others meet, too."""
    values, vectors = np.linalg.eigh(part.covariance)
    root = vectors * np.sqrt(values.clip(min=0.0))
    n, p, r = len(part.matrix), len(xi.free), part.size
    effect = np.zeros((p, r))
    effect[:n] = part.matrix
    start = xi.first.shape[1]
    columns = {**xi.columns, part.name: slice(start, start + r)}
    if part.correlation == 0.0:
        first = np.hstack([xi.first, np.zeros((p, r))])
        pushes = np.hstack([xi.pushes, effect @ root])
        return _Open(xi.free, xi.pushed, xi.initial, xi.fresh, first, pushes, columns)
    rho, none = part.correlation, np.zeros((p, r))
    wide = ((0, r), (0, r))
    below = (np.zeros((r, start)), np.sqrt(1.0 - rho * rho) * root)
    return _Open(
        _stacked(xi.free, effect, rho * np.eye(r)),
        np.pad(xi.pushed, wide),
        np.pad(xi.initial, wide),
        np.pad(xi.fresh, wide),
        np.block([[xi.first, none], [below[0], root]]),
        np.block([[xi.pushes, none], list(below)]),
        columns,
    )


def _learned(xi: _Open, vehicle: Vehicle, common: Matrix) -> _Open:
    """Return what there is with what lasts as it is known, together with other vehicles."""
    n = vehicle.system.num_states
    state, own, lasting = np.split(common, [n, 2 * n])
    start = xi.first.shape[1]
    columns = {**xi.columns, _LEARNED: slice(start, start + common.shape[1])}
    rows = [state, own, lasting] if vehicle.disturbance_correlation > 0.0 else [state, lasting]
    first = np.hstack([np.zeros_like(xi.first), np.vstack(rows)])
    pushes = np.pad(xi.pushes, ((0, 0), (0, common.shape[1])))
    return _Open(xi.free, xi.pushed, xi.initial, xi.fresh, first, pushes, columns)


def _stacked(first: Matrix, second: Matrix, last: Matrix) -> Matrix:
    """Return an upper block triangle."""
    return np.block([[first, second], [np.zeros_like(second.T), last]])


def _filtered(vehicle: Vehicle, xi: _Open, horizon: int) -> Loop:
    """Return the loop of a vehicle and its filter.

    Parameters
    ----------
    vehicle : Vehicle
        With a measurement.
    xi : _Open
        What there is.
    horizon : int
        Number of steps T.
    """
    free, pushed = xi.free, xi.pushed
    initial, fresh = xi.total()
    size = len(free)
    H, R = _sensor(vehicle, size)
    error, gains = initial, []
    unknown = np.zeros((horizon + 1, 2 * size, 2 * size))
    for k in range(horizon + 1):
        gain = error @ H.T @ _inverse(H @ error @ H.T + R)
        if k == 0 and vehicle.belief is not None:
            gain = np.zeros_like(gain)
        gains.append(gain)
        left = np.eye(size) - gain @ H
        after = left @ error @ left.T + gain @ R @ gain.T
        unknown[k, :size, :size] = after
        error = free @ after @ free.T + fresh
    transitions, disturbances = np.empty((2, horizon, 2 * size, 2 * size))
    for k, gain in enumerate(gains[1:]):
        corrected = gain @ H @ free
        transitions[k] = np.block([[free, pushed], [corrected, free + pushed - corrected]])
        disturbances[k] = _told(gain, H, R, fresh)
    begun = _told(gains[0], H, R, initial)
    loop = Loop(transitions, disturbances, begun, size, None, unknown)
    if not xi.columns:
        return loop
    common = Common(
        xi.columns,
        _seen_of(gains[0], H) @ xi.first,
        np.array([_seen_of(gain, H) @ xi.pushes for gain in gains[1:]]),
        _told(gains[0], H, R, xi.initial),
        np.array([_told(gain, H, R, xi.fresh) for gain in gains[1:]]),
    )
    return replace(loop, common=common)


def _sensor(vehicle: Vehicle, size: int) -> tuple[Matrix, Matrix]:
    """Return what a vehicle's sensor sees of a longer state, and its noise."""
    if vehicle.measurement is None:
        return np.zeros((0, size)), np.zeros((0, 0))
    C = vehicle.measurement.matrix
    return np.hstack([C, np.zeros((len(C), size - C.shape[1]))]), vehicle.measurement.covariance


def _told(gain: Matrix, H: Matrix, R: Matrix, noise: Matrix) -> Matrix:
    """Return the joint covariance of a noise, and of what a filter makes of it and of its own."""
    both = _seen_of(gain, H)
    own = np.vstack([np.zeros_like(gain), gain])
    return np.asarray(both @ noise @ both.T + own @ R @ own.T)


def _seen_of(gain: Matrix, H: Matrix) -> Matrix:
    """Return a noise, and what a filter makes of it."""
    return np.vstack([np.eye(H.shape[1]), gain @ H])


def _inverse(matrix: Matrix) -> Matrix:
    """Return the inverse of a covariance where it has one, 0 along all other directions."""
    values, vectors = np.linalg.eigh(0.5 * (matrix + matrix.T))
    seen = values > _NOTHING * max(values.max(initial=0.0), 0.0)
    return np.asarray((vectors[:, seen] / values[seen]) @ vectors[:, seen].T)
