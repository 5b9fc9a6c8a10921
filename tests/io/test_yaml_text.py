from __future__ import annotations

import math

import pytest
from ruamel.yaml import YAML

from radmpc.errors import FileFormatError
from radmpc.io.text.yaml_text import read_yaml
from radmpc.io.text.yaml_writing import write_yaml


def value_of(text: str) -> object:
    return read_yaml(text, "f.yaml")[0]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e-3", 1e-3),
        ("1.0e+3", 1000.0),
        (".5", 0.5),
        ("5.", 5.0),
        ("-7", -7),
        ("+7", 7),
        ("010", 10),
        ("0o10", 8),
        ("0x1f", 31),
        ("1_000", "1_000"),
        ("yes", "yes"),
        ("off", "off"),
        ("12:30", "12:30"),
        ("true", True),
        ("False", False),
        ("~", None),
        ("null", None),
        ("'1'", "1"),
        ('"true"', "true"),
        (".inf", math.inf),
        ("-.INF", -math.inf),
        ("2001-01-01", "2001-01-01"),
    ],
)
def test_scalars_mean_what_yaml_1_2_says(text: str, value: object) -> None:
    read = value_of(f"[{text}]")
    assert read == [value]
    assert type(read[0]) is type(value)


def test_values_agree_with_an_independent_reader() -> None:
    text = "a: [1, 2.5, {b: c, d: ~}]\ne:\n- f: 'g'\n  h: >-\n    i\n    j\n- [true, 1e-3]\nk:\n"
    assert value_of(text) == YAML(typ="safe", pure=True).load(text)


def test_an_alias_repeats_its_anchor() -> None:
    assert value_of("a: &x [1, 2]\nb: *x\nc: {d: *x}") == {
        "a": [1, 2],
        "b": [1, 2],
        "c": {"d": [1, 2]},
    }


def test_places_know_the_line_of_every_part() -> None:
    _, places = read_yaml("a:\n  b: 1\n  c:\n    - 2\n    - {d: 3}\n", "f.yaml")
    assert places.line_of(("a",)) == 1
    assert places.line_of(("a", "c")) == 3
    assert places.line_of(("a", "c", 1)) == 5
    assert places.line_of(("a", "c", 1, "d", "not", "there")) == 5
    assert places.line_of(("z",)) == 1
    assert places.line_of(("a", 0)) == 1
    assert places.line_of(("a", "c", "x")) == 3
    assert places.line_of(("a", "c", 7)) == 3


def test_an_anchor_named_twice_stands_for_the_later_one() -> None:
    assert value_of("[&x 1, &x 2, *x]") == [1, 2, 2]


def test_an_alias_as_a_key_is_refused() -> None:
    with pytest.raises(FileFormatError, match=r"f.yaml:2: keys must be text"):
        value_of("a: &x b\n*x : 1\n")


@pytest.mark.parametrize(
    "value",
    [
        {"text": 'it\'s: #\n\t"x" \x7f\x85\u2028 é 😀'},
        {"true": "yes", "": "", "1": "1", "a b": "~", "-": "- x"},
        {"numbers": [1e-05, -1e300, 0.1, 5.0, -0.0, 7, 1e22]},
        {"long": ["x" * 60, "y" * 60], "none": None, "flag": True, "empty": {}, "no": []},
        {"nested": [{"a": "x" * 60, "b": [1, 2]}, {"a": "y" * 60, "b": {"c": "z" * 60}}]},
        {"deep": [[["x" * 60], ["y" * 60]], []]},
    ],
)
def test_written_yaml_reads_back_equal_here_and_elsewhere(value: dict[str, object]) -> None:
    text = write_yaml(value)
    assert value_of(text) == value
    assert YAML(typ="safe", pure=True).load(text) == value


def test_small_floats_are_written_with_a_point_for_older_readers() -> None:
    assert write_yaml({"a": 1e-05}) == "a: 1.0e-05\n"
