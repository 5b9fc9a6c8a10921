"""Lines, areas and faces are cut where the longitude jumps from 180° to -180°."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from radmpc.io.export.antimeridian import cut_area, cut_face, cut_line


def test_heights_at_a_cut_are_those_of_the_slope() -> None:
    upright = np.array([[179.9, 0.0, 0.0], [-179.9, 0.0, 0.0], [-179.9, 0.0, 100.0]])
    west, east = cut_face(upright)
    assert west.tolist() == [[179.9, 0.0, 0.0], [180.0, 0.0, 0.0], [180.0, 0.0, 50.0]]
    assert east.tolist() == [
        [-180.0, 0.0, 0.0],
        [-179.9, 0.0, 0.0],
        [-179.9, 0.0, 100.0],
        [-180.0, 0.0, 50.0],
    ]
    lying = cut_area([np.array([[179.9, 0.0, 0.0], [-179.9, 0.0, 20.0], [179.9, 1.0, 0.0]])])
    heights = {(row[0], row[1]): row[2] for part in lying for ring in part for row in ring.tolist()}
    assert heights[180.0, 0.0] == heights[-180.0, 0.0] == pytest.approx(10.0)


def test_what_only_touches_the_cut_has_one_part() -> None:
    line = np.array([[179.9, 1.0, 0.0], [-180.0, 2.0, 0.0], [179.8, 3.0, 0.0]])
    assert [part.tolist() for part in cut_line(line)] == [
        [[179.9, 1.0, 0.0], [180.0, 2.0, 0.0], [179.8, 3.0, 0.0]]
    ]
    ((ring,),) = cut_area([line])
    assert {tuple(row) for row in ring.tolist()} == {
        (179.9, 1.0, 0.0),
        (180.0, 2.0, 0.0),
        (179.8, 3.0, 0.0),
    }
    (face,) = cut_face(line)
    assert face[:, 0].tolist() == [179.9, 180.0, 179.8]
    upright = np.array([[180.0, 1.0, 0.0], [-180.0, 2.0, 0.0], [180.0, 2.0, 9.0]])
    (face,) = cut_face(upright)
    assert np.ptp(face[:, 0]) == 0.0


def test_a_line_that_crosses_often_has_a_part_for_each_time() -> None:
    line = np.array([[179.0, 0.0, 0.0], [-179.0, 1.0, 0.0], [179.0, 2.0, 0.0], [-179.0, 3.0, 0.0]])
    parts = cut_line(line)
    assert [part[:, 0].tolist() for part in parts] == [
        [179.0, 180.0],
        [-180.0, -179.0, -180.0],
        [180.0, 179.0, 180.0],
        [-180.0, -179.0],
    ]
    assert [part[0, 1] for part in parts] == [0.0, 0.5, 1.5, 2.5]


def test_an_area_around_a_pole_is_led_along_the_cut() -> None:
    east = np.arange(0.0, 360.0, 60.0) + 10.0
    ring = np.column_stack([(east + 180.0) % 360.0 - 180.0, np.full(6, 89.0), np.zeros(6)])
    parts = [shapely.Polygon(outer) for (outer,) in cut_area([ring])]
    assert all(part.is_valid for part in parts)
    assert sum(part.area for part in parts) == pytest.approx(360.0)
