"""Several charts of one problem, their layers, and what vehicles drawn on them visit."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from radmpc.errors import FileFormatError, ScenarioError
from radmpc.importing.formats import import_scenario
from radmpc.importing.options import ImportOptions
from radmpc.model.visits import steps_visited
from running import first_plan

EAST, NORTH = 10.145, 54.3325


def place(east: float, north: float) -> list[float]:
    """A position in thousandths of degrees from the middle: 65 m and 111 m."""
    return [EAST + 1e-3 * east, NORTH + 1e-3 * north]


def feature(kind: str, coordinates: object, **properties: object) -> dict[str, Any]:
    geometry = {"type": kind, "coordinates": coordinates}
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def block(east: float, north: float, **properties: object) -> dict[str, Any]:
    steps = ((0, 0), (0.1, 0), (0.1, 0.1), (0, 0.1), (0, 0))
    ring = [place(east + x, north + y) for x, y in steps]
    return feature("Polygon", [ring], **properties)


def point(east: float, north: float, **properties: object) -> dict[str, Any]:
    return feature("Point", place(east, north), **properties)


def ends(name: str, north: float) -> list[dict[str, Any]]:
    return [
        point(-0.5, north, role="start", vehicle=name, radius=1.5, speed=2, acceleration=0.5),
        point(0.5, north, role="goal", vehicle=name),
    ]


def chart(folder: Path, file: str, *features: dict[str, Any], **more: object) -> Path:
    content = {"type": "FeatureCollection", "features": list(features), **more}
    (folder / file).write_text(json.dumps(content, indent=1), encoding="utf-8")
    return folder / file


KML = """<?xml version="1.0" encoding="UTF-8"?>
<kml xmlns="http://www.opengis.net/kml/2.2"><Document><name>sheet 7</name>
<Folder><name>depths</name>
<Placemark><name>ten meters</name><LineString><coordinates>
10.1440,54.3320 10.1460,54.3320</coordinates></LineString></Placemark>
</Folder>
<Folder><name>shore</name>
<Placemark><name>quay</name><LineString><coordinates>
10.1440,54.3335 10.1460,54.3335</coordinates></LineString></Placemark>
</Folder></Document></kml>
"""


def test_charts_of_both_formats_become_one_scenario_in_one_frame(tmp_path: Path) -> None:
    land = tmp_path / "land.kml"
    land.write_text(KML, encoding="utf-8")
    fleet = chart(tmp_path, "fleet.geojson", *ends("a", 0.0), block(0, 0.1, name="pier"))
    options = ImportOptions(layer=["fleet", "shore=obstacle"])
    imported = import_scenario([fleet, land], options)
    scenario = imported.scenario
    assert [o.name for o in scenario.obstacles] == ["pier", "quay"]
    assert scenario.name == "fleet"
    assert scenario.source is not None
    assert scenario.source["file"] == "fleet.geojson, land.kml"
    assert scenario.source["format"] == "geojson + kml"
    quay = scenario.obstacles[1].at(0)[0].vertices
    # From the start of the vehicle to the western end of the quay: 65 m per thousandth, 111 m.
    away = quay[quay[:, 0].argmin()] - scenario.vehicles[0].start_position
    np.testing.assert_allclose(away, [-0.5 * 65.04, 1.0 * 111.33], atol=0.05)
    assert (
        imported.choices["layers"]
        == "fleet, shore as obstacle, as asked; left out: 1 feature of others"
    )


def test_names_of_several_files_are_kept_apart(tmp_path: Path) -> None:
    one = chart(
        tmp_path, "west.geojson", *ends("a", -0.2), block(-0.2, 0, name="pier"), block(-0.3, 0.2)
    )
    two = chart(
        tmp_path, "east.geojson", *ends("a", 0.4), *ends("b", 0.8), block(0.2, 0, name="pier")
    )
    scenario = import_scenario([one, two]).scenario
    assert [v.name for v in scenario.vehicles] == ["west/a", "east/a", "b"]
    assert [o.name for o in scenario.obstacles] == ["west/pier", "polygon2", "east/pier"]
    assert scenario.source is not None
    assert "led by the file's" in scenario.source["choices"]["names"]


def test_files_of_one_name_in_two_folders_are_told_apart(tmp_path: Path) -> None:
    (tmp_path / "b").mkdir()
    one = chart(tmp_path, "bay.geojson", *ends("a", 0.0), block(0, 0.1, name="pier"))
    two = chart(tmp_path / "b", "bay.geojson", block(0.2, 0.3, name="pier"))
    scenario = import_scenario([one, two]).scenario
    assert [o.name for o in scenario.obstacles] == ["bay/pier", "bay_2/pier"]


def test_a_vehicle_may_start_in_one_file_and_end_in_another(tmp_path: Path) -> None:
    start, goal = ends("a", 0.0)
    one, two = chart(tmp_path, "starts.geojson", start), chart(tmp_path, "goals.geojson", goal)
    assert [v.name for v in import_scenario([one, two]).scenario.vehicles] == ["a"]


def test_what_neighboring_sheets_show_alike_is_taken_once(tmp_path: Path) -> None:
    origin, pier = point(0, 0, role="origin"), block(0, 0.1, name="pier")
    one = chart(tmp_path, "one.geojson", origin, pier, *ends("a", 0.0))
    two = chart(tmp_path, "two.geojson", origin, pier)
    imported = import_scenario([one, two])
    assert [o.name for o in imported.scenario.obstacles] == ["pier"]
    assert imported.choices["drawn alike"].startswith("2 features")


def test_two_origins_are_refused_with_the_file_that_has_the_second(tmp_path: Path) -> None:
    one = chart(tmp_path, "one.geojson", point(0, 0, role="origin"), *ends("a", 0.0))
    two = chart(tmp_path, "two.geojson", block(0, 1), point(1, 0, role="origin"))
    with pytest.raises(
        FileFormatError, match=r"two\.geojson:\d+: features\[1\]: must be one origin"
    ):
        import_scenario([one, two])


def test_an_error_names_the_file_it_is_in(tmp_path: Path) -> None:
    one = chart(tmp_path, "one.geojson", *ends("a", 0.0))
    two = chart(tmp_path, "two.geojson", point(1, 0, role="gaol", vehicle="b"))
    with pytest.raises(FileFormatError, match=r"two\.geojson:\d+: features\[0\]\.properties\.role"):
        import_scenario([one, two])
    with pytest.raises(FileFormatError, match=r"/two\.geojson:\d+: features\[0\]\.prop"):
        import_scenario(two)
    with pytest.raises(FileFormatError, match=r"one\.geojson, .*two\.geojson: agents: must be at"):
        import_scenario([one, chart(tmp_path, "two.geojson")], ImportOptions(agents=5))


def test_only_charts_are_imported_several_at_once(tmp_path: Path) -> None:
    one = chart(tmp_path, "one.geojson", *ends("a", 0.0))
    other = tmp_path / "mine.yaml"
    other.write_text("agents: []\n", encoding="utf-8")
    with pytest.raises(FileFormatError, match=r"mine\.yaml: is no chart"):
        import_scenario([one, other])


def test_layers_are_a_property_a_collection_or_a_file(tmp_path: Path) -> None:
    one = chart(
        tmp_path, "one.geojson", *ends("a", 0.0), block(0, 0.1, name="pier", layer="built"),
        block(0, 0.3, name="reef", layer="seabed"), name="plan",
    )  # fmt: skip
    two = chart(tmp_path, "two.geojson", block(0.2, 0.5, name="mole"), name="shore")
    for layers, names in (
        ((), ["pier", "reef", "mole"]),
        (("plan",), ["pier", "reef"]),
        (("one", "shore"), ["pier", "reef", "mole"]),
    ):
        scenario = import_scenario([one, two], ImportOptions(layer=layers)).scenario
        assert [o.name for o in scenario.obstacles] == names


def test_files_of_one_name_are_one_layer_and_the_second_one_of_its_own(tmp_path: Path) -> None:
    charts = [chart(tmp_path, "fleet.geojson", *ends("a", 0.0))]
    for i, folder in enumerate(("north", "south")):
        (tmp_path / folder).mkdir()
        mole = block(0.0, 0.2 + 0.2 * i, name=folder)
        charts.append(chart(tmp_path / folder, "land.geojson", mole))
    for layer, names in (("land", ["north", "south"]), ("land_2", ["south"])):
        imported = import_scenario(charts, ImportOptions(layer=["fleet", layer]))
        assert [obstacle.name for obstacle in imported.scenario.obstacles] == names


def test_a_layer_that_is_nowhere_is_refused_with_those_there_are(tmp_path: Path) -> None:
    one = chart(tmp_path, "one.geojson", *ends("a", 0.0), name="plan")
    with pytest.raises(FileFormatError, match="layer: must be one of 'one', 'plan', got 'shor'"):
        import_scenario(one, ImportOptions(layer=["plan", "shor"]))
    with pytest.raises(ScenarioError, match="must be names of layers"):
        ImportOptions(layer=[3])  # type: ignore[list-item] # what a caller may try


def visited(tmp_path: Path, *features: dict[str, Any], **options: Any) -> Any:
    path = chart(tmp_path, "fleet.geojson", *ends("a", 0.0), *features)
    return import_scenario(path, ImportOptions(**options)).scenario


def test_visits_are_drawn_with_order_box_window_and_speed(tmp_path: Path) -> None:
    scenario = visited(
        tmp_path,
        point(0.3, 0.1, role="via", vehicle="a", order="2", half_width="3", before="140"),
        point(-0.2, 0.2, name="via a", order=1, after=20, before=60, speed=0.5),
    )
    first, second = scenario.vehicles[0].via
    start = scenario.vehicles[0].start_position
    np.testing.assert_allclose(first.center - start, [0.3 * 65.04, 0.2 * 111.33], atol=0.05)
    np.testing.assert_allclose(first.upper - first.lower, 3.0, atol=1e-4)
    np.testing.assert_allclose(second.upper - second.lower, 6.0, atol=1e-4)
    assert first.between == (np.ceil(20 / scenario.dt), np.floor(60 / scenario.dt))
    assert first.speed is not None
    assert first.speed.tolist() == [0.5, 0.5]
    assert second.between == (1, min(np.floor(140 / scenario.dt), scenario.horizon))
    plan = first_plan(scenario, time_limit=30.0).require()
    path = plan.trajectories[0].means
    steps = steps_visited(scenario.vehicles[0].via, path[:, :2], path[:, 2:])
    assert steps is not None
    assert 20 <= steps[0] * scenario.dt <= 60


def test_the_horizon_is_long_enough_for_visits_and_windows(tmp_path: Path) -> None:
    short = visited(tmp_path)
    way = visited(tmp_path, point(0.0, 0.5, role="via", vehicle="a"))
    late = visited(tmp_path, point(0.0, 0.0, role="via", vehicle="a", after=300))
    assert way.horizon * way.dt > 1.4 * short.horizon * short.dt
    assert late.horizon * late.dt > 300 + 20


def test_a_goal_with_a_window_is_reached_within_it(tmp_path: Path) -> None:
    start, goal = ends("a", 0.0)
    goal["properties"] |= {"after": 40, "before": 55}
    scenario = import_scenario(chart(tmp_path, "x.geojson", start, goal)).scenario
    within = scenario.vehicles[0].goal.within
    assert within == (np.ceil(40 / scenario.dt), np.floor(55 / scenario.dt))


@pytest.mark.parametrize(
    ("more", "expected"),
    [
        ({"vehicle": "b"}, "vehicle: must be a vehicle that starts somewhere, got 'b'"),
        ({"after": "soon"}, "after: must be a number, got 'soon'"),
        ({"before": -3}, "before: must be >= 0 s, got -3"),
        ({"after": 9, "before": 8}, "before: must be at least after"),
        ({"half_width": 0}, "half_width: must be"),
        ({"speed": -1}, "speed: must be >= 0 m/s"),
        ({"after": 22, "before": 22.5}, "holds none of"),
    ],
)
def test_a_visit_that_cannot_be_is_refused(
    tmp_path: Path, more: dict[str, object], expected: str
) -> None:
    with pytest.raises(FileFormatError, match=expected):
        visited(tmp_path, point(0, 0, **{"role": "via", "vehicle": "a"} | more))


def test_a_single_step_that_a_window_does_not_hold_is_singular(tmp_path: Path) -> None:
    visit = point(0, 0, role="via", vehicle="a", after=10, before=20)
    with pytest.raises(FileFormatError, match=r"holds none of 1 step of [0-9.]+ s: widen it"):
        visited(tmp_path, visit, horizon=1)


def test_orders_are_stated_of_all_visits_and_differ(tmp_path: Path) -> None:
    one = point(0, 0.1, role="via", vehicle="a", order=1)
    with pytest.raises(FileFormatError, match="order: is required of all"):
        visited(tmp_path, one, point(0, 0.2, role="via", vehicle="a"))
    with pytest.raises(FileFormatError, match="order: must differ"):
        visited(tmp_path, one, point(0, 0.2, role="via", vehicle="a", order=1))
