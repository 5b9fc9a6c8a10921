"""Classes whose methods are made late are those that Python makes at once."""

from __future__ import annotations

import abc
import copy
import dataclasses
import inspect
import pickle
import subprocess
import sys
from dataclasses import FrozenInstanceError, dataclass, field

import pytest

from radmpc.console.running.late_dataclasses import late, make_methods_late

OPTIONS = {"frozen": True, "slots": True}


class Wide:
    """What every class below may lack."""

    __slots__ = ()


class Short:
    """Two fields."""

    number: int
    name: str


class Point(Wide):
    """A place.

    Attributes
    ----------
    x, y : float
        Where it is.
    marks : list of str
        What is written there.
    length : float
        Of the way to it.
    """

    x: float
    y: float = 0.5
    marks: list[str] = field(default_factory=list)
    length: float = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "length", self.x + self.y)

    @property
    def double(self) -> float:
        return 2.0 * self.x


def twin(kind: type) -> type:
    """Return another one: a decorator changes the class that it gets."""
    members = {k: v for k, v in vars(kind).items() if k not in {"__dict__", "__weakref__"}}
    made = type(kind)(kind.__name__, kind.__bases__, members)
    made.__qualname__ = kind.__qualname__
    return made


SOURCE = Point
USUAL = dataclass(**OPTIONS)(twin(SOURCE))
Point = late(twin(SOURCE), OPTIONS)  # type: ignore[misc] # pickles look for it here


@pytest.mark.parametrize("arguments", [(1.0,), (1.0, 2.0), (1.0, 2.0, ["a"])])
def test_an_instance_holds_what_it_is_given_and_defaults(arguments: tuple[object, ...]) -> None:
    made, wanted = late(twin(SOURCE), OPTIONS)(*arguments), USUAL(*arguments)
    for name in ("x", "y", "marks", "length", "double"):
        assert getattr(made, name) == getattr(wanted, name)
    assert repr(made) == repr(wanted)
    assert dataclasses.asdict(made) == dataclasses.asdict(wanted)


def test_a_class_may_have_no_fields() -> None:
    class Nothing:
        """No field."""

    assert repr(late(Nothing, OPTIONS)()).endswith("Nothing()")


def test_lists_are_not_shared() -> None:
    assert Point(1.0).marks is not Point(1.0).marks


@pytest.mark.parametrize("words", [{}, {"x": 1.0, "z": 2.0}, {"x": 1.0, "length": 2.0}])
def test_wrong_arguments_are_refused_in_the_same_words(words: dict[str, float]) -> None:
    with pytest.raises(TypeError) as usual:
        USUAL(**words)
    with pytest.raises(TypeError) as told:
        Point(**words)
    assert str(told.value) == str(usual.value)


@pytest.mark.parametrize("name", ["x", "length", "other"])
def test_values_stay_as_they_are(name: str) -> None:
    point = Point(1.0)
    with pytest.raises(FrozenInstanceError, match=f"cannot assign to field '{name}'"):
        setattr(point, name, 2.0)
    with pytest.raises(FrozenInstanceError, match=f"cannot delete field '{name}'"):
        delattr(point, name)
    assert (point.x, point.length) == (1.0, 1.5)


def test_equal_values_are_equal_and_have_one_hash() -> None:
    kind = late(twin(Short), OPTIONS)
    assert kind(1, "a") == kind(1, "a")
    assert kind(1, "a") != kind(2, "a")
    assert (
        hash(kind(1, "a")) == hash(kind(1, "a")) == hash(dataclass(**OPTIONS)(twin(Short))(1, "a"))
    )


def test_without_comparison_everything_is_equal_to_itself_alone() -> None:
    kind = late(twin(Short), {**OPTIONS, "eq": False})
    one = same = kind(1, "a")
    assert one == same
    assert one != kind(1, "a")
    assert hash(one) == object.__hash__(one)


def test_pickles_and_copies_hold_the_same() -> None:
    point = Point(1.0, 2.0, ["a"])
    for other in (pickle.loads(pickle.dumps(point)), copy.deepcopy(point), copy.copy(point)):
        assert type(other) is Point
        assert other == point
    assert dataclasses.replace(point, x=3.0).length == 5.0


def test_whoever_looks_at_the_class_sees_the_same() -> None:
    for look in (
        lambda kind: str(inspect.signature(kind)),
        lambda kind: [f.name for f in dataclasses.fields(kind)],
        lambda kind: kind.__match_args__,
        lambda kind: kind.__slots__,
        lambda kind: (kind.__name__, kind.__qualname__, kind.__module__, kind.__doc__),
        dataclasses.is_dataclass,
    ):
        # Each time anew: the first look makes the methods.
        kind = late(twin(SOURCE), OPTIONS)
        assert look(kind) == look(dataclass(**OPTIONS)(twin(SOURCE)))
    assert not hasattr(Point(1.0), "__dict__")


def test_what_is_written_in_the_class_is_kept() -> None:
    class Own:  # noqa: PLW1641 - dataclasses make the hash
        """A name."""

        name: str

        def __repr__(self) -> str:
            return f"<{self.name}>"

        def __eq__(self, other: object) -> bool:
            return isinstance(other, type(self))

    kind = late(Own, OPTIONS)
    assert repr(kind("a")) == "<a>"
    assert kind("a") == kind("b")
    assert hash(kind("a")) == hash(kind("a"))


def test_an_abstract_base_stays_one() -> None:
    class Base(abc.ABC):
        __slots__ = ()

        @abc.abstractmethod
        def area(self) -> float: ...

    class Square(Base):
        """A square."""

        side: float

        def area(self) -> float:
            return self.side**2

    class Nothing(Base):
        """No shape."""

        side: float

    assert late(Square, OPTIONS)(2.0).area() == 4.0
    with pytest.raises(TypeError, match="abstract"):
        late(Nothing, OPTIONS)(1.0)


def test_a_usual_dataclass_may_have_such_a_base() -> None:
    @dataclass(frozen=True, slots=True)
    class Named(late(twin(Short), OPTIONS)):  # type: ignore[misc] # made above
        more: int = 3

    assert (Named(1, "a").more, Named(1, "a").name) == (3, "a")
    assert repr(Named(1, "a")).endswith("Named(number=1, name='a', more=3)")


def test_only_plain_frozen_classes_of_the_package_are_made_late(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(dataclasses, "dataclass", dataclass)
    make_methods_late("json")

    def methods(module: str, hint: str = "int", **options: bool) -> bool:
        members = {"__module__": module, "__annotations__": {"a": hint}, "__doc__": "A class."}
        kind = dataclasses.dataclass(**options)(type("Made", (), members))
        return inspect.isfunction(vars(kind)["__init__"])

    assert not methods("json.decoder", **OPTIONS)
    assert methods("json.decoder", frozen=True)
    assert methods("json.decoder", slots=True)
    assert methods("json.decoder", "ClassVar[int]", **OPTIONS)
    assert methods("json.decoder", **OPTIONS, kw_only=True)
    assert methods("copy", **OPTIONS)
    assert methods("json", **OPTIONS)


LOOKS = """
import contextlib, dataclasses, importlib, inspect, pkgutil, re, sys
import radmpc
if sys.argv[1:]:
    from radmpc.console.running.late_dataclasses import make_methods_late
    make_methods_late("radmpc")
for module in pkgutil.walk_packages(radmpc.__path__, "radmpc."):
    if not module.name.endswith("__main__"):
        with contextlib.suppress(ImportError):  # of what is not installed
            importlib.import_module(module.name)
for name, module in sorted(sys.modules.items()):
    for kind in vars(module).values() if name.startswith("radmpc.") else ():
        if inspect.isclass(kind) and kind.__module__ == name and dataclasses.is_dataclass(kind):
            fields = [(f.name, f.init, f.compare) for f in dataclasses.fields(kind)]
            own = [n for n in vars(kind) if not n.startswith("__") or n == "__slots__"]
            takes = re.sub("0x[0-9a-f]+", "", str(inspect.signature(kind)))
            print(name, kind.__qualname__, takes, fields, sorted(own), sep="|")
"""


@pytest.mark.slow
def test_the_classes_of_the_package_are_the_same() -> None:
    told = [
        subprocess.run(
            [sys.executable, "-c", LOOKS, *words],
            capture_output=True, text=True, timeout=60, check=True,
        ).stdout.splitlines()
        for words in ([], ["late"])
    ]  # fmt: skip
    assert len(told[0]) > 300
    assert told[1] == told[0]
