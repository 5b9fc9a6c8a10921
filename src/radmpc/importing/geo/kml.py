"""KML: Placemarks with Points, LineStrings or Polygons."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import replace

from radmpc.arrays import Matrix, as_matrix
from radmpc.errors import FileFormatError, ScenarioError
from radmpc.importing.geo.feature import Feature, Path, drawn_line, drawn_ring, read_position
from radmpc.importing.geo.kml_xml import Placemark, Shape, read_placemarks
from radmpc.importing.geo.layers import Layers
from radmpc.importing.geo.properties import stated
from radmpc.importing.geo.rejoining import rejoined
from radmpc.io.text.document import Document
from radmpc.io.text.files import one_line, read_text, shown
from radmpc.io.text.lines import Place

__all__ = ["is_kml", "kml_document", "kml_features", "kmz_refusal"]


def kmz_refusal(path: str | os.PathLike[str]) -> FileFormatError:
    """Return why an archive is not read."""
    return FileFormatError(
        one_line(f"{os.fspath(path)}: is a packed KMZ: unpack it and import the .kml file in it")
    )


def kml_document(path: str | os.PathLike[str]) -> Document:
    """Return the Placemarks of a KML file with their lines, not yet checked.

    Raises
    ------
    FileFormatError
        If the file cannot be read, is no KML, or holds shapes other than points, lines and
        polygons.
    """
    name, text = os.fspath(path), read_text(path)
    placemarks = read_placemarks(text, name)
    places = Place(1, [_place(placemark) for placemark in placemarks])
    return Document(name, text, tuple(placemarks), Place(1, {"Placemark": places}))


def is_kml(value: object) -> bool:
    """Whether a document holds Placemarks."""
    return isinstance(value, tuple) and all(isinstance(one, Placemark) for one in value)


def kml_features(document: Document, layers: Layers, files: Sequence[str]) -> Iterator[Feature]:
    """Yield what is drawn in a KML file.

    Parameters
    ----------
    document : Document
        The file.
    layers : Layers
        Those that are taken. A Placemark lies in one of the file's name, of that of the document
        and of those of its folders.
    files : sequence of str
        The file's names as layers.

    Raises
    ------
    ScenarioError
        If something in it is missing or not known here; its path says where.
    """
    placemarks = document.value if isinstance(document.value, tuple) else ()
    for i, placemark in enumerate(placemarks):
        names = (*files, *placemark.layers)
        if not layers.takes(names):
            continue
        if not placemark.shapes:
            name = placemark.properties.get("name")
            layers.placeless.append(shown(name) if name else f"Placemark {i + 1}")
        else:
            for feature in rejoined(_features(placemark, ("Placemark", i))):
                yield replace(feature, usual_role=layers.role(names))


def _features(placemark: Placemark, path: Path) -> Iterator[Feature]:
    """Yield the points, lines and polygons of one Placemark."""
    properties = stated(placemark.properties)
    for i, shape in enumerate(placemark.shapes):
        where = (*path, f"{shape.kind} {i + 1}")
        rings = _RINGS[shape.kind](shape, where)
        yield Feature(shape.kind, rings, properties, path, where, path)


def _point(shape: Shape, path: Path) -> tuple[Matrix, ...]:
    """Return the position of a Point, (1, 3)."""
    places = shape.outer[0] if len(shape.outer) == 1 else []
    if len(places) != 1:
        raise ScenarioError(f"must have 1 position, got {len(places)}", path)
    return (as_matrix([read_position(places[0], path)]),)


def _line(shape: Shape, path: Path) -> tuple[Matrix, ...]:
    """Return the positions of a LineString, (r, 3)."""
    return (drawn_line(shape.outer[0] if len(shape.outer) == 1 else [], path),)


def _polygon(shape: Shape, path: Path) -> tuple[Matrix, ...]:
    """Return the rings of a Polygon, each (r, 3)."""
    if len(shape.outer) != 1:
        raise ScenarioError(f"must have 1 outerBoundaryIs, got {len(shape.outer)}", path)
    return tuple(
        drawn_ring(ring, (*path, i)) for i, ring in enumerate([*shape.outer, *shape.inner])
    )


_RINGS = {"Point": _point, "LineString": _line, "Polygon": _polygon}


def _place(placemark: Placemark) -> Place:
    """Return the lines of a Placemark."""
    parts = {key: Place(line) for key, line in placemark.lines.items()}
    for i, shape in enumerate(placemark.shapes):
        rings = [
            Place(lines[0] if lines else shape.line, [Place(line) for line in lines])
            for lines in (*shape.outer_lines, *shape.inner_lines)
        ]
        parts[f"{shape.kind} {i + 1}"] = Place(shape.line, rings)
    return Place(placemark.line, parts)
