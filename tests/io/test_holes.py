"""Polygons with holes: what is free within them is flown through, drawn and exported."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import shapely
from exported_plans import HARBOR, contents, plan_of

import radmpc
from radmpc.errors import ScenarioError
from radmpc.io.native.mapping import from_dict, to_dict
from radmpc.model.obstacle import Obstacle, PolygonShape
from radmpc.plotting import plot_scenario

RING = [[0, 0], [10, 0], [10, 10], [0, 10]]
BASIN = [[3, 3], [7, 3], [7, 7], [3, 7]]
KML = "{http://www.opengis.net/kml/2.2}"

SCENARIO = {
    "format": "radmpc/scenario/1",
    "name": "basin",
    "dt": 1.0,
    "horizon": 5,
    "risk_bound": 0.01,
    "avoidance": "intervals",
    "obstacles": [{"name": "mole", "vertices": RING, "holes": [BASIN]}],
    "vehicles": [
        {
            "name": "tug",
            "start": [4, 4],
            "goal": {"center": [6, 6], "half_width": 0.2},
            "radius": 0.3,
            "control_limit": 1.0,
            "initial_covariance": 1e-4,
            "disturbance_covariance": 1e-4,
        }
    ],
}


def test_the_pieces_are_what_is_left_of_the_outline() -> None:
    free = [BASIN, [[8, 1], [9, 1], [8.5, 2]]]
    pieces = Obstacle.polygon("mole", RING, free).at(0)
    found = [shapely.Polygon(piece.vertices) for piece in pieces]
    wanted = shapely.Polygon(RING, free)
    assert shapely.union_all(found).symmetric_difference(wanted).area == pytest.approx(
        0.0, abs=1e-9
    )
    assert sum(piece.area for piece in found) == pytest.approx(wanted.area)
    assert all(piece.area == pytest.approx(piece.convex_hull.area) for piece in found)


def test_what_is_in_a_hole_is_planned_there_and_certified() -> None:
    result = radmpc.plan(from_dict(SCENARIO))
    assert result.is_certified
    filled = {**SCENARIO, "obstacles": [{"name": "mole", "vertices": RING}]}
    assert radmpc.plan(from_dict(filled)).plan is None


def test_holes_come_back_from_files(tmp_path: Path) -> None:
    scenario = from_dict(SCENARIO)
    shape = scenario.obstacles[0].shape
    assert isinstance(shape, PolygonShape)
    np.testing.assert_array_equal(shape.holes[0], BASIN)
    assert to_dict(scenario)["obstacles"] == [
        {
            "name": "mole",
            "vertices": np.array(RING, float).tolist(),
            "holes": [np.array(BASIN, float).tolist()],
        }
    ]
    radmpc.save_scenario(scenario, tmp_path / "basin.yaml")
    assert to_dict(radmpc.load_scenario(tmp_path / "basin.yaml")) == to_dict(scenario)


@pytest.mark.parametrize(
    ("obstacle", "words"),
    [
        ({"min": [0, 0], "max": [1, 1], "holes": [BASIN]}, "holes: stand beside vertices alone"),
        (
            {"vertices": RING, "holes": [[[3, 3], [4, 4]]]},
            "every hole must have at least 3 corners",
        ),
        ({"vertices": RING, "holes": [[[30, 3], [40, 3], [40, 9]]]}, "Hole lies outside shell"),
        ({"vertices": RING, "holes": [BASIN, BASIN]}, "must be a simple polygon with an area"),
        ({"vertices": [[0, 0], [1, 0]], "holes": [BASIN]}, "the outline must have at least 3"),
    ],
)
def test_what_is_no_hole_is_refused(obstacle: dict[str, object], words: str) -> None:
    with pytest.raises(ScenarioError) as error:
        from_dict({**SCENARIO, "obstacles": [{"name": "mole", **obstacle}]})
    assert words in str(error.value)


def test_solids_have_no_holes() -> None:
    cube = np.array(np.meshgrid([0, 1], [0, 1], [0, 1])).reshape(3, -1).T
    with pytest.raises(ScenarioError, match="only polygons have holes"):
        Obstacle.polygon("block", cube, [BASIN])


def test_maps_show_holes() -> None:
    mole = {"name": "mole", "vertices": [[900, 0], [990, 0], [990, 90], [900, 90]]}
    mole["holes"] = [[[930, 30], [960, 30], [960, 60]]]
    plan = plan_of(HARBOR | {"obstacles": [mole]})
    (data,) = contents(plan, "geojson").values()
    feature = next(f for f in json.loads(data)["features"] if f["properties"]["name"] == "mole")
    outer, inner = (shapely.LinearRing(ring) for ring in feature["geometry"]["coordinates"])
    assert outer.is_ccw
    assert not inner.is_ccw
    (data,) = contents(plan, "kml").values()
    assert len(list(ElementTree.fromstring(data).iter(f"{KML}innerBoundaryIs"))) == 1


def test_pictures_leave_holes_free() -> None:
    axes = plot_scenario(from_dict(SCENARIO))
    (patch,) = [patch for patch in axes.patches if patch.get_gid() == "obstacle:mole"]
    outer, inner = (shapely.LinearRing(ring) for ring in patch.get_path().to_polygons())
    assert shapely.Polygon(outer, [inner]).area == pytest.approx(100.0 - 16.0)
    assert outer.is_ccw
    assert not inner.is_ccw  # renderers leave it free
