"""GeoJSON (RFC 7946): a FeatureCollection of points, lines and polygons."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from radmpc.arrays import as_matrix
from radmpc.errors import ScenarioError
from radmpc.importing.geo.feature import Feature, Path, drawn_line, drawn_ring, read_position
from radmpc.importing.geo.layers import Layers
from radmpc.importing.geo.properties import stated
from radmpc.importing.geo.rejoining import rejoined
from radmpc.io.text.document import Document
from radmpc.io.text.files import read_text, shown
from radmpc.io.text.json_text import read_json

__all__ = ["geojson_document", "geojson_features", "is_geojson"]

_SHAPES = ("Point", "MultiPoint", "LineString", "MultiLineString", "Polygon", "MultiPolygon")
_TYPES = ("FeatureCollection", "Feature", "GeometryCollection", *_SHAPES)
_WGS84 = ("CRS84", "EPSG::4326", "EPSG:4326")


def geojson_document(path: str | os.PathLike[str]) -> Document:
    """Return what a GeoJSON file holds, not yet checked.

    Raises
    ------
    FileFormatError
        If the file cannot be read or is no JSON.
    """
    name, text = os.fspath(path), read_text(path)
    return Document(name, text, read_json(text, name), None)


def is_geojson(value: object) -> bool:
    """Whether a file's content looks like GeoJSON."""
    return isinstance(value, Mapping) and value.get("type") in _TYPES


def geojson_features(document: Document, layers: Layers, files: Sequence[str]) -> Iterator[Feature]:
    """Yield what is drawn in a GeoJSON file.

    Parameters
    ----------
    document : Document
        The file.
    layers : Layers
        Those that are taken. A feature lies in one of the file's name, of that of the collection
        (``name``) and of its own property ``layer``.
    files : sequence of str
        The file's names as layers.

    Raises
    ------
    ScenarioError
        If something in it is missing or not known here; its path says where.
    """
    value = document.value
    if not isinstance(value, Mapping) or value.get("type") != "FeatureCollection":
        got = value.get("type") if isinstance(value, Mapping) else value
        raise ScenarioError(f"must be 'FeatureCollection', got {shown(got)}", ("type",))
    if "crs" in value and not str(value["crs"]).rstrip("'}").endswith(_WGS84):
        # Meters of some projection would be read as degrees.
        raise ScenarioError(f"must be WGS 84 (CRS84), got {shown(value['crs'])}", ("crs",))
    features = value.get("features")
    if not isinstance(features, list):
        raise ScenarioError(f"must be a list, got {shown(features)}", ("features",))
    outer = [name for name in (*files, value.get("name")) if isinstance(name, str) and name]
    for i, given in enumerate(features):
        entry = _checked(given, ("features", i))
        properties = _properties(entry, ("features", i))
        inner = properties.get("layer")
        names = [*outer, inner] if isinstance(inner, str) and inner else outer
        if not layers.takes(names):
            continue
        if _is_placeless(entry, ("features", i)):
            layers.placeless.append(_title(properties, i))
        else:
            for feature in rejoined(_features(entry, properties, ("features", i))):
                yield replace(feature, usual_role=layers.role(names))


def _is_placeless(entry: Mapping[str, object], path: Path) -> bool:
    """Whether a feature has no place: RFC 7946 wants its geometry to be null."""
    if "geometry" not in entry:
        raise ScenarioError("is required, null where there is none", (*path, "geometry"))
    return entry["geometry"] is None


def _title(properties: Mapping[str, object], index: int) -> str:
    """Return what a feature is called in a note: its name, or its place in the file."""
    name = properties.get("name")
    return shown(name) if isinstance(name, str) else f"features[{index}]"


def _checked(entry: object, path: Path) -> Mapping[str, object]:
    """Return what is a feature."""
    if not isinstance(entry, Mapping) or entry.get("type") != "Feature":
        raise ScenarioError("must be a mapping with type 'Feature'", path)
    return entry


def _properties(entry: Mapping[str, object], path: Path) -> Mapping[str, object]:
    """Return the properties of a feature, none if it has none."""
    properties = entry.get("properties")
    if properties is None:
        properties = {}
    if not isinstance(properties, Mapping):
        raise ScenarioError(f"must be a mapping, got {shown(properties)}", (*path, "properties"))
    return stated(properties)


def _features(
    entry: Mapping[str, object], properties: Mapping[str, object], path: Path
) -> Iterator[Feature]:
    """Yield the point, lines or polygons of one feature."""
    geometry, inner = entry.get("geometry"), (*path, "geometry")
    if not isinstance(geometry, Mapping):
        raise ScenarioError(f"must be a mapping, got {shown(geometry)}", inner)
    kind, coordinates = geometry.get("type"), geometry.get("coordinates")
    where = (*inner, "coordinates")
    if kind not in _SHAPES:
        # A shape left out may have been meant as an obstacle.
        *first, last = map(repr, _SHAPES)
        raise ScenarioError(
            f"must be {', '.join(first)} or {last}, got {shown(kind)}", (*inner, "type")
        )
    parts = [(coordinates, where)]
    if str(kind).startswith("Multi"):
        parts = [(part, (*where, i)) for i, part in enumerate(_list(coordinates, where))]
    for part, place in parts:
        if kind in {"Point", "MultiPoint"}:
            rings = (as_matrix([read_position(part, place)]),)
            yield Feature("Point", rings, properties, path, place, (*path, "properties"))
            continue
        if kind in {"LineString", "MultiLineString"}:
            line = drawn_line(_list(part, place), place)
            yield Feature("LineString", (line,), properties, path, place, (*path, "properties"))
            continue
        outlines = [
            drawn_ring(_list(ring, (*place, i)), (*place, i))
            for i, ring in enumerate(_list(part, place))
        ]
        yield Feature("Polygon", tuple(outlines), properties, path, place, (*path, "properties"))


def _list(value: object, path: Path) -> list[object]:
    """Return a value that is a list with something in it."""
    if not isinstance(value, list) or not value:
        raise ScenarioError(f"must be a list of at least one entry, got {shown(value)}", path)
    return value
