"""GeoJSON and KML: maps become scenarios, positions those of another library."""

import copy
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from drawings import AREA, LATITUDE, LONGITUDE, drawing, line, place, point, polygon, written

from radmpc.errors import FileFormatError
from radmpc.geodesy import Origin, to_local
from radmpc.importing.formats import ImportOptions, import_scenario
from radmpc.io.export.origin import Placement, scenario_origin
from radmpc.io.native.scenario_file import load_scenario, save_scenario
from radmpc.model.scenario import Scenario
from running import first_plan

FOLDER = Path(__file__).parent.parent.parent / "instances" / "drawn"


def imported(folder: Path, *more: dict[str, Any]) -> Scenario:
    return import_scenario(written(folder, drawing(*more))).scenario


def test_the_origin_leads_back_to_where_things_were_drawn(tmp_path: Path) -> None:
    scenario = imported(tmp_path)
    origin = scenario_origin(scenario)
    assert origin is not None
    drawn = [place(-0.5, 0.0), place(0.5, 0.1), *[place(x, y) for x, y in ((0, -0.2), (0.1, 0.2))]]
    vehicle = scenario.vehicles[0]
    corners = scenario.obstacles[0].at(0)[0].vertices
    local = [vehicle.start_position, vehicle.goal.center, corners[0], corners[2]]
    found = Placement(origin).geodetic(np.array(local))
    meters = np.array([111_320.0, 64_900.0])  # per degree of latitude and longitude here
    away = (found[:, :2] - np.array(drawn)[:, ::-1]) * meters
    assert np.abs(away).max() < 0.01
    assert np.all(found[:, 2] == 0.0)


def test_positions_are_those_of_another_library(tmp_path: Path) -> None:
    pymap3d = pytest.importorskip("pymap3d")
    scenario = imported(tmp_path)
    origin = scenario_origin(scenario)
    assert origin is not None
    for position, (east, north) in (
        (scenario.vehicles[0].start_position, (-0.5, 0.0)),
        (scenario.vehicles[0].goal.center, (0.5, 0.1)),
    ):
        longitude, latitude = place(east, north)
        wanted = pymap3d.geodetic2enu(
            latitude, longitude, 0.0, origin.latitude, origin.longitude, 0.0
        )
        np.testing.assert_allclose(position, wanted[:2], atol=1e-4)


def test_distances_are_meters_on_the_ground(tmp_path: Path) -> None:
    scenario = imported(tmp_path)
    # A degree of longitude at 54.3325° is 65.0 km on WGS 84, one of latitude 111.33 km.
    way = scenario.vehicles[0].goal.center - scenario.vehicles[0].start_position
    np.testing.assert_allclose(way, [65.04, 11.13], atol=0.02)


def test_the_origin_is_kept_in_the_scenario_file(tmp_path: Path) -> None:
    scenario = imported(tmp_path)
    save_scenario(scenario, tmp_path / "scenario.yaml")
    loaded = load_scenario(tmp_path / "scenario.yaml")
    assert loaded.source is not None
    assert loaded.source["format"] == "geojson"
    assert loaded.source["origin"] == {
        "latitude": pytest.approx(LATITUDE, abs=1e-3),
        "longitude": pytest.approx(LONGITUDE, abs=1e-3),
        "height": 0.0,
    }


def test_a_point_may_state_the_origin(tmp_path: Path) -> None:
    scenario = imported(tmp_path, point(0.0, 0.0, role="origin", height=30.0))
    assert scenario_origin(scenario) == Origin(LATITUDE, LONGITUDE, 30.0)
    np.testing.assert_allclose(scenario.vehicles[0].start_position[1], 0.0, atol=1e-3)


def test_a_vehicle_is_what_its_properties_say(tmp_path: Path) -> None:
    scenario = imported(
        tmp_path,
        point(-0.5, 0.3, name="Start beta-2"),
        point(0.5, -0.3, name="goal: beta-2", radius="0.8"),
    )
    first, second = scenario.vehicles
    assert (first.name, first.radius) == ("a", 1.5)
    assert first.speed_limit is not None
    assert (first.speed_limit.tolist(), first.control_limit.tolist()) == ([2.0] * 2, [0.5] * 2)
    assert (second.name, second.radius) == ("beta-2", 0.8)
    assert second.speed_limit is not None
    assert (second.speed_limit.tolist(), second.control_limit.tolist()) == ([1.0] * 2, [1.0] * 2)


def test_a_rectangle_as_area_is_the_workspace(tmp_path: Path) -> None:
    scenario = imported(tmp_path, AREA)
    assert [obstacle.name for obstacle in scenario.obstacles] == ["pier"]
    assert scenario.workspace is not None
    size = scenario.workspace.upper - scenario.workspace.lower
    np.testing.assert_allclose(size, [2 * 65.04, 111.34], atol=0.1)


def test_of_any_other_area_the_rest_of_its_box_becomes_obstacles(tmp_path: Path) -> None:
    corners = [(-1, -0.5), (1, -0.5), (1, 0.2), (0.4, 0.5), (-1, 0.5)]
    scenario = imported(tmp_path, polygon(corners, role="area"))
    assert [obstacle.name for obstacle in scenario.obstacles] == ["pier", "outside1"]
    (triangle,) = scenario.obstacles[1].at(0)
    area = shapely.Polygon(triangle.vertices).area
    assert area == pytest.approx(0.5 * 0.6 * 65.04 * 0.3 * 111.34, rel=0.02)
    source = scenario.source
    assert source is not None
    assert "its bounding box is the workspace, the rest of that 1 obstacle" in str(source)


def test_holes_of_the_area_are_obstacles(tmp_path: Path) -> None:
    area = copy.deepcopy(AREA)
    hole = [(-0.3, -0.3), (-0.2, -0.3), (-0.25, -0.2)]
    area["geometry"]["coordinates"].append([place(*c) for c in [*hole, hole[0]]])
    scenario = imported(tmp_path, area)
    assert [obstacle.name for obstacle in scenario.obstacles] == ["pier", "hole1"]


def test_several_polygons_of_one_feature_are_several_obstacles(tmp_path: Path) -> None:
    islands = polygon([(0.3, 0.3), (0.4, 0.3), (0.4, 0.4)], name="islands")
    other = polygon([(-0.3, 0.3), (-0.2, 0.3), (-0.2, 0.4)])
    shape = islands["geometry"]
    shape["type"] = "MultiPolygon"
    shape["coordinates"] = [shape["coordinates"], other["geometry"]["coordinates"]]
    scenario = imported(tmp_path, islands, other)
    names = [obstacle.name for obstacle in scenario.obstacles]
    assert names == ["pier", "islands", "islands (2)", "polygon4"]


def test_a_polygon_that_is_not_convex_is_one_obstacle_of_pieces(tmp_path: Path) -> None:
    hook = [(0.2, 0.2), (0.4, 0.2), (0.4, 0.4), (0.35, 0.4), (0.35, 0.25), (0.2, 0.25)]
    scenario = imported(tmp_path, polygon(hook))
    assert len(scenario.obstacles[1].at(0)) == 2


def test_what_crosses_the_antimeridian_stays_in_one_piece(tmp_path: Path) -> None:
    content = drawing()
    ring = [[179.9999, 0.001], [-179.9999, 0.001], [-179.9999, 0.002], [179.9999, 0.001]]
    content["features"][0]["geometry"]["coordinates"] = [ring]
    for feature, longitude in zip(content["features"][1:], (179.9995, -179.9995), strict=True):
        feature["geometry"]["coordinates"] = [longitude, 0.0]
    scenario = import_scenario(written(tmp_path, content)).scenario
    way = scenario.vehicles[0].goal.center - scenario.vehicles[0].start_position
    np.testing.assert_allclose(way, [111.32, 0.0], atol=0.01)
    assert np.ptp(scenario.obstacles[0].at(0)[0].vertices[:, 0]) == pytest.approx(22.26, abs=0.01)


def test_unknown_properties_and_heights_are_told(tmp_path: Path) -> None:
    content = drawing(point(-0.5, 0.3, role="start", vehicle="b", raduis=3, stroke="#f00"))
    content["features"].append(point(0.5, -0.3, role="goal", vehicle="b"))
    content["features"][1]["geometry"]["coordinates"].append(25.0)
    result = import_scenario(written(tmp_path, content))
    assert result.warnings == (
        "properties ignored: raduis (did you mean radius?)",
        "drawn heights are ignored: vehicles move at 0 m",
    )


def test_long_sides_are_told(tmp_path: Path) -> None:
    far = polygon([(-60, 10), (60, 10), (60, 20)])
    result = import_scenario(written(tmp_path, drawing(far)))
    assert "sides of polygons and lines are straight in the plane" in result.warnings[0]


FENCE = [place(0.2, -0.2), place(0.2, 0.0), place(0.2, 0.0), place(0.3, 0.2)]
BOOM = [place(0.4, -0.2), place(0.4, 0.2)]


@pytest.mark.slow
def test_lines_become_walls_without_thickness(tmp_path: Path) -> None:
    scenario = imported(
        tmp_path,
        line("LineString", FENCE, role="obstacle", name="fence"),
        line("MultiLineString", [BOOM, FENCE[2:]], role="obstacle"),
    )
    _, fence, *booms = scenario.obstacles
    assert [fence.name, *(o.name for o in booms)] == ["fence", "line3", "line4"]
    # The position that stands twice is ignored.
    assert [len(o.at(0)) for o in (fence, *booms)] == [2, 1, 1]
    lengths = [float(np.linalg.norm(np.diff(p.vertices, axis=0))) for p in fence.at(0)]
    assert lengths == pytest.approx([22.26, 23.19], abs=0.1)
    assert first_plan(scenario, time_limit=20.0).is_certified


def test_a_point_may_be_a_post(tmp_path: Path) -> None:
    *_, post = imported(tmp_path, point(0.2, 0.0, role="obstacle", name="buoy")).obstacles
    assert (post.name, post.at(0)[0].vertices.shape) == ("buoy", (1, 2))


@pytest.mark.parametrize(
    ("feature", "message"),
    [
        (line("LineString", FENCE), r"\.role: must be stated of a LineString: 'obstacle'"),
        (line("LineString", FENCE, role="area"), r"\.role: must be 'obstacle' of a LineString"),
        (line("LineString", FENCE[1:3], role="obstacle"), "must have at least 2 different pos"),
        (line("LineString", [], role="obstacle"), "must be a list of at least one entry"),
        (line("LineString", [1.0, 2.0], role="obstacle"), r"must be \[longitude, latitude\]"),
        (line("MultiLineString", FENCE, role="obstacle"), r"must be \[longitude, latitude\]"),
        (
            line("LineString", [place(i, 0) for i in range(300)], role="obstacle"),
            "must have at most 200 corners, got 300",
        ),
    ],
)
def test_a_line_that_cannot_be_meant_is_one_line(
    tmp_path: Path, feature: dict[str, Any], message: str
) -> None:
    with pytest.raises(FileFormatError, match=message) as caught:
        imported(tmp_path, feature)
    assert "\n" not in str(caught.value)


def test_options_hold_for_drawings_too(tmp_path: Path) -> None:
    path = written(tmp_path, drawing())
    scenario = import_scenario(path, ImportOptions(radius=0.7)).scenario
    assert scenario.vehicles[0].radius == 0.7


def test_the_same_drawing_in_both_formats_is_the_same_scenario() -> None:
    one, two = (
        import_scenario(FOLDER / f"marina.{suffix}").scenario for suffix in ("geojson", "kml")
    )
    for first, second in zip(one.vehicles, two.vehicles, strict=True):
        assert first.name == second.name
        assert first.start.tolist() == second.start.tolist()
        assert first.radius == second.radius == 1.5
    assert [o.name for o in one.obstacles] == [o.name for o in two.obstacles]
    assert (
        one.obstacles[1].at(0)[0].vertices.tolist() == two.obstacles[1].at(0)[0].vertices.tolist()
    )


@pytest.mark.slow
def test_a_drawing_is_planned_within_the_bound_and_lies_where_it_was_drawn() -> None:
    scenario = import_scenario(FOLDER / "marina.geojson").scenario
    result = first_plan(scenario, time_limit=20.0)
    assert result.is_certified
    origin = scenario_origin(scenario)
    assert origin is not None
    ends = [t.means[-1][:2] for t in result.plan.trajectories]
    found = Placement(origin).geodetic(np.array(ends))
    wanted = np.array([[54.3323, 10.1458], [54.3325, 10.1443]])
    # A quarter of the radius of 1.5 m, 0.375 m.
    assert np.abs((found[:, :2] - wanted) * [111_320.0, 65_000.0]).max() <= 0.38


def test_frames_far_north_keep_their_meters() -> None:
    origin = Origin(89.9, 45.0)
    east = to_local(np.array([[89.9, 46.0, 0.0]]), origin)[0]
    assert np.hypot(east[0], east[1]) == pytest.approx(194.9, abs=0.5)


def test_an_obstacle_with_speed_and_course_is_on_a_track(tmp_path: Path) -> None:
    known = {"position_deviation": 3.0, "speed_deviation": 0.1, "course_deviation": "2"}
    hull = [(1.0, 1.0), (1.2, 1.0), (1.2, 1.1), (1.0, 1.1)]
    ship = polygon(hull, name="ship", speed=2.5, course=270, **known)
    scenario = imported(tmp_path, ship)
    [track] = [o for o in scenario.obstacles if o.name == "ship"]
    still = imported(tmp_path, polygon(hull, name="ship"))
    [outline] = [o for o in still.obstacles if o.name == "ship"]
    np.testing.assert_allclose(
        np.sort(track.at(0)[0].vertices, axis=0), np.sort(outline.at(0)[0].vertices, axis=0)
    )
    moved = track.at(1)[0].vertices.mean(axis=0) - track.at(0)[0].vertices.mean(axis=0)
    mean = 2.5 * np.exp(-0.5 * np.radians(2.0) ** 2)
    assert moved == pytest.approx([-mean * scenario.dt, 0.0], abs=1e-9)
    assert np.sqrt(np.diag(track.spread.positions[0])) == pytest.approx([3.0, 3.0])


@pytest.mark.parametrize(
    ("properties", "message"),
    [
        ({"course": 90}, "course: needs speed as well"),
        ({"speed": 3.0}, "speed: needs course as well"),
        ({"speed_deviation": 3.0}, "speed_deviation: needs course as well"),
        ({"speed": 3.0, "course": "west"}, "course: must be a number, got 'west'"),
        ({"speed": -3.0, "course": 1}, "speed: must be >= 0 m/s"),
        ({"speed": 3.0, "course": 360}, "course: must be from -180 to below 360 degrees"),
        ({"speed": 3.0, "course": 1, "course_deviation": 40}, "course_deviation: must be at most"),
    ],
)
def test_half_a_report_is_refused(properties, message, tmp_path: Path) -> None:
    ship = polygon([(1.0, 1.0), (1.2, 1.0), (1.2, 1.1)], name="ship", **properties)
    with pytest.raises(FileFormatError, match=re.escape(message)):
        imported(tmp_path, ship)
