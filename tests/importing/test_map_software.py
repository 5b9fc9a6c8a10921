"""What mapping programs write: features without a place, nulls in columns, shapes of one part."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from drawings import drawing, line, place, point, polygon, written
from refusing import refusal

from radmpc.importing.formats import import_ground, import_scenario
from radmpc.importing.options import ImportOptions
from radmpc.io.native.encoding import encode_scenario

NOTHING = {"type": "Feature", "properties": {"name": "sign"}, "geometry": None}


def test_a_feature_without_a_place_is_skipped_with_a_note(tmp_path: Path) -> None:
    imported = import_scenario(written(tmp_path, drawing(NOTHING)))
    assert [one.name for one in imported.scenario.obstacles] == ["pier"]
    assert "without geometry, skipped: 'sign'" in imported.warnings
    assert "without geometry, skipped: 'sign'" in imported.scenario.source["warnings"]


def test_features_without_a_place_are_counted_where_they_have_no_name(tmp_path: Path) -> None:
    many = [{"type": "Feature", "properties": None, "geometry": None} for _ in range(7)]
    imported = import_scenario(written(tmp_path, drawing(*many)))
    assert "without geometry, skipped: features[3], features[4], features[5], features[6], " in (
        " ".join(imported.warnings)
    )
    assert any(warning.endswith("features[7] and 2 more") for warning in imported.warnings)


def test_a_shape_without_coordinates_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path, drawing(line("Polygon", [], name="mole")))
    assert "features[3].geometry.coordinates: must be a list of at least" in str(refusal(path))


def test_a_missing_geometry_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path, drawing({"type": "Feature", "properties": {}}))
    assert "features[3].geometry: is required, null where there is none" in str(refusal(path))


def test_features_without_a_place_of_layers_that_are_not_taken_are_not_told(tmp_path: Path) -> None:
    content = drawing({**NOTHING, "properties": {"layer": "signs"}})
    for feature in content["features"][:3]:
        feature["properties"]["layer"] = "fleet"
    imported = import_scenario(written(tmp_path, content), ImportOptions(layer=("fleet",)))
    assert not any("without geometry" in warning for warning in imported.warnings)


def test_a_placemark_without_a_place_is_told(tmp_path: Path) -> None:
    marks = "".join(
        f"<Placemark><name>{name}</name>{shape}</Placemark>"
        for name, shape in (
            ("start a", "<Point><coordinates>10.1445,54.3325</coordinates></Point>"),
            ("goal a", "<Point><coordinates>10.1455,54.3326</coordinates></Point>"),
            ("sign", "<description>no entry</description>"),
        )
    )
    text = f'<kml xmlns="http://www.opengis.net/kml/2.2"><Document>{marks}</Document></kml>'
    imported = import_scenario(written(tmp_path, text, "bay.kml"))
    assert imported.warnings == ("without geometry, skipped: 'sign'",)


def test_the_ground_of_a_map_passes_over_features_without_a_place(tmp_path: Path) -> None:
    ground = import_ground(written(tmp_path, drawing(NOTHING)))
    assert ground is not None
    assert [one.name for one in ground.obstacles] == ["pier"]


def columns(content: dict[str, Any]) -> dict[str, Any]:
    """Give all features all properties, null or blank where they have none, as tables do."""
    keys = {key for one in content["features"] for key in one["properties"]}
    for number, one in enumerate(content["features"]):
        empty = None if number % 2 else ""
        one["properties"] = dict.fromkeys(keys, empty) | one["properties"]
    return content


def test_properties_that_are_null_or_blank_say_nothing(tmp_path: Path) -> None:
    more = [
        point(-0.5, 0.3, kind="start", vehicle="b", radius=1.5),
        point(0.5, 0.3, kind="goal", vehicle="b"),
        point(0.2, 0.3, role="via", vehicle="b", order=1),
        point(0.2, -0.3, role="via", vehicle="a", half_width=2.0),
        point(0.0, 0.0, role="origin", height=3.0),
        line("LineString", [place(0.2, 0.0), place(0.2, 0.1)], role="obstacle", name="boom"),
    ]
    bare = import_scenario(written(tmp_path, drawing(*more)))
    full = import_scenario(written(tmp_path, columns(drawing(*more))))
    assert encode_scenario(full.scenario) == encode_scenario(bare.scenario)


def test_names_may_be_whole_numbers_that_a_table_made_decimal(tmp_path: Path) -> None:
    content = drawing()
    for feature in content["features"][1:]:
        feature["properties"]["vehicle"] = 7.0
    content["features"].append(polygon([(0.2, 0.2), (0.3, 0.2), (0.3, 0.3)], name="x"))
    content["features"][-1]["properties"]["for"] = [7.0]
    scenario = import_scenario(written(tmp_path, content)).scenario
    assert [vehicle.name for vehicle in scenario.vehicles] == ["7"]
    assert scenario.obstacles[1].concerns is not None


def test_points_of_one_feature_are_so_many_points(tmp_path: Path) -> None:
    content = drawing(
        line("MultiPoint", [place(0.2, 0.0), place(0.2, 0.1)], role="obstacle", name="piles")
    )
    for feature in content["features"][1:3]:
        geometry = feature["geometry"]
        feature["geometry"] = {"type": "MultiPoint", "coordinates": [geometry["coordinates"]]}
    scenario = import_scenario(written(tmp_path, content)).scenario
    assert [one.name for one in scenario.obstacles] == ["pier", "piles", "piles (2)"]
    assert [vehicle.name for vehicle in scenario.vehicles] == ["a"]


def test_a_planned_path_is_refused_as_what_it_is(tmp_path: Path) -> None:
    path = line("LineString", [place(0.2, 0.0), place(0.2, 0.1)], kind="path", name="tug")
    found = str(refusal(written(tmp_path, drawing(path))))
    assert "features[3].properties.kind: is a path of a plan: paths are not imported" in found
