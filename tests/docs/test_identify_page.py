from __future__ import annotations

import json
from pathlib import Path

import pytest
from pages import ROOT, first_column, section
from typer.testing import CliRunner

from radmpc.cli import app
from radmpc.importing.logs.csv_log import COLUMNS
from simulator import Truth, as_csv, fly

PAGE = ROOT / "docs" / "identify.md"


def test_the_keys_that_identify_prints_are_those_of_its_table(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("wind.csv").write_text(as_csv(fly(Truth(steps=60), 1)), encoding="utf-8")
    result = CliRunner().invoke(app, ["identify", "wind.csv", "--json"])
    assert result.exit_code == 0, result.output
    content = json.loads(result.stdout)
    keys = [*content, *(f"groups[].{key}" for group in content["groups"] for key in group)]
    assert sorted(keys) == sorted(first_column(section(PAGE, "## `radmpc identify --json`")))


def test_the_page_names_every_column_of_csv() -> None:
    text = section(PAGE, "## Logs")
    assert [name for name in COLUMNS if f"`{name}`" not in text] == []
