"""The package's dataclasses beside the standard library's: what values do, and what is compiled."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import pickle
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar, get_type_hints

import pytest

import radmpc
from radmpc.records import dataclass


class Checked:
    """A base that checks what its dataclass is given."""

    __slots__ = ()
    kind: ClassVar[str] = "a place"

    def __post_init__(self) -> None:
        if self.x < 0:  # type: ignore[attr-defined] # of the classes below
            raise ValueError("must be at least 0")


class Place(Checked):
    """A place."""

    x: float
    name: str = dataclasses.field(default="", repr=False)
    notes: list[str] = dataclasses.field(default_factory=list)
    rank: int = dataclasses.field(default=3, compare=False)
    made: int = dataclasses.field(init=False, default=7)
    later: int = dataclasses.field(init=False)
    many: tuple[int, ...] = dataclasses.field(init=False, default_factory=tuple)


class Single:
    """A value of one field."""

    x: float


class Nothing:
    """No field."""


OPTIONS = [
    {"frozen": True},
    {"frozen": True, "eq": False},
    {"frozen": True, "eq": False, "repr": False},
    {"eq": False},
    {},
]
ARGUMENTS: list[tuple[type, tuple[object, ...], dict[str, object]]] = [
    (Place, (1.0,), {}),
    (Place, (1.0, "here", ["a"], 4), {}),
    (Place, (), {"x": 2.0, "rank": 1}),
    (Place, (-1.0,), {}),
    (Place, (), {}),
    (Place, (1.0, "a", [], 2, 3), {}),
    (Place, (1.0,), {"later": 3}),
    pytest.param(
        Single,
        (float("nan"),),
        {},
        marks=pytest.mark.skipif(
            sys.version_info >= (3, 13), reason="there no value that holds a NaN equals itself"
        ),
    ),
    (Nothing, (1,), {}),
]


def answer(act: Callable[[], object]) -> object:
    """Return what something returns or how it fails."""
    try:
        return act()
    except (TypeError, ValueError, AttributeError) as error:
        # Of later versions of Python, one has quotes around attributes' names and one has not.
        return type(error), re.sub("'", "", str(error))


def actions(kind: Any, value: Any, again: Any) -> list[Callable[[], object]]:
    """What users and the package do with dataclasses and their values."""
    return [
        lambda: repr(value),
        lambda: value == again,
        lambda: value == 1.0,
        lambda: hash(value) == hash(again),
        lambda: hash(value) == hash(value),
        lambda: setattr(value, "x", 3.0),
        lambda: delattr(value, "x"),
        lambda: dataclasses.asdict(dataclasses.replace(value)),
        lambda: repr(copy.copy(value)),
        lambda: [(f.name, f.type, f.default) for f in dataclasses.fields(value)],
        lambda: kind.__match_args__,
        lambda: kind.__doc__,
        lambda: sorted(kind.__slots__),
        lambda: hasattr(value, "__dict__"),
        lambda: isinstance(kind.__hash__, type(None)),
    ]


@pytest.mark.parametrize("options", OPTIONS, ids=str)
@pytest.mark.parametrize(("body", "values", "named"), ARGUMENTS)
def test_a_value_does_what_one_of_the_standard_librarys_does(
    body: type, values: tuple[object, ...], named: dict[str, object], options: dict[str, Any]
) -> None:
    answers = []
    for decorate in (dataclass, dataclasses.dataclass):
        # A class anew for each: making slots takes what defines the fields away.
        inside = {k: v for k, v in vars(body).items() if k not in {"__dict__", "__weakref__"}}
        kind = decorate(slots=True, **options)(type(body.__name__, body.__bases__, inside))
        made = answer(lambda kind=kind: kind(*values, **named))
        if isinstance(made, tuple):
            answers.append([made])
            continue
        again = kind(*values, **named)
        answers.append([answer(act) for act in actions(kind, made, again)])
    of_ours, of_theirs = answers
    hidden = re.compile(" at 0x[0-9a-f]+")
    assert [hidden.sub("", str(a)) for a in of_ours] == [hidden.sub("", str(a)) for a in of_theirs]


@dataclass(frozen=True, slots=True)
class Pair:
    """Two numbers, the second of which may be left out."""

    first: float
    second: float = 2.0
    others: list[float] = dataclasses.field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Triple(Pair):
    """A third beside them."""

    third: float = 3.0


class Named(Triple):
    """A class that is no dataclass."""


def test_a_signature_is_told_before_and_after_the_first_value() -> None:
    told = "(first: 'float', second: 'float' = 2.0, others: 'list[float]' = <factory>) -> None"
    assert str(inspect.signature(Pair)) == told
    Pair(1.0)
    assert str(inspect.signature(Pair)) == told
    hints = get_type_hints(Pair.__init__)
    assert hints == {"first": float, "second": float, "others": list[float], "return": type(None)}
    with pytest.raises(TypeError, match=r"Pair\.__init__\(\) missing 1 required positional arg"):
        Pair()  # type: ignore[call-arg] # tried on purpose


def test_a_dataclass_of_a_dataclass_has_the_fields_of_both() -> None:
    made = Triple(1.0, third=4.0)
    assert repr(made) == "Triple(first=1.0, second=2.0, others=[], third=4.0)"
    assert made == dataclasses.replace(Triple(0.0, third=4.0), first=1.0)
    assert made != Pair(1.0)


def test_a_plain_class_of_a_dataclass_sets_what_is_its_own_alone() -> None:
    made = Named(1.0)
    made.place = "here"  # type: ignore[attr-defined] # tried on purpose
    assert made.place == "here"  # type: ignore[attr-defined] # tried on purpose
    with pytest.raises(dataclasses.FrozenInstanceError, match="cannot assign to field 'third'"):
        made.third = 0.0  # type: ignore[misc] # tried on purpose


def test_a_value_comes_back_from_a_pickle_and_is_frozen() -> None:
    back = pickle.loads(pickle.dumps(Triple(1.0, others=[5.0])))
    assert back == Triple(1.0, others=[5.0])
    with pytest.raises(dataclasses.FrozenInstanceError, match="cannot delete field 'first'"):
        del back.first


def test_a_value_without_fields_is_like_all_others() -> None:
    kind: Any = dataclass(frozen=True, slots=True)(Nothing)
    assert (repr(kind()), kind() == kind(), hash(kind()) == hash(kind())) == (
        "Nothing()",
        True,
        True,
    )


def test_a_value_that_holds_itself_is_shown() -> None:
    made = Pair(1.0)
    made.others.append(made)  # type: ignore[arg-type] # tried on purpose
    assert repr(made) == "Pair(first=1.0, second=2.0, others=[...])"


def test_nothing_is_compiled_for_a_class_of_which_no_value_is_made() -> None:
    asks = """
import builtins, dataclasses
from radmpc.records import dataclass
texts, run = [], builtins.exec
builtins.exec = lambda *words: (texts.append(words[0]), run(*words))[1]
@dataclasses.dataclass(init=False, repr=False, eq=False, slots=True)
class Bare:
    first: float
bare = len(texts)  # which the standard library compiles of itself since 3.13: nothing
texts.clear()
@dataclass(frozen=True, slots=True)
class Pair:
    '''Two.'''
    first: float
    second: float = 2.0
print(len(texts) - bare); Pair(1.0); Pair(1.0) == Pair(2.0); print(len(texts) - bare)
"""
    done = subprocess.run(
        [sys.executable, "-c", asks], capture_output=True, text=True, timeout=60, check=True
    )
    assert done.stdout.split() == ["0", "1"]


def test_the_packages_dataclasses_are_its_own_where_they_have_slots_and_no_order() -> None:
    others = []
    for file in Path(radmpc.__file__).parent.rglob("*.py"):
        text = file.read_text(encoding="utf-8")
        if file.name != "records.py" and re.search(
            "^from dataclasses .*\\bdataclass\\b", text, re.M
        ):
            kinds = re.findall(r"^ *@dataclass(.*)", text, re.M)
            others += [file] * all("slots=True" in kind and "order" not in kind for kind in kinds)
    assert others == []
