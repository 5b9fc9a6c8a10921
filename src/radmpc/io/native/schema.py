"""The shape of scenario files, ``radmpc/scenario/1``: keys, types, sizes. No cross-checks."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag

from radmpc.io.native.numbers import MARK, Matrix, Number, ScalarOrVector, Square, Text, Vector
from radmpc.io.ranges import MOST_OBSTACLES, MOST_VEHICLES, SCENARIO_FORMAT
from radmpc.ranges import FILE_STEPS

__all__ = [
    "MOST_VISITS",
    "SCENARIO_FORMAT",
    "DisturbanceSpec",
    "DriftSpec",
    "DynamicsSpec",
    "FeedbackSpec",
    "FileModel",
    "GoalSpec",
    "KeepSpec",
    "LqrSpec",
    "MeasurementSpec",
    "NormSpec",
    "ObjectiveSpec",
    "ObstacleSpec",
    "ScenarioSpec",
    "SharedDisturbanceSpec",
    "SurveySpec",
    "TrackSpec",
    "VehicleSpec",
    "VisitSpec",
    "WorkspaceSpec",
]


_MOST_STATES = 50
"""States of one vehicle; like the other counts a guard against slips, not a limit of the method."""

_MOST_CORNERS = 2000
"""Corners of one outline."""

_MOST_SAMPLES = 1_000_000
"""Independent steps that covariances were estimated from: beyond, they are known."""


_MOST_RANGES = 10_000
"""Pairs of vehicles that keep a range."""

MOST_VISITS = 200
"""Boxes that one vehicle visits."""


class FileModel(BaseModel):
    """A mapping in a file: no conversions between types, no unknown keys."""

    # Validators take as long to build as small files to read: one for each kind of file that is
    # read, when it is, rather than one for each class.
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, defer_build=True)


class WorkspaceSpec(FileModel):
    """``{min, max}``."""

    min: Vector
    max: Vector


class DeviationsSpec(FileModel):
    """Standard deviations of what is reported of a track."""

    position: ScalarOrVector = 0.0
    speed: Number = 0.0
    course: Number = 0.0


class TrackSpec(FileModel):
    """An outline, and one of three descriptions of how it moves; which, is checked later."""

    outline: Annotated[Matrix, Field(max_length=_MOST_CORNERS)]
    start: Vector | None = None
    velocity: Vector | None = None
    position: Vector | None = None
    speed: Number | None = None
    course: Number | None = None
    deviations: DeviationsSpec | None = None
    covariance: Square = 0.0
    disturbance_covariance: Square = 0.0


def _moving(value: object) -> str:
    """Return whether a value is meant as a track or as outlines step by step."""
    return MARK + ("track" if isinstance(value, dict) else "outlines")


class ObstacleSpec(FileModel):
    """A name and one of five descriptions; which, is checked when it is built."""

    name: Text
    vertices: Annotated[Matrix, Field(max_length=_MOST_CORNERS)] | None = None
    holes: Annotated[list[Matrix], Field(max_length=_MOST_CORNERS)] | None = None
    line: Annotated[Matrix, Field(max_length=_MOST_CORNERS)] | None = None
    min: Vector | None = None
    max: Vector | None = None
    normals: Matrix | None = None
    offsets: Vector | None = None
    moving: (
        Annotated[
            Annotated[list[Matrix], Tag(MARK + "outlines")]
            | Annotated[TrackSpec, Tag(MARK + "track")],
            Discriminator(_moving),
        ]
        | None
    ) = None
    only: Annotated[list[Text], Field(min_length=1)] | None = Field(None, alias="for")
    exempt: Annotated[list[Text], Field(min_length=1)] | None = Field(None, alias="except")


class GoalSpec(FileModel):
    """``{center, half_width}`` or ``{min, max}``, the speed, and the window of arrival."""

    center: Vector | None = None
    half_width: ScalarOrVector = 0.0
    min: Vector | None = None
    max: Vector | None = None
    speed: ScalarOrVector | None = None
    within: Annotated[list[int], Field(min_length=2, max_length=2)] | None = None


class VisitSpec(FileModel):
    """A box as of a goal, the window of steps, and the speed."""

    center: Vector | None = None
    half_width: ScalarOrVector = 0.0
    min: Vector | None = None
    max: Vector | None = None
    between: Annotated[list[int], Field(min_length=2, max_length=2)] | None = None
    speed: ScalarOrVector | None = None


class SurveySpec(FileModel):
    """Lines over an area, to and fro: visits at their ends."""

    area: Annotated[Matrix, Field(max_length=_MOST_CORNERS)]
    spacing: Number
    direction: Vector = [1.0, 0.0]
    half_width: ScalarOrVector | None = None
    altitude: Number | None = None
    speed: ScalarOrVector | None = None


class NormSpec(FileModel):
    """A limit of a Euclidean norm, and others per axis."""

    norm: Number
    axes: ScalarOrVector | None = None


def _limit(value: object) -> str:
    """Return whether a value is meant as a norm, a list or a number."""
    kind = "norm" if isinstance(value, dict) else "list" if isinstance(value, list) else "number"
    return MARK + kind


Limit = Annotated[
    Annotated[Number, Tag(MARK + "number")]
    | Annotated[Vector, Tag(MARK + "list")]
    | Annotated[NormSpec, Tag(MARK + "norm")],
    Discriminator(_limit),
]


class DynamicsSpec(FileModel):
    """``{model}`` or ``{A, B, position, velocity}``."""

    model: Literal["double_integrator"] | None = None
    A: Annotated[Matrix, Field(max_length=_MOST_STATES)] | None = None
    B: Annotated[Matrix, Field(max_length=_MOST_STATES)] | None = None
    position: list[int] | None = None
    velocity: list[int] | None = None


class LqrSpec(FileModel):
    """Weights of the linear-quadratic regulator."""

    Q: Square
    R: Square


class FeedbackSpec(FileModel):
    """``{gain}`` or ``{lqr}``."""

    gain: Matrix | None = None
    lqr: LqrSpec | None = None


class DriftSpec(FileModel):
    """``{velocity}`` or ``{state}``."""

    velocity: Vector | None = None
    state: Vector | None = None


class DisturbanceSpec(FileModel):
    """``{covariance}``, and ``time_constant`` or ``correlation``."""

    covariance: Square
    time_constant: Number | None = None
    correlation: Number | None = None


class MeasurementSpec(FileModel):
    """``{of, covariance}`` or ``{matrix, covariance}``."""

    of: list[int] | None = None
    matrix: Matrix | None = None
    covariance: Square


class ObjectiveSpec(FileModel):
    """What effort and time are worth."""

    effort: Number = 1.0
    time: Number = 0.0


class VehicleSpec(FileModel):
    """A vehicle's fields, or the defaults of all: any of them may be missing."""

    name: Text = ""
    start: Vector = []
    goal: GoalSpec | None = None
    radius: Number = 0.0
    control_limit: Limit = 0.0
    speed_limit: Limit | None = None
    initial_covariance: Square = 0.0
    disturbance_covariance: Square = 0.0
    disturbance: DisturbanceSpec | None = None
    dynamics: DynamicsSpec = DynamicsSpec.model_construct(model="double_integrator")
    feedback: FeedbackSpec | None = None
    control_sigmas: Number = 3.0
    cost_weight: Number = 1.0
    drift: DriftSpec | None = None
    measurement: MeasurementSpec | None = None
    via: Annotated[list[VisitSpec], Field(max_length=MOST_VISITS)] = []
    survey: SurveySpec | None = None


class SharedDisturbanceSpec(FileModel):
    """``{name, covariance, on}``, and ``time_constant`` or ``correlation``."""

    name: Text
    covariance: Square
    time_constant: Number | None = None
    correlation: Number | None = None
    on: dict[str, Square | None]


class KeepSpec(FileModel):
    """Two vehicles, and the range that they keep."""

    vehicles: Annotated[list[Text], Field(min_length=2, max_length=2)]
    within: Number


class ScenarioSpec(FileModel):
    """A whole scenario."""

    format: Literal["radmpc/scenario/1"]
    name: Text
    dt: Number
    horizon: Annotated[int, Field(le=FILE_STEPS)]
    risk_bound: Number
    avoidance: Literal["steps", "intervals"] = "intervals"
    pair_faces: Annotated[int, Field(le=360)] | None = None
    workspace: WorkspaceSpec | None = None
    obstacles: Annotated[list[ObstacleSpec], Field(max_length=MOST_OBSTACLES)] = []
    defaults: VehicleSpec = VehicleSpec.model_construct()
    vehicles: Annotated[list[VehicleSpec], Field(max_length=MOST_VEHICLES)]
    shared_disturbances: Annotated[list[SharedDisturbanceSpec], Field(max_length=_MOST_STATES)] = []
    covariance_samples: Annotated[int, Field(le=_MOST_SAMPLES)] | None = None
    objective: ObjectiveSpec = ObjectiveSpec.model_construct()
    assign: bool = False
    goals: Annotated[list[GoalSpec], Field(max_length=MOST_VEHICLES)] | None = None
    keep: Annotated[list[KeepSpec], Field(max_length=_MOST_RANGES)] = []
    source: dict[str, Any] | None = None
