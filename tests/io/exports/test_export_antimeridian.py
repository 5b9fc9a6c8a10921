"""Where the longitude jumps from 180° to -180°, maps are cut: nothing runs around the earth."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import shapely
from exported_plans import CENTIMETER, FLIGHT, HARBOR, contents, means, plan_of, written

from radmpc.geodesy import Origin, to_local
from radmpc.importing.formats import import_scenario

KML = "{http://www.opengis.net/kml/2.2}"
TRACK = "{http://www.google.com/kml/ext/2.2}"

FIJI = Origin(-17.5, 179.9985, 12.0)
"""The longitude jumps 159 m east of it."""

YARD = [[0, 0], [400, 0], [400, 400], [0, 400]]

COMB = [
    [100, 600],
    [200, 600],
    [200, 700],
    [120, 700],
    [120, 800],
    [200, 800],
    [200, 900],
    [100, 900],
]
"""Two teeth reach east across the jump."""

BRACE = [
    [220, 1000],
    [220, 1300],
    [100, 1300],
    [100, 1200],
    [190, 1200],
    [190, 1100],
    [100, 1100],
    [100, 1000],
]
"""Two teeth reach west across it."""

STRAIT: dict[str, Any] = HARBOR | {
    "name": "Taveuni",
    "obstacles": [
        {"name": "yard", "vertices": YARD, "holes": [[[100, 100], [100, 200], [200, 200]]]},
        {"name": "comb", "vertices": COMB},
        {"name": "brace", "vertices": BRACE},
        {"name": "net", "line": [[100, -500], [150, -480], [300, -600], [300, -700], [100, -700]]},
        {"name": "buoy", "min": [300, -900], "max": [310, -890]},
    ],
    "vehicles": [
        {
            "name": "tug",
            "start": [-100, 3000, 5, 0],
            "goal": {"center": [200, 3000], "half_width": 90, "speed": None},
        },
        {
            "name": "pilot 7",
            "start": [1500, -2500],
            "goal": {"center": [1500, -2500], "speed": None},
        },
    ],
}

RIDGE: dict[str, Any] = FLIGHT | {
    "obstacles": [
        {"name": "tower", "min": [100, 100, 0], "max": [240, 150, 80]},
        {"name": "crane", "vertices": [[100, 0, 0], [190, 0, 0], [150, 80, 0], [165, 20, 60]]},
    ],
    "vehicles": [
        FLIGHT["vehicles"][0] | {"start": [140, 20, 30, 4, 0, 1]},
    ],
}


def features(content: dict[str, Any], origin: Origin = FIJI) -> dict[tuple[str, str], Any]:
    """The features of an export, by kind and name."""
    collection = json.loads(contents(plan_of(content), "geojson", origin=origin)["fleet.geojson"])
    return {(f["properties"]["kind"], f["properties"]["name"]): f for f in collection["features"]}


def longitudes(geometry: Any) -> list[np.ndarray]:
    """The longitudes of each line and ring of a shape [°]."""
    parts = shapely.get_parts(shapely.from_geojson(json.dumps(geometry)))
    rings = [
        ring
        for part in parts
        for ring in ([part.exterior, *part.interiors] if part.geom_type == "Polygon" else [part])
    ]
    return [shapely.get_coordinates(ring)[:, 0] for ring in rings]


@pytest.mark.parametrize("content", [STRAIT, RIDGE], ids=["strait", "ridge"])
def test_no_line_of_geojson_runs_around_the_earth(content: dict[str, Any]) -> None:
    for feature in features(content).values():
        for ring in longitudes(feature["geometry"]):
            assert np.abs(ring).max() <= 180.0
            assert np.ptp(ring) < 1.0


def test_what_crosses_has_parts_and_what_does_not_is_as_it_was() -> None:
    kinds = {key: feature["geometry"]["type"] for key, feature in features(STRAIT).items()}
    assert kinds == {
        ("path", "tug"): "MultiLineString",
        ("start", "tug"): "Point",
        ("goal", "tug"): "MultiPolygon",
        ("path", "pilot 7"): "LineString",
        ("start", "pilot 7"): "Point",
        ("goal", "pilot 7"): "Point",
        ("obstacle", "yard"): "MultiPolygon",
        ("obstacle", "comb"): "MultiPolygon",
        ("obstacle", "brace"): "MultiPolygon",
        ("obstacle", "net"): "MultiLineString",
        ("obstacle", "buoy"): "Polygon",
    }


def test_a_cut_path_has_a_time_and_an_uncertainty_per_corner() -> None:
    path = features(STRAIT)["path", "tug"]
    west, east = path["geometry"]["coordinates"]
    assert (west[-1][0], east[0][0]) == (180.0, -180.0)
    assert west[-1][1:] == east[0][1:]
    corners, more = [*west, *east], path["properties"]
    assert {len(more[key]) for key in ("times", "three_sigma_east", "three_sigma_north")} == {
        len(corners)
    }
    cut = len(west) - 1
    assert more["times"][cut] == more["times"][cut + 1]
    # Steps are as they were, and the cut lies between two of them.
    assert more["times"][:cut] + more["times"][cut + 2 :] == [20.0 * k for k in range(7)]
    assert more["times"][cut - 1] < more["times"][cut] < more["times"][cut + 2]
    plan = plan_of(STRAIT)
    times, steps = np.array(more["times"]), 20.0 * np.arange(7)
    expected = [np.interp(times, steps, column) for column in means(plan, "tug").T]
    np.testing.assert_allclose(local(corners), np.column_stack(expected), atol=CENTIMETER)


def local(places: Any) -> np.ndarray:
    """East and north of rows of longitude, latitude, height."""
    lon, lat, height = np.asarray(places, dtype=float).T
    return to_local(np.column_stack([lat, lon, height]), FIJI)[:, :2]


def test_parts_together_are_the_area_and_its_hole() -> None:
    found = features(STRAIT)["obstacle", "yard"]["geometry"]["coordinates"]
    parts = [
        shapely.Polygon(local(outer), [local(hole) for hole in holes]) for outer, *holes in found
    ]
    assert all(part.exterior.is_ccw for part in parts)
    hole = [[100, 100], [100, 200], [200, 200]]
    whole = shapely.Polygon(YARD, [hole])
    both = shapely.union_all([part.buffer(0.001) for part in parts])
    assert both.buffer(CENTIMETER).contains(whole)
    assert whole.buffer(CENTIMETER).contains(both)
    assert shapely.intersection(*parts).area < 0.1


@pytest.mark.parametrize("content", [STRAIT, RIDGE], ids=["strait", "ridge"])
def test_no_line_of_kml_runs_around_the_earth(content: dict[str, Any]) -> None:
    root = ElementTree.fromstring(contents(plan_of(content), "kml", origin=FIJI)["fleet.kml"])
    rings = list(kml_lines(root))
    assert any(ring.max() == 180.0 for ring in rings)
    assert any(ring.min() == -180.0 for ring in rings)
    for ring in rings:
        assert np.abs(ring).max() <= 180.0
        assert np.ptp(ring) < 1.0


def kml_lines(root: ElementTree.Element) -> Iterator[np.ndarray]:
    """Yield the longitudes of each line, ring and track [°]."""
    for text in root.iter(f"{KML}coordinates"):
        yield np.array([float(word.split(",")[0]) for word in (text.text or "").split()])
    for track in root.iter(f"{TRACK}Track"):
        coords = [(coord.text or "").split()[0] for coord in track.iter(f"{TRACK}coord")]
        assert len(coords) == len(list(track.iter(f"{KML}when")))
        yield np.array(coords, dtype=float)


@pytest.mark.filterwarnings("ignore")  # of the libraries' own
@pytest.mark.parametrize("content", [STRAIT, RIDGE], ids=["strait", "ridge"])
def test_cut_kml_keeps_to_the_schema(content: dict[str, Any], tmp_path: Path) -> None:
    pytest.importorskip("lxml")
    validator = pytest.importorskip("fastkml.validator")
    (file,) = written(plan_of(content), "kml", tmp_path, origin=FIJI)
    schema = Path(validator.__file__).parent / "schema" / "kml22gx.xsd"
    assert validator.validate(file_to_validate=file, schema=schema)


@pytest.mark.filterwarnings("ignore")  # of the libraries' own
def test_geopandas_finds_a_cut_fleet_within_a_kilometer_of_the_jump(tmp_path: Path) -> None:
    geopandas = pytest.importorskip("geopandas")
    (file,) = written(plan_of(STRAIT), "geojson", tmp_path, origin=FIJI)
    table = geopandas.read_file(file)
    assert table.geometry.is_valid.all()
    length = table[table["kind"] == "path"].to_crs("EPSG:3832").length
    # Mercator about 150° E stretches by 5 % here; around the earth it would be 40,000 km.
    assert length.max() < 1000.0


@pytest.mark.parametrize("ending", ["geojson", "kml"])
def test_obstacles_that_were_cut_are_imported_whole(ending: str, tmp_path: Path) -> None:
    plan = plan_of(STRAIT)
    file = tmp_path / f"chart.{ending}"
    file.write_bytes(drawn(contents(plan, ending, origin=FIJI)[f"fleet.{ending}"], ending))
    scenario = import_scenario(file).scenario
    found = {obstacle.name: obstacle for obstacle in scenario.obstacles}
    assert sorted(found) == ["brace", "buoy", "comb", "net", "yard"]
    assert len(found["yard"].shape.vertices) == 4
    assert [len(hole) for hole in found["yard"].shape.holes] == [3]
    assert len(found["comb"].shape.vertices) == len(found["brace"].shape.vertices) == 8
    assert len(found["net"].shape.points) == 5
    assert scenario.vehicles[0].name == "tug"


def drawn(content: bytes, ending: str) -> bytes:
    """An export's obstacles, with a start and a goal as an operator draws them."""
    if ending == "geojson":
        collection = json.loads(content)
        kept = [f for f in collection["features"] if f["properties"]["kind"] == "obstacle"]
        for role, place in (("start", [179.999, -17.49]), ("goal", [-179.999, -17.49])):
            kept.append(
                {
                    "type": "Feature",
                    "properties": {"name": f"{role} tug"},
                    "geometry": {"type": "Point", "coordinates": place},
                }
            )
        return json.dumps(collection | {"features": kept}).encode()
    root = ElementTree.fromstring(content)
    (document,) = root.iter(f"{KML}Document")
    for folder in list(document.iter(f"{KML}Folder")):
        document.remove(folder)
    for mark in document.iter(f"{KML}Placemark"):
        if mark.findtext(f"{KML}name") == "net":
            extended = ElementTree.SubElement(mark, f"{KML}ExtendedData")
            data = ElementTree.SubElement(extended, f"{KML}Data", {"name": "role"})
            ElementTree.SubElement(data, f"{KML}value").text = "obstacle"
    for role, place in (("start", "179.999,-17.49"), ("goal", "-179.999,-17.49")):
        mark = ElementTree.SubElement(document, f"{KML}Placemark")
        ElementTree.SubElement(mark, f"{KML}name").text = f"{role} tug"
        point = ElementTree.SubElement(mark, f"{KML}Point")
        ElementTree.SubElement(point, f"{KML}coordinates").text = place
    return ElementTree.tostring(root)
