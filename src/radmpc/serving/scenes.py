"""What can be seen of a document, as the page has it; see `radmpc.serving.protocol`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, NotRequired, TypedDict

__all__ = [
    "Box",
    "Change",
    "Cure",
    "Ellipse",
    "GoalView",
    "Handle",
    "ObstacleView",
    "Path",
    "Point",
    "RangeView",
    "Remark",
    "ScenarioView",
    "VehicleView",
]

Path = Sequence[str | int]
Point = Sequence[float]


class Change(TypedDict):
    """One value of a document to be replaced, or taken away."""

    path: Path
    value: NotRequired[Any]


class Cure(TypedDict):
    """A change that removes a cause."""

    label: str
    changes: Sequence[Change]


class Remark(TypedDict):
    """Something wrong, or worth knowing."""

    severity: Literal["error", "fatal", "warning"]
    text: str
    path: Path
    vehicles: Sequence[str]
    at: Point | None
    cures: Sequence[Cure]


class Handle(TypedDict):
    """A point that can be dragged, and the numbers that move with it."""

    at: Point
    x: Sequence[Path]
    y: Sequence[Path]
    z: Sequence[Path]


class Ellipse(TypedDict):
    """One standard deviation of a place."""

    axes: Sequence[float]
    angle: float
    rotation: Sequence[float] | None


class Box(TypedDict):
    """A box of the map."""

    min: Point
    max: Point


class ObstacleView(TypedDict):
    """One obstacle, ready to be drawn."""

    name: str
    path: Path
    kind: Literal["polygon", "line", "solid"]
    rings: Sequence[Sequence[Point]]
    corners: Sequence[Point]
    triangles: Sequence[Sequence[int]]
    moving: Sequence[Sequence[Point]] | None
    uncertain: Sequence[Ellipse] | None
    only: str | None
    handles: Sequence[Handle]


class GoalView(TypedDict):
    """A box to visit or to come to."""

    box: Box
    path: Path
    label: str
    handles: Sequence[Handle]


class VehicleView(TypedDict):
    """One vehicle, ready to be drawn."""

    name: str
    path: Path
    radius: float
    start: Point
    startHandle: Handle | None
    goal: GoalView
    via: Sequence[GoalView]


class RangeView(TypedDict):
    """Two vehicles that are to stay in range of each other."""

    vehicles: Sequence[str]
    within: float


class ScenarioView(TypedDict):
    """A scenario, ready to be drawn."""

    name: str
    dimension: int
    dt: float
    horizon: int
    riskBound: float
    avoidance: Literal["intervals", "steps"]
    workspace: Box | None
    workspaceHandles: Sequence[Handle]
    vehicles: Sequence[VehicleView]
    obstacles: Sequence[ObstacleView]
    ranges: Sequence[RangeView]
    extent: Box
