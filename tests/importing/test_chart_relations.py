"""Obstacles drawn for some vehicles, and ranges that drawn vehicles keep to each other."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from radmpc.errors import FileFormatError
from radmpc.importing.formats import ImportedScenario, import_scenario
from radmpc.importing.options import ImportOptions
from radmpc.io.native.scenario_file import load_scenario, save_scenario
from radmpc.model.relations.keep import Keep
from radmpc.model.scenario import Scenario


def feature(kind: str, coordinates: object, **properties: object) -> dict[str, Any]:
    geometry = {"type": kind, "coordinates": coordinates}
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def place(east: float, north: float) -> list[float]:
    """A position in thousandths of degrees from the middle: 65 m and 111 m."""
    return [10.145 + 1e-3 * east, 54.3325 + 1e-3 * north]


def block(north: float = 0.1, size: float = 0.1, **properties: object) -> dict[str, Any]:
    steps = ((0, 0), (0.1, 0), (0.1, size), (0, size), (0, 0))
    return feature("Polygon", [[place(x, north + y) for x, y in steps]], **properties)


def vehicle(name: str, north: float, **properties: object) -> list[dict[str, Any]]:
    limits = {"radius": 1.5, "speed": 2, "acceleration": 0.5}
    return [
        feature("Point", place(-0.5, north), role="start", vehicle=name, **limits, **properties),
        feature("Point", place(0.5, north), role="goal", vehicle=name),
    ]


def chart(folder: Path, *features: object, file: str = "fleet.geojson") -> Path:
    flat = [one for part in features for one in (part if isinstance(part, list) else [part])]
    content = {"type": "FeatureCollection", "features": flat}
    (folder / file).write_text(json.dumps(content, indent=1), encoding="utf-8")
    return folder / file


def drawn(folder: Path, *features: object, **options: Any) -> ImportedScenario:
    return import_scenario(chart(folder, *features), ImportOptions(**options))


def concerns(scenario: Scenario) -> dict[str, tuple[str, ...] | None]:
    """Whom each obstacle names, exempt vehicles led by a minus."""
    found: dict[str, tuple[str, ...] | None] = {}
    for obstacle in scenario.obstacles:
        whom = obstacle.concerns
        sign = "-" if whom is not None and whom.are_exempt else ""
        found[obstacle.name] = None if whom is None else tuple(sign + n for n in whom.names)
    return found


def two() -> list[dict[str, Any]]:
    return [*vehicle("barge", 0.0), *vehicle("boat", 0.4)]


def test_obstacles_are_for_those_whom_they_name(tmp_path: Path) -> None:
    imported = drawn(
        tmp_path,
        two(),
        block(name="shallows", **{"for": "barge"}),
        block(0.6, name="zone", **{"except": ["boat", "barge"]}),
        feature("Point", place(0, -0.5), name="buoy", role="obstacle", **{"except": " boat "}),
        block(0.8, name="pier", **{"for": ""}),
    )
    assert concerns(imported.scenario) == {
        "shallows": ("barge",),
        "zone": ("-boat", "-barge"),
        "buoy": ("-boat",),
        "pier": None,
    }
    told = "shallows only barge; zone all but boat, barge; buoy all but boat"
    assert imported.choices["obstacles for some"] == told
    assert imported.warnings == ()


def test_ranges_are_kept_to_those_whom_starts_and_goals_name(tmp_path: Path) -> None:
    start, goal = vehicle("c", 0.8, keep="a", range="90")
    fleet = [*vehicle("a", 0.0, keep=["b"], range=60.5), *vehicle("b", 0.4, keep="a", range=60.5)]
    goal["properties"] |= {"keep": "b, a", "range": "50, 90"}
    imported = drawn(tmp_path, fleet, start, goal)
    keep = imported.scenario.keep
    assert keep == (Keep(["a", "b"], 60.5), Keep(["c", "a"], 90.0), Keep(["c", "b"], 50.0))
    assert imported.choices["ranges"] == "a and b 60.5 m; c and a 90 m; c and b 50 m"
    save_scenario(imported.scenario, tmp_path / "fleet.yaml")
    assert load_scenario(tmp_path / "fleet.yaml").keep == keep


def test_what_concerns_vehicles_that_are_left_out_is_not_told(tmp_path: Path) -> None:
    fleet = [
        *vehicle("a", 0.0, keep=["b", "c"], range="60.5, 90"), *vehicle("b", 0.4),
        *vehicle("c", 0.8),
    ]  # fmt: skip
    blocks = [
        block(0.2, name="boom", **{"for": "c"}),
        block(0.6, name="zone", **{"for": "a, c"}),
        block(1.0, name="pier", **{"except": "c"}),
    ]
    told = {}
    for agents in (3, 2, 1):
        imported = drawn(tmp_path, fleet, blocks, agents=agents)
        told[agents] = [imported.choices.get(key) for key in ("obstacles for some", "ranges")]
        assert imported.scenario.source["choices"] == imported.choices
    assert told == {
        3: ["boom only c; zone only a, c; pier all but c", "a and b 60.5 m; a and c 90 m"],
        2: ["zone only a", "a and b 60.5 m"],
        1: ["zone only a", None],
    }


def test_short_words_are_no_misspelled_relations(tmp_path: Path) -> None:
    words = {"foo": 1, "fro": 1, "fo": 1, "excpet": "b"}
    assert drawn(tmp_path, vehicle("a", 0.0, **words)).warnings == (
        "properties ignored: excpet (did you mean except?), fo, foo, fro",
    )


KML = """<?xml version="1.0" encoding="UTF-8"?>
<kml xmlns="http://www.opengis.net/kml/2.2"><Document>
{}
<Placemark><name>bank</name>
<ExtendedData><Data name="for"><value>a, b</value></Data></ExtendedData>
<Polygon><outerBoundaryIs><LinearRing><coordinates>10.1450,54.3340 10.1451,54.3340
10.1451,54.3342 10.1450,54.3340</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark>
</Document></kml>
"""


def test_kml_states_the_same_in_extended_data(tmp_path: Path) -> None:
    marks = ""
    for k, name in enumerate("abc"):
        for role, east in (("start", 10.1445), ("goal", 10.1455)):
            marks += (
                f'<Placemark><name>{role} {name}</name><ExtendedData><Data name="keep"><value>'
                f'{"a" if name == "b" else ""}</value></Data><Data name="range"><value>'
                f"{75 if name == 'b' else ''}</value></Data></ExtendedData><Point><coordinates>"
                f"{east},{54.3325 + 1e-4 * k}</coordinates></Point></Placemark>\n"
            )
    (tmp_path / "fleet.kml").write_text(KML.format(marks), encoding="utf-8")
    scenario = import_scenario(tmp_path / "fleet.kml").scenario
    assert concerns(scenario) == {"bank": ("a", "b")}
    assert scenario.keep == (Keep(["b", "a"], 75.0),)


def test_who_passes_through_needs_no_way_around(tmp_path: Path) -> None:
    ring = [place(x, y) for x, y in ((-1, -0.5), (1, -0.5), (1, 0.5), (-1, 0.5), (-1, -0.5))]
    area = feature("Polygon", [ring], role="area")
    shut = feature("LineString", [place(0, -1), place(0, 1)], name="bar", role="obstacle")
    everybody = drawn(tmp_path, area, vehicle("boat", 0.4), shut)
    assert "between start and goal of 'boat' a hull of" in everybody.warnings[0]
    shut["properties"]["for"] = "barge"
    barge = vehicle("barge", 0.0)
    barge[1]["geometry"]["coordinates"] = place(-0.1, 0.0)
    some = drawn(tmp_path, area, vehicle("boat", 0.4), barge, shut)
    assert some.warnings == ()


def test_of_fewer_vehicles_only_those_are_named(tmp_path: Path) -> None:
    fleet = [*two(), *vehicle("tug", 0.8, keep="boat", range=50)]
    fleet[0]["properties"] |= {"keep": "boat, tug", "range": 80}
    named = [
        block(0.1, name="one", **{"for": "barge, tug"}),
        block(-0.4, name="two", **{"for": "tug"}),
        block(-0.6, name="three", **{"except": "tug"}),
    ]
    scenario = drawn(tmp_path, fleet, named, agents=2).scenario
    assert concerns(scenario) == {"one": ("barge",), "three": None}
    assert scenario.keep == (Keep(["barge", "boat"], 80.0),)


def test_charts_mean_their_own_vehicles(tmp_path: Path) -> None:
    west = chart(
        tmp_path,
        vehicle("a", 0.0, keep="b", range=70),
        vehicle("b", 0.3),
        block(0.1, name="bank", **{"for": "a, b"}),
        file="west.geojson",
    )
    east = chart(
        tmp_path,
        vehicle("a", 0.6),
        block(0.1, name="bank", **{"for": "a"}),
        file="east.geojson",
    )
    scenario = import_scenario([west, east]).scenario
    assert concerns(scenario) == {"west/bank": ("west/a", "b"), "east/bank": ("east/a",)}
    assert scenario.keep == (Keep(["west/a", "b"], 70.0),)


def test_an_obstacle_for_some_on_one_sheet_stays_one_for_all_of_the_next(tmp_path: Path) -> None:
    one = chart(tmp_path, two(), block(name="pier", **{"for": "boat"}), file="one.geojson")
    next_one = chart(tmp_path, block(name="pier"), file="two.geojson")
    assert concerns(import_scenario([one, next_one]).scenario) == {
        "one/pier": ("boat",),
        "two/pier": None,
    }


@pytest.mark.parametrize(
    ("role", "properties", "message"),
    [
        ("obstacle", {"for": "brage"}, "for: must name vehicles that start somewhere, got 'brage'"),
        ("obstacle", {"except": "boat, boat"}, "except: must name vehicles once, got 'boat' twice"),
        ("obstacle", {"for": ["boat", 1.5]}, "for: must be names, with commas between"),
        ("obstacle", {"for": "boat", "except": "barge"}, "except: must not stand beside 'for'"),
        ("obstacle", {"keep": "boat"}, "keep: is for starts and goals, this is of the role 'obst"),
        ("area", {"for": "boat"}, "for: is for obstacles, this is of the role 'area'"),
    ],
)
def test_an_obstacle_that_names_nobody_is_one_line(
    tmp_path: Path, role: str, properties: dict[str, Any], message: str
) -> None:
    with pytest.raises(FileFormatError) as caught:
        drawn(tmp_path, two(), block(-9, 20, role=role, **properties))
    text = str(caught.value)
    assert message in text
    assert "fleet.geojson:" in text
    assert "features[4].properties" in text
    assert "\n" not in text


@pytest.mark.parametrize(
    ("properties", "message"),
    [
        ({"keep": "boat"}, "keep: needs range as well"),
        ({"range": 40}, "range: needs keep as well"),
        ({"keep": "boat", "range": "far"}, "range: must be a number > 0 m, got 'far'"),
        ({"keep": "boat", "range": -1}, "range: must be a number > 0 m, got -1"),
        ({"keep": "boat", "range": [40, 50]}, "range: must be one number, or one for each of 1"),
        ({"keep": "tug", "range": 40}, "keep: must name other vehicles, got 'tug' itself"),
        ({"keep": "ship", "range": 40}, "keep: must name vehicles that start somewhere"),
        ({"keep": "barge", "range": 40}, "range: must be 50 m of 'tug' and 'barge' as stated"),
    ],
)
def test_a_range_that_cannot_be_kept_is_one_line(
    tmp_path: Path, properties: dict[str, Any], message: str
) -> None:
    tug = vehicle("tug", 0.8)
    tug[1]["properties"] |= properties
    tug[0]["properties"] |= (
        {"keep": "barge", "range": 50} if properties.get("keep") == "barge" else {}
    )
    with pytest.raises(FileFormatError) as caught:
        drawn(tmp_path, two(), tug)
    assert message in str(caught.value)
    assert "features[5].properties" in str(caught.value)
