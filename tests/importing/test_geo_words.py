"""What an import of a map tells of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from drawings import written

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
