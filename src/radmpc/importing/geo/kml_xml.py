"""The XML of KML files, read without document types, entities or other files."""

from __future__ import annotations

import re
from xml.parsers import expat

from radmpc.errors import FileFormatError
from radmpc.io.text.files import one_line, shown
from radmpc.io.text.lines import MAX_DEPTH
from radmpc.records import dataclass, field

__all__ = ["Placemark", "Shape", "read_placemarks"]

_OTHER_SHAPES = frozenset({"Model", "Track", "MultiTrack", "NetworkLink"})
_SHAPES = frozenset({"Point", "LineString", "Polygon"})
_FOLDERS = frozenset({"Document", "Folder"})
_VALUES = frozenset({"value", "SimpleData"})
_BOUNDARIES = ("outerBoundaryIs", "innerBoundaryIs")
_WORD = re.compile(r"\S+")


@dataclass(slots=True)
class Shape:
    """A Point, LineString or Polygon: lists of positions, and the lines on which these stand.

    Attributes
    ----------
    kind : str
        ``Point``, ``LineString`` or ``Polygon``.
    line : int
        Where it begins in the file.
    outer, inner : list of list
        Positions of each outer ring (or of the point or line) and of each hole.
    outer_lines, inner_lines : list of list of int
        The line on which each position stands.
    """

    kind: str
    line: int
    outer: list[list[object]] = field(default_factory=list)
    inner: list[list[object]] = field(default_factory=list)
    outer_lines: list[list[int]] = field(default_factory=list)
    inner_lines: list[list[int]] = field(default_factory=list)


@dataclass(slots=True)
class Placemark:
    """What is read of a Placemark.

    Attributes
    ----------
    line : int
        Where it begins in the file.
    properties : dict
        Its name and extended data, by key.
    lines : dict
        The line on which each property stands, by key.
    layers : tuple of str
        Names of the folders that hold it, the outermost first, and of the document.
    shapes : list of Shape
        In the order of the file.
    """

    line: int
    properties: dict[str, str] = field(default_factory=dict)
    lines: dict[str, int] = field(default_factory=dict)
    layers: tuple[str, ...] = ()
    shapes: list[Shape] = field(default_factory=list)


def read_placemarks(text: str, name: str) -> list[Placemark]:
    """Return the Placemarks of a KML text, however deep in folders.

    Parameters
    ----------
    text : str
        The whole file.
    name : str
        The file, for messages.

    Raises
    ------
    FileFormatError
        If the text is no KML, declares a document type, or holds other shapes.
    """
    if not text.strip():
        raise FileFormatError(one_line(f"{name}:1: is empty"))
    reader = _Reader(name)
    try:
        reader.parser.Parse(text, True)
    except expat.ExpatError as error:
        what = expat.ErrorString(error.code)
        raise FileFormatError(one_line(f"{name}:{error.lineno}: not valid XML: {what}")) from error
    return reader.placemarks


class _Reader:
    """Takes the events of the XML parser."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.placemarks: list[Placemark] = []
        self.parser = expat.ParserCreate()
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._characters
        self.parser.StartDoctypeDeclHandler = self._doctype
        self._open: list[str] = []
        self._folders: list[str] = []
        self._key = ""
        self._text: list[str] = []
        self._line = 1

    def _failure(self, message: str) -> FileFormatError:
        """Return an error at the current line."""
        return FileFormatError(one_line(f"{self.name}:{self.parser.CurrentLineNumber}: {message}"))

    def _doctype(self, *_: object) -> None:
        """Refuse document types: entities that expand to gigabytes are declared there."""
        raise self._failure("must not declare a document type (<!DOCTYPE ...>)")

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        """Take the start of an element."""
        tag = tag.rpartition(":")[2]
        if not self._open and tag != "kml":
            raise self._failure(f"must be KML, got an XML document of {shown(tag)}")
        if len(self._open) >= MAX_DEPTH:
            raise self._failure(f"must not be nested deeper than {MAX_DEPTH} levels")
        if tag in _OTHER_SHAPES or (tag == "LinearRing" and self._open[-1] not in _BOUNDARIES):
            # A track left out may have been meant as a border, a link may lead to obstacles.
            hint = ": paths of plans are not imported" if tag.endswith("Track") else ""
            raise self._failure(f"must be Points, LineStrings and Polygons only, got a {tag}{hint}")
        self._line = self.parser.CurrentLineNumber
        self._text = []
        if tag == "Placemark":
            folders = tuple(name for name in self._folders if name)
            self.placemarks.append(Placemark(self._line, layers=folders))
        elif tag in _FOLDERS:
            self._folders.append("")
        elif tag in {"Data", "SimpleData"}:
            self._key = attributes.get("name", "")
        elif tag in _SHAPES and "Placemark" in self._open:
            self.placemarks[-1].shapes.append(Shape(tag, self._line))
        self._open.append(tag)

    def _characters(self, text: str) -> None:
        """Take text, of which an element may get several pieces."""
        self._text.append(text)

    def _end(self, _: str) -> None:
        """Take the end of an element, and what stood in it."""
        tag, text = self._open.pop(), "".join(self._text)
        self._text = []
        if "Placemark" not in self._open:
            if tag == "name" and self._open and self._open[-1] in _FOLDERS:
                self._folders[-1] = text.strip()
            elif tag in _FOLDERS:
                self._folders.pop()
            return
        if tag == "name" and self._open[-1] == "Placemark":
            self._property("name", text)
        elif tag in _VALUES and self._key:
            self._property(self._key, text)
        elif tag == "coordinates" and self.placemarks[-1].shapes:
            self._coordinates(text)

    def _property(self, key: str, text: str) -> None:
        """Take a property."""
        placemark = self.placemarks[-1]
        if key in placemark.lines and key != "name":
            raise self._failure(f"the property {shown(key)} stands twice")
        placemark.properties[key] = text.strip()
        placemark.lines[key] = self._line

    def _coordinates(self, text: str) -> None:
        """Take the positions of a Point, a line or a ring: words of numbers with commas between."""
        positions: list[object] = []
        lines: list[int] = []
        line, seen = self._line, 0
        for word in _WORD.finditer(text):
            line += text.count("\n", seen, word.start())
            seen = word.start()
            try:
                positions.append([float(part) for part in word[0].split(",")])
            except ValueError as error:
                raise FileFormatError(
                    one_line(
                        f"{self.name}:{line}: coordinates must be longitude,latitude[,height] "
                        f"between blanks, got {shown(word[0])}"
                    )
                ) from error
            lines.append(line)
        shape = self.placemarks[-1].shapes[-1]
        is_inner = "innerBoundaryIs" in self._open
        (shape.inner if is_inner else shape.outer).append(positions)
        (shape.inner_lines if is_inner else shape.outer_lines).append(lines)
