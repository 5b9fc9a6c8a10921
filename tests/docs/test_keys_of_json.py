from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path

import pytest
from pages import ROOT, first_column, section
from typer.testing import CliRunner

from radmpc.cli import app
from radmpc.model.plan import Coupling

FORMATS = ROOT / "docs" / "formats.md"
PLANS = "## Plans: `radmpc/plan/1`"

# Mappings whose keys are data: stages, packages; and those with a table of their own.
LEAVES = {"seconds", "versions", "scenario"}


def keys(value: dict[str, object], before: str = "") -> Iterator[str]:
    """Keys of an object as the tables write them: ``planners[].name``."""
    for name, content in value.items():
        yield before + name
        if isinstance(content, list) and content and isinstance(content[0], dict):
            for item in content:
                yield from keys(item, f"{before}{name}[].")


def deep_keys(value: dict[str, object], before: str = "") -> Iterator[str]:
    """The same, with the keys of mappings within: ``planners[].kept_back.share``."""
    for name, content in value.items():
        if isinstance(content, dict):
            yield from deep_keys(content, f"{before}{name}.")
            continue
        yield before + name
        if isinstance(content, list) and content and isinstance(content[0], dict):
            for item in content:
                yield from deep_keys(item, f"{before}{name}[].")


def printed(*words: str) -> dict[str, object]:
    result = CliRunner().invoke(app, [*words, "--json"])
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


@pytest.mark.parametrize(
    "words",
    [
        ("verify", "fleet.plan.json", "--samples", "1000"),
        ("compare", "fleet.yaml", "--planners", "radmpc,certified", "--samples", "1000"),
        ("planners",),
        ("fly", "fleet.plan.json", "--replan", "none"),
    ],
    ids=lambda words: words[0],
)
def test_the_keys_that_a_command_prints_are_those_of_its_table(
    words: tuple[str, ...], workbench: Path
) -> None:
    told = first_column(section(FORMATS, f"### `radmpc {words[0]} --json`"))
    assert sorted(set(keys(printed(*words)))) == sorted(told)


def test_the_keys_that_check_prints_are_those_of_its_table() -> None:
    scene = ROOT / "tests" / "data" / "scenes" / "goal-too-near-fleet.yaml"
    told = first_column(section(FORMATS, "### `radmpc check --json`"))
    assert sorted(set(deep_keys(printed("check", str(scene))))) == sorted(told)


def test_a_comparison_that_failed_has_keys_of_the_table(workbench: Path) -> None:
    from radmpc.console.commands.comparing import _as_json  # noqa: PLC0415 - what such a line is made by
    from radmpc.experiments.comparing import Comparison  # noqa: PLC0415 - one case asks for it

    failed = Comparison("ira", None, None, "the solver broke")
    told = first_column(section(FORMATS, "### `radmpc compare --json`"))
    assert {f"planners[].{name}" for name in _as_json(failed)} <= set(told)


def test_the_keys_of_a_plan_file_are_those_of_its_table(workbench: Path) -> None:
    plan = json.loads(Path("fleet.plan.json").read_text(encoding="utf-8"))
    told = set(first_column(section(FORMATS, PLANS)))
    flat = {name for name in plan if name != "risk"} | {f"risk.{name}" for name in plan["risk"]}
    rows = set(plan["risk"]["ledger"][0]) | set(plan["vehicles"][0])
    coupling = {field.name for field in fields(Coupling)}
    # The price is absent where the planner does not know it.
    assert told | {"risk.price"} == flat | rows | coupling | {"risk.price"}


def test_plan_prints_its_plan_file_without_vehicles(workbench: Path) -> None:
    shown = printed("plan", "fleet.yaml", "-o", "again.plan.json")
    written = json.loads(Path("again.plan.json").read_text(encoding="utf-8"))
    assert shown.keys() == written.keys() - {"vehicles"}


def test_the_keys_of_a_flight_file_are_those_of_its_tables(workbench: Path) -> None:
    printed("fly", "fleet.plan.json", "--replan", "none", "-o", "fleet.flight.jsonl")
    lines = Path("fleet.flight.jsonl").read_text(encoding="utf-8").splitlines()
    first, second = (set(json.loads(line)) - {"digest"} for line in lines[:2])
    told = first_column(section(FORMATS, "## A flight: `radmpc/flight/1`"))
    # Left out where covariances are known, and where all were measured or nobody was.
    for name in ("scale", "partly"):
        told.remove(name)
    assert sorted(first) + sorted(second) == sorted(told[: len(first)]) + sorted(told[len(first) :])
