"""Whom obstacles concern and who keeps which range, in what is exported."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from exported_plans import HARBOR, contents, plan_of

from radmpc.importing.formats import import_scenario
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.relations.concerns import all_but, only_for
from radmpc.model.relations.keep import Keep

SPACE = "http://www.opengis.net/kml/2.2"


def related() -> Plan:
    """Return a plan in the harbor whose mole is for one vehicle, whose barge is for all but one."""
    planned = plan_of(HARBOR)
    mole, barge, ship = planned.scenario.obstacles
    obstacles = (only_for(mole, ["tug"]), all_but(barge, ["pilot 7"]), ship)
    keep = (Keep(["pilot 7", "tug"], 8000.5),)
    return replace(planned, scenario=replace(planned.scenario, obstacles=obstacles, keep=keep))


def goal(feature: dict[str, Any]) -> dict[str, Any]:
    """A box as the point that imports take for a goal."""
    geometry = feature["geometry"]
    if geometry["type"] == "Polygon":
        (west, south, _), _, (east, north, _) = geometry["coordinates"][0][:3]
        middle = [0.5 * (west + east), 0.5 * (south + north)]
        feature = feature | {"geometry": {"type": "Point", "coordinates": middle}}
    return feature


def test_imports_read_the_relations_that_maps_export(tmp_path: Path) -> None:
    planned = related()
    (content,) = contents(planned, "geojson").values()
    features = {"goal": list[Any](), "start": [], "path": [], "obstacle": []}
    for one in json.loads(content)["features"]:
        features[one["properties"]["kind"]].append(one)
    drawn = [*features["start"], *map(goal, features["goal"]), *features["obstacle"][:3]]
    path = tmp_path / "harbor.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", "features": drawn}), encoding="utf-8")
    again = import_scenario(path).scenario

    def whom(obstacles: tuple[Obstacle, ...]) -> list[object]:
        return [(obstacle.name, obstacle.concerns) for obstacle in obstacles]

    assert whom(again.obstacles) == whom(planned.scenario.obstacles)
    assert again.keep == planned.scenario.keep


def test_google_earth_gets_relations_as_extended_data(tmp_path: Path) -> None:
    (content,) = contents(related(), "kml").values()
    told = {}
    for mark in ElementTree.fromstring(content).iter(f"{{{SPACE}}}Placemark"):
        data = mark.findall(f"{{{SPACE}}}ExtendedData/{{{SPACE}}}Data")
        stated = {one.get("name"): one.findtext(f"{{{SPACE}}}value") for one in data}
        told[mark.findtext(f"{{{SPACE}}}name")] = stated
    assert {name: stated for name, stated in told.items() if stated} == {
        "pilot 7: start": {"keep": "tug", "range": "8000.5"},
        "mole": {"for": "tug"},
        "barge": {"except": "pilot 7"},
    }


def test_relations_in_google_earth_keep_to_the_schema(tmp_path: Path) -> None:
    pytest.importorskip("lxml")
    validator = pytest.importorskip("fastkml.validator")
    (content,) = contents(related(), "kml").values()
    file = tmp_path / "harbor.kml"
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    schema = Path(validator.__file__).parent / "schema" / "kml22gx.xsd"
    assert validator.validate(file_to_validate=file, schema=schema)
