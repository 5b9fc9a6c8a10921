"""Drawn features in a local plane, and notes on what the projection chose and lost."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import chain

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.errors import ScenarioError
from radmpc.geodesy import Origin, to_local
from radmpc.importing.geo.feature import Feature
from radmpc.importing.geo.properties import misplaced_properties, unknown_properties
from radmpc.importing.rounding import rounded
from radmpc.records import dataclass
from radmpc.rounding import rounded_up

__all__ = [
    "CONTROL_LIMIT",
    "RADIUS",
    "SPEED_LIMIT",
    "Placed",
    "describe_choices",
    "describe_losses",
]

RADIUS = 0.5
"""Of vehicles of which none is stated [m]."""

SPEED_LIMIT = 1.0
"""The same, per axis [m/s]."""

CONTROL_LIMIT = 1.0
"""The same, per axis [m/s²]."""

_FARTHEST = 1e5
"""Distance from the origin beyond which a plane is no picture of the ground [m]."""

_VISIBLE_SAGITTA = 0.1
"""Sagitta of a side, between map and plane, from which it is warned of [m]."""

_EARTH = 6.37e6
"""Radius of the earth [m]."""


@dataclass(frozen=True, slots=True)
class Placed:
    """Features in the plane that touches the earth at an origin.

    Attributes
    ----------
    origin : Origin
        Where the plane touches.
    """

    origin: Origin

    def outlines(self, feature: Feature) -> tuple[Matrix, ...]:
        """Return a feature's rings, each (r, 2), east and north [m]."""
        return tuple(self._local(ring) for ring in feature.rings)

    def point(self, feature: Feature) -> Vector:
        """Return where a point lies, (2,) [m]."""
        return np.asarray(self._local(feature.rings[0])[0])

    def _local(self, ring: Matrix) -> Matrix:
        """Return longitudes and latitudes in the plane; drawn heights are ignored."""
        heights = np.full(len(ring), self.origin.height)
        places = np.column_stack([ring[:, 1], ring[:, 0], heights])
        return rounded(np.asarray(to_local(places, self.origin)[:, :2]))

    def check(self, features: Sequence[Feature]) -> None:
        """Refuse what lies too far from the rest: two mistakes made one map.

        Raises
        ------
        ScenarioError
            If a position lies farther from the origin than a plane is a picture of the ground.
        """
        away = [max(np.abs(ring).max() for ring in self.outlines(one)) for one in features]
        farthest = int(np.argmax(away))
        if not away[farthest] <= _FARTHEST:
            feature = features[farthest]
            raise ScenarioError(
                f"must lie within {_FARTHEST / 1e3:g} km of the origin, the middle of everything "
                f"drawn unless stated, got {feature.rings[0][0, :2].tolist()}, "
                f"{away[farthest] / 1e3:.0f} km away",
                feature.shape_path,
            )

    def longest_side(self, features: Sequence[Feature]) -> float:
        """Return the longest side of any polygon or line [m]."""
        return max(
            (
                float(np.linalg.norm(np.diff(ring, axis=0), axis=1).max())
                for feature in features
                if feature.kind != "Point"
                for ring in self._closed(feature)
            ),
            default=0.0,
        )

    def _closed(self, feature: Feature) -> tuple[Matrix, ...]:
        """Return a line, or a polygon's rings with the first corner repeated [m]."""
        rings = self.outlines(feature)
        is_open = feature.kind == "LineString"
        return rings if is_open else tuple(np.vstack([ring, ring[:1]]) for ring in rings)


def describe_choices(
    stated: Sequence[Mapping[str, float]], origin: Origin, is_stated: bool, area: str
) -> tuple[tuple[str, str], ...]:
    """Return what was chosen, and why.

    Parameters
    ----------
    stated : sequence of mapping
        Each vehicle's stated settings.
    origin : Origin
        Of the plane.
    is_stated : bool
        Whether the file states it.
    area : str
        What became of the area.
    """
    usual = {
        "radius": f"{RADIUS:g} m",
        "speed_limit": f"{SPEED_LIMIT:g} m/s",
        "control_limit": f"{CONTROL_LIMIT:g} m/s²",
    }
    told = {}
    for key, text in usual.items():
        count = sum(key in one for one in stated)
        told[key] = "as stated" if count == len(stated) else text
        if 0 < count < len(stated):
            told[key] = f"as stated, else {text}"
    limits = f"speed {told['speed_limit']}, acceleration {told['control_limit']}, per axis"
    # Adding zero takes the sign from a zero.
    latitude, longitude = origin.latitude + 0.0, origin.longitude + 0.0
    place = f"{latitude:.9g}°, {longitude:.9g}°, height {origin.height:g} m"
    return (
        ("origin", f"{place}, {'as stated' if is_stated else 'the middle of everything drawn'}"),
        ("frame", "x east, y north in meters, in the plane that touches WGS 84 at the origin"),
        ("area", area),
        ("radius", told["radius"]),
        ("limits", limits),
    )


def describe_losses(features: Sequence[Feature], placed: Placed) -> tuple[str, ...]:
    """Return what could not be carried over.

    Parameters
    ----------
    features : sequence of Feature
        All that are imported.
    placed : Placed
        The plane in which they lie.
    """
    warnings = []
    unknown = (unknown_properties(one.properties) for one in features)
    misplaced = (misplaced_properties(one.properties, one.role) for one in features)
    for what, notes in (("ignored", unknown), ("without effect", misplaced)):
        listed = sorted(set(chain.from_iterable(notes)))
        if listed:
            more = f" and {len(listed) - 5} more" if len(listed) > 5 else ""
            warnings.append(f"properties {what}: {', '.join(listed[:5])}{more}")
    height = placed.origin.height
    drawn = np.concatenate([ring[:, 2] for feature in features for ring in feature.rings])
    if np.any(np.abs(drawn[drawn != 0.0] - height) > 0.5):
        warnings.append(f"drawn heights are ignored: vehicles move at {height:g} m")
    # How far a line of equal latitude bends away from the straight one.
    slope = np.tan(np.radians(min(abs(placed.origin.latitude), 89.0)))
    sagitta = placed.longest_side(features) ** 2 * slope / (8.0 * _EARTH)
    if sagitta > _VISIBLE_SAGITTA:
        warnings.append(
            "sides of polygons and lines are straight in the plane, up to "
            f"{rounded_up(sagitta):g} m beside a line of equal latitude: give long ones more "
            "corners"
        )
    return tuple(warnings)
