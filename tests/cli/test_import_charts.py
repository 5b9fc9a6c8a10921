"""Several charts imported by one command."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from importing.test_chart_files import KML, block, chart, ends, feature, place, point
from radmpc.io.native.scenario_file import load_scenario

from .conftest import Run, assert_one_line

RING = [
    place(x, y) for x, y in ((-0.6, -0.1), (-0.4, -0.1), (-0.4, 0.1), (-0.6, 0.1), (-0.6, -0.1))
]
"""Around where vehicle a starts."""


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


@pytest.mark.parametrize(
    ("drawn", "told"),
    [
        (point(0.0, 0.0, role="via", vehicle="a", before=4), "cannot be in the box of via[0]"),
        (
            feature("LineString", RING, role="obstacle", name="fence"),
            "obstacle 'fence' leaves no opening",
        ),
    ],
)
def test_what_rules_out_a_plan_at_first_sight_is_told_as_by_check(
    run: Run, tmp_path: Path, drawn: dict[str, Any], told: str
) -> None:
    chart(tmp_path, "bay.geojson", *ends("a", 0.0), drawn)
    options = ("--dt", "2", "--horizon", "20", "--noise", "0.01")
    imported = run("import", "bay.geojson", "-o", "bay.yaml", *options)
    assert imported.exit_code == 0, imported.stderr
    assert any("no plan: " in one and told in one for one in imported.stdout.splitlines())
    assert "no plan: " in run("check", "bay.yaml").stdout


def test_ranges_that_are_lost_at_the_start_are_told(run: Run, tmp_path: Path) -> None:
    features = [*ends("a", 0.0), *ends("b", 0.5)]
    features[0]["properties"].update(keep="b", range=50)
    chart(tmp_path, "bay.geojson", *features)
    text = run("import", "bay.geojson", "-o", "bay.yaml").stdout
    assert "no plan: The starts of vehicles 'a' and 'b' are" in text
