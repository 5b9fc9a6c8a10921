"""Shortcuts: a span of the controls replaced by cheaper ones between the same states."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.solvers.rrt.connect import ROUNDS, connect
from radmpc.solvers.rrt.course import Course
from radmpc.solvers.solution import Limits

__all__ = ["Shortcuts"]

_MIN_GAIN = 1e-3
"""Relative gain below which shortening stops [-]."""

_MAX_SPANS = 24
"""Spans tried at once, those that would gain most [-]."""

_RANK_TOL = 1e-9
"""Remainder of a row that counts as 0, as a share of the longest row [-]."""

_PARTS = np.array([1.0, 0.7, 0.4, 0.2, 0.1, 0.05])
"""Shares of the step toward a cheaper course that are tried [-]: all of them keep the states at
both ends of the span."""


class Shortcuts:
    """Shortens courses of one vehicle.

    Parameters
    ----------
    course : Course
        The vehicle.
    """

    def __init__(self, course: Course) -> None:
        self.course = course
        begins, ends = np.triu_indices(course.horizon, 1)
        self._ends = ends
        self._inside = course.steps >= begins[:, None]
        self._inside &= course.steps < ends[:, None]
        self._rows = _seen_later(course)
        self._tails = _tails(course)

    def shorten(self, controls: Vector, limits: Limits, rounds: int = ROUNDS) -> Vector:
        """Replace spans as long as that pays.

        Parameters
        ----------
        controls : (c,) array
            Controls that satisfy the program.
        limits : Limits
            When to stop early.
        rounds : int
            See `radmpc.solvers.rrt.connect.connect`.

        Returns
        -------
        (c,) array
            Controls that satisfy it too, at no more cost.
        """
        course = self.course
        cost = float(course.costs(controls[None])[0])
        while not limits.reached:
            shorter = self._shorter(controls, rounds)
            gains = cost - course.costs(shorter)
            promising = np.argsort(-gains, kind="stable")[:_MAX_SPANS]
            promising = promising[gains[promising] > _MIN_GAIN * cost]
            if promising.size == 0:
                break
            moves = shorter[promising] - controls
            tried = (controls + _PARTS[:, None, None] * moves).reshape(-1, controls.size)
            is_kept = course.failures(tried) > course.horizon
            costs = np.where(is_kept, course.costs(tried), float("inf"))
            least = int(costs.argmin())
            if costs[least] >= cost * (1.0 - _MIN_GAIN):
                break
            controls, cost = tried[least], float(costs[least])
        return controls

    def _shorter(self, controls: Vector, rounds: int) -> Matrix:
        """Return the controls with each span replaced, those up to the goal last."""
        rows = self._rows[self._ends]
        replaced = np.where(self._inside, controls, 0.0)
        needs = (rows @ replaced[:, :, None])[:, :, 0]
        found = connect(rows, needs, self._inside * self.course.limits, rounds)
        tails = np.tile(controls, (len(self._tails), 1))
        home = self.course.to_goal(tails, self._tails, rounds)
        return np.concatenate([controls - replaced + found, home])


def _tails(course: Course) -> np.ndarray:
    """Return the controls from each step on, all of them and one axis at a time, (s, c)."""
    num_axes = course.steps.size // course.horizon
    is_tail = course.steps >= np.arange(course.horizon)[:, None]
    is_axis = np.arange(course.steps.size) % num_axes == np.arange(num_axes)[:, None]
    return np.vstack([is_tail, *(is_tail & one for one in is_axis)])


def _seen_later(course: Course) -> Tensor:
    """Return how later conditions depend on the controls before each step, (T, q, c): the state."""
    T, size = course.horizon, course.steps.size
    bases = []
    for end in range(T):
        later = np.vstack(
            [course.positions[end + 1 :].reshape(-1, size), course.hard[course.hard_levels > end]]
        )
        later = np.where(course.steps < end, later, 0.0)
        bases.append(_basis(later))
    width = max([len(b) for b in bases], default=0)
    rows = np.zeros((T, width, size))
    for end, basis in enumerate(bases):
        rows[end, : len(basis)] = basis
    return rows


def _basis(rows: Matrix) -> Matrix:
    """Return an orthonormal basis of what some rows span, (q, c).

    Later conditions depend on the past through the state: few vectors span hundreds of rows.
    Gram–Schmidt with the longest remainder first finds them without a decomposition of the whole,
    whose threads wait for each other where the machine is busy.
    """
    found: list[Vector] = []
    left = rows
    lengths = np.sqrt(np.square(left).sum(axis=1))
    least = _RANK_TOL * lengths.max(initial=_RANK_TOL)
    while len(found) < min(rows.shape) and lengths.max(initial=0.0) > least:
        axis = left[lengths.argmax()]
        for earlier in found:
            # Once more: the first subtraction left a little by rounding.
            axis = axis - (axis @ earlier) * earlier
        axis = axis / np.sqrt(np.square(axis).sum())
        found.append(axis)
        left = left - (left * axis).sum(axis=1)[:, None] * axis
        lengths = np.sqrt(np.square(left).sum(axis=1))
    return np.array(found).reshape(len(found), rows.shape[1])
