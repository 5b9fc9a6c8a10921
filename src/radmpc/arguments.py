"""Checks of arguments of public functions: errors of one line that say what is allowed."""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Collection
from numbers import Integral, Real
from typing import TypeGuard

import numpy as np

from radmpc.errors import ArgumentError, ArgumentTypeError, FileFormatError, ScenarioError
from radmpc.wording import one, value_text

__all__ = [
    "check_callable",
    "check_executor",
    "check_integer",
    "check_kind",
    "check_path",
    "check_rng",
    "check_time_limit",
    "check_word",
    "field_integer",
    "field_number",
    "field_parts",
    "field_text",
    "is_integer",
    "is_number",
    "one",
    "value_text",
]


def is_number(value: object) -> TypeGuard[float]:
    """Whether a value is a real number that a float holds; no bool and no span of time, but nan."""
    if not isinstance(value, Real) or isinstance(value, (bool, np.timedelta64)):
        return False
    return not isinstance(value, Integral) or abs(int(value)) <= sys.float_info.max


def is_integer(value: object) -> TypeGuard[int]:
    """Whether a value is an integer, of Python's or numpy's; no bool, span of time, or 10.0."""
    return isinstance(value, Integral) and not isinstance(value, (bool, np.timedelta64))


def check_kind(
    value: object, kinds: type | tuple[type, ...], name: str, allowed: str, hint: str = ""
) -> None:
    """Refuse what is of another kind.

    Parameters
    ----------
    value : object
        The argument.
    kinds : type or tuple of type
        What it may be.
    name : str
        What it is called.
    allowed : str
        What it may be, in words.
    hint : str
        What to do instead.

    Raises
    ------
    ArgumentTypeError
        If it is none of these.
    """
    if not isinstance(value, kinds):
        told_hint = f": {hint}" if hint else ""
        raise ArgumentTypeError(f"{name} must be {allowed}, got {value_text(value)}{told_hint}")


def check_callable(value: object, name: str) -> None:
    """Refuse what can neither be called nor is None.

    Parameters
    ----------
    value : object
        The argument.
    name : str
        Its name, for the message.

    Raises
    ------
    ArgumentTypeError
        If it is anything else.
    """
    if value is not None and not callable(value):
        raise ArgumentTypeError(f"{name} must be a function or None, got {value_text(value)}")


def check_executor(executor: object) -> None:
    """Refuse what takes no tasks, with an `ArgumentTypeError`: None does not matter."""
    takes = callable(getattr(executor, "submit", None)) and not isinstance(executor, type)
    if executor is not None and not takes:
        allowed = "a concurrent.futures.Executor or None"
        raise ArgumentTypeError(f"executor must be {allowed}, got {value_text(executor)}")


def check_integer(value: object, name: str, least: int, most: float = math.inf) -> int:
    """Return an integer within a range.

    Parameters
    ----------
    value : object
        The argument.
    name : str
        What it is called.
    least : int
        Smallest value allowed.
    most : int or inf
        Largest value allowed.

    Returns
    -------
    int
        Python's, also of numpy's.

    Raises
    ------
    ArgumentTypeError
        If it is no integer.
    ArgumentError
        If it is out of range.
    """
    allowed = f"an integer {f'>= {least}' if most == math.inf else f'from {least} to {most}'}"
    if not is_integer(value):
        hint = ""  # 1e4 samples are a common slip: say how to write them, unless in 300 digits
        if is_number(value) and float(value).is_integer() and abs(value) < 1e16:
            hint = f": write {int(value)}"
        raise ArgumentTypeError(f"{name} must be {allowed}, got {value_text(value)}{hint}")
    number = int(value)
    if not least <= number <= most:
        raise ArgumentError(f"{name} must be {allowed}, got {value_text(value)}")
    return number


def check_path(path: object, name: str = "path") -> None:
    """Refuse what names no file: a number would be taken for an open file's.

    Parameters
    ----------
    path : object
        The argument.
    name : str
        Its name, for the message.

    Raises
    ------
    ArgumentTypeError
        If it is neither text nor a path.
    FileFormatError
        If it holds a NUL or half a character, which no name of a file does.
    """
    check_kind(path, (str, os.PathLike), name, "the name of a file (str or Path)")
    if "\0" in str(path):
        raise FileFormatError(f"{value_text(str(path))}: is no file name: it holds a NUL")
    try:
        os.fsencode(str(path))
    except UnicodeEncodeError as error:
        raise FileFormatError(f"{str(path)!a:.60}: is no file name: half a character") from error


def check_rng(rng: object) -> None:
    """Refuse what is no source of random numbers.

    Raises
    ------
    ArgumentTypeError
        If it is neither a generator nor an integer nor None.
    ArgumentError
        If it is a negative integer.
    """
    if rng is None or isinstance(rng, np.random.Generator):
        return
    allowed = "an integer >= 0, a numpy.random.Generator or None"
    if not is_integer(rng):
        raise ArgumentTypeError(f"rng must be {allowed}, got {value_text(rng)}")
    if int(rng) < 0:
        raise ArgumentError(f"rng must be {allowed}, got {value_text(rng)}")


def check_time_limit(seconds: object) -> None:
    """Refuse what is no time.

    Raises
    ------
    ArgumentTypeError
        If it is neither a number nor None.
    ArgumentError
        If it is negative or nan.
    """
    if seconds is None:
        return
    allowed = "a number of seconds >= 0 or None"
    if not is_number(seconds):
        raise ArgumentTypeError(f"time_limit must be {allowed}, got {value_text(seconds)}")
    if not 0.0 <= seconds <= math.inf:
        raise ArgumentError(f"time_limit must be {allowed}, got {value_text(seconds)}")


def field_number(value: object, path: tuple[str | int, ...]) -> float:
    """Return a number of a scenario as Python's float; its range is the caller's business.

    Parameters
    ----------
    value : object
        What was given.
    path : tuple of str or int
        Where it stands in the scenario.

    Raises
    ------
    ScenarioError
        If it is no number.
    """
    if not is_number(value):
        raise ScenarioError(f"must be a number, got {value_text(value)}", path)
    return float(value)


def field_integer(value: object, path: tuple[str | int, ...]) -> int:
    """Return an integer of a scenario as Python's.

    Parameters
    ----------
    value : object
        What was given.
    path : tuple of str or int
        Where it stands in the scenario.

    Raises
    ------
    ScenarioError
        If it is none.
    """
    if not is_integer(value):
        raise ScenarioError(f"must be an integer, got {value_text(value)}", path)
    return int(value)


def field_parts(value: object, allowed: str, path: tuple[str | int, ...]) -> tuple[object, ...]:
    """Return parts of a scenario as a tuple.

    Parameters
    ----------
    value : object
        What was given.
    allowed : str
        What it must be, for the message.
    path : tuple of str or int
        Where it stands in the scenario.

    Raises
    ------
    ScenarioError
        If the value cannot be iterated over.
    """
    try:
        return tuple(value)  # type: ignore[arg-type] # that is the question
    except TypeError as error:
        raise ScenarioError(f"must be {allowed}, got {value_text(value)}", path) from error


def check_word(value: object, words: Collection[str], name: str) -> None:
    """Refuse what is none of a planner's words.

    Parameters
    ----------
    value : object
        What was given.
    words : collection of str
        What is allowed.
    name : str
        The field's name, for the message.

    Raises
    ------
    ScenarioError
        With the words allowed.
    """
    if not (isinstance(value, str) and value in words):
        known = " or ".join(map(repr, words))
        raise ScenarioError(f"{name} must be {known}, got {value_text(value)}")


def field_text(value: object, path: tuple[str | int, ...]) -> None:
    """Refuse what is no text, with a `ScenarioError`.

    Parameters
    ----------
    value, path
        As in `field_number`.
    """
    if not isinstance(value, str):
        raise ScenarioError(f"must be text, got {value_text(value)}", path)
