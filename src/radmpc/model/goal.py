"""Where a vehicle's mean must be at the horizon."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from radmpc.arguments import field_number
from radmpc.arrays import Frozen, Vector, as_axes, as_vector
from radmpc.errors import ScenarioError

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
    """

    lower: Vector
    upper: Vector
    speed: Vector | None

    if TYPE_CHECKING:  # what it takes is wider than what it holds

        def __init__(
            self, lower: npt.ArrayLike, upper: npt.ArrayLike, speed: npt.ArrayLike | None
        ) -> None: ...

    def __post_init__(self) -> None:
        """Freeze the arrays and check their order."""
        lower = as_vector(self.lower, path=("min",))
        object.__setattr__(self, "lower", lower)
        object.__setattr__(self, "upper", as_vector(self.upper, lower.size, ("max",)))
        if not np.all(self.lower <= self.upper):
            raise ScenarioError(
                f"min must not exceed max, got {self.lower.tolist()} and {self.upper.tolist()}"
            )
        if self.speed is not None:
            speed = as_vector(self.speed, lower.size, ("speed",))
            object.__setattr__(self, "speed", speed)
            if np.any(speed < 0.0):
                raise ScenarioError(f"must be >= 0 m/s, got {speed.tolist()}", ("speed",))

    @classmethod
    def at(
        cls,
        center: npt.ArrayLike,
        half_width: npt.ArrayLike = 0.0,
        speed: npt.ArrayLike | None = 0.0,
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
        return cls(middle - half, middle + half, limit)

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
