"""GeoJSON (RFC 7946): tracks with times and uncertainty, starts, goals and obstacles."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from radmpc.arrays import Matrix
from radmpc.geometry import Polytope
from radmpc.io.export.antimeridian import cut_area, cut_line
from radmpc.io.export.job import Job
from radmpc.io.export.origin import Placement
from radmpc.io.export.outlines import Kind, footprint, goal_outline, holes, outline
from radmpc.io.export.relations import ranges_kept, whom
from radmpc.io.export.statements import origin_sentence, risk_sentence, title
from radmpc.io.export.tracks import TimedPath
from radmpc.io.text.json_text import write_json
from radmpc.model.goal import Goal
from radmpc.model.obstacle import Obstacle
from radmpc.model.visits import Visit

__all__ = ["write_geojson"]

_AXES = ("east", "north", "up")

Feature = dict[str, object]

Shape = tuple[str, object]
"""A geometry's type and coordinates."""


def write_geojson(job: Job) -> bytes:
    """Return a plan as a feature collection.

    Parameters
    ----------
    job : Job
        The plan and its place on earth.

    Returns
    -------
    bytes
        JSON. The property ``kind`` is ``path``, ``start``, ``goal``, ``visit`` or
        ``obstacle``.
    """
    features: list[Feature] = []
    for track in job.tracks:
        goal = track.vehicle.goal
        features += [_path(track, job.place), _start(track, job)]
        features.append(_box("goal", track.name, goal, job.place))
        features += _visits(track, job.place)
    features += _obstacles(job)
    content: dict[str, object] = {
        "type": "FeatureCollection",
        "name": job.plan.scenario.name,
        "description": title(job.plan),
        "risk": risk_sentence(job.plan, job.is_certified),
        "altitude": "heights are in meters above the WGS84 ellipsoid",
        "time": "times are in seconds since the start of the mission",
        "origin": origin_sentence(job.place),
        **({} if job.note is None else {"steps": job.note}),
        "features": features,
    }
    return write_json(content).encode()


def _feature(kind: str, name: str, shape: Shape, **more: object) -> Feature:
    """Return a feature."""
    form, coordinates = shape
    return {
        "type": "Feature",
        "geometry": {"type": form, "coordinates": coordinates},
        "properties": {"kind": kind, "name": name} | more,
    }


def _path(track: TimedPath, place: Placement) -> Feature:
    """Return a track as a line; its lists have one entry per corner."""
    sigmas = np.round(track.three_sigma, 6)
    rows = np.column_stack([_positions(track.positions, place), track.times, sigmas])
    parts = cut_line(rows)
    _, _, _, times, *deviations = np.vstack(parts).T
    more: dict[str, object] = {"radius": track.vehicle.radius, "times": times.tolist()}
    for axis, column in zip(_AXES, deviations, strict=False):
        more[f"three_sigma_{axis}"] = column.tolist()
    line = _whole("LineString", [part[:, :3].tolist() for part in parts])
    return _feature("path", track.name, line, **more)


def _start(track: TimedPath, job: Job) -> Feature:
    """Return where a vehicle starts, and which ranges it keeps."""
    (position,) = _positions(track.vehicle.start_position[None], job.place).tolist()
    more = {"radius": track.vehicle.radius} | ranges_kept(job.plan.scenario.keep, track.name)
    return _feature("start", track.name, ("Point", position), **more)


def _box(kind: str, name: str, box: Goal | Visit, place: Placement, **more: object) -> Feature:
    """Return a goal or a visit: its box seen from above, or its middle where that has no area."""
    corners = goal_outline(box)
    if corners is None:
        (position,) = _positions(box.center[None], place).tolist()
        return _feature(kind, name, ("Point", position), **more)
    heights = _heights(place, box.lower, box.upper)
    raised = _raised(corners, float(box.lower[-1]), box.lower.size)
    return _feature(kind, name, _shape("Polygon", raised, place), **heights, **more)


def _visits(track: TimedPath, place: Placement) -> Iterator[Feature]:
    """Yield what a vehicle visits, in order, and when it does."""
    for number, visit in enumerate(track.vehicle.via):
        when: dict[str, object] = {"number": number}
        if number < len(track.visits):
            step = track.visits[number]
            when |= {"step": step, "time": float(track.times[step])}
        yield _box("visit", track.name, visit, place, **when)


def _obstacles(job: Job) -> Iterator[Feature]:
    """Yield every obstacle, a moving one as an outline per step."""
    for obstacle in job.plan.scenario.obstacles:
        steps = range(len(obstacle.steps))
        for step in steps:
            more = _when(obstacle, step, job.plan.scenario.dt) | whom(obstacle)
            if obstacle.dimension == 2:
                kind, corners = outline(obstacle, step)
                shape = _shape(kind, corners, job.place, holes(obstacle))
                yield _feature("obstacle", obstacle.name, shape, **more)
                continue
            for piece in obstacle.at(step):
                yield _body(obstacle.name, piece, job.place, more)


def _when(obstacle: Obstacle, step: int, dt: float) -> dict[str, object]:
    """Return when a moving obstacle is expected there, and how surely; nothing of a fixed one."""
    if not obstacle.is_moving:
        return {}
    found: dict[str, object] = {"time": step * dt}
    if obstacle.spread is not None:
        sigmas = 3.0 * np.sqrt(np.diag(obstacle.spread.positions[step]).clip(min=0.0))
        found |= {
            f"three_sigma_{axis}": round(sigma, 6)
            for axis, sigma in zip(_AXES, sigmas.tolist(), strict=False)
        }
    return found


def _body(name: str, piece: Polytope, place: Placement, more: dict[str, object]) -> Feature:
    """Return an obstacle in space: seen from above, with its lowest and highest point."""
    low, high = piece.vertices.min(axis=0), piece.vertices.max(axis=0)
    kind, corners = footprint(piece)
    shape = _shape(kind, _raised(corners, float(low[2]), 3), place)
    return _feature("obstacle", name, shape, **_heights(place, low, high), **more)


def _heights(place: Placement, low: Matrix, high: Matrix) -> dict[str, float]:
    """Return base and top of a box in space [m above the ellipsoid]; nothing in the plane."""
    if low.size == 2:
        return {}
    base, top = place.geodetic(np.array([low, high]))[:, 2].tolist()
    return {"base": base, "top": top}


def _raised(corners: Matrix, height: float, dimension: int) -> Matrix:
    """Return plane corners at a height of the plan, where it has heights."""
    if dimension == 2:
        return corners
    return np.column_stack([corners, np.full(len(corners), height)])


def _shape(kind: Kind, corners: Matrix, place: Placement, free: Sequence[Matrix] = ()) -> Shape:
    """Return type and coordinates of what has corners, and perhaps holes."""
    if kind == "Polygon":
        areas = cut_area([_positions(ring, place) for ring in (corners, *free)])
        return _whole(kind, [[_ring(ring) for ring in rings] for rings in areas])
    positions = _positions(corners, place)
    if kind == "Point":
        return kind, positions[0].tolist()
    return _whole(kind, [part.tolist() for part in cut_line(positions)])


def _whole(kind: Kind, parts: Sequence[object]) -> Shape:
    """Return type and coordinates of a shape, which may have been cut at the antimeridian."""
    return (kind, parts[0]) if len(parts) == 1 else (f"Multi{kind}", parts)


def _ring(positions: Matrix) -> list[list[float]]:
    """Return a closed ring of positions."""
    corners: list[list[float]] = positions.tolist()
    return [*corners, corners[0]]


def _positions(points: Matrix, place: Placement) -> Matrix:
    """Return longitude, latitude [°] and height [m] of points, (k, 3): in this order."""
    return np.asarray(place.geodetic(points)[:, [1, 0, 2]])
