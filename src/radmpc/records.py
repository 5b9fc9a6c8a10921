"""Dataclasses as the standard library's, without the wait for code that most runs never use.

The standard library writes up to six functions of a class as text and compiles them, which takes
half a millisecond; a command loads more than two hundred and makes values of half of them. Here
the standard library finds the fields and makes the slots, ``__init__`` is compiled at its
first use, and the others are functions that know the names of their fields.
"""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, field, fields, replace
from operator import attrgetter
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

__all__ = ["FrozenDict", "FrozenList", "Kept", "asdict", "dataclass", "field", "fields", "replace"]

_Methods = Mapping[str, object]

_Value = TypeVar("_Value")
_Result = TypeVar("_Result")


def _dataclass(
    *, slots: bool, frozen: bool = False, eq: bool = True, repr: bool = True
) -> Callable[[type], type]:
    """Return what makes a dataclass with slots of a class.

    It behaves as the standard library's. What nothing here uses is missing: order, keywords alone,
    values for ``__post_init__`` alone.

    Parameters
    ----------
    slots : bool
        True; written out for those who know it from the standard library.
    frozen, eq, repr : bool
        As there.
    """
    if not slots:
        raise TypeError("dataclasses without slots are the standard library's")

    def decorate(kind: type) -> type:
        made: type = dataclasses.dataclass(init=False, repr=False, eq=False, slots=True)(kind)
        methods: dict[str, object] = {"__init__": _LateInit(made)}
        if repr:
            methods["__repr__"] = _shown
        if frozen:
            methods |= _frozen(made)
        if eq:
            methods |= _compared(made, is_hashed=frozen)
        for name, method in methods.items():
            # Python itself writes that a class with an __eq__ has no hash.
            if name not in vars(made) or (name == "__hash__" and made.__hash__ is None):
                setattr(made, name, method)
        return made

    return decorate


class Kept:
    """What was computed of a value that does not change, kept for the next request.

    A field of it, made anew for each value: what others are made of one, by copies with changes or
    by pickles, begins with nothing.
    """

    __slots__ = ("_found",)

    def __init__(self) -> None:
        self._found: dict[Callable[..., Any], Any] = {}

    def __reduce__(self) -> tuple[type[Kept], tuple[()]]:
        """Return what makes an empty one."""
        return Kept, ()

    def once(self, compute: Callable[[_Value], _Result], value: _Value) -> _Result:
        """Return what a function makes of the value that this belongs to.

        Parameters
        ----------
        compute : callable
            The function.
        value : object
            That value.
        """
        if compute not in self._found:
            self._found[compute] = compute(value)
        found: _Result = self._found[compute]
        return found


def _refuse(_self: object, *_: Any, **__: Any) -> NoReturn:
    """Refuse to change what belongs to a frozen value."""
    kind, copy = ("list", "list") if isinstance(_self, list) else ("mapping", "dict")
    raise TypeError(f"this {kind} belongs to a frozen value: make a {copy} of it to change it")


class FrozenDict(dict[str, Any]):
    """A mapping of a frozen value: a deep, read-only copy of the caller's.

    A dict, so that JSON, pickles and copies take it as they take any.
    """

    __slots__ = ()

    def __init__(self, given: Mapping[str, Any]) -> None:
        super().__init__((key, _copied(value)) for key, value in given.items())

    def __reduce__(self) -> tuple[type[FrozenDict], tuple[dict[str, Any]]]:
        """Return what makes an equal one."""
        return FrozenDict, (dict(self),)

    __setitem__ = __delitem__ = __ior__ = _refuse
    clear = pop = popitem = setdefault = update = _refuse


class FrozenList(list[Any]):
    """A list within a `FrozenDict`, copied and read-only as that is.

    A list, for the same reason.
    """

    __slots__ = ()

    def __init__(self, given: Iterable[Any]) -> None:
        super().__init__(map(_copied, given))

    def __reduce__(self) -> tuple[type[FrozenList], tuple[list[Any]]]:
        """Return what makes an equal one."""
        return FrozenList, (list(self),)

    __setitem__ = __delitem__ = __iadd__ = __imul__ = _refuse
    append = extend = insert = pop = remove = clear = sort = reverse = _refuse


def _copied(value: Any) -> Any:
    """Return a copy of what dicts, lists and tuples hold, frozen; numpy's values as Python's."""
    if isinstance(value, Mapping):
        return FrozenDict(value)
    # Not imported: where nobody has, there are none of its values.
    numpy = sys.modules.get("numpy")
    if numpy is not None and isinstance(value, (numpy.ndarray, numpy.generic)):
        value = value.tolist()
    if type(value) is tuple:
        return tuple(map(_copied, value))
    return FrozenList(value) if type(value) in {list, FrozenList} else value


class _LateInit:
    """A class's ``__init__`` until its first use."""

    __slots__ = ("_owner",)

    def __init__(self, owner: type) -> None:
        self._owner = owner

    def __get__(self, value: object, kind: type) -> object:
        made = _compiled_init(self._owner)
        self._owner.__init__ = made  # type: ignore[misc] # in its own place
        return made.__get__(value, kind)


class _Factory:
    """Stands in signatures for what is made anew for each value."""

    def __repr__(self) -> str:
        return "<factory>"


def _compiled_init(kind: Any) -> Any:
    """Return an ``__init__`` with the fields' parameters and defaults."""
    parameters, lines = ["self"], []
    scope: dict[str, Any] = {"_factory": _Factory()}
    for one in fields(kind):
        name = value = parameter = one.name
        scope[f"_put_{name}"] = getattr(kind, name).__set__  # of its slot
        scope[f"_default_{name}"], scope[f"_make_{name}"] = one.default, one.default_factory
        if one.default_factory is not dataclasses.MISSING:
            parameter = f"{name}=_factory"
            value = f"_make_{name}() if {name} is _factory else {name}"
        elif one.default is not dataclasses.MISSING:
            parameter = f"{name}=_default_{name}"
        if one.init:
            parameters.append(parameter)
        elif parameter == name:
            continue
        else:
            value = f"_make_{name}()" if parameter.endswith("=_factory") else f"_default_{name}"
        lines.append(f"_put_{name}(self, {value})")
    if hasattr(kind, "__post_init__"):
        lines.append("self.__post_init__()")
    head, body = f"def __init__({', '.join(parameters)}):", "\n  ".join(lines or ["pass"])
    text = f"def make({', '.join(scope)}):\n {head}\n  {body}\n return __init__"
    around = vars(sys.modules[kind.__module__]) if kind.__module__ in sys.modules else {}
    found: dict[str, Any] = {}
    exec(text, around, found)
    made = found["make"](**scope)
    made.__qualname__ = f"{kind.__qualname__}.__init__"
    made.__annotations__ = {one.name: one.type for one in fields(kind) if one.init}
    made.__annotations__["return"] = None
    return made


@recursive_repr()
def _shown(value: Any) -> str:
    """Return the fields by name."""
    shown = (f"{one.name}={getattr(value, one.name)!r}" for one in fields(value) if one.repr)
    return f"{type(value).__qualname__}({', '.join(shown)})"


def _frozen(kind: Any) -> _Methods:
    """Return what keeps values from being changed, and lets them be copied nevertheless."""
    names = frozenset(one.name for one in fields(kind))

    def refuse_to_set(self: object, name: str, value: object) -> None:
        if type(self) is kind or name in names:
            raise dataclasses.FrozenInstanceError(f"cannot assign to field {name!r}")
        super(kind, self).__setattr__(name, value)

    def refuse_to_delete(self: object, name: str) -> None:
        if type(self) is kind or name in names:
            raise dataclasses.FrozenInstanceError(f"cannot delete field {name!r}")
        super(kind, self).__delattr__(name)

    return {
        "__setattr__": refuse_to_set,
        "__delattr__": refuse_to_delete,
        "__getstate__": _state,
        "__setstate__": _put_state,
    }


def _state(value: Any) -> list[object]:
    """Return what a pickle keeps."""
    return [getattr(value, one.name) for one in fields(value)]


def _put_state(value: Any, state: list[object]) -> None:
    """Write what a pickle has kept."""
    for one, kept in zip(fields(value), state, strict=True):
        object.__setattr__(value, one.name, kept)


def _compared(kind: Any, *, is_hashed: bool) -> _Methods:
    """Return what compares values field by field, and hashes those that do not change."""
    names = [one.name for one in fields(kind) if one.compare]

    def few(value: object) -> tuple[object, ...]:
        return tuple(getattr(value, name) for name in names)

    entries: Callable[[object], object] = attrgetter(*names) if len(names) > 1 else few

    def is_equal(self: object, other: object) -> object:
        if other.__class__ is not self.__class__:
            return NotImplemented
        return entries(self) == entries(other)

    def hashed(self: object) -> int:
        return hash(entries(self))

    return {"__eq__": is_equal, "__hash__": hashed if is_hashed else None}


if TYPE_CHECKING:
    from dataclasses import dataclass
else:
    dataclass = _dataclass
