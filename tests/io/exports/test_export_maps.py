from __future__ import annotations

import json
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import shapely
from exported_plans import (
    CENTIMETER,
    FLIGHT,
    HARBOR,
    MOLE,
    ORIGIN,
    assert_at,
    back,
    contents,
    means,
    plan_of,
    renamed,
    written,
)

from radmpc.io.export.names import xml_text

KML = "{http://www.opengis.net/kml/2.2}"


def features(content: dict[str, Any], **options: Any) -> list[dict[str, Any]]:
    """The features of a scenario's export."""
    collection = json.loads(contents(plan_of(content), "geojson", **options)["fleet.geojson"])
    assert collection["type"] == "FeatureCollection"
    return list(collection["features"])


def places(geometry: Any) -> np.ndarray:
    """Latitude, longitude, height of a shape's corners: maps put the longitude first."""
    lon, lat, height = shapely.get_coordinates(geometry, include_z=True).T
    return np.column_stack([lat, lon, height])


# --- GeoJSON


def test_geojson_has_a_path_a_start_and_a_goal_per_vehicle_and_every_obstacle() -> None:
    found = [(f["properties"]["kind"], f["properties"]["name"]) for f in features(HARBOR)]
    own = [(kind, name) for name in ("tug", "pilot 7") for kind in ("path", "start", "goal")]
    assert found == [*own, ("obstacle", "mole"), ("obstacle", "barge")] + [("obstacle", "ship")] * 7


def test_geojson_says_what_is_certified_and_what_its_numbers_mean() -> None:
    collection = json.loads(contents(plan_of(HARBOR), "geojson")["fleet.geojson"])
    assert collection["name"] == "wide harbor"
    assert "at most 0.04, risk bound 0.05" in collection["risk"]
    assert "WGS84 ellipsoid" in collection["altitude"]
    assert "seconds" in collection["time"]
    assert "54.1234" in collection["origin"]


@pytest.mark.parametrize("content", [HARBOR, FLIGHT], ids=["harbor", "flight"])
def test_shapely_reads_every_feature_as_a_valid_shape(content: dict[str, Any]) -> None:
    for feature in features(content):
        shape = shapely.from_geojson(json.dumps(feature["geometry"]))
        assert shape.is_valid
        assert not shape.is_empty
        if shape.geom_type == "Polygon":
            # RFC 7946: the outer ring runs counter-clockwise.
            assert shape.exterior.is_ccw


def test_paths_carry_times_and_three_sigma_per_corner() -> None:
    plan = plan_of(HARBOR)
    path = features(HARBOR)[0]["properties"]
    assert path["times"] == [20.0 * step for step in range(7)]
    sigma = 3.0 * np.sqrt(plan.trajectories[0].covariances[:, [0, 1], [0, 1]])
    assert path["three_sigma_east"] == pytest.approx(sigma[:, 0].tolist(), abs=1e-6)
    assert path["three_sigma_north"] == pytest.approx(sigma[:, 1].tolist(), abs=1e-6)
    assert path["three_sigma_east"][0] == pytest.approx(0.6)
    assert "three_sigma_up" not in path
    assert "three_sigma_up" in features(FLIGHT)[0]["properties"]


def test_a_goal_without_an_area_is_a_point() -> None:
    goals = {
        f["properties"]["name"]: f for f in features(HARBOR) if f["properties"]["kind"] == "goal"
    }
    assert goals["tug"]["geometry"]["type"] == "Polygon"
    assert goals["pilot 7"]["geometry"]["type"] == "Point"


def test_moving_obstacles_stand_once_per_step() -> None:
    ships = [f["properties"] for f in features(HARBOR) if f["properties"]["name"] == "ship"]
    assert [ship["time"] for ship in ships] == [20.0 * step for step in range(7)]


def test_obstacles_in_space_tell_their_base_and_top() -> None:
    tower = next(f for f in features(FLIGHT) if f["properties"]["name"] == "tower")["properties"]
    # 0 and 80 m above the origin; the earth falls away by millimeters.
    assert tower["base"] == pytest.approx(ORIGIN.height, abs=0.01)
    assert tower["top"] == pytest.approx(ORIGIN.height + 80.0, abs=0.01)


@pytest.mark.filterwarnings("ignore")  # of the libraries' own
@pytest.mark.parametrize("content", [HARBOR, FLIGHT], ids=["harbor", "flight"])
def test_geopandas_finds_every_vehicle_where_the_plan_has_it(
    content: dict[str, Any], tmp_path: Path
) -> None:
    geopandas = pytest.importorskip("geopandas")
    plan = plan_of(content)
    (file,) = written(plan, "geojson", tmp_path)
    table = geopandas.read_file(file)
    assert table.crs.to_epsg() == 4326
    for vehicle in plan.scenario.vehicles:
        own = table[table["name"] == vehicle.name].set_index("kind")
        assert_at(places(own.geometry["path"]), means(plan, vehicle.name))
        assert_at(places(own.geometry["start"]), [vehicle.start_position])
        assert list(own["times"]["path"]) == [
            step * plan.scenario.dt for step in range(plan.scenario.horizon + 1)
        ]


@pytest.mark.filterwarnings("ignore")  # of the libraries' own
def test_geopandas_finds_obstacles_and_goals_where_the_scenario_has_them(tmp_path: Path) -> None:
    geopandas = pytest.importorskip("geopandas")
    (file,) = written(plan_of(HARBOR), "geojson", tmp_path)
    table = geopandas.read_file(file)
    (mole,) = table[table["name"] == "mole"].geometry
    assert_same_shape(mole, shapely.Polygon(MOLE))
    ships = table[table["name"] == "ship"].sort_values("time").geometry
    for step, ship in enumerate(ships):
        west = 50 * step
        outline = [[west, -2000], [west + 90, -2000], [west + 90, -1900]]
        assert_same_shape(ship, shapely.Polygon(outline))
    (goal,) = table[(table["name"] == "tug") & (table["kind"] == "goal")].geometry
    assert_same_shape(goal, shapely.box(-3900, 2100, -2100, 3900))


def assert_same_shape(geometry: Any, expected: shapely.Polygon) -> None:
    """Compare a shape on a map with one in local coordinates."""
    found = shapely.Polygon(back(places(geometry))[:, :2])
    assert shapely.hausdorff_distance(found.exterior, expected.exterior) < CENTIMETER
    assert len(found.exterior.coords) == len(expected.exterior.coords)


# --- KML


def test_kml_has_a_time_per_place_and_a_color_per_vehicle() -> None:
    root = ElementTree.fromstring(contents(plan_of(HARBOR), "kml")["fleet.kml"])
    tracks = list(root.iter("{http://www.google.com/kml/ext/2.2}Track"))
    assert len(tracks) == 2
    for track in tracks:
        whens = [when.text or "" for when in track.iter(f"{KML}when")]
        start = datetime(1970, 1, 1, tzinfo=UTC)
        assert [datetime.fromisoformat(when) for when in whens] == [
            start + timedelta(seconds=20.0 * step) for step in range(7)
        ]
        assert len(list(track.iter("{http://www.google.com/kml/ext/2.2}coord"))) == 7
    colors = [c.text for c in root.iterfind(f".//{KML}LineStyle/{KML}color")]
    assert len(set(colors)) == 3


def test_kml_says_what_is_certified_and_what_its_numbers_mean() -> None:
    root = ElementTree.fromstring(contents(plan_of(HARBOR), "kml")["fleet.kml"])
    text = root.findtext(f"{KML}Document/{KML}description") or ""
    for expected in ("risk bound 0.05", "above ground", "1970-01-01", "latitude 54.1234"):
        assert expected in text
    modes = {mode.text for mode in root.iter(f"{KML}altitudeMode")}
    assert modes == {"relativeToGround"}


def test_a_moving_obstacle_is_shown_for_a_step_at_a_time() -> None:
    root = ElementTree.fromstring(contents(plan_of(HARBOR), "kml")["fleet.kml"])
    spans = [
        (span.findtext(f"{KML}begin"), span.findtext(f"{KML}end"))
        for span in root.iter(f"{KML}TimeSpan")
    ]
    assert len(spans) == 7
    assert spans[1] == ("1970-01-01T00:00:20.000000Z", "1970-01-01T00:00:40.000000Z")


def test_names_that_xml_cannot_hold_are_written_all_the_same() -> None:
    plan = renamed(plan_of(HARBOR), "tug", "<tug & \ufffe co>")
    root = ElementTree.fromstring(contents(plan, "kml")["fleet.kml"])
    names = [name.text for name in root.iterfind(f".//{KML}Folder/{KML}name")]
    assert names[0] == "<tug & \N{REPLACEMENT CHARACTER} co>"
    assert xml_text("å\U0001f6a2\x1b") == "å\U0001f6a2\N{REPLACEMENT CHARACTER}"


@pytest.mark.filterwarnings("ignore")  # of the libraries' own
@pytest.mark.parametrize("content", [HARBOR, FLIGHT], ids=["harbor", "flight"])
def test_fastkml_finds_every_vehicle_where_the_plan_has_it(
    content: dict[str, Any], tmp_path: Path
) -> None:
    fastkml = pytest.importorskip("fastkml")
    plan = plan_of(content)
    (file,) = written(plan, "kml", tmp_path)
    (document,) = fastkml.KML.parse(file).features
    assert document.name == plan.scenario.name
    folders = {feature.name: feature for feature in document.features[: len(plan.trajectories)]}
    for vehicle in plan.scenario.vehicles:
        path, start, _ = folders[vehicle.name].features
        coords = np.array(path.kml_geometry.coords)
        # Heights above ground, which stands at the origin's height.
        found = np.column_stack([coords[:, 1], coords[:, 0], coords[:, 2] + ORIGIN.height])
        assert_at(found, means(plan, vehicle.name))
        (lon, lat, height) = start.geometry.coords[0]
        assert_at([[lat, lon, height + ORIGIN.height]], [vehicle.start_position])


@pytest.mark.filterwarnings("ignore")  # of the libraries' own
@pytest.mark.parametrize("content", [HARBOR, FLIGHT], ids=["harbor", "flight"])
def test_kml_keeps_to_the_schema(content: dict[str, Any], tmp_path: Path) -> None:
    pytest.importorskip("lxml")
    validator = pytest.importorskip("fastkml.validator")
    (file,) = written(plan_of(content), "kml", tmp_path)
    schema = Path(validator.__file__).parent / "schema" / "kml22gx.xsd"
    assert validator.validate(file_to_validate=file, schema=schema)
