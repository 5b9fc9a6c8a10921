"""Drawn obstacles that move: an outline where it is at the start, its speed and course."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix
from radmpc.errors import ScenarioError
from radmpc.importing.geo.feature import Feature
from radmpc.io.text.files import shown
from radmpc.model.obstacle import Obstacle
from radmpc.model.obstacle_reported import track_from_course

__all__ = ["moving_obstacle"]

_DEVIATIONS = ("position_deviation", "speed_deviation", "course_deviation")


def moving_obstacle(name: str, feature: Feature, outline: Matrix) -> Obstacle | None:
    """Return an obstacle on the track that its properties report; None if it has no course.

    Parameters
    ----------
    name : str
        The obstacle's.
    feature : Feature
        With a role of an obstacle.
    outline : (v, 2) array
        Where it is at the start, in the local plane [m]; its hull counts.

    Raises
    ------
    ScenarioError
        If speed, course or a deviation is missing, no number, or not allowed.
    """
    if feature.properties.get("course") is None:
        lost = [key for key in ("speed", *_DEVIATIONS) if feature.properties.get(key) is not None]
        if lost:
            text = f"needs course as well: an obstacle with {lost[0]} moves"
            raise ScenarioError(text, (*feature.properties_path, lost[0]))
        return None
    if feature.properties.get("speed") is None:
        text = "needs speed as well [m/s]: an obstacle with a course moves"
        raise ScenarioError(text, (*feature.properties_path, "course"))
    numbers = {
        key: _number(feature, key)
        for key in ("speed", "course", *_DEVIATIONS)
        if feature.properties.get(key) is not None
    }
    place = 0.5 * (outline.min(axis=0) + outline.max(axis=0))
    speed, course = numbers.pop("speed"), numbers.pop("course")
    try:
        start, covariance = track_from_course(place, speed, course, **numbers)
    except ScenarioError as error:
        raise error.under(*feature.properties_path) from error
    return Obstacle.tracked(name, np.asarray(outline - place), start, covariance)


def _number(feature: Feature, key: str) -> float:
    """Return a property that is a finite number."""
    value = feature.number(key)
    if not np.isfinite(value):
        given = shown(feature.properties[key])
        raise ScenarioError(f"must be a number, got {given}", (*feature.properties_path, key))
    return value
