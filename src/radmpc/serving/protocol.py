"""What the server and the page say to each other; fields are described in ``web/src/protocol.ts``.

Names are the page's, so that what is sent is what is written here: a test holds both against each
other. Python's null is None, its undefined a key that is not there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypedDict

from radmpc.serving.scenes import (
    Box,
    Change,
    Cure,
    Ellipse,
    GoalView,
    Handle,
    ObstacleView,
    Path,
    Point,
    RangeView,
    Remark,
    ScenarioView,
    VehicleView,
)

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
    "Judging",
    "LedgerLine",
    "Named",
    "ObstacleView",
    "Path",
    "PlanSummary",
    "PlanView",
    "Point",
    "RangeView",
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
    "stopFlight", "flight", "stopJudging",
)  # fmt: skip
"""Everything that a page may ask for."""

EVENTS = ("document", "search", "plan", "flight", "tick", "judging")
"""Everything that the server tells unasked."""

Content = Mapping[str, Any]
FailureKind = Literal["stale", "refused", "exists", "limit", "gone", "internal"]


class Failure(TypedDict):
    """Why a call was not answered."""

    kind: FailureKind
    text: str
    path: Path | None


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
    note: str | None


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
    note: str | None


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
    """Samples of a plan."""

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


class Judging(TypedDict):
    """How far the referee is with a plan from a file."""

    file: str
    vehicles: int
    seconds: float
    limit: float
    isOver: bool


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
