"""What an import of a map tells of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from drawings import drawing, point, written

from radmpc.importing.formats import import_scenario


def test_what_is_told_of_a_large_area_on_the_equator_is_in_plain_numbers(tmp_path: Path) -> None:
    def around(latitude: float, half: float) -> dict[str, Any]:
        sides = [(-half, -half), (half, -half), (half, half), (-half, half), (-half, -half)]
        # A little west of 0°: that rounds to a zero with a sign.
        ring = [[east - 2e-10, latitude + north] for east, north in sides]
        area = {"type": "Polygon", "coordinates": [ring]}
        ends = {"start": [-half / 2.0 - 2e-10, latitude], "goal": [half / 2.0, latitude]}
        features = [{"type": "Feature", "properties": {"role": "area"}, "geometry": area}] + [
            {
                "type": "Feature",
                "properties": {"role": role, "vehicle": "alpha"},
                "geometry": {"type": "Point", "coordinates": at},
            }
            for role, at in ends.items()
        ]
        return {"type": "FeatureCollection", "features": features}

    large = import_scenario(written(tmp_path, around(50.0, 0.5)))
    (told,) = (text for text in large.warnings if "equal latitude" in text)
    assert "up to 290 m beside" in told
    small = import_scenario(written(tmp_path, around(0.0, 0.001)))
    assert small.choices["origin"].startswith("0°, 0°, height 0 m")


def test_properties_of_features_that_do_not_have_them_are_told(tmp_path: Path) -> None:
    # A buoy's radius of 20 m would otherwise vanish, and a start's hour.
    content = drawing(
        point(0.2, 0.4, role="obstacle", name="buoy", radius=20, height=None),
        point(-0.5, 0.3, role="start", vehicle="b", after=30),
        point(0.5, -0.3, role="goal", vehicle="b", after=30, speed=1),
        point(0.3, 0.3, role="via", vehicle="b", acceleration=2, speed=1, order=1),
    )
    assert import_scenario(written(tmp_path, content)).warnings == (
        "properties without effect: acceleration of a via, after of a start, radius of an obstacle",
    )
