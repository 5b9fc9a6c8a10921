"""What drawings cannot be, told in one line each."""

import copy
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from drawings import AREA, drawing, place, point, polygon, written
from refusing import refusal

from radmpc.errors import FileFormatError
from radmpc.importing.formats import import_scenario
from radmpc.model.obstacle import PolygonShape


def change(feature: int, *path: str | int, to: object) -> Callable[[dict[str, Any]], None]:
    """What puts a value into a drawing's feature, or removes it (``...``)."""

    def act(content: dict[str, Any]) -> None:
        target = content["features"][feature]
        for key in path[:-1]:
            target = target[key]
        if to is ...:
            del target[path[-1]]
        else:
            target[path[-1]] = to

    return act


def add(*features: dict[str, Any]) -> Callable[[dict[str, Any]], None]:
    return lambda content: content["features"].extend(copy.deepcopy(features))


RING = ("geometry", "coordinates", 0)
TURNED = [place(*c) for c in [(0, 0), (0.1, 0.1), (0.1, 0), (0, 0.1), (0, 0)]]


@pytest.mark.parametrize(
    ("act", "line"),
    [
        (
            change(0, *RING, 1, to=[10.1, 120.0]),
            r"\d+: features\[0\].geometry.coordinates\[0\]\[1\]: latitude must be a number from "
            r"-90 to 90, longitude stands first, got 120.0",
        ),
        (
            change(1, "geometry", "coordinates", to=[181, 0]),
            r"\d+: features\[1\].geometry.coordinates: longitude must be a number from -180",
        ),
        (
            change(1, "geometry", "coordinates", to=["10", 54]),
            r"\d+: features\[1\].geometry.coordinates: longitude must be a number .* got '10'",
        ),
        (
            change(1, "geometry", "coordinates", to=[10]),
            r"\d+: features\[1\].geometry.coordinates: must be \[longitude, latitude\], got \[10\]",
        ),
        (
            change(0, *RING, 4, to=[10.1, 54.3]),
            r"\d+: features\[0\].geometry.coordinates\[0\]\[4\]: must be closed: the last pos",
        ),
        (
            change(0, *RING, to=TURNED),
            r"\d+: features\[0\].geometry.coordinates\[0\]: must not cross or touch itself .* got "
            r"Self-intersection\[10.14",
        ),
        (
            change(0, *RING, to=[place(0, 0)] * 5),
            r"\d+: features\[0\].geometry.coordinates\[0\]: must have at least 3 different corners",
        ),
        (
            change(0, *RING, to=[place(0, 0)]),
            r"\d+: features\[0\].geometry.coordinates\[0\]: must have at least 4 positions",
        ),
        (
            change(0, *RING, to=[place(i, i * i / 1e3) for i in range(300)] + [place(0, 0)]),
            r"\d+: features\[0\].geometry.coordinates\[0\]: must have at most 200 corners, got 300",
        ),
        (
            change(0, "geometry", "coordinates", to=[TURNED[:1] * 0]),
            r"\d+: features\[0\].geometry.coordinates\[0\]: must be a list of at least one entry",
        ),
        (
            change(0, "geometry", "type", to="GeometryCollection"),
            r"\d+: features\[0\].geometry.type: must be 'Point', .* or 'MultiPolygon', got 'Geo",
        ),
        (
            change(0, "geometry", to=[]),
            r"\d+: features\[0\].geometry: must be a mapping, got \[\]",
        ),
        (
            change(0, "properties", to=[1]),
            r"\d+: features\[0\].properties: must be a mapping, got \[1\]",
        ),
        (change(0, "type", to="Polygon"), r"\d+: features\[0\]: must be a mapping with type 'Fe"),
        (
            change(0, "properties", "role", to="start"),
            r"\d+: features\[0\].properties.role: must be 'obstacle' or 'area' of a Polygon",
        ),
        (
            change(1, "properties", "role", to=...),
            r"\d+: features\[1\].properties.role: must be 'start' or 'goal' .* got neither",
        ),
        (
            change(1, "properties", "vehicle", to=...),
            r"\d+: features\[1\].properties.vehicle: is required of a start or goal",
        ),
        (
            change(1, "properties", "vehicle", to=["a"]),
            r"\d+: features\[1\].properties.vehicle: must be text, got \['a'\]",
        ),
        (
            change(2, "properties", "vehicle", to="b"),
            r"\d+: features\[1\].properties.vehicle: vehicle 'a' needs a goal, a Point with role",
        ),
        (
            add(point(0.6, 0.3, role="goal", vehicle="b")),
            r"\d+: features\[3\].properties.vehicle: vehicle 'b' needs a start",
        ),
        (
            add(point(0.6, 0.3, role="goal", vehicle="a")),
            r"\d+: features\[3\].properties.vehicle: must be unique among goals, got 'a' twice",
        ),
        (
            add(polygon([(0.3, 0.3), (0.4, 0.3), (0.4, 0.4)], name="pier")),
            r"\d+: features\[3\].properties.name: must be unique among obstacles, got 'pier' twice",
        ),
        (
            change(1, "properties", "radius", to=-1),
            r"\d+: features\[1\].properties.radius: must be a number > 0 m, got -1",
        ),
        (
            change(1, "properties", "radius", to="wide"),
            r"\d+: features\[1\].properties.radius: must be a number > 0 m, got 'wide'",
        ),
        (
            change(1, "properties", "speed_limit", to=3),
            r"\d+: features\[1\].properties.speed: is 'speed_limit' by another name",
        ),
        (
            change(2, "properties", "radius", to=3),
            r"\d+: features\[2\].properties.radius: must be 1.5 as at the start of 'a', got 3",
        ),
        (add(AREA, AREA), r"\d+: features\[4\]: must be one area only, got a second"),
        (
            add(polygon([(-0.4, -0.5), (1, -0.5), (1, 0.5), (-0.4, 0.5)], role="area")),
            r"\d+: features\[1\].geometry.coordinates: must lie in the area, got \[10.144",
        ),
        (
            add(point(0, 0, role="origin"), point(0, 0, role="origin")),
            r"\d+: features\[4\]: must be one origin only, got a second",
        ),
        (
            add(point(0, 0, role="origin", height="low")),
            r"\d+: features\[3\].properties.height: must lie between",
        ),
        (
            change(1, "geometry", "coordinates", to=[54.3, 10.1]),
            r"\d+: features\[1\].geometry.coordinates: must lie within 100 km of the origin",
        ),
        (
            lambda content: content.update(features=content["features"][:1]),
            r"\d+: needs at least one vehicle: Points with role 'start' and 'goal'",
        ),
        (lambda content: content.update(features=[]), r"\d+: needs Points and Polygons"),
        (lambda content: content.update(features={}), r"\d+: features: must be a list, got {}"),
        (
            lambda content: content.update(
                crs={"type": "name", "properties": {"name": "EPSG:3857"}}
            ),
            r"\d+: crs: must be WGS 84",
        ),
        (
            lambda content: content.update(type="Feature"),
            r"\d+: type: must be 'FeatureCollection', got 'Feature'",
        ),
    ],
)
def test_a_drawing_that_cannot_be_meant_is_one_line(
    tmp_path: Path, act: Callable[[dict[str, Any]], None], line: str
) -> None:
    content = drawing()
    act(content)
    with pytest.raises(FileFormatError, match=r"bay.geojson:" + line):
        import_scenario(written(tmp_path, content))


def test_a_hole_of_an_obstacle_stays_free(tmp_path: Path) -> None:
    content = drawing()
    hole = [(0.02, 0.0), (0.05, 0.0), (0.05, 0.05), (0.02, 0.0)]
    content["features"][0]["geometry"]["coordinates"].append([place(*c) for c in hole])
    scenario = import_scenario(written(tmp_path, content)).scenario
    shape = scenario.obstacles[0].shape
    assert isinstance(shape, PolygonShape)
    (free,) = shape.holes
    assert free.shape == (3, 2)


def test_a_hole_beside_its_obstacle_is_refused(tmp_path: Path) -> None:
    content = drawing()
    hole = [(9.02, 0.0), (9.05, 0.0), (9.05, 0.05), (9.02, 0.0)]
    content["features"][0]["geometry"]["coordinates"].append([place(*c) for c in hole])
    with pytest.raises(FileFormatError, match=r"features\[0\].geometry.coordinates: .*Hole"):
        import_scenario(written(tmp_path, content))


@pytest.mark.parametrize(
    ("text", "line"),
    [("", "is empty"), ("{", "not valid JSON"), ("[]", "is of no format known here")],
)
def test_a_file_that_is_no_drawing_is_one_line(tmp_path: Path, text: str, line: str) -> None:
    with pytest.raises(FileFormatError, match=line):
        import_scenario(written(tmp_path, text))


def test_a_file_too_large_is_refused_before_it_is_read(tmp_path: Path) -> None:
    path = tmp_path / "huge.geojson"
    with path.open("wb") as file:
        file.truncate(200 * 2**20)
    with pytest.raises(FileFormatError, match=r"huge.geojson: must be at most 8 MiB, got 200$"):
        import_scenario(path)


def test_spoiled_drawings_end_in_one_line(tmp_path: Path) -> None:
    rng = random.Random(5)
    values = [None, True, "", "x", -1, 1e308, float("nan"), [], {}, [[]], [1, 2], 10**300, "area"]
    num_refused = 0
    for _ in range(400):
        content: Any = drawing(AREA)
        part, key = content, "features"
        while isinstance(part[key], list | dict) and part[key] and rng.random() < 0.85:
            part = part[key]
            key = rng.choice(list(part)) if isinstance(part, dict) else rng.randrange(len(part))
        part[key] = copy.deepcopy(rng.choice(values))
        path = written(tmp_path, content)
        line = refusal(path)
        if line is not None:
            num_refused += 1
            assert line.startswith(f"{path}:")
            assert line.isprintable()
    assert num_refused > 200
