"""What operators draw on a map, whatever its format: points, lines and polygons."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import TypeGuard

import shapely

from radmpc.arrays import Matrix, as_matrix
from radmpc.errors import ScenarioError
from radmpc.importing.geo.properties import SETTINGS
from radmpc.io.text.files import shown
from radmpc.ranges import check_range
from radmpc.records import dataclass

__all__ = ["Feature", "Path", "drawn_line", "drawn_ring", "is_whole", "read_position"]

Path = tuple[str | int, ...]

_NAMED = re.compile(r"(start|goal|via)[\s:_-]+(.+)", re.IGNORECASE)
_ROLES = {
    "Point": ("start", "goal", "via", "origin", "obstacle"),
    "LineString": ("obstacle",),
    "Polygon": ("obstacle", "area"),
}

_MOST_CORNERS = 200
"""Corners of one outline: each edge becomes a face of the certificate and of the program."""


@dataclass(frozen=True, slots=True, eq=False)
class Feature:
    """A point, a line or a polygon.

    Attributes
    ----------
    kind : str
        ``Point``, ``LineString`` or ``Polygon``.
    rings : tuple of (r, 3) array
        Longitude [°], latitude [°], height [m]; of a polygon the outline first, then holes, each
        without the repeated last position. A point is one ring of one position, a line one of its
        positions.
    properties : mapping
        As the file states them.
    path, shape_path, properties_path : tuple of str or int
        Where it stands in the file, its outline and its properties.
    usual_role : str or None
        What it stands for where it does not say, by its layer; None leaves that to its name.
    """

    kind: str
    rings: tuple[Matrix, ...]
    properties: Mapping[str, object]
    path: Path
    shape_path: Path
    properties_path: Path
    usual_role: str | None = None

    @property
    def name(self) -> str | None:
        """Its name, None if it has none."""
        return self._text("name")

    @property
    def role(self) -> str:
        """What it stands for, by its property or by its name.

        Raises
        ------
        ScenarioError
            If that is not stated, or unknown.
        """
        key = "kind" if "role" not in self.properties and "kind" in self.properties else "role"
        role, allowed = self._text(key) or self.usual_role, _ROLES[self.kind]
        if role is None and self.kind == "LineString":
            # It may have been meant as a way, or as a border.
            raise ScenarioError(
                "must be stated of a LineString: 'obstacle'; it might be a way or a border",
                (*self.properties_path, key),
            )
        if role is None:
            role = self._role_by_name()
        role = role.lower()
        if role == "path" and self.kind == "LineString":
            raise ScenarioError(
                "is a path of a plan: paths are not imported", (*self.properties_path, key)
            )
        if role not in allowed:
            got = f"got {shown(role)}" if role else "or a name like 'start alpha', got neither"
            raise ScenarioError(
                f"must be {' or '.join(map(repr, allowed))} of a {self.kind}, {got}",
                (*self.properties_path, key),
            )
        return role

    def _role_by_name(self) -> str:
        """Return the role that the name begins with; of a polygon an obstacle if it does not."""
        name = (self.name or "").lower()
        if self.kind == "Polygon":
            return "area" if name in {"area", "operating area", "workspace"} else "obstacle"
        match = _NAMED.fullmatch(name)
        return match[1] if match else name if name == "origin" else ""

    @property
    def vehicle(self) -> str:
        """The name of the vehicle that starts or ends here.

        Raises
        ------
        ScenarioError
            If there is none.
        """
        name = self._text("vehicle")
        if name is None and self.name is not None:
            match = _NAMED.fullmatch(self.name)
            name = match[2].strip() if match else self.name
        if name is None:
            raise ScenarioError(
                "is required of a start or goal: the vehicle's name",
                (*self.properties_path, "vehicle"),
            )
        return name

    def settings(self) -> dict[str, float]:
        """Return what the properties say of the vehicle, in SI units.

        Raises
        ------
        ScenarioError
            If a value is no number above 0, or is stated twice.
        """
        found: dict[str, float] = {}
        for key, (name, unit) in SETTINGS.items():
            if self.properties.get(key) is None:
                continue
            path = (*self.properties_path, key)
            value = self.number(key)
            if not value > 0.0:
                given = shown(self.properties[key])
                raise ScenarioError(f"must be a number > 0 {unit}, got {given}", path)
            check_range(value, unit, path)
            if name in found:
                raise ScenarioError(f"is {name!r} by another name: state one of them", path)
            found[name] = value
        return found

    def number(self, key: str) -> float:
        """Return a property that is a number, or the text of one; nan if it is neither."""
        value = self.properties[key]
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            return float("nan")
        try:
            # Drawing programs keep all properties as text.
            return float(value)
        except (ValueError, OverflowError):
            return float("nan")

    def _text(self, key: str) -> str | None:
        """Return a property as text, None where it is missing or empty."""
        value = self.properties.get(key)
        if is_whole(value):
            return str(int(value))
        if value is None or (isinstance(value, str) and not value.strip()):
            return None
        if not isinstance(value, str) or not value.isprintable():
            raise ScenarioError(f"must be text, got {shown(value)}", (*self.properties_path, key))
        return value.strip()


def is_whole(value: object) -> TypeGuard[int | float]:
    """Whether a value is a whole number, which may be a name; tables make some of them decimal."""
    if isinstance(value, float):
        return value.is_integer()
    return isinstance(value, int) and not isinstance(value, bool)


def read_position(value: object, path: Path) -> list[float]:
    """Return longitude, latitude and height of a position.

    Parameters
    ----------
    value : object
        Of a file.
    path : tuple of str or int
        Where it stands.

    Raises
    ------
    ScenarioError
        If it is none, or lies outside the earth's degrees.
    """
    if not isinstance(value, list) or len(value) not in {2, 3, 4}:
        raise ScenarioError(f"must be [longitude, latitude], got {shown(value)}", path)
    numbers = []
    for given, name, limit in zip(
        [*value[:3], 0.0], ("longitude", "latitude", "height"), (180.0, 90.0, 1e5), strict=False
    ):
        is_number = isinstance(given, int | float) and not isinstance(given, bool)
        if not is_number or not abs(given) <= limit:
            hint = ", longitude stands first" if name == "latitude" else ""
            raise ScenarioError(
                f"{name} must be a number from {-limit:g} to {limit:g}{hint}, got {shown(given)}",
                path,
            )
        numbers.append(float(given))
    return numbers


def drawn_line(positions: Sequence[object], path: Path) -> Matrix:
    """Return a line's positions, (r, 3), without those that repeat the one before.

    Parameters
    ----------
    positions : sequence of object
        Of a file.
    path : tuple of str or int
        Where they stand.

    Raises
    ------
    ScenarioError
        If it has too few or too many.
    """
    given = [read_position(value, (*path, i)) for i, value in enumerate(positions)]
    corners = given[:1] + [two for one, two in pairwise(given) if one[:2] != two[:2]]
    _check_count(len(corners), path)
    if len(corners) < 2:
        raise ScenarioError(f"must have at least 2 different positions, got {len(corners)}", path)
    return as_matrix(corners, path=path)


def _check_count(corners: int, path: Path) -> None:
    """Refuse what has too many corners."""
    if corners > _MOST_CORNERS:
        raise ScenarioError(
            f"must have at most {_MOST_CORNERS} corners, got {corners}: simplify it", path
        )


def drawn_ring(positions: Sequence[object], path: Path) -> Matrix:
    """Return a polygon's ring, (r, 3), without its repeated last position.

    Parameters
    ----------
    positions : sequence of object
        Of a file, the last like the first.
    path : tuple of str or int
        Where they stand.

    Raises
    ------
    ScenarioError
        If it is not closed, crosses itself, or has too few or too many corners.
    """
    if len(positions) < 4:
        raise ScenarioError(
            f"must have at least 4 positions, the last like the first, got {len(positions)}", path
        )
    given = [read_position(value, (*path, i)) for i, value in enumerate(positions)]
    if given[0][:2] != given[-1][:2]:
        raise ScenarioError(
            f"must be closed: the last position must be the first, {given[0][:2]}, "
            f"got {given[-1][:2]}",
            (*path, len(given) - 1),
        )
    corners = [one for one, two in pairwise(given) if one[:2] != two[:2]]
    _check_count(len(corners), path)
    ring = as_matrix(corners or given[:1], path=path)
    if len(ring) < 3:
        raise ScenarioError(f"must have at least 3 different corners, got {len(ring)}", path)
    # A ring across the antimeridian jumps by 360°.
    degrees = ring[:, :2].copy()
    if degrees[:, 0].max() - degrees[:, 0].min() > 180.0:
        degrees[degrees[:, 0] < 0.0, 0] += 360.0
    polygon = shapely.Polygon(degrees)
    if not polygon.is_valid or polygon.area <= 0.0:
        why = shapely.is_valid_reason(polygon)
        raise ScenarioError(f"must not cross or touch itself and enclose an area, got {why}", path)
    return ring
