"""From data to file models, and from what pydantic finds to one line."""

from __future__ import annotations

import difflib
import types
import typing
from collections.abc import Callable, Mapping
from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from radmpc.errors import ScenarioError
from radmpc.io.native.numbers import MARK
from radmpc.io.text.files import shown

__all__ = ["check_format", "union_members", "validated"]

_Model = TypeVar("_Model", bound=BaseModel)

_MESSAGES: Mapping[str, str] = {
    "missing": "is required",
    "model_type": "must be a mapping",
    "dict_type": "must be a mapping",
    "list_type": "must be a list",
    "float_type": "must be a number",
    "finite_number": "must be a finite number",
    "int_type": "must be a whole number",
    "string_type": "must be text",
    "string_unicode": "must be text that UTF-8 can encode",
    "literal_error": "must be {expected}",
    "greater_than_equal": "must be at least {ge:.10g}",
    "less_than_equal": "must be at most {le:.10g}",
}


def check_format(data: object, expected: str) -> Mapping[str, object]:
    """Return the data as a mapping whose ``format`` is the expected one.

    Parameters
    ----------
    data : object
        Of a file.
    expected : str
        The ``format`` it must state.

    Raises
    ------
    ScenarioError
        If it is no mapping, or states no format or another.
    """
    if not isinstance(data, Mapping):
        raise ScenarioError(f"must be a mapping with 'format: {expected}', got {shown(data)}")
    if "format" not in data:
        raise ScenarioError(f"is required, as 'format: {expected}'", ("format",))
    if data["format"] != expected:
        raise ScenarioError(f"must be {expected!r}, got {shown(data['format'])}", ("format",))
    return data


def validated(model: type[_Model], data: Mapping[str, object]) -> _Model:
    """Return data as a file model.

    Parameters
    ----------
    model : type
        Of the file model.
    data : mapping
        Of a file.

    Raises
    ------
    ScenarioError
        With all that is wrong.
    """
    try:
        return model.model_validate(data)
    except ValidationError as error:
        found = error.errors(include_url=False)
    # A misspelled key is named before the required one it was meant to be.
    found.sort(key=lambda detail: detail["type"] == "missing")
    first, *rest = (ScenarioError(_message(model, one), _path(one)) for one in found)
    count = f" (and {len(rest)} more)" if rest else ""
    raise ScenarioError(first.message + count, first.path, tuple(rest))


def _path(detail: ErrorDetails) -> tuple[str | int, ...]:
    """Return where, without the marks of shapes."""
    return tuple(
        key for key in detail["loc"] if not (isinstance(key, str) and key.startswith(MARK))
    )


def _message(model: type[BaseModel], detail: ErrorDetails) -> str:
    """Return what is wrong with a value."""
    kind = detail["type"]
    if kind == "extra_forbidden":
        *parent, key = _path(detail)
        return _unknown(str(key), _keys(model, parent))
    if kind == "missing":
        return _MESSAGES[kind]
    if kind == "too_long":
        most, count = detail["ctx"]["max_length"], len(detail["input"])
        return f"must have at most {most:,} entries, got {count:,}"
    if kind == "too_short":
        least, count = detail["ctx"]["min_length"], len(detail["input"])
        return f"must have at least {least} {'entry' if least == 1 else 'entries'}, got {count}"
    if kind not in _MESSAGES:
        return detail["msg"]
    expected = _MESSAGES[kind].format(**detail.get("ctx", {}))
    return f"{expected}, got {shown(detail['input'])}"


def _unknown(key: str, allowed: list[str]) -> str:
    """Return that a key is unknown, and the one it may be meant to be."""
    near = difflib.get_close_matches(key[:100].lower(), allowed, n=1)
    if near:
        return f"unknown key, did you mean {near[0]!r}?"
    return f"unknown key, allowed are {', '.join(allowed)}"


def _keys(model: type[BaseModel], path: list[str | int]) -> list[str]:
    """Return the keys allowed in the mapping at a path."""
    annotation: Any = model
    for key in path:
        if isinstance(key, str):
            annotation = _only(annotation, _is_model).model_fields[key].annotation
        else:
            annotation = typing.get_args(_only(annotation, _is_list))[0]
    fields = _only(annotation, _is_model).model_fields
    return [field.alias or name for name, field in fields.items()]


def _only(annotation: Any, is_wanted: Callable[[Any], bool]) -> Any:
    """Return the one member of a union that is meant, or the type itself."""
    found = [member for member in union_members(annotation) if is_wanted(member)]
    return found[0] if found else annotation


def union_members(annotation: Any) -> list[Any]:
    """Return the members of a union, however deep and however marked; the type itself if none.

    Parameters
    ----------
    annotation : type
        Of a field.
    """
    if typing.get_origin(annotation) is Annotated:
        return union_members(typing.get_args(annotation)[0])
    if isinstance(annotation, types.UnionType) or typing.get_origin(annotation) is typing.Union:
        return [one for member in typing.get_args(annotation) for one in union_members(member)]
    return [annotation]


def _is_model(annotation: Any) -> bool:
    """Whether a type is a mapping with known keys."""
    return isinstance(annotation, type) and issubclass(annotation, BaseModel)


def _is_list(annotation: Any) -> bool:
    """Whether a type is a list."""
    return typing.get_origin(annotation) is list
