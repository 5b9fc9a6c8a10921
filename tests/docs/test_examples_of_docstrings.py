from __future__ import annotations

import doctest
from importlib import import_module

import pytest
from pages import ROOT

SOURCE = ROOT / "src"
# Only files with examples are imported: others may need what is not installed.
NAMES = [
    ".".join(path.relative_to(SOURCE).with_suffix("").parts).removesuffix(".__init__")
    for path in sorted(SOURCE.rglob("*.py"))
    if ">>>" in path.read_text(encoding="utf-8")
]


def test_there_are_docstrings_with_examples() -> None:
    assert {"radmpc", "radmpc.planners.planner"} <= set(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_examples_in_docstrings_say_what_they_print(name: str) -> None:
    failed, attempted = doctest.testmod(import_module(name))
    assert attempted > 0
    assert failed == 0
