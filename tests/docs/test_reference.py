from __future__ import annotations

import inspect

from pages import ROOT
from reference import arguments, attributes, functions, raised, sections, shown

import radmpc


def test_every_public_name_stands_in_the_reference() -> None:
    overview = (ROOT / "docs" / "reference" / "index.md").read_text(encoding="utf-8")
    public = set(radmpc.__all__) - {"__version__"}
    assert public - {path.removeprefix("radmpc.") for path in shown()} == set()
    errors = {name for name in public if name.endswith("Error")}
    assert [name for name in public - errors if f"`{name}`" not in overview] == []


def test_every_public_name_is_loaded_from_where_it_stands() -> None:
    for name in radmpc.__all__:
        assert getattr(radmpc, name) is not None
    assert dir(radmpc) == sorted(radmpc.__all__)


def test_everything_in_the_reference_says_what_it_is() -> None:
    told = {path: v for path, v in shown().items() if inspect.isclass(v) or inspect.isfunction(v)}
    assert [path for path, value in {**told, **functions()}.items() if not value.__doc__] == []


def test_functions_tell_every_argument() -> None:
    silent = {
        path: missing
        for path, function in functions().items()
        if (missing := set(arguments(function)) - set(sections(function).get("parameters", [])))
    }
    assert silent == {}


def test_functions_document_no_argument_that_they_do_not_have() -> None:
    false = {
        path: extra
        for path, function in functions().items()
        if (extra := set(sections(function).get("parameters", [])) - set(arguments(function)))
    }
    assert false == {}


def test_functions_tell_what_they_return() -> None:
    silent = [
        path
        for path, function in functions().items()
        if inspect.signature(function).return_annotation not in {"None", None}
        and "returns" not in sections(function)
    ]
    assert silent == []


def test_functions_tell_what_they_raise() -> None:
    silent = {
        path: missing
        for path, function in functions().items()
        if (
            missing := raised(function)
            - set(", ".join(sections(function).get("raises", [])).split(", "))
        )
    }
    assert silent == {}


def test_records_tell_every_attribute() -> None:
    silent = {
        path: missing
        for path, value in shown().items()
        if inspect.isclass(value)
        and (missing := set(attributes(value)) - set(sections(value).get("attributes", [])))
    }
    assert silent == {}
