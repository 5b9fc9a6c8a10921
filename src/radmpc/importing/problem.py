"""What files of other groups state: vehicles, obstacles, bounds. No noise, no risk bound."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from pydantic import BaseModel, ConfigDict

from radmpc.arrays import Vector, as_vector
from radmpc.errors import ScenarioError
from radmpc.model.obstacle import Obstacle
from radmpc.model.relations.keep import Keep
from radmpc.model.scenario import Workspace
from radmpc.ranges import check_range
from radmpc.records import dataclass, replace

__all__ = [
    "ForeignModel",
    "ForeignProblem",
    "ForeignShape",
    "ForeignVehicle",
    "ForeignVisit",
    "Window",
]

Window = tuple[float, float]
"""First and last moment since the start [s]; the last may be infinite."""


class ForeignModel(BaseModel):
    """A mapping in a file of another group: what is not known here is ignored."""

    model_config = ConfigDict(extra="ignore", strict=True, frozen=True)


@dataclass(frozen=True, slots=True, eq=False)
class ForeignVisit:
    """A place on the way.

    Attributes
    ----------
    center : (d,) array
        Middle of the box that is visited [m].
    half_width : float
        From there to its sides [m].
    window : (float, float) or None
        When [s]; None is any time.
    speed : float or None
        At most, per axis [m/s]; None leaves it free.
    """

    center: Vector
    half_width: float
    window: Window | None = None
    speed: float | None = None


@dataclass(frozen=True, slots=True)
class ForeignShape:
    """A hull that is no disc.

    Attributes
    ----------
    kind : str
        What its file calls vehicles of this hull.
    parts : str or None
        What it is made of, in words; None where the hull is not known.
    covering : float or None
        Radius of the disc that covers it at any angle [m]; None where that is not known.
    """

    kind: str
    parts: str | None
    covering: float | None


@dataclass(frozen=True, slots=True, eq=False)
class ForeignVehicle:
    """A double integrator, or what is to be flown as one.

    Attributes
    ----------
    name : str
        Unique within its problem.
    start, goal : (d,) array
        Positions [m].
    start_velocity, goal_velocity : (d,) array
        Velocities there [m/s].
    radius : float
        Hull radius [m].
    speed_limit : float
        Per axis [m/s].
    control_limit : float
        Acceleration per axis [m/s²].
    goal_half_width : (d,) array or None
        Of the region around the goal that is as good as the goal itself [m]; None if only a point
        is stated.
    via : tuple of ForeignVisit
        Places to be visited, in order.
    arrival : (float, float) or None
        When it may arrive, to stay from then on [s]; None is at the end.
    shape : ForeignShape or None
        The published hull, around which the radius is that of a disc; None where it is that disc.
    """

    name: str
    start: Vector
    goal: Vector
    start_velocity: Vector
    goal_velocity: Vector
    radius: float
    speed_limit: float
    control_limit: float
    goal_half_width: Vector | None = None
    via: tuple[ForeignVisit, ...] = ()
    arrival: Window | None = None
    shape: ForeignShape | None = None

    def __post_init__(self) -> None:
        """Freeze the arrays, and refuse what would overflow."""
        d = len(self.start)
        for name, unit in (("radius", "m"), ("speed_limit", "m/s"), ("control_limit", "m/s²")):
            check_range(getattr(self, name), unit, (name,))
        if self.goal_half_width is not None:
            width = as_vector(self.goal_half_width, d, ("goal_half_width",))
            object.__setattr__(self, "goal_half_width", width)
        for name in ("start", "goal", "start_velocity", "goal_velocity"):
            object.__setattr__(self, name, as_vector(getattr(self, name), d, (name,)))

    def minimum_time(self) -> float:
        """Return the least time from start to goal with nothing in the way [s].

        With places to visit, that with a stop at each, and no earlier than their windows.
        """
        if self.via:
            windows = [*(visit.window for visit in self.via), self.arrival]
            time = 0.0
            for leg, window in zip(self.legs(), windows, strict=True):
                time = max(time + leg.minimum_time(), 0.0 if window is None else window[0])
            return time
        early = 0.0 if self.arrival is None else self.arrival[0]
        return max(early, self._straight_time())

    def legs(self) -> tuple[ForeignVehicle, ...]:
        """Return the ways from place to place, at rest where it visits; itself if nowhere."""
        if not self.via:
            return (self,)
        stops = [visit.center for visit in self.via]
        still = np.zeros(self.start.size)
        ends = [(self.start, self.start_velocity), *((stop, still) for stop in stops)]
        ends.append((self.goal, self.goal_velocity))
        return tuple(
            replace(self, start=a, start_velocity=u, goal=b, goal_velocity=v, via=(), arrival=None)
            for (a, u), (b, v) in pairwise(ends)
        )

    def _straight_time(self) -> float:
        """Return the least time from start to goal [s]."""
        return max(
            _axis_time(distance, v0, v1, self.speed_limit, self.control_limit)
            for distance, v0, v1 in zip(
                self.goal - self.start, self.start_velocity, self.goal_velocity, strict=True
            )
        )


@dataclass(frozen=True, slots=True, eq=False)
class ForeignProblem:
    """A problem as published.

    Attributes
    ----------
    name : str
        For the scenario.
    format, file : str
        What the file's format is called, and the file.
    vehicles : tuple of ForeignVehicle
        At least one.
    obstacles : tuple of Obstacle
        What stands in the way.
    workspace : Workspace or None
        Bounds of the vehicles' centers.
    reasons : tuple of (str, str)
        What the importer had to choose itself, and why.
    warnings : tuple of str
        What could not be carried over.
    bounds_hulls : bool
        Whether the bounds hold the whole vehicles, not only their centers.
    usual_vehicles : int or None
        How many of the vehicles are taken if the user does not say; None is all of them.
    origin : mapping or None
        Where the frame stands on the earth: ``latitude`` and ``longitude`` [°], ``height`` [m].
    keep : tuple of Keep
        Ranges that vehicles keep to each other.
    """

    name: str
    format: str
    file: str
    vehicles: tuple[ForeignVehicle, ...]
    obstacles: tuple[Obstacle, ...] = ()
    workspace: Workspace | None = None
    reasons: tuple[tuple[str, str], ...] = ()
    warnings: tuple[str, ...] = ()
    bounds_hulls: bool = False
    usual_vehicles: int | None = None
    origin: Mapping[str, float] | None = None
    keep: tuple[Keep, ...] = ()

    def __post_init__(self) -> None:
        """Refuse a problem without vehicles."""
        if not self.vehicles:
            raise ScenarioError("needs at least one vehicle, got none")


def _axis_time(distance: float, v0: float, v1: float, v_max: float, a_max: float) -> float:
    """Return the least time along one axis: accelerate, coast at the limit, brake [s]."""
    v0, v1 = (min(max(v, -v_max), v_max) for v in (v0, v1))
    # What is covered while the speed changes straight from one value to the other.
    if distance < 0.5 * (v0 + v1) * abs(v1 - v0) / a_max:
        distance, v0, v1 = -distance, -v0, -v1
    peak = float((max(a_max * distance + 0.5 * (v0**2 + v1**2), 0.0)) ** 0.5)
    if peak <= v_max:
        return (2.0 * peak - v0 - v1) / a_max
    covered = (v_max**2 - 0.5 * (v0**2 + v1**2)) / a_max
    return (2.0 * v_max - v0 - v1) / a_max + (distance - covered) / v_max
