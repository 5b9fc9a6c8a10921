"""KML 2.2 with Google's tracks: when each vehicle is where, starts, goals and obstacles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import UTC, datetime, timedelta
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from radmpc.arrays import Matrix
from radmpc.io.export.antimeridian import cut_area, cut_face, cut_line
from radmpc.io.export.job import Job
from radmpc.io.export.names import xml_text
from radmpc.io.export.origin import Placement
from radmpc.io.export.outlines import Kind, goal_outline, holes, kind_of, outline, triangles
from radmpc.io.export.relations import ranges_kept, whom
from radmpc.io.export.statements import origin_sentence, risk_sentence, title
from radmpc.io.export.tracks import TimedPath, check_duration
from radmpc.model.goal import Goal
from radmpc.model.obstacle import Obstacle
from radmpc.model.visits import Visit

__all__ = ["write_kml"]

_START = datetime(1970, 1, 1, tzinfo=UTC)

_LONGEST = 2e11
"""Longest mission [s]: the years of KML's dates have four digits."""

_COLORS = ("1f77b4", "ff7f0e", "2ca02c", "d62728", "9467bd", "8c564b", "e377c2", "17becf")
_GRAY = "7f7f7f"


def write_kml(job: Job) -> bytes:
    """Return a plan as KML.

    Parameters
    ----------
    job : Job
        The plan and its place on earth.

    Returns
    -------
    bytes
        XML in UTF-8. Heights are above ground, which stands for the origin's height; time 0 is
        the first second of 1970.

    Raises
    ------
    ScenarioError
        If the mission lasts longer than dates have years.
    """
    check_duration(job.plan, _LONGEST, "the dates of KML")
    # Names with their prefixes: those of ElementTree's registry are shared by the process.
    root = Element(
        "kml",
        {
            "xmlns": "http://www.opengis.net/kml/2.2",
            "xmlns:gx": "http://www.google.com/kml/ext/2.2",
        },
    )
    document = SubElement(root, "Document")
    _text(document, "name", job.plan.scenario.name)
    _text(document, "description", _description(job))
    for number in range(len(job.tracks)):
        _style(document, f"vehicle{number}", _COLORS[number % len(_COLORS)])
    _style(document, "obstacle", _GRAY)
    for number, track in enumerate(job.tracks):
        _vehicle(document, track, f"#vehicle{number}", job)
    for obstacle in job.plan.scenario.obstacles:
        _obstacle(document, obstacle, job)
    ElementTree.indent(root)
    content: bytes = ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)
    return content + b"\n"


def _description(job: Job) -> str:
    """Return what a reader must know."""
    sentences = (
        title(job.plan),
        risk_sentence(job.plan, job.is_certified),
        "heights are in meters above ground, which stands for the height of the plan's origin",
        "times count from 1970-01-01T00:00:00Z, the start of the mission",
        origin_sentence(job.place),
        *([] if job.note is None else [job.note]),
    )
    return "\n".join(sentences)


def _vehicle(parent: Element, track: TimedPath, style: str, job: Job) -> None:
    """Add a vehicle's folder: track, start and goal."""
    place = job.place
    folder = SubElement(parent, "Folder")
    _text(folder, "name", track.name)
    _track(_placemark(folder, track.name, style), track, place)
    start = track.vehicle.start_position[None]
    mark = _placemark(folder, f"{track.name}: start", style)
    _data(mark, ranges_kept(job.plan.scenario.keep, track.name))
    _point(mark, start, place)
    for number, visit in enumerate(track.vehicle.via):
        mark = _placemark(folder, f"{track.name}: visit {number + 1}", style)
        if number < len(track.visits):
            stamp = Element("TimeStamp")
            _text(stamp, "when", _when(float(track.times[track.visits[number]])))
            mark.insert(1, stamp)
        _box(mark, visit, place)
    _box(_placemark(folder, f"{track.name}: goal", style), track.vehicle.goal, place)


def _track(mark: Element, track: TimedPath, place: Placement) -> None:
    """Add when a vehicle is where, in several tracks where it crosses the antimeridian."""
    parts = cut_line(np.column_stack([_places(track.positions, place), track.times]))
    parent = mark
    if len(parts) > 1:
        parent = SubElement(mark, "gx:MultiTrack")
        _text(parent, "altitudeMode", "relativeToGround")
        # Between its tracks there is no time.
        _text(parent, "gx:interpolate", "1")
    for part in parts:
        path = SubElement(parent, "gx:Track")
        _text(path, "altitudeMode", "relativeToGround")
        for time in part[:, 3].tolist():
            _text(path, "when", _when(time))
        for point in part[:, :3].tolist():
            _text(path, "gx:coord", _words(point, " "))


def _box(mark: Element, box: Goal | Visit, place: Placement) -> None:
    """Add a box seen from above, or its middle where that has no area."""
    corners = goal_outline(box)
    if corners is None:
        _point(mark, box.center[None], place)
        return
    if box.lower.size == 3:
        corners = np.column_stack([corners, np.full(len(corners), box.center[2])])
    _polygon(mark, corners, place)


def _obstacle(parent: Element, obstacle: Obstacle, job: Job) -> None:
    """Add an obstacle: an outline in the plane, a surface in space; a moving one per step."""
    dt = job.plan.scenario.dt
    for step in range(len(obstacle.steps)):
        mark = _placemark(parent, obstacle.name, "#obstacle")
        if obstacle.is_moving:
            span = Element("TimeSpan")
            _text(span, "begin", _when(step * dt))
            _text(span, "end", _when((step + 1) * dt))
            # The schema wants the time before the style.
            mark.insert(1, span)
        _data(mark, whom(obstacle))
        if obstacle.dimension == 2:
            _shape(mark, *outline(obstacle, step), job.place, holes(obstacle))
            continue
        surface = SubElement(mark, "MultiGeometry")
        for piece in obstacle.at(step):
            if len(piece.vertices) < 3:
                _shape(surface, kind_of(piece.vertices), piece.vertices, job.place)
            for face in triangles(piece).reshape(-1, 3, 3):
                for part in cut_face(_places(face, job.place)):
                    _rings(surface, [part])


def _shape(
    parent: Element, kind: Kind, corners: Matrix, place: Placement, free: Sequence[Matrix] = ()
) -> None:
    """Add what has corners, and perhaps holes."""
    if kind == "Polygon":
        _polygon(parent, corners, place, free)
    elif kind == "Point":
        _point(parent, corners, place)
    else:
        parts = cut_line(_places(corners, place))
        group = _group(parent, len(parts))
        for part in parts:
            line = SubElement(group, "LineString")
            _text(line, "altitudeMode", "relativeToGround")
            _text(line, "coordinates", " ".join(_words(row, ",") for row in part.tolist()))


def _group(parent: Element, parts: int) -> Element:
    """Return where the parts of a shape go: one shape, or a group of them."""
    if parts == 1 or parent.tag == "MultiGeometry":
        return parent
    return SubElement(parent, "MultiGeometry")


def _placemark(parent: Element, name: str, style: str) -> Element:
    """Add a placemark and return it."""
    mark = SubElement(parent, "Placemark")
    _text(mark, "name", name)
    _text(mark, "styleUrl", style)
    return mark


def _data(mark: Element, properties: Mapping[str, Sequence[object]]) -> None:
    """Add lists as extended data, with commas between; nothing where there are none."""
    if not properties:
        return
    extended = SubElement(mark, "ExtendedData")
    for key, values in properties.items():
        data = SubElement(extended, "Data", {"name": key})
        _text(data, "value", ", ".join(map(str, values)))


def _point(parent: Element, points: Matrix, place: Placement) -> None:
    """Add a point."""
    point = SubElement(parent, "Point")
    _text(point, "altitudeMode", "relativeToGround")
    _text(point, "coordinates", _words(_places(points, place)[0].tolist(), ","))


def _polygon(
    parent: Element, corners: Matrix, place: Placement, free: Sequence[Matrix] = ()
) -> None:
    """Add a polygon, perhaps with holes, in parts where it crosses the antimeridian."""
    areas = cut_area([_places(around, place) for around in (corners, *free)])
    group = _group(parent, len(areas))
    for rings in areas:
        _rings(group, rings)


def _rings(parent: Element, rings: Sequence[Matrix]) -> None:
    """Add a polygon: its outline, then its holes, each as `_places` gives them."""
    polygon = SubElement(parent, "Polygon")
    _text(polygon, "altitudeMode", "relativeToGround")
    for number, places in enumerate(rings):
        border = "innerBoundaryIs" if number else "outerBoundaryIs"
        ring = SubElement(SubElement(polygon, border), "LinearRing")
        rows = [*places.tolist(), places[0].tolist()]
        _text(ring, "coordinates", " ".join(_words(row, ",") for row in rows))


def _places(points: Matrix, place: Placement) -> Matrix:
    """Return longitude, latitude [°] and height above the origin [m] of points, (k, 3)."""
    return np.column_stack([place.geodetic(points)[:, [1, 0]], place.levels(points)])


def _words(row: Sequence[float], between: str) -> str:
    """Return longitude, latitude and height as text."""
    longitude, latitude, level = row
    return between.join((f"{longitude:.9f}", f"{latitude:.9f}", f"{level:.4f}"))


def _style(parent: Element, name: str, color: str) -> None:
    """Add a style; KML writes colors as alpha, blue, green, red."""
    style = SubElement(parent, "Style", {"id": name})
    written = color[4:6] + color[2:4] + color[0:2]
    _text(SubElement(style, "IconStyle"), "color", f"ff{written}")
    line = SubElement(style, "LineStyle")
    _text(line, "color", f"ff{written}")
    _text(line, "width", "3")
    _text(SubElement(style, "PolyStyle"), "color", f"80{written}")


def _when(time: float) -> str:
    """Return a time [s] as a date."""
    return (_START + timedelta(seconds=time)).strftime("%Y-%m-%dT%H:%M:%S.%fZ")


def _text(parent: Element, tag: str, text: str) -> None:
    """Add an element that holds text."""
    SubElement(parent, tag).text = xml_text(text)
