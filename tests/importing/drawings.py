"""Features of GeoJSON in meters around a place, written and imported."""

import json
from pathlib import Path
from typing import Any

LATITUDE, LONGITUDE = 54.3325, 10.145


def polygon(corners: list[tuple[float, float]], **properties: object) -> dict[str, Any]:
    """A polygon of corners in thousandths of degrees east and north of the middle."""
    ring = [place(east, north) for east, north in [*corners, corners[0]]]
    return {
        "type": "Feature",
        "properties": properties,
        "geometry": {"type": "Polygon", "coordinates": [ring]},
    }


def point(east: float, north: float, **properties: object) -> dict[str, Any]:
    return {
        "type": "Feature",
        "properties": properties,
        "geometry": {"type": "Point", "coordinates": place(east, north)},
    }


def place(east: float, north: float) -> list[float]:
    return [LONGITUDE + 1e-3 * east, LATITUDE + 1e-3 * north]


def drawing(*more: dict[str, Any]) -> dict[str, Any]:
    return {
        "type": "FeatureCollection",
        "features": [
            polygon([(0, -0.2), (0.1, -0.2), (0.1, 0.2), (0, 0.2)], name="pier"),
            point(-0.5, 0.0, role="start", vehicle="a", radius=1.5, speed=2, acceleration=0.5),
            point(0.5, 0.1, role="goal", vehicle="a"),
            *more,
        ],
    }


def written(folder: Path, content: object, name: str = "bay.geojson") -> Path:
    path = folder / name
    path.write_text(
        content if isinstance(content, str) else json.dumps(content, indent=1), encoding="utf-8"
    )
    return path


AREA = polygon([(-1, -0.5), (1, -0.5), (1, 0.5), (-1, 0.5)], role="area")


def line(shape: str, coordinates: object, **properties: object) -> dict[str, Any]:
    return {
        "type": "Feature",
        "properties": properties,
        "geometry": {"type": shape, "coordinates": coordinates},
    }
