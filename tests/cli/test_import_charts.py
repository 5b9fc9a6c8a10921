"""Several charts imported by one command."""

from __future__ import annotations

from pathlib import Path

import pytest

from importing.test_chart_files import KML, block, chart, ends
from radmpc.io.native.scenario_file import load_scenario

from .conftest import Run, assert_one_line


@pytest.fixture
def charts(tmp_path: Path) -> Path:
    (tmp_path / "land.kml").write_text(KML, encoding="utf-8")
    chart(tmp_path, "fleet.geojson", *ends("a", 0.0), block(0, 0.1, name="pier"))
    return tmp_path


def test_charts_are_imported_together_by_layers(run: Run, charts: Path) -> None:
    layers = ("--layer", "fleet", "--layer", "shore=obstacle")
    result = run("import", "fleet.geojson", "land.kml", "-o", "both.yaml", *layers)
    assert result.exit_code == 0, result.stderr
    assert "fleet, shore as obstacle, as asked" in result.stdout
    names = [obstacle.name for obstacle in load_scenario(charts / "both.yaml").obstacles]
    assert names == ["pier", "quay"]


def test_a_chart_is_never_written_over(run: Run, charts: Path) -> None:
    result = run("import", "fleet.geojson", "land.kml", "-o", "land.kml")
    assert result.exit_code == 2
    assert "it is what is read" in assert_one_line(result.stderr)
