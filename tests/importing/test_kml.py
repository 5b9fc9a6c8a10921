from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest
from refusing import refusal

from radmpc.errors import FileFormatError
from radmpc.importing.formats import import_scenario
from sampling import IS_THOROUGH

FOLDER = Path(__file__).parent.parent.parent / "instances" / "drawn"

BAY = """\
<?xml version="1.0" encoding="UTF-8"?>
<kml xmlns="http://www.opengis.net/kml/2.2" xmlns:gx="http://www.google.com/kml/ext/2.2">
<Document>
<Style id="red"><LineStyle><color>ff0000ff</color></LineStyle></Style>
<Placemark id="p1">
<name>pier</name>
<Polygon><outerBoundaryIs><LinearRing>
<coordinates>
10.1450,54.3323,0
10.1451,54.3323,0 10.1451,54.3327,0
10.1450,54.3327,0
10.1450,54.3323,0
</coordinates>
</LinearRing></outerBoundaryIs></Polygon>
</Placemark>
<Folder><Folder>
<Placemark>
<name>start alpha</name>
<ExtendedData><Data name="radius"><value> 1.5 </value></Data>
<SchemaData><SimpleData name="speed">2</SimpleData></SchemaData></ExtendedData>
<Point><coordinates>10.1445,54.3325</coordinates></Point>
</Placemark>
<Placemark>
<name>home</name>
<ExtendedData><Data name="role"><value>goal</value></Data>
<Data name="vehicle"><value>alpha</value></Data></ExtendedData>
<MultiGeometry><Point><coordinates>10.1455,54.3326,0</coordinates></Point></MultiGeometry>
</Placemark>
</Folder></Folder>
</Document>
</kml>
"""


def written(folder: Path, text: str, name: str = "bay.kml") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def test_placemarks_become_obstacles_and_vehicles(tmp_path: Path) -> None:
    imported = import_scenario(written(tmp_path, BAY))
    scenario = imported.scenario
    assert [obstacle.name for obstacle in scenario.obstacles] == ["pier"]
    (vehicle,) = scenario.vehicles
    assert (vehicle.name, vehicle.radius) == ("alpha", 1.5)
    assert vehicle.speed_limit is not None
    assert vehicle.speed_limit.tolist() == [2.0, 2.0]
    way = vehicle.goal.center - vehicle.start_position
    np.testing.assert_allclose(way, [65.04, 11.13], atol=0.02)
    assert scenario.source is not None
    assert scenario.source["format"] == "kml"
    assert imported.warnings == ()


def test_names_in_a_namespace_are_the_same_names(tmp_path: Path) -> None:
    text = BAY.replace("<Placemark", "<k:Placemark").replace("</Placemark", "</k:Placemark")
    text = text.replace("<kml ", '<kml xmlns:k="http://www.opengis.net/kml/2.2" ')
    assert len(import_scenario(written(tmp_path, text)).scenario.vehicles) == 1


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        (
            "<kml xmlns",
            '<!DOCTYPE kml [<!ENTITY a "b">]>\n<kml xmlns',
            r"bay.kml:2: must not declare a document type",
        ),
        ("</Document>", "", r"bay.kml:\d+: not valid XML: mismatched tag"),
        ("<name>pier", "<name>&b;", r"bay.kml:6: not valid XML: undefined entity"),
        ("10.1451,54.3323,0", "10.1451,x", r"bay.kml:10: coordinates must be longitude,latitude"),
        (
            "10.1451,54.3323,0",
            "10.1451,95",
            r"bay.kml:10: Placemark\[0\].Polygon 1\[0\]\[1\]: latitude must be a number from -90",
        ),
        (
            "\n10.1450,54.3323,0\n</coord",
            "\n</coord",
            r"bay.kml:11: Placemark\[0\].Polygon 1\[0\]\[3\]: must be closed",
        ),
        (
            "10.1445,54.3325<",
            "10.1445,54.3325 10,54<",
            r"bay.kml:21: Placemark\[1\].Point 1: must have 1 position, got 2",
        ),
        (
            "10.1445,54.3325<",
            "<",
            r"bay.kml:21: Placemark\[1\].Point 1: must have 1 position, got 0",
        ),
        (
            "</Polygon>",
            "<outerBoundaryIs><LinearRing><coordinates>1,1</coordinates></LinearRing>"
            "</outerBoundaryIs></Polygon>",
            r"bay.kml:7: Placemark\[0\].Polygon 1: must have 1 outerBoundaryIs, got 2",
        ),
        (
            "Polygon>",
            "Track>",
            r"bay.kml:7: must be Points, LineStrings and Polygons only, got a Track",
        ),
        (
            "<Folder><Folder>",
            "<NetworkLink/><Folder><Folder>",
            r"bay.kml:16: must be Points, LineStrings and Polygons only, got a NetworkLink",
        ),
        (
            " 1.5 ",
            "wide",
            r"bay.kml:19: Placemark\[1\].radius: must be a number > 0 m, got 'wide'",
        ),
        ('name="speed"', 'name="radius"', r"bay.kml:20: the property 'radius' stands twice"),
        (
            "<value>alpha",
            "<value>bravo",
            r"bay.kml:17: Placemark\[1\].vehicle: vehicle 'alpha' needs a goal",
        ),
        (
            "<name>start alpha",
            "<name>alpha",
            r"bay.kml:17: Placemark\[1\].role: must be 'start' or",
        ),
        ("<kml ", "<gpx ", r"bay.kml:2: must be KML, got an XML document of 'gpx'"),
        ("<Folder><Folder>", "<Folder>" * 60, r"bay.kml:16: must not be nested deeper than 50"),
    ],
)
def test_a_drawing_that_cannot_be_meant_is_one_line(
    tmp_path: Path, old: str, new: str, line: str
) -> None:
    assert old in BAY
    with pytest.raises(FileFormatError, match=line):
        import_scenario(written(tmp_path, BAY.replace(old, new)))


BOOM = """\
<Placemark>
<ExtendedData><Data name="role"><value>obstacle</value></Data></ExtendedData>
<MultiGeometry>
<LineString><coordinates>10.145,54.331 10.146,54.331 10.146,54.332</coordinates></LineString>
<Point><coordinates>10.144,54.331</coordinates></Point>
</MultiGeometry>
</Placemark>
"""


def test_lines_and_points_may_be_obstacles(tmp_path: Path) -> None:
    text = BAY.replace("<Folder><Folder>", BOOM + "<Folder><Folder>")
    obstacles = import_scenario(written(tmp_path, text)).scenario.obstacles
    assert [o.name for o in obstacles] == ["pier", "line2", "post3"]
    assert [len(o.at(0)) for o in obstacles] == [1, 2, 1]


def test_a_line_without_places_is_refused(tmp_path: Path) -> None:
    line = "<LineString><coordinates>10.145,54.331 10.146,54.331 10.146,54.332</coordinates>"
    text = BAY.replace("<Folder><Folder>", BOOM.replace(line, "<LineString>") + "<Folder><Folder>")
    with pytest.raises(FileFormatError, match=r"bay.kml:19: .*must have at least 2 different pos"):
        import_scenario(written(tmp_path, text))


def test_files_that_are_none_are_one_line(tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match=r"bay.kml:1: is empty"):
        import_scenario(written(tmp_path, " \n"))
    with pytest.raises(FileFormatError, match=r"bay.kml:1: needs Points and Polygons or LineStr"):
        import_scenario(written(tmp_path, "<kml/>"))
    with pytest.raises(FileFormatError, match=r"bay.kmz: is a packed KMZ: unpack it"):
        import_scenario(written(tmp_path, "PK", "bay.kmz"))


@pytest.mark.slow
def test_spoiled_drawings_end_in_one_line(tmp_path: Path) -> None:
    rng = random.Random(11)
    text = (FOLDER / "marina.kml").read_text(encoding="utf-8")
    bits = ["", "<", ">", "&", "\0", "<Point>", "</Placemark>", "<!--", "]]>", ",", "x", "9" * 400]
    num_refused = 0
    num_cases = 300 if IS_THOROUGH else 40
    for _ in range(num_cases):
        at = rng.randrange(len(text))
        broken = text[:at] + rng.choice(bits) + text[at + rng.choice([0, 1, 7, 60]) :]
        path = written(tmp_path, broken)
        line = refusal(path)
        if line is not None:
            num_refused += 1
            assert line.startswith(f"{path}:")
            assert line.isprintable()
    assert num_refused > num_cases // 2
