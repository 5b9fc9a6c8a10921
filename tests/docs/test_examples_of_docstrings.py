from __future__ import annotations

import doctest
from importlib import import_module

import pytest
from pages import ROOT

import radmpc

SOURCE = ROOT / "src"
# Only files with examples are imported: others may need what is not installed.
NAMES = [
    ".".join(path.relative_to(SOURCE).with_suffix("").parts).removesuffix(".__init__")
    for path in sorted(SOURCE.rglob("*.py"))
    if ">>>" in path.read_text(encoding="utf-8")
]

MET_MOST = [
    *("load_scenario", "save_scenario", "plan", "certify", "simulate", "save_plan", "load_plan"),
    *("Vehicle", "Goal", "Risk", "LedgerRow", "Coupling", "identify", "Track", "import_scenario"),
    *("ImportOptions", "save_export", "plot_plan", "plot_ledger", "plot_risk", "plot_distances"),
    *("save_figure", "animate_plan", "save_animation"),
]


def test_there_are_docstrings_with_examples() -> None:
    assert {"radmpc", "radmpc.planners.planner"} <= set(NAMES)


@pytest.mark.parametrize("name", MET_MOST)
def test_what_users_meet_most_has_an_example(name: str) -> None:
    assert ">>>" in (getattr(radmpc, name).__doc__ or "")


@pytest.mark.parametrize("name", NAMES)
def test_examples_in_docstrings_say_what_they_print(name: str) -> None:
    failed, attempted = doctest.testmod(import_module(name))
    assert attempted > 0
    assert failed == 0
