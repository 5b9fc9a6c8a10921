"""Where a vehicle's mean must be at the horizon."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from radmpc.arguments import field_integer, field_number
from radmpc.arrays import Frozen, Vector, as_axes, as_matrix, as_vector
from radmpc.errors import ScenarioError
from radmpc.model.numbers import step_window
from radmpc.ranges import sized
from radmpc.records import dataclass

__all__ = ["Goal"]


@dataclass(frozen=True, slots=True, eq=False)
class Goal(Frozen):
    """A box for the mean position at the horizon, and the largest mean speed there.

    Attributes
    ----------
    lower, upper : (d,) array
        Corners of the box [m], ``lower <= upper``.
    speed : (d,) array or None
        Largest mean speed per axis at the horizon [m/s]; None leaves it free.
    within : tuple of (int, int) or None
        First and last step at which it may arrive, to stay within box and speed at all steps from
        then on; None is at the horizon.

    Examples
    --------
    >>> Goal([8.8, 4.8], [9.2, 5.2], speed=[0.05, 0.05])
    Goal(lower=array([8.8, 4.8]), upper=array([9.2, 5.2]), speed=array([0.05, 0.05]), within=None)
    """

    lower: Vector
    upper: Vector
    speed: Vector | None
    within: tuple[int, int] | None = None

    if TYPE_CHECKING:  # what it takes is wider than what it holds

        def __init__(
            self,
            lower: npt.ArrayLike,
            upper: npt.ArrayLike,
            speed: npt.ArrayLike | None,
            within: Sequence[int] | None = None,
        ) -> None: ...

    def __post_init__(self) -> None:
        """Freeze the arrays and check their order."""
        lower = sized(as_vector(self.lower, path=("min",)), ("min",))
        object.__setattr__(self, "lower", lower)
        upper = sized(as_vector(self.upper, lower.size, ("max",)), ("max",))
        object.__setattr__(self, "upper", upper)
        if not np.all(self.lower <= self.upper):
            raise ScenarioError(
                f"min must not exceed max, got {self.lower.tolist()} and {self.upper.tolist()}"
            )
        if self.speed is not None:
            speed = sized(as_vector(self.speed, lower.size, ("speed",)), ("speed",))
            object.__setattr__(self, "speed", speed)
            if np.any(speed < 0.0):
                raise ScenarioError(f"must be >= 0 m/s, got {speed.tolist()}", ("speed",))
        if self.within is not None:
            object.__setattr__(self, "within", step_window(self.within, "within"))

    @classmethod
    def at(
        cls,
        center: npt.ArrayLike,
        half_width: npt.ArrayLike = 0.0,
        speed: npt.ArrayLike | None = 0.0,
        within: Sequence[int] | None = None,
    ) -> Goal:
        """Return a goal around a point.

        Parameters
        ----------
        center : (d,) array_like
            Middle of the box [m].
        half_width : number or (d,) array_like
            From the middle to the sides [m], ≥ 0.
        speed : number, (d,) array_like or None
            Largest mean speed per axis [m/s]: 0 is a stop, None leaves it free.
        within : sequence of two int or None
            First and last step at which it may arrive, to stay from then on; None is the horizon.

        Returns
        -------
        Goal
            The box.

        Raises
        ------
        ScenarioError
            If shapes differ or a number is negative.
        """
        middle = as_vector(center, path=("center",))
        half = as_axes(half_width, middle.size, ("half_width",))
        limit = None if speed is None else as_axes(speed, middle.size, ("speed",))
        return cls(middle - half, middle + half, limit, within)

    @property
    def center(self) -> Vector:
        """Middle of the box [m]."""
        return 0.5 * (self.lower + self.upper)

    def contains(
        self, position: npt.ArrayLike, velocity: npt.ArrayLike | None, tol: float = 1e-6
    ) -> bool:
        """Whether a mean position and velocity count as arrived.

        Parameters
        ----------
        position : (d,) array
            Mean position at the horizon [m].
        velocity : (d,) array or None
            Mean velocity there [m/s]; None where the dynamics have none.
        tol : float
            What a box and a speed may be missed by [m, m/s].

        Returns
        -------
        bool
            True within the box and at most at the speed.

        Raises
        ------
        ScenarioError
            If a vector has another size or is not finite.
        """
        tol = field_number(tol, ("tol",))
        place = as_vector(position, self.lower.size, ("position",))
        inside = np.all(place >= self.lower - tol) and np.all(place <= self.upper + tol)
        if self.speed is None or velocity is None:
            return bool(inside)
        speed = np.abs(as_vector(velocity, self.lower.size, ("velocity",)))
        return bool(inside and np.all(speed <= self.speed + tol))

    def window(self, horizon: int) -> tuple[int, int]:
        """Return the first and the last step of arrival.

        Parameters
        ----------
        horizon : int
            Number of steps T.

        Returns
        -------
        tuple of (int, int)
            Steps.

        Raises
        ------
        ScenarioError
            If the number of steps is none.
        """
        horizon = field_integer(horizon, ("horizon",))
        return (horizon, horizon) if self.within is None else self.within

    def arrival(
        self, positions: npt.ArrayLike, velocities: npt.ArrayLike | None, tol: float = 1e-6
    ) -> int | None:
        """Return the step at which a path arrives: the first of its window from which it stays.

        Parameters
        ----------
        positions : (T+1, d) array
            Mean positions [m].
        velocities : (T+1, d) array or None
            Mean velocities [m/s]; None where the dynamics have none.
        tol : float
            What box and speed may be missed by [m, m/s].

        Returns
        -------
        int or None
            None where it does not arrive within the window.

        Raises
        ------
        ScenarioError
            If a matrix has another shape or is not finite.
        """
        tol = field_number(tol, ("tol",))
        places = as_matrix(positions, (None, self.lower.size), ("positions",))
        outside = np.any((places < self.lower - tol) | (places > self.upper + tol), axis=1)
        if self.speed is not None and velocities is not None:
            speeds = np.abs(as_matrix(velocities, places.shape, ("velocities",)))
            outside |= np.any(speeds > self.speed + tol, axis=1)
        first, last = self.window(len(places) - 1)
        late = np.flatnonzero(outside)
        step = max(first, int(late[-1]) + 1 if late.size else 0)
        return step if step <= last else None
