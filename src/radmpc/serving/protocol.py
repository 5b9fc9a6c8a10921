"""What the server and the page say to each other; fields are described in ``web/src/protocol.ts``.

Names are the page's, so that what is sent is what is written here: a test holds both against each
other. Python's null is None, its undefined a key that is not there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal, NotRequired, TypedDict

__all__ = [
    "CALLS",
    "EVENTS",
    "REFUSED",
    "SOCKET",
    "Box",
    "Change",
    "Collision",
    "Content",
    "CouplingView",
    "Cure",
    "DocumentState",
    "Ellipse",
    "Failure",
    "FailureKind",
    "FileEntry",
    "FlightState",
    "GoalView",
    "Handle",
    "Hello",
    "LedgerLine",
    "Named",
    "ObstacleView",
    "Path",
    "PlanSummary",
    "PlanView",
    "Point",
    "Remark",
    "ScenarioView",
    "SearchState",
    "TickView",
    "TrackView",
    "Trail",
    "TrailsView",
    "VehicleView",
]

SOCKET = "/socket"
"""Where the page's socket is."""

REFUSED = 4401
"""Code by which the server closes a socket whose token is not its own."""

CALLS = (
    "hello", "files", "new", "open", "drop", "state", "close", "change", "undo", "redo", "save",
    "export", "why", "plan", "stop", "pause", "resume", "view", "savePlan", "simulate", "fly",
    "stopFlight", "flight",
)  # fmt: skip
"""Everything that a page may ask for."""

EVENTS = ("document", "search", "plan", "flight", "tick")
"""Everything that the server tells unasked."""

Path = Sequence[str | int]
Content = Mapping[str, Any]
Point = Sequence[float]
FailureKind = Literal["stale", "refused", "limit", "gone", "internal"]


class Failure(TypedDict):
    """Why a call was not answered."""

    kind: FailureKind
    text: str
    path: Path | None


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
    extent: Box


class PlanSummary(TypedDict):
    """A plan in few words."""

    plan: str
    revision: int
    planner: str
    status: str
    riskBound: float
    cost: float | None
    bound: float | None
    certified: float | None
    holds: bool
    seconds: float
    price: float | None
    explanation: str | None


class SearchState(TypedDict):
    """A search for plans."""

    search: str
    document: str
    revision: int
    planner: str
    state: Literal["running", "paused", "ended", "failed"]
    seconds: float
    limit: float
    stage: str
    cost: float | None
    bound: float | None
    gap: float | None
    found: int
    told: str | None


class TickView(TypedDict):
    """A tick of a flight."""

    step: int
    states: Sequence[Point]
    left: float
    spent: float
    decision: str
    isReplan: bool
    milliseconds: float
    alarm: str | None


class FlightState(TypedDict):
    """A flight under way, or read from its file."""

    flight: str
    document: str
    plan: str | None
    state: Literal["running", "paused", "ended", "failed"]
    step: int
    steps: int
    riskBound: float
    ticks: Sequence[TickView]
    told: str | None


class DocumentState(TypedDict):
    """A document that is open."""

    document: str
    revision: int
    content: Content
    view: ScenarioView | None
    remarks: Sequence[Remark]
    canUndo: bool
    canRedo: bool
    file: str | None
    isSaved: bool
    plans: Sequence[PlanSummary]
    searches: Sequence[SearchState]
    flights: Sequence[FlightState]


class LedgerLine(TypedDict):
    """Where a part of the risk goes."""

    cause: Literal["pair", "obstacle", "workspace", "range"]
    vehicle: str
    other: str | None
    step: int
    risk: float
    at: Point


class TrackView(TypedDict):
    """One vehicle of a plan."""

    name: str
    path: Sequence[Point]
    ellipses: Sequence[Ellipse]
    speed: Sequence[float]


class CouplingView(TypedDict):
    """Why two vehicles are planned together."""

    vehicle: str
    other: str
    text: str


class PlanView(TypedDict):
    """A plan, ready to be drawn."""

    plan: str
    summary: PlanSummary
    scenario: ScenarioView
    perStep: int
    tracks: Sequence[TrackView]
    ledger: Sequence[LedgerLine]
    left: float
    saturation: float
    sets: Sequence[Sequence[str]]
    couplings: Sequence[CouplingView]
    sigmas: float
    level: float
    report: Sequence[str]
    remarks: Sequence[Remark]


class Collision(TypedDict):
    """Where and when a simulated mission ends badly."""

    at: Point
    time: float
    names: Sequence[str]


class Trail(TypedDict):
    """One simulated mission."""

    paths: Sequence[Sequence[Point]]
    collision: Collision | None


class TrailsView(TypedDict):
    """Simulated missions of a plan."""

    plan: str
    flights: int
    collisions: int
    interval: Point
    trails: Sequence[Trail]


class FileEntry(TypedDict):
    """A file of the folder."""

    path: str
    kind: Literal["scenario", "plan", "flight", "chart"]
    bytes: int


class Named(TypedDict):
    """A name and what it means."""

    name: str
    text: str


class Hello(TypedDict):
    """What the server can do."""

    version: str
    planners: Sequence[Named]
    exports: Sequence[Named]
    templates: Sequence[Named]
    folder: str
    documents: Sequence[Mapping[str, str]]
    document: str | None
