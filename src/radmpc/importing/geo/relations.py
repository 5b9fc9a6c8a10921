"""Which vehicles drawn obstacles concern, and which ranges drawn vehicles keep."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from radmpc.errors import ScenarioError
from radmpc.importing.geo.feature import Feature, Path, is_whole
from radmpc.io.text.files import shown
from radmpc.model.obstacle import Obstacle
from radmpc.model.relations.concerns import all_but, only_for
from radmpc.model.relations.keep import Keep
from radmpc.ranges import check_range

__all__ = ["check_places", "concerning", "keep_of", "renamed_relations"]

_NAMING = ("for", "except", "keep")
"""Properties that name other vehicles."""

_OF_ROLES = {"for": ("obstacle",), "except": ("obstacle",), "keep": ("start", "goal")}
"""What has them."""


def check_places(features: Sequence[Feature]) -> None:
    """Refuse relations of what has none: they would have no effect.

    Parameters
    ----------
    features : sequence of Feature
        All that are imported.

    Raises
    ------
    ScenarioError
        With the first that has one.
    """
    for feature in features:
        for key, roles in _OF_ROLES.items():
            if _is_stated(feature, key) and feature.role not in roles:
                raise ScenarioError(
                    f"is for {' and '.join(f'{role}s' for role in roles)}, "
                    f"this is of the role {feature.role!r}",
                    (*feature.properties_path, key),
                )


def concerning(feature: Feature, obstacle: Obstacle, vehicles: Collection[str] | None) -> Obstacle:
    """Return an obstacle that concerns the vehicles its ``for`` or ``except`` selects.

    Parameters
    ----------
    feature : Feature
        What is drawn.
    obstacle : Obstacle
        What became of it, for everybody.
    vehicles : collection of str or None
        Names of all vehicles that are drawn; None takes any name.

    Raises
    ------
    ScenarioError
        If both are stated, or one names no vehicles.
    """
    only, free = (_names(feature, key, vehicles) for key in ("for", "except"))
    if only and free:
        raise ScenarioError(
            "must not stand beside 'for': state one of them", (*feature.properties_path, "except")
        )
    if only:
        return only_for(obstacle, only)
    return all_but(obstacle, free) if free else obstacle


def keep_of(points: Sequence[Feature], vehicles: Collection[str]) -> tuple[Keep, ...]:
    """Return the ranges that starts and goals state: ``keep`` names the others, ``range`` how far.

    Parameters
    ----------
    points : sequence of Feature
        Starts and goals.
    vehicles : collection of str
        Names of all vehicles that are drawn.

    Raises
    ------
    ScenarioError
        If one of both is missing, names no other vehicles, or two differ of one pair.
    """
    found: dict[frozenset[str], Keep] = {}
    for point in points:
        path: Path = (*point.properties_path, "keep")
        others, ranges = _names(point, "keep", vehicles), _ranges(point)
        if bool(others) != bool(ranges):
            text = "needs range as well [m]" if others else "needs keep as well: the other vehicle"
            raise ScenarioError(text, path if others else (*point.properties_path, "range"))
        if len(ranges) == 1:
            ranges *= len(others)
        if len(ranges) != len(others):
            raise ScenarioError(
                f"must be one number, or one for each of {len(others)} vehicles, got {len(ranges)}",
                (*point.properties_path, "range"),
            )
        for other, within in zip(others, ranges, strict=True):
            if other == point.vehicle:
                raise ScenarioError(f"must name other vehicles, got {shown(other)} itself", path)
            pair = frozenset((point.vehicle, other))
            one = found.setdefault(pair, Keep((point.vehicle, other), within))
            if one.within != within:
                raise ScenarioError(
                    f"must be {one.within:g} m of {shown(point.vehicle)} and {shown(other)} as "
                    f"stated before, got {within:g}",
                    (*point.properties_path, "range"),
                )
    return tuple(found.values())


def renamed_relations(feature: Feature, names: Mapping[str, str]) -> Feature:
    """Return a feature whose relations name vehicles as they are called among several charts.

    Parameters
    ----------
    feature : Feature
        As its chart has it.
    names : mapping
        New names of the chart's own vehicles, by their names in it.
    """
    properties = dict(feature.properties)
    for key in _NAMING:
        if names and _is_stated(feature, key):
            properties[key] = [names.get(name, name) for name in _words(feature, key)]
    return feature if properties == feature.properties else replace(feature, properties=properties)


def _is_stated(feature: Feature, key: str) -> bool:
    """Whether a property says anything."""
    value = feature.properties.get(key)
    return value is not None and not (isinstance(value, str) and not value.strip())


def _words(feature: Feature, key: str) -> list[str]:
    """Return a property that is a list of texts, or a text of them with commas between."""
    if not _is_stated(feature, key):
        return []
    value = feature.properties[key]
    parts: list[object] = list(value) if isinstance(value, list) else [value]
    if isinstance(value, str):
        parts = [part.strip() for part in value.split(",")]
    words = [str(int(part)) if is_whole(part) else part for part in parts]
    for word in words:
        if not isinstance(word, str) or not word.strip() or not word.isprintable():
            raise ScenarioError(
                f"must be names, with commas between, got {shown(value)}",
                (*feature.properties_path, key),
            )
    return [str(word).strip() for word in words]


def _names(feature: Feature, key: str, vehicles: Collection[str] | None) -> list[str]:
    """Return the vehicles that a property names, none if it is not stated."""
    words = _words(feature, key)
    for i, word in enumerate(words):
        path = (*feature.properties_path, key)
        if vehicles is not None and word not in vehicles:
            raise ScenarioError(f"must name vehicles that start somewhere, got {shown(word)}", path)
        if word in words[:i]:
            raise ScenarioError(f"must name vehicles once, got {shown(word)} twice", path)
    return words


def _ranges(feature: Feature) -> list[float]:
    """Return the property ``range``: a number, a list, or text of numbers with commas between."""
    if not _is_stated(feature, "range"):
        return []
    value, path = feature.properties["range"], (*feature.properties_path, "range")
    parts = value.split(",") if isinstance(value, str) else value
    ranges = []
    for part in parts if isinstance(parts, list) else [parts]:
        number = replace(feature, properties={"range": part}).number("range")
        if not number > 0.0:
            raise ScenarioError(f"must be a number > 0 m, got {shown(value)}", path)
        check_range(number, "m", path)
        ranges.append(number)
    return ranges
