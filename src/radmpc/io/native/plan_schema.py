"""The shape of plan files, ``radmpc/plan/1``: keys, types, sizes. No cross-checks."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from radmpc.io.native.numbers import Finite, FiniteMatrix, Text
from radmpc.io.native.schema import FileModel

__all__ = ["CouplingSpec", "LedgerSpec", "PlanSpec", "RiskSpec", "TrajectorySpec"]


class LedgerSpec(FileModel):
    """One row of the ledger."""

    cause: Literal["obstacle", "pair", "workspace", "range"]
    vehicle: Text
    other: Text | None
    step: Annotated[int, Field(ge=0)]
    risk: Annotated[Finite, Field(ge=0.0)]


class RiskSpec(FileModel):
    """The risk bound, and what is charged against it."""

    bound: Finite
    certified: Annotated[Finite, Field(ge=0.0)] | None
    ledger: list[LedgerSpec]
    price: Annotated[Finite, Field(ge=0.0)] | None = None
    saturation: Annotated[Finite, Field(ge=0.0, le=1.0)] | None = None


class CouplingSpec(FileModel):
    """One edge of the coupling graph."""

    vehicle: Text
    other: Text
    reason: Literal["collision", "risk", "blocked", "distance", "share", "range"]
    value: Annotated[Finite, Field(ge=0.0)] | None


class TrajectorySpec(FileModel):
    """One vehicle's part. Whether it fits the scenario is for the referee to say."""

    name: Text
    controls: FiniteMatrix
    means: FiniteMatrix
    covariances: list[FiniteMatrix]
    gain: FiniteMatrix | None


class FirstPlanSpec(FileModel):
    """The first certified plan."""

    seconds: Finite
    cost: Finite


class PlanSpec(FileModel):
    """A whole plan; its scenario is checked by its own schema."""

    format: Literal["radmpc/plan/1"]
    scenario: dict[str, Any]
    planner: Text
    seed: int | None
    status: Literal["optimal", "feasible", "infeasible", "limit"]
    cost: Finite | None
    lower_bound: Finite | None
    certified_lower_bound: Finite | None = None
    risk: RiskSpec
    sets: list[list[Text]]
    couplings: list[CouplingSpec] = Field(default_factory=list)
    seconds: dict[str, Finite] = Field(default_factory=dict)
    versions: dict[str, Text] = Field(default_factory=dict)
    explanation: Text | None = None
    stopped_by: Text | None = None
    first_plan: FirstPlanSpec | None = None
    vehicles: list[TrajectorySpec]
