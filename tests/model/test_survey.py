from __future__ import annotations

import numpy as np
import pytest
import shapely
from shapely.geometry import LineString, Polygon

from radmpc import ScenarioError
from radmpc.io.native.mapping import from_dict, to_dict
from radmpc.model.survey import survey_visits

FIELD = [[0.0, 0.0], [12.0, 0.0], [14.0, 6.0], [3.0, 9.0]]
BAY = [[0.0, 0.0], [10.0, 0.0], [10.0, 8.0], [7.0, 8.0], [7.0, 3.0], [3.0, 3.0], [3.0, 8.0]]
BAY.append([0.0, 8.0])


def lines(area, spacing: float, direction=(1.0, 0.0)) -> list[LineString]:
    centers = [visit.center for visit in survey_visits(area, spacing, direction)]
    assert len(centers) % 2 == 0
    return [LineString(pair) for pair in zip(centers[::2], centers[1::2], strict=True)]


@pytest.mark.parametrize("area", [FIELD, FIELD[::-1], BAY], ids=["field", "clockwise", "bay"])
@pytest.mark.parametrize("direction", [(1.0, 0.0), (0.0, -2.0), (1.0, 0.7)])
def test_lines_are_chords_of_the_area_and_leave_nothing_far_from_them(area, direction) -> None:
    spacing = 1.7
    found = lines(area, spacing, direction)
    polygon = Polygon(area)
    assert all(polygon.buffer(1e-9).covers(line) for line in found)
    # What is farther from every line than half the spacing is at most the corners that lines,
    # which end at the border, leave where that is slanted.
    strips = shapely.union_all([line.buffer(0.5 * spacing + 1e-9) for line in found])
    assert polygon.difference(strips).area < 0.03 * polygon.area


def test_lines_are_flown_to_and_fro_and_lie_no_farther_apart_than_asked() -> None:
    rectangle = [[0.0, 0.0], [10.0, 0.0], [10.0, 6.0], [0.0, 6.0]]
    visits = survey_visits(rectangle, 2.0, speed=1.0)
    assert [visit.center.tolist() for visit in visits] == [
        [0.0, 1.0], [10.0, 1.0], [10.0, 3.0], [0.0, 3.0], [0.0, 5.0], [10.0, 5.0],
    ]  # fmt: skip
    assert all(visit.between is None for visit in visits)
    assert visits[0].upper.tolist() == [0.5, 1.5]
    assert visits[0].speed is not None
    assert len(survey_visits(rectangle, 2.1)) == 6
    assert len(survey_visits(rectangle, 1.9)) == 8
    assert len(survey_visits(rectangle, 99.0)) == 2
    (first, *_) = survey_visits(rectangle, 2.0, [0.0, 1.0], half_width=0.1, altitude=30.0)
    assert first.center == pytest.approx([9.0, 0.0, 30.0])
    assert first.upper - first.center == pytest.approx([0.1] * 3)


def test_every_piece_of_a_line_that_leaves_the_area_is_flown() -> None:
    pieces = lines(BAY, 2.0)
    assert [line.length for line in pieces] == pytest.approx([10.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0])


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"spacing": 0.0}, "survey.spacing: must be > 0 m, got 0"),
        ({"direction": [0.0, 0.0]}, "survey.direction: must not be zero in both coordinates"),
        ({"area": [[0.0, 0.0], [1.0, 1.0]]}, "survey.area: must have three corners or more"),
        ({"area": [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]}, "survey.area: must have three corners"),
        ({"half_width": -1.0}, "survey.half_width: must be >= 0 m"),
        ({"altitude": 3.0}, "survey.altitude: must be left out in the plane, got 3"),
        ({"spacing": 0.01}, "survey: must have at most 200 visits with those of via, got"),
        ({"spacing": 1e-8}, "survey.spacing: must leave at most 10,000 lines over an area 9 m"),
        ({"spacing": 5e-324}, "survey.spacing: must leave at most 10,000 lines over an area 9 m"),
    ],
)
def test_surveys_in_files_become_visits_or_are_refused(changes, told: str) -> None:
    vehicle = {
        "name": "a",
        "start": [0.0, 0.0],
        "goal": {"center": [10.0, 0.0]},
        "radius": 0.3,
        "control_limit": 2.0,
        "via": [{"center": [1.0, 1.0], "half_width": 0.5}],
        "survey": {"area": FIELD, "spacing": 3.0},
    }
    content = {
        "format": "radmpc/scenario/1",
        "name": "survey",
        "dt": 1.0,
        "horizon": 30,
        "risk_bound": 0.01,
        "vehicles": [vehicle],
    }
    given = from_dict(content)
    via = given.vehicles[0].via
    assert len(via) == 7
    assert np.array_equal(via[1].lower, survey_visits(FIELD, 3.0)[0].lower)
    assert len(to_dict(given)["vehicles"][0]["via"]) == 7
    spoiled = {**vehicle, "survey": {**vehicle["survey"], **changes}}
    with pytest.raises(ScenarioError) as refusal:
        from_dict({**content, "vehicles": [spoiled]})
    assert told in str(refusal.value)


def test_surveys_in_space_need_an_altitude() -> None:
    vehicle = {
        "name": "a",
        "start": [0.0, 0.0, 2.0],
        "goal": {"center": [10.0, 0.0, 2.0]},
        "radius": 0.3,
        "control_limit": 2.0,
        "survey": {"area": FIELD, "spacing": 3.0},
    }
    content = {
        "format": "radmpc/scenario/1",
        "name": "survey",
        "dt": 1.0,
        "horizon": 30,
        "risk_bound": 0.01,
        "vehicles": [vehicle],
    }
    with pytest.raises(ScenarioError) as refusal:
        from_dict(content)
    assert str(refusal.value) == "vehicles[0].survey.altitude: is required in space"
    vehicle["survey"]["altitude"] = 2.0
    assert from_dict(content).vehicles[0].via[0].center[2] == 2.0
