"""What the page's protocol.ts and scenes.ts name, the server's protocol.py names too."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NotRequired, get_args, get_origin, get_type_hints, is_typeddict

import pytest

from radmpc.serving import protocol
from radmpc.serving.desk.calls import _CALLS

SOURCES = Path(__file__).parents[2] / "web" / "src"
TEXT = "".join((SOURCES / f"{name}.ts").read_text("utf-8") for name in ("protocol", "scenes"))
TEXT = re.sub(r"/\*.*?\*/|//[^\n]*", "", TEXT, flags=re.DOTALL)
INTERFACES = dict(re.findall(r"export interface (\w+) \{(.*?)\n\}", TEXT, re.DOTALL))
ARGUMENTS = {"Calls"}


def named(body):
    """Return the fields of an interface, and whether each may be missing."""
    flat = re.sub(r"\{[^{}]*\}", "", body)
    found = re.findall(r"(?:^|;|\n)\s*(?:readonly )?(\w+)(\??):", flat)
    return {name: bool(mark) for name, mark in found}


@pytest.mark.parametrize("name", sorted(INTERFACES.keys() - ARGUMENTS))
def test_an_interface_of_the_page_has_the_same_fields_here(name):
    ours = getattr(protocol, name)
    assert is_typeddict(ours)
    hints = get_type_hints(ours, include_extras=True)
    optional = {key: get_origin(hint) is NotRequired for key, hint in hints.items()}
    assert optional == named(INTERFACES[name])


def test_every_typed_dict_here_is_told_to_the_page():
    ours = {name for name in protocol.__all__ if is_typeddict(getattr(protocol, name))}
    assert ours - INTERFACES.keys() == {"Collision", "Named"}  # spelled out where they are used


def test_calls_and_events_are_the_same_and_all_are_answered():
    calls = re.findall(r"^\s+(\w+): \[", INTERFACES["Calls"], re.MULTILINE)
    assert tuple(calls) == protocol.CALLS == tuple(_CALLS)
    events = re.findall(r'readonly event: "(\w+)"', TEXT)
    assert tuple(events) == protocol.EVENTS


def test_words_are_the_same():
    kinds = re.search(r"readonly kind: ([^;]*?stale[^;]*);", TEXT)[1]
    assert set(re.findall(r'"(\w+)"', kinds)) == set(get_args(protocol.FailureKind))
    for name in ("SearchState", "FlightState"):
        states = re.search(r"readonly state: ([^;]*);", INTERFACES[name])[1]
        hint = get_type_hints(getattr(protocol, name))["state"]
        assert set(re.findall(r'"(\w+)"', states)) == set(get_args(hint))


def test_socket_and_code_are_the_same():
    assert f'SOCKET = "{protocol.SOCKET}"' in TEXT
    assert f"REFUSED = {protocol.REFUSED}" in TEXT
