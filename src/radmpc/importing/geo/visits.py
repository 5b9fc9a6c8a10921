"""Places that a vehicle drawn on a map visits, and windows of time, in seconds."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.errors import ScenarioError
from radmpc.importing.geo.feature import Feature
from radmpc.importing.geo.local_plane import Placed
from radmpc.importing.problem import ForeignVisit, Window
from radmpc.io.text.files import shown
from radmpc.ranges import check_range

__all__ = ["describe_visits", "visits_of", "window_of"]


def visits_of(
    features: Sequence[Feature], placed: Placed, radius: float
) -> tuple[ForeignVisit, ...]:
    """Return what a vehicle visits, by ``order`` where that is stated, else as drawn.

    Parameters
    ----------
    features : sequence of Feature
        Points of the role ``via``, of one vehicle.
    placed : Placed
        The local plane.
    radius : float
        Of the vehicle's hull [m]: the half width of boxes that state none.

    Raises
    ------
    ScenarioError
        If only some state an order, two the same one, or a number is none.
    """
    stated = ["order" in feature.properties for feature in features]
    if any(stated) and not all(stated):
        missing = features[stated.index(False)]
        raise ScenarioError(
            "is required of all that a vehicle visits, or of none",
            (*missing.properties_path, "order"),
        )
    ordered = list(features)
    if all(stated):
        numbers = [_number(feature, "order") for feature in features]
        for i, number in enumerate(numbers):
            if number in numbers[:i]:
                path = (*features[i].properties_path, "order")
                raise ScenarioError(
                    f"must differ among a vehicle's visits, got {number:g} twice", path
                )
        ordered = [features[i] for i in np.argsort(numbers)]
    return tuple(_visit(feature, placed, radius) for feature in ordered)


def describe_visits(features: Sequence[Feature]) -> tuple[tuple[str, str], ...]:
    """Return how large the boxes are that are visited, in words; nothing if there are none.

    Parameters
    ----------
    features : sequence of Feature
        Points of the role ``via``, of all vehicles.
    """
    if not features:
        return ()
    stated = sum(feature.properties.get("half_width") is not None for feature in features)
    told = "as stated" if stated == len(features) else "one radius"
    if 0 < stated < len(features):
        told = f"as stated, else {told}"
    told = f"boxes whose half width is {told}"
    return (("visits", told),)


def _visit(feature: Feature, placed: Placed, radius: float) -> ForeignVisit:
    """Return one place that is visited."""
    half = radius
    if feature.properties.get("half_width") is not None:
        half = _number(feature, "half_width")
        check_range(half, "m", (*feature.properties_path, "half_width"))
    speed = None
    if feature.properties.get("speed") is not None:
        speed = _number(feature, "speed")
        if speed < 0.0:
            path = (*feature.properties_path, "speed")
            raise ScenarioError(f"must be >= 0 m/s, got {speed:g}", path)
    return ForeignVisit(placed.point(feature), half, window_of(feature), speed)


def window_of(feature: Feature) -> Window | None:
    """Return when a place is to be visited or reached, None if it does not say.

    Parameters
    ----------
    feature : Feature
        A point of the role ``via`` or ``goal``.

    Raises
    ------
    ScenarioError
        If ``after`` or ``before`` is no number of seconds, or they are no window.
    """
    found = {
        key: _number(feature, key)
        for key in ("after", "before")
        if feature.properties.get(key) is not None
    }
    if not found:
        return None
    for key, value in found.items():
        if value < 0.0:
            raise ScenarioError(f"must be >= 0 s, got {value:g}", (*feature.properties_path, key))
    first, last = found.get("after", 0.0), found.get("before", np.inf)
    if first > last:
        raise ScenarioError(
            f"must be at least after ({first:g} s), got {last:g} s",
            (*feature.properties_path, "before"),
        )
    return first, last


def _number(feature: Feature, key: str) -> float:
    """Return a property that is a finite number."""
    value = feature.number(key)
    if not np.isfinite(value):
        given = shown(feature.properties[key])
        raise ScenarioError(f"must be a number, got {given}", (*feature.properties_path, key))
    return value
