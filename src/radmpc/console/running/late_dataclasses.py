"""Methods of dataclasses are made when they are first needed, for commands that end soon.

Python writes five methods of a frozen dataclass and compiles them where the class stands: a sixth
of the time of `plan` for two vehicles. Of the classes that it loads a third has no instance, hardly
any is printed or compared, and that values stay as they are needs no code of each class.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from functools import partial
from threading import RLock
from typing import Any, NoReturn

__all__ = ["late", "make_methods_late"]

_USUAL = dataclasses.dataclass
_KNOWN = {"frozen", "slots", "eq", "repr"}
_OTHER_KINDS = ("ClassVar", "InitVar", "KW_ONLY")
_LOCK = RLock()


def make_methods_late(package: str) -> None:
    """Let a package's frozen dataclasses with slots get their methods when they are first needed.

    Parameters
    ----------
    package : str
        Of its classes those that are loaded from now on; all others are made as usual.
    """

    def dataclass(kind: type | None = None, /, **options: Any) -> Any:
        if kind is None:
            return lambda decorated: dataclass(decorated, **options)
        is_ours = kind.__module__.startswith(f"{package}.") and _is_plain(kind, options)
        return late(kind, options) if is_ours else _USUAL(kind, **options)

    dataclasses.dataclass = dataclass


def _is_plain(kind: type, options: Mapping[str, object]) -> bool:
    """Whether a class has nothing that only Python's own decorator knows to handle."""
    return (
        bool(options.get("frozen") and options.get("slots"))
        and options.keys() <= _KNOWN
        and not any("__dataclass_fields__" in vars(base) for base in kind.__mro__)
        and not any(
            isinstance(hint, str) and any(word in hint for word in _OTHER_KINDS)
            for hint in vars(kind).get("__annotations__", {}).values()
        )
    )


class _Later:
    """An attribute of a class that is made when somebody asks for it."""

    __slots__ = ("_make",)

    def __init__(self, make: Callable[[], Any]) -> None:
        self._make = make

    def __get__(self, instance: object, owner: type | None = None) -> Any:
        made = self._make()
        return made.__get__(instance, owner) if callable(made) else made


def late(original: type, options: Mapping[str, Any]) -> type:
    """Return the class with slots in place of its fields, and its methods to come.

    Parameters
    ----------
    original : type
        As it was written; Python's own decorator gets it once anything but ``__init__`` is needed.
    options : mapping of str to object
        Of the decorator.
    """
    names = tuple(vars(original).get("__annotations__", {}))
    members = {
        name: value
        for name, value in vars(original).items()
        if name not in {*names, "__dict__", "__weakref__"}
    }
    given = {name: vars(original)[name] for name in names if name in vars(original)}
    later = {"__dataclass_fields__", "__dataclass_params__", "__match_args__"}
    if options.get("repr", True):
        later.add("__repr__")
    if options.get("eq", True):
        later |= {"__eq__", "__hash__"}
    # A class that has `__eq__` of its own has None for a hash, which is none of its own.
    later = {name for name in later if members.get(name) is None}

    def finish(name: str) -> Any:
        with _LOCK:
            if "__dataclass_fields__" not in vars(original):
                _USUAL(original, **{**options, "slots": False})
            for each in later:
                if isinstance(vars(made).get(each), _Later):
                    setattr(made, each, vars(original)[each])
        return vars(made)[name]

    def initializer() -> Any:
        method = _initializer(made, names, given)
        made.__init__ = method  # type: ignore[misc] # as Python's own decorator does
        return method

    members |= {"__slots__": names, "__setattr__": _refuse_to_set, "__delattr__": _refuse_to_delete}
    members.setdefault("__getstate__", _state)
    members.setdefault("__setstate__", _set_state)
    members.setdefault("__init__", _Later(initializer))
    members |= {name: _Later(partial(finish, name)) for name in later}
    made = type(original)(original.__name__, original.__bases__, members)
    made.__qualname__ = original.__qualname__
    return made


def _initializer(kind: type, names: tuple[str, ...], given: Mapping[str, Any]) -> Any:
    """Return a class's ``__init__``: a parameter for each field, then ``__post_init__``.

    Parameters
    ----------
    kind : type
        With a slot for each field.
    names : tuple of str
        Of the fields.
    given : mapping of str to object
        What stands behind their equals signs: defaults, or what `dataclasses.field` returns.
    """
    parameters, lines = ["_self"], []
    known: dict[str, Any] = {"_asked": _ASKED}
    for name in names:
        value = given.get(name, dataclasses.MISSING)
        is_field = isinstance(value, dataclasses.Field)
        default = value.default if is_field else value
        factory = value.default_factory if is_field else dataclasses.MISSING
        known |= {f"_set_{name}": vars(kind)[name].__set__, f"_default_{name}": default}
        source = name
        if factory is not dataclasses.MISSING:
            known |= {f"_default_{name}": _ASKED, f"_make_{name}": factory}
            source = f"_make_{name}() if {name} is _asked else {name}"
        is_given = default is not dataclasses.MISSING or factory is not dataclasses.MISSING
        if not is_field or value.init:
            parameters.append(f"{name}=_default_{name}" if is_given else name)
        elif is_given:
            source = f"_default_{name}" if factory is dataclasses.MISSING else f"_make_{name}()"
        else:
            continue
        lines.append(f"_set_{name}(_self, {source})")
    if hasattr(kind, "__post_init__"):
        lines.append("_self.__post_init__()")
    text = f"def __init__({', '.join(parameters)}):\n " + "\n ".join(lines or ["pass"])
    exec(text, known)
    made = known["__init__"]
    made.__qualname__ = f"{kind.__qualname__}.__init__"
    made.__module__ = kind.__module__
    hints = vars(kind).get("__annotations__", {})
    # After "_self", up to what is said of defaults.
    told = (name.partition("=")[0] for name in parameters[1:])
    made.__annotations__ = {name: hints[name] for name in told} | {"return": None}
    return made


class _Asked:
    """Default of a parameter whose value a factory makes."""

    def __repr__(self) -> str:
        return "<factory>"


_ASKED = _Asked()


def _refuse_to_set(self: object, name: str, value: object) -> NoReturn:
    """Keep an instance as it is."""
    del self, value
    raise dataclasses.FrozenInstanceError(f"cannot assign to field {name!r}")


def _refuse_to_delete(self: object, name: str) -> NoReturn:
    """Keep an instance as it is."""
    del self
    raise dataclasses.FrozenInstanceError(f"cannot delete field {name!r}")


def _state(self: Any) -> list[object]:
    """Return what pickles and copies keep."""
    return [getattr(self, field.name) for field in dataclasses.fields(self)]


def _set_state(self: Any, state: list[object]) -> None:
    """Take what pickles and copies have kept."""
    for field, value in zip(dataclasses.fields(self), state, strict=True):
        object.__setattr__(self, field.name, value)
