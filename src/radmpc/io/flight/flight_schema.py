"""The shape of flight files, ``radmpc/flight/1``: keys, types, sizes. No cross-checks."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from radmpc.io.native.numbers import Finite, FiniteMatrix, Text
from radmpc.io.native.schema import FileModel

__all__ = ["ContactSpec", "HeaderSpec", "LegSpec", "RowSpec"]

Count = Annotated[int, Field(strict=True, ge=0)]
Share = Annotated[Finite, Field(ge=0.0)]


class HeaderSpec(FileModel):
    """The first line; its plan is checked by its own schema."""

    format: Literal["radmpc/flight/1"]
    backend: Text
    options: dict[str, Text]
    replan: Text | None
    missions: Annotated[int, Field(strict=True, ge=1)]
    seed: Count
    deadline: Share | None
    versions: dict[str, Text]
    plan: dict[str, Any]
    digest: Text


class ContactSpec(FileModel):
    """Something that was hit, left or lost."""

    step: Count
    cause: Literal["obstacle", "pair", "workspace", "range"]
    vehicle: Text
    other: Text | None


class LegSpec(FileModel):
    """A leg that was adopted."""

    risk_bound: Share
    starts: list[list[Finite]]
    controls: list[FiniteMatrix]
    means: list[FiniteMatrix] | None = None


class ScaleSpec(FileModel):
    """What is known of the factor of covariances."""

    samples: Count
    factor: Share


class RowSpec(FileModel):
    """One tick."""

    mission: Count
    step: Count
    states: list[list[Finite]] | None
    partly: list[list[Finite] | None] | None = None
    contacts: list[ContactSpec]
    choice: Literal["tail", "candidate"]
    reason: Text
    value: Share | None
    wealth: Share
    price: Share | None
    next_step: Share | None
    tail: Share
    bank: Share
    controls: list[list[Finite]]
    excess: Share
    leg: LegSpec | None
    scale: ScaleSpec | None = None
    alarms: list[Text]
    seconds: Share
    digest: Text
