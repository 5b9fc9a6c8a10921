"""How messages name values, kinds and shares."""

from __future__ import annotations

import re
import reprlib
from collections.abc import Sequence
from numbers import Integral, Real

import numpy as np

__all__ = [
    "changed_texts",
    "count_text",
    "distinct_texts",
    "names_of_choices",
    "number_text",
    "one",
    "percent",
    "place_text",
    "short_cost",
    "value_text",
    "with_options",
]

_LONGEST = 60
"""Letters of a value that a message shows; longer ones are shortened."""

_ROUNDING = 1e-9
"""Share below which two costs, or places, differ by rounding alone, and cost that is none [-]."""

_REPR = reprlib.Repr()
_REPR.maxstring = _REPR.maxother = _REPR.maxlong = _LONGEST
_REPR.maxlevel = 3


def value_text(value: object) -> str:
    """Return a value for a message, in one short line: itself if it is plain, else its kind."""
    if value is None or isinstance(value, str | bytes | bool | Real):
        plain = value.item() if isinstance(value, np.generic) else value
        return _REPR.repr(plain)
    if isinstance(value, list | tuple):
        text = " ".join(_REPR.repr(value).split())
        return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."
    if isinstance(value, type):
        return f"the class {value.__name__}"
    return one(type(value))


def one(kind: type) -> str:
    """Return ``a Vehicle`` for `Vehicle`, ``an Obstacle`` for `Obstacle`."""
    return f"{'an' if kind.__name__[0] in 'aeiouAEIOU' else 'a'} {kind.__name__}"


def percent(share: float) -> str:
    """Return what a cost could fall by as a percentage of two digits: ``3.4 %``."""
    return f"{100.0 * share if share > _ROUNDING else 0.0:.2g} %"


def short_cost(cost: float, digits: int = 6) -> str:
    """Return a cost, and 0 for what is rounding: fleets that stay cost no effort.

    Parameters
    ----------
    cost : float
        Of a plan, >= 0.
    digits : int
        Significant ones.
    """
    return f"{cost if abs(cost) > _ROUNDING else 0.0:.{digits}g}"


def place_text(position: Sequence[float]) -> str:
    """Return a place as ``(8.5, 0)``: four digits, and 0 for what is rounding beside others.

    Parameters
    ----------
    position : sequence of float
        Coordinates [m].
    """
    least = _ROUNDING * max(map(abs, position))
    return f"({', '.join(f'{x if abs(x) > least else 0.0:.4g}' for x in position)})"


def count_text(number: int, noun: str) -> str:
    """Return a number and its noun, which ends in s unless there is one.

    Parameters
    ----------
    number : int
        How many.
    noun : str
        Of what; its plural must end in s.
    """
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def number_text(value: float) -> str:
    """Return the shortest text that is read back as the same number: ``3``, ``1e-06``.

    Parameters
    ----------
    value : float
        Python's or numpy's.
    """
    if isinstance(value, Integral):
        return str(int(value))
    short = f"{value:g}"
    return short if float(short) == value else repr(float(value))


def distinct_texts(one: float, other: float) -> tuple[str, str]:
    """Return two numbers with as many digits, three at least, as tell them apart.

    Parameters
    ----------
    one, other : float
        To be compared by who reads them; alike where they are equal.
    """
    for digits in range(3, 17):
        texts = f"{one:.{digits}g}", f"{other:.{digits}g}"
        if texts[0] != texts[1] or one == other:
            return texts
    return repr(float(one)), repr(float(other))


def with_options(name: str, *options: str) -> str:
    """Return ``name``, or ``name(one, other)`` where some options are not empty.

    Parameters
    ----------
    name : str
        Of a choice.
    *options : str
        What is said of it.
    """
    told = ", ".join(filter(None, options))
    return f"{name}({told})" if told else name


def changed_texts(record: object, usual: object, *names: str) -> tuple[str, ...]:
    """Return ``keep=0.5`` for every number of a record that is not the usual one.

    Parameters
    ----------
    record, usual : object
        Of the same class; the second by default.
    *names : str
        Fields to compare.
    """
    values = ((name, getattr(record, name)) for name in names)
    return tuple(
        f"{name}={number_text(value)}" for name, value in values if value != getattr(usual, name)
    )


def names_of_choices(text: str) -> tuple[str, ...]:
    """Return the names of policy, solver and decomposition, without their options.

    Parameters
    ----------
    text : str
        What `str` makes of a planner, as it stands in plans: ``optimal, branch, certified(3)``.
    """
    # Options have options of their own in turn: couplings(1e-06, receding(reset)).
    while (bare := re.sub(r"\([^()]*\)", "", text)) != text:
        text = bare
    return tuple(part.strip() for part in text.split(","))[:3]
