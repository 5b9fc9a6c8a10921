"""Obstacles without thickness on maps and in recordings."""

from __future__ import annotations

import json
from io import BytesIO
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from exported_plans import FLIGHT, HARBOR, contents, plan_of

from radmpc.geometry import hull
from radmpc.io.export.outlines import footprint

OBSTACLES = "/radmpc/obstacles"
KML = "{http://www.opengis.net/kml/2.2}"
PLATE = [[900, 0, 0], [900, 90, 0], [900, 90, 80], [900, 0, 80]]
WALLS: dict[str, Any] = HARBOR | {
    "obstacles": [
        {"name": "fence", "line": [[900, 0], [900, 500], [1200, 900]]},
        {"name": "boom", "min": [-900, -900], "max": [-900, -500]},
        {"name": "pile", "vertices": [[300, 300]]},
        {"name": "gate", "moving": [[[-2000, 0], [-2000, 90 + k]] for k in range(7)]},
    ]
}
HANGING: dict[str, Any] = FLIGHT | {
    "obstacles": [
        {"name": "sign", "vertices": PLATE},
        {"name": "wire", "line": [[900, 200, 0], [900, 200, 50], [900, 300, 50]]},
        {"name": "lamp", "vertices": [[800, 0, 40]]},
    ]
}


def shapes(content: dict[str, Any]) -> dict[str, str]:
    """The geometry of each obstacle's first feature."""
    (data,) = contents(plan_of(content), "geojson").values()
    found = json.loads(data)["features"]
    obstacles = [f for f in reversed(found) if f["properties"]["kind"] == "obstacle"]
    return {f["properties"]["name"]: f["geometry"]["type"] for f in obstacles}


def test_walls_are_lines_and_posts_points_on_maps() -> None:
    assert shapes(WALLS) == {
        "fence": "LineString", "boom": "LineString", "pile": "Point", "gate": "LineString",
    }  # fmt: skip


def test_a_plate_on_edge_is_a_line_from_above() -> None:
    assert shapes(HANGING) == {"sign": "LineString", "wire": "Point", "lamp": "Point"}
    kind, corners = footprint(hull(PLATE))
    assert kind == "LineString"
    assert sorted(corners.tolist()) == [[900, 0], [900, 90]]


def test_a_line_keeps_its_corners_in_order() -> None:
    (data,) = contents(plan_of(WALLS), "geojson").values()
    fence = next(f for f in json.loads(data)["features"] if f["properties"]["name"] == "fence")
    assert len(fence["geometry"]["coordinates"]) == 3


@pytest.mark.parametrize(
    ("content", "name", "wanted"),
    [
        (WALLS, "fence", {"LineString": 1}),
        (WALLS, "pile", {"Point": 1}),
        (HANGING, "sign", {"Polygon": 2}),
        (HANGING, "wire", {"LineString": 2}),
        (HANGING, "lamp", {"Point": 1}),
    ],
)
def test_kml_shows_what_has_no_thickness(
    content: dict[str, Any], name: str, wanted: dict[str, int]
) -> None:
    (data,) = contents(plan_of(content), "kml").values()
    marks = ElementTree.fromstring(data).iter(f"{KML}Placemark")
    (mark,) = [m for m in marks if m.findtext(f"{KML}name") == name]
    kinds = ["LineString", "Point", "Polygon"]
    counts = {kind: len(list(mark.iter(f"{KML}{kind}"))) for kind in kinds}
    assert {kind: count for kind, count in counts.items() if count} == wanted


def test_markers_are_lines_and_balls_where_there_is_no_area() -> None:
    reading = pytest.importorskip("mcap_ros2.reader")
    kinds = []
    for content in (WALLS, HANGING):
        (data,) = contents(plan_of(content), "mcap").values()
        first = next(
            m.ros_msg
            for m in reading.read_ros2_messages(BytesIO(data))
            if m.channel.topic == OBSTACLES
        )
        kinds += [(m.text, m.type, len(m.points)) for m in first.markers]
        assert all(0.0 < m.scale.x <= 1.0 and np.isfinite(m.points[0].x) for m in first.markers)
    assert kinds == [
        ("fence", 5, 4), ("boom", 5, 2), ("pile", 7, 1), ("gate", 5, 2),
        ("sign", 11, 6), ("wire", 5, 4), ("lamp", 7, 1),
    ]  # fmt: skip
