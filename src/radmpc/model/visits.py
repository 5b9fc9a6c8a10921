"""Boxes that a vehicle's mean visits on its way to the goal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from radmpc.arguments import field_integer, field_number, field_parts, value_text
from radmpc.arrays import Frozen, Vector, as_axes, as_matrix, as_vector
from radmpc.errors import ScenarioError
from radmpc.model.dynamics import LinearSystem
from radmpc.model.numbers import step_window
from radmpc.model.workspace import Workspace
from radmpc.ranges import sized
from radmpc.records import dataclass

__all__ = ["Visit", "check_visits", "checked_visits", "steps_of_visits", "steps_visited"]


@dataclass(frozen=True, slots=True, eq=False)
class Visit(Frozen):
    """A box for the mean position at one step of a window, and the largest mean speed there.

    Attributes
    ----------
    lower, upper : (d,) array
        Corners of the box [m], ``lower <= upper``.
    between : tuple of (int, int) or None
        First and last step at which it may take place, 1 at least and the horizon T at most; None
        is any step from 1 to T - 1.
    speed : (d,) array or None
        Largest mean speed per axis at the visit [m/s]; None leaves it free.

    Examples
    --------
    >>> import radmpc
    >>> radmpc.Visit.at([10.0, 8.0], half_width=1.0, between=(3, 6))
    Visit(lower=array([9., 7.]), upper=array([11.,  9.]), between=(3, 6), speed=None)
    """

    lower: Vector
    upper: Vector
    between: tuple[int, int] | None = None
    speed: Vector | None = None

    if TYPE_CHECKING:  # what it takes is wider than what it holds

        def __init__(
            self,
            lower: npt.ArrayLike,
            upper: npt.ArrayLike,
            between: Sequence[int] | None = None,
            speed: npt.ArrayLike | None = None,
        ) -> None: ...

    def __post_init__(self) -> None:
        """Freeze the arrays, and check corners, window and speed."""
        put = object.__setattr__
        lower = sized(as_vector(self.lower, path=("min",)), ("min",))
        upper = sized(as_vector(self.upper, lower.size, ("max",)), ("max",))
        put(self, "lower", lower)
        put(self, "upper", upper)
        if not np.all(lower <= upper):
            ends = f"{lower.tolist()} and {upper.tolist()}"
            raise ScenarioError(f"min must not exceed max, got {ends}")
        if self.between is not None:
            put(self, "between", step_window(self.between, "between"))
        if self.speed is not None:
            speed = sized(as_axes(self.speed, lower.size, ("speed",)), ("speed",))
            put(self, "speed", speed)
            if np.any(speed < 0.0):
                raise ScenarioError(f"must be >= 0 m/s, got {speed.tolist()}", ("speed",))

    @classmethod
    def at(
        cls,
        center: npt.ArrayLike,
        half_width: npt.ArrayLike = 0.0,
        between: Sequence[int] | None = None,
        speed: npt.ArrayLike | None = None,
    ) -> Visit:
        """Return a visit of a box around a point.

        Parameters
        ----------
        center : (d,) array_like
            Middle of the box [m].
        half_width : number or (d,) array_like
            From the middle to the sides [m], ≥ 0.
        between : sequence of two int or None
            First and last step of its window; None is any step from 1 to T - 1.
        speed : number, (d,) array_like or None
            Largest mean speed per axis there [m/s]; None leaves it free.

        Returns
        -------
        Visit
            The box and its window.

        Raises
        ------
        ScenarioError
            If shapes differ, a number is negative, or the window is none.
        """
        middle = as_vector(center, path=("center",))
        half = as_axes(half_width, middle.size, ("half_width",))
        if np.any(half < 0.0):
            raise ScenarioError(f"must be >= 0 m, got {half.tolist()}", ("half_width",))
        return cls(middle - half, middle + half, between, speed)

    @property
    def center(self) -> Vector:
        """Middle of the box [m]."""
        return 0.5 * (self.lower + self.upper)

    def window(self, horizon: int) -> tuple[int, int]:
        """Return the first and the last step of its window, whatever is visited before or after.

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
        return (1, horizon - 1) if self.between is None else self.between


def steps_of_visits(visits: Sequence[Visit], horizon: int) -> tuple[tuple[int, int], ...]:
    """Return the steps at which visits may take place, given that they do so one after the other.

    Parameters
    ----------
    visits : sequence of Visit
        In the order in which they take place, each at a later step than the one before.
    horizon : int
        Number of steps T.

    Returns
    -------
    tuple of (int, int)
        First and last step of each; a last one before the first where there is none left.
    """
    firsts, earliest = [], 0
    for visit in visits:
        earliest = max(visit.window(horizon)[0], earliest + 1)
        firsts.append(earliest)
    lasts, latest = [], horizon + 1
    for visit in reversed(visits):
        latest = min(visit.window(horizon)[1], latest - 1)
        lasts.append(latest)
    return tuple(zip(firsts, reversed(lasts), strict=True))


def steps_visited(
    visits: Sequence[Visit],
    positions: npt.ArrayLike,
    velocities: npt.ArrayLike | None,
    tol: float = 1e-6,
) -> tuple[int, ...]:
    """Return the steps at which a path makes visits, each as early as it can.

    Parameters
    ----------
    visits : sequence of Visit
        In the order in which they take place.
    positions : (T+1, d) array
        Mean positions [m].
    velocities : (T+1, d) array or None
        Mean velocities [m/s]; None where the dynamics have none.
    tol : float
        What a box and a speed may be missed by [m, m/s].

    Returns
    -------
    tuple of int
        One per visit, up to the first that is not made.

    Raises
    ------
    ScenarioError
        If what is visited is none, or a matrix has another shape or is not finite.

    Examples
    --------
    >>> import radmpc
    >>> path = [[0.0, 0.0], [4.0, 0.0], [8.0, 1.0], [12.0, 2.0]]  # mean positions, step by step
    >>> buoy = radmpc.Visit.at([8.0, 0.5], half_width=1.0)
    >>> radmpc.steps_visited([buoy], path, velocities=None)
    (2,)
    """
    tol = field_number(tol, ("tol",))
    places = as_matrix(positions, path=("positions",))
    speeds = None if velocities is None else as_matrix(velocities, places.shape, ("velocities",))
    steps: list[int] = []
    for visit in _listed(visits, "visits", places.shape[1]):
        first, last = visit.window(len(places) - 1)
        made = np.all((places >= visit.lower - tol) & (places <= visit.upper + tol), axis=1)
        if visit.speed is not None and speeds is not None:
            made &= np.all(np.abs(speeds) <= visit.speed + tol, axis=1)
        made[: max(first, steps[-1] + 1 if steps else 0)] = made[last + 1 :] = False
        if not made.any():
            break
        steps.append(int(made.argmax()))
    return tuple(steps)


def checked_visits(given: object, system: LinearSystem) -> tuple[Visit, ...]:
    """Return what a vehicle visits as a tuple, checked against its dynamics.

    Parameters
    ----------
    given : iterable of Visit
        In the order in which they take place.
    system : LinearSystem
        The vehicle's dynamics.

    Raises
    ------
    ScenarioError
        If a part is no `Visit`, has other axes than the position, or a speed without velocities.
    """
    visits = _listed(given, "via", system.dimension)
    for j, visit in enumerate(visits):
        if visit.speed is not None and system.velocity is None:
            wrong = "a speed needs dynamics whose velocity indices are given"
            raise ScenarioError(wrong, ("via", j, "speed"))
    return visits


def _listed(given: object, name: str, dimension: int) -> tuple[Visit, ...]:
    """Return what an argument of a name lists, if all of it can be visited."""
    visits = field_parts(given, "a sequence of Visits", (name,))
    for j, visit in enumerate(visits):
        if not isinstance(visit, Visit):
            raise ScenarioError(f"must be a Visit, got {value_text(visit)}", (name, j))
        if (count := visit.lower.size) != dimension:
            wrong = f"must have {dimension} coordinates like the position, got {count}"
            raise ScenarioError(wrong, (name, j))
    return tuple(visit for visit in visits if isinstance(visit, Visit))


def check_visits(visits: Sequence[Visit], horizon: int, workspace: Workspace | None) -> None:
    """Check that visits fit within the horizon and the workspace, one after the other.

    Parameters
    ----------
    visits : sequence of Visit
        Of one vehicle.
    horizon : int
        Number of steps T.
    workspace : Workspace or None
        None is unbounded.

    Raises
    ------
    ScenarioError
        With the first visit that does not fit.
    """
    windows = steps_of_visits(visits, horizon)
    for j, (visit, window) in enumerate(zip(visits, windows, strict=True)):
        try:
            _check_visit(visit, window, horizon, workspace)
        except ScenarioError as error:
            raise error.under("via", j) from error


def _check_visit(
    visit: Visit, window: tuple[int, int], horizon: int, workspace: Workspace | None
) -> None:
    """Check one visit, with the steps that the others leave it."""
    _, last = visit.window(horizon)
    if last > horizon:
        raise ScenarioError(
            f"must end at the horizon of {horizon} steps at the latest, got {last}", ("between",)
        )
    if window[0] > window[1]:
        raise ScenarioError(
            "leaves no step: visits must take place in order, one step apart, each within its "
            f"window (steps 1 to {horizon - 1} where none is given, up to {horizon} where one is)"
        )
    if workspace is None:
        return
    if np.any(visit.lower > workspace.upper) or np.any(visit.upper < workspace.lower):
        raise ScenarioError(
            f"must touch the workspace {workspace.lower.tolist()} to {workspace.upper.tolist()}, "
            f"got {visit.lower.tolist()} to {visit.upper.tolist()}"
        )
