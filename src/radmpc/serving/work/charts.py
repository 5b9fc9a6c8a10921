"""Charts and other groups' problems as documents, and as obstacles of documents."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import PurePath

import numpy as np

from radmpc.arrays import Vector
from radmpc.errors import FileFormatError, ScenarioError
from radmpc.geodesy import Origin, to_geodetic
from radmpc.importing import import_scenario
from radmpc.importing.formats import import_ground
from radmpc.importing.geo.ground import Ground
from radmpc.io.native.decoding import decode_scenario
from radmpc.io.native.encoding import encode_scenario
from radmpc.model.scenario import Scenario
from radmpc.serving.documents.templates import empty
from radmpc.serving.protocol import Content
from radmpc.serving.work.control import Control

__all__ = ["read_chart", "read_obstacles"]

_ROOM = 0.1
"""Share of the size of a chart without an area that is left free around it [-]."""

_LEAST_ROOM = 5.0
"""The same at least [m]."""


def read_chart(control: Control, path: str, name: str) -> dict[str, object]:
    """Return the document that a chart leads to; what was chosen for it stands in its source.

    Where nobody starts or ends, it is a world to draw vehicles in.

    Parameters
    ----------
    control : Control
        Not used: this takes a moment.
    path, name : str
        Where the chart is, and what the page calls it.

    Raises
    ------
    FileFormatError
        With one line that names file, line and field.
    """
    del control
    with _named(path, name):
        ground = import_ground(path)
        if ground is None or ground.has_vehicles:
            return encode_scenario(import_scenario(path).scenario)
        return _world(ground, name)


def read_obstacles(control: Control, path: str, name: str, content: Content) -> list[object]:
    """Return the obstacles of a chart, as entries of a document.

    Parameters
    ----------
    control : Control
        Not used.
    path, name : str
        As in `read_chart`.
    content : mapping
        The document: if it knows where on earth it is, the chart comes to its place; else its
        middle comes to that of the workspace.

    Raises
    ------
    FileFormatError
        As in `read_chart`.
    """
    del control
    with _named(path, name):
        ground = import_ground(path)
        if ground is None:
            return _entries(encode_scenario(import_scenario(path).scenario))
        origin = _origin_of(content) or _beside(ground, content)
        return _entries(_encoded(import_ground(path, origin) or ground))


@contextmanager
def _named(path: str, name: str) -> Iterator[None]:
    """Have errors name a file as the page does."""
    try:
        yield
    except FileFormatError as error:
        raise FileFormatError(str(error).replace(path, name)) from error


def _world(ground: Ground, name: str) -> dict[str, object]:
    """Return a document without vehicles."""
    encoded = _encoded(ground)
    return {
        **empty(),
        "name": PurePath(name).stem,
        "workspace": encoded["workspace"],
        "obstacles": _entries(encoded),
        "source": {"file": PurePath(name).name, "origin": asdict(ground.origin)},
    }


def _entries(content: Content) -> list[object]:
    """Return the obstacles of a document."""
    found = content.get("obstacles")
    return list(found) if isinstance(found, list) else []


def _encoded(ground: Ground) -> dict[str, object]:
    """Return a ground as a document: somebody stands in for its vehicles."""
    named = {name for o in ground.obstacles if o.concerns for name in o.concerns.names}
    low, high = _box(ground)
    # A chart that is added to a document may be far from the document's origin.
    middle = (0.5 * (low + high)).tolist()
    place = {"start": middle, "goal": {"center": middle}}
    start = decode_scenario(
        {
            **empty(),
            "workspace": {"min": low.tolist(), "max": high.tolist()},
            "vehicles": [{"name": name, **place} for name in sorted(named) or ["-"]],
        }
    )
    return encode_scenario(
        Scenario(
            name="-",
            dt=start.dt,
            horizon=start.horizon,
            vehicles=start.vehicles,
            risk_bound=start.risk_bound,
            workspace=start.workspace,
            obstacles=ground.obstacles,
        )
    )


def _box(ground: Ground) -> tuple[Vector, Vector]:
    """Return the corners of the workspace, the one drawn or one with room around everything [m]."""
    if ground.workspace is not None:
        return ground.workspace.lower, ground.workspace.upper
    pieces = [piece for obstacle in ground.obstacles for piece in obstacle.steps[0]]
    if not pieces:
        return np.array([-20.0, -15.0]), np.array([20.0, 15.0])
    corners = np.vstack([piece.vertices for piece in pieces])
    low, high = corners.min(axis=0), corners.max(axis=0)
    room = max(_ROOM * float((high - low).max()), _LEAST_ROOM)
    return np.floor(low - room), np.ceil(high + room)


def _origin_of(content: Content) -> Origin | None:
    """Return where on earth a document says that it is."""
    source = content.get("source")
    stated = source.get("origin") if isinstance(source, Mapping) else None
    if not isinstance(stated, Mapping):
        return None
    try:
        return Origin(stated["latitude"], stated["longitude"], stated.get("height", 0.0))
    except (ScenarioError, KeyError):
        return None


def _beside(ground: Ground, content: Content) -> Origin:
    """Return the origin by which the middle of a chart comes to that of a document's workspace."""
    workspace = content.get("workspace")
    if not isinstance(workspace, Mapping):
        return ground.origin
    try:
        ends = np.array([workspace["min"], workspace["max"]], dtype=np.float64)[:, :2]
    except (KeyError, ValueError, IndexError, TypeError):
        return ground.origin
    if ends.shape != (2, 2) or not np.isfinite(ends).all():
        return ground.origin
    moved = np.mean(_box(ground), axis=0) - ends.mean(axis=0)
    latitude, longitude, _ = to_geodetic(np.array([[*moved, 0.0]]), ground.origin)[0]
    return Origin(float(latitude), float(longitude), ground.origin.height)
