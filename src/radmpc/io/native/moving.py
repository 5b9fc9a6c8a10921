"""Tracks of obstacles as files state them, to and from an obstacle's."""

from __future__ import annotations

from radmpc.errors import ScenarioError
from radmpc.io.native.schema import TrackSpec
from radmpc.model.obstacle import Obstacle, TrackShape
from radmpc.model.obstacle_reported import track_from_course

__all__ = ["build_tracked", "encode_track"]

_KINDS = (("start",), ("velocity",), ("position", "speed", "course"))
"""Keys that say where an outline is and how it moves: one of these."""

_DEVIATIONS = {
    "position_deviation": "position",
    "speed_deviation": "speed",
    "course_deviation": "course",
}


def build_tracked(name: str, spec: TrackSpec) -> Obstacle:
    """Return an obstacle on a track.

    Parameters
    ----------
    name : str
        The obstacle's.
    spec : TrackSpec
        What the file gives.

    Raises
    ------
    ScenarioError
        If none or several descriptions are given, or one is not allowed.
    """
    given = [key for kind in _KINDS for key in kind if getattr(spec, key) is not None]
    if tuple(given) not in _KINDS:
        allowed = ", ".join(" and ".join(kind) for kind in _KINDS)
        got = " and ".join(given) or "none of them"
        raise ScenarioError(f"needs exactly one of: {allowed}; got {got}", ("moving",))
    if spec.position is not None and spec.speed is not None and spec.course is not None:
        return _reported(name, spec, (spec.position, spec.speed, spec.course))
    if spec.deviations is not None:
        text = "needs position, speed and course; a start has a covariance"
        raise ScenarioError(text, ("moving", "deviations"))
    start = spec.start
    if start is None:
        velocity = spec.velocity or []
        _check_size(spec, "velocity", len(velocity))
        start = [0.0] * len(velocity) + velocity
    return Obstacle.tracked(name, spec.outline, start, spec.covariance, spec.disturbance_covariance)


def _reported(name: str, spec: TrackSpec, report: tuple[list[float], float, float]) -> Obstacle:
    """Return an obstacle of which position, speed and course are reported."""
    if "covariance" in spec.model_fields_set:
        text = "needs start; position, speed and course have deviations"
        raise ScenarioError(text, ("moving", "covariance"))
    deviations = {} if spec.deviations is None else spec.deviations.model_dump()
    given = {key: deviations.get(short, 0.0) for key, short in _DEVIATIONS.items()}
    position, speed, course = report
    _check_size(spec, "position", 2)
    try:
        start, covariance = track_from_course(position, speed, course, **given)
    except ScenarioError as error:
        key = str(error.path[0])
        path = ("deviations", _DEVIATIONS[key]) if key in _DEVIATIONS else (key,)
        raise ScenarioError(error.message, ("moving", *path)) from error
    return Obstacle.tracked(name, spec.outline, start, covariance, spec.disturbance_covariance)


def _check_size(spec: TrackSpec, key: str, size: int) -> None:
    """Refuse what has not as many coordinates as the outline, by the name that it has in files."""
    corners = spec.outline
    if corners and len(corners[0]) != size:
        dimension = len(corners[0])
        text = f"must have {dimension} numbers like the corners of outline, got {size}"
        if key == "position":
            text = f"is in the plane, got an outline whose corners have {dimension} coordinates"
        raise ScenarioError(text, ("moving", key))


def encode_track(shape: TrackShape) -> dict[str, object]:
    """Return what a track is written as; its covariances are added where they are not 0.

    Parameters
    ----------
    shape : TrackShape
        The outline, and how it moves.
    """
    return {"outline": shape.outline.tolist(), "start": shape.start.tolist()}
