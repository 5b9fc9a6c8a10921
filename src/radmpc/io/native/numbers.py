"""Types of numbers in files: real, finite, of sane size, with rows of equal length."""

from __future__ import annotations

from typing import Annotated, Any, cast

from pydantic import AfterValidator, Discriminator, Field, GetCoreSchemaHandler, Tag
from pydantic_core import CoreSchema, PydanticCustomError

from radmpc.ranges import LARGEST

__all__ = [
    "MARK",
    "Finite",
    "FiniteMatrix",
    "Matrix",
    "Number",
    "ScalarOrVector",
    "Square",
    "Text",
    "Vector",
]

MARK = "\0"
"""First character of what pydantic adds to a path for a choice between shapes."""


def _check_rows(rows: list[list[float]]) -> list[list[float]]:
    """Refuse rows of different lengths."""
    lengths = sorted({len(row) for row in rows})
    if len(lengths) > 1:
        raise PydanticCustomError(
            "ragged",
            "must have rows of equal length, got lengths {first} and {last}",
            {"first": lengths[0], "last": lengths[-1]},
        )
    return rows


def _check_text(text: str) -> str:
    """Refuse text that no file can hold: halves of characters."""
    try:
        text.encode("utf-8")
    except UnicodeEncodeError as error:
        raise PydanticCustomError("encoding", "must be text that UTF-8 can encode") from error
    return text


def _shape(value: object) -> str:
    """Return whether a value is meant as a number, a list or a matrix."""
    if not isinstance(value, list):
        return MARK + "number"
    return MARK + ("matrix" if any(isinstance(item, list) for item in value) else "list")


def _at_most_list(value: object) -> str:
    """Return whether a value is meant as a number or a list."""
    return MARK + ("list" if isinstance(value, list) else "number")


class _Once:
    """Has pydantic build the schema of a type once, not for every field of it."""

    __slots__ = ("_schema",)

    def __init__(self) -> None:
        self._schema: CoreSchema | None = None

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        if self._schema is None:
            self._schema = handler(source)
        # A tag that makes it one of several shapes is written into it.
        return cast(
            "CoreSchema", {**self._schema, "metadata": dict(self._schema.get("metadata", {}))}
        )


Text = Annotated[str, AfterValidator(_check_text), _Once()]
Finite = Annotated[float, Field(strict=True, allow_inf_nan=False), _Once()]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=-LARGEST, le=LARGEST), _Once()]
Vector = Annotated[list[Number], _Once()]
Matrix = Annotated[list[list[Number]], AfterValidator(_check_rows), _Once()]
FiniteMatrix = Annotated[list[list[Finite]], AfterValidator(_check_rows), _Once()]

# Chosen by what is given, not by trying all: one error instead of one per shape.
ScalarOrVector = Annotated[
    Annotated[Number, Tag(MARK + "number")] | Annotated[Vector, Tag(MARK + "list")],
    Discriminator(_at_most_list),
    _Once(),
]
Square = Annotated[
    Annotated[Number, Tag(MARK + "number")]
    | Annotated[Vector, Tag(MARK + "list")]
    | Annotated[Matrix, Tag(MARK + "matrix")],
    Discriminator(_shape),
    _Once(),
]
