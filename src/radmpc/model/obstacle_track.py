r"""A rigid outline on a track at constant velocity, known up to Gaussian noise.

With position p and velocity v the track is

.. math:: \begin{pmatrix} p \\ v \end{pmatrix}^{\!+} = \begin{pmatrix} I & dt\, I \\ 0 & I
          \end{pmatrix} \begin{pmatrix} p \\ v \end{pmatrix} + w, \qquad w \sim N(0, W),

new at every step. Between steps the outline moves linearly, as those given step by step do.
"""

from __future__ import annotations

from collections.abc import Sized
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from radmpc.arguments import check_integer, is_integer
from radmpc.arrays import (
    Frozen,
    Matrix,
    Tensor,
    Vector,
    as_covariance,
    as_matrix,
    as_vector,
    frozen,
    unchecked,
)
from radmpc.errors import ArgumentError, ScenarioError
from radmpc.ranges import check_range, check_steps, sized
from radmpc.records import dataclass

__all__ = ["TrackShape", "TrackSpread", "check_step", "is_empty"]


def is_empty(value: object) -> bool:
    """Whether a value has a length, and it is 0.

    Parameters
    ----------
    value : object
        What was given.
    """
    if isinstance(value, np.ndarray):  # which has a length only with an axis
        return value.size == 0
    return isinstance(value, Sized) and not len(value)


def check_step(step: object, last: int, *, is_early: bool) -> None:
    """Refuse a step that what moves does not have.

    Parameters
    ----------
    step : object
        What was given.
    last : int
        The last that there is.
    is_early : bool
        Whether its scenario has yet to lay out the others.

    Raises
    ------
    ArgumentTypeError
        If it is no integer.
    ArgumentError
        If it is out of range.
    """
    try:
        check_integer(step, "step", 0, last)
    except ArgumentError as error:
        if not is_early or not is_integer(step):
            raise
        raise ArgumentError(f"{error}: its scenario lays out the others") from None


@dataclass(frozen=True, slots=True, eq=False)
class TrackSpread(Frozen):
    """How far the true place of an outline is from its mean, at steps and between them.

    Attributes
    ----------
    positions : (T+1, d, d) array
        Covariance of its place at each step [m²].
    crossed : (T, d, d) array
        Covariance of its place at each step with that at the next [m²].
    """

    positions: Tensor
    crossed: Tensor

    def deviation(self, step: int) -> float:
        """Return the largest standard deviation along any direction at a step [m].

        Parameters
        ----------
        step : int
            0..T.
        """
        largest = np.linalg.eigvalsh(self.positions[step])[-1]
        return float(np.sqrt(max(largest, 0.0)))

    def since(self, step: int, horizon: int) -> TrackSpread:
        """Return the same over some steps from one on.

        Parameters
        ----------
        step : int
            The first.
        horizon : int
            How many follow it.
        """
        last = step + horizon
        return TrackSpread(self.positions[step : last + 1], self.crossed[step:last])

    def between(self, steps: npt.NDArray[np.int64], shares: Vector) -> Tensor:
        """Return covariances at shares of the way from steps to the next ones, (i, d, d) [m²].

        Parameters
        ----------
        steps : (i,) int array
            Steps 0..T-1.
        shares : (i,) array
            From 0 to 1 [-].
        """
        s = shares[:, None, None]
        both = self.crossed[steps] + self.crossed[steps].transpose(0, 2, 1)
        here, there = self.positions[steps], self.positions[steps + 1]
        return np.asarray((1.0 - s) ** 2 * here + s**2 * there + s * (1.0 - s) * both)


@dataclass(frozen=True, slots=True, eq=False)
class TrackShape(Frozen):
    """A convex outline that moves along without turning.

    Attributes
    ----------
    outline : (v, d) array
        Points whose hull is the outline, relative to the place on the track [m].
    start : (2 d,) array
        Mean place [m] and velocity [m/s] at k = 0.
    covariance : (2 d, 2 d) array
        Of place and velocity at k = 0 [m², m²/s²]; 0 is known exactly.
    disturbance_covariance : (2 d, 2 d) array
        Of what every step adds to both; 0 is a velocity that never changes.
    """

    outline: Matrix
    start: Vector
    covariance: Matrix
    disturbance_covariance: Matrix

    if TYPE_CHECKING:  # what it takes is wider than what it holds

        def __init__(
            self,
            outline: npt.ArrayLike,
            start: npt.ArrayLike,
            covariance: npt.ArrayLike,
            disturbance_covariance: npt.ArrayLike,
        ) -> None: ...

    def __post_init__(self) -> None:
        """Freeze the arrays; refuse what does not fit."""
        put = object.__setattr__
        if is_empty(self.outline):
            raise ScenarioError("needs at least one point, got none", ("moving", "outline"))
        path = ("moving", "outline")
        outline = sized(as_matrix(self.outline, path=path), path)
        put(self, "outline", outline)
        size = 2 * outline.shape[1]
        start = as_vector(self.start, path=("moving", "start"))
        if start.size != size:
            text = f"must have {size} numbers (a place and a velocity), got {start.size}"
            raise ScenarioError(text, ("moving", "start"))
        put(self, "start", sized(start, ("moving", "start")))
        for name in ("covariance", "disturbance_covariance"):
            put(self, name, as_covariance(getattr(self, name), size, ("moving", name)))

    @property
    def dimension(self) -> int:
        """Number of coordinates."""
        return int(self.outline.shape[1])

    @property
    def is_uncertain(self) -> bool:
        """Whether its place is not known exactly at all times."""
        return bool(self.covariance.any() or self.disturbance_covariance.any())

    def outlines(self, dt: float, horizon: int) -> tuple[Matrix, ...]:
        """Return the mean outline at steps 0..T, (v, d) each [m].

        Parameters
        ----------
        dt : float
            Step [s].
        horizon : int
            Number of steps T.
        """
        dt, horizon = check_range(dt, "s", ("dt",)), check_steps(horizon)
        place, velocity = np.split(self.start, 2)
        return tuple(self.outline + (place + (k * dt) * velocity) for k in range(horizon + 1))

    def spread(self, dt: float, horizon: int) -> TrackSpread | None:
        """Return covariances of the place; None where it is known exactly.

        Parameters
        ----------
        dt : float
            Step [s].
        horizon : int
            Number of steps T.
        """
        if not self.is_uncertain:
            return None
        d, moved = self.dimension, _transition(self.dimension, dt)
        states = [self.covariance]
        for _ in range(horizon):
            states.append(moved @ states[-1] @ moved.T + self.disturbance_covariance)
        every = np.array(states)
        crossed = (every[:-1] @ moved.T)[:, :d, :d]
        return TrackSpread(frozen(every[:, :d, :d].copy()), frozen(crossed.copy()))

    def later(self, steps: int, dt: float) -> TrackShape:
        """Return the track as it is known some steps later, nothing seen in between.

        Parameters
        ----------
        steps : int
            How many, 0 or more.
        dt : float
            Step [s].
        """
        start, covariance, moved = self.start, self.covariance, _transition(self.dimension, dt)
        for _ in range(steps):
            start = moved @ start
            covariance = moved @ covariance @ moved.T + self.disturbance_covariance
        covariance = 0.5 * covariance + 0.5 * covariance.T
        # What was checked at its beginning may have grown beyond what files take.
        return unchecked(TrackShape, self.outline, start, covariance, self.disturbance_covariance)


def _transition(dimension: int, dt: float) -> Matrix:
    """Return the step of a place and a velocity that stays, (2 d, 2 d)."""
    moved = np.eye(2 * dimension)
    moved[:dimension, dimension:] = dt * np.eye(dimension)
    return moved
