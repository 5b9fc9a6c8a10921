"""Between a local east-north-up frame and WGS84: closed formulas by way of ECEF."""

from __future__ import annotations

import numpy as np

from radmpc.arguments import is_number, value_text
from radmpc.arrays import Matrix, Vector
from radmpc.errors import ScenarioError
from radmpc.records import dataclass

__all__ = ["Origin", "to_geodetic", "to_local"]

_A = 6378137.0
"""Semi-major axis of WGS 84 [m]."""

_F = 1.0 / 298.257223563
"""Flattening of WGS 84 [-]."""

_B = _A * (1.0 - _F)  # semi-minor axis [m]
_E2 = _F * (2.0 - _F)  # first eccentricity, squared
_EP2 = _E2 / (1.0 - _E2)  # second eccentricity, squared


@dataclass(frozen=True, slots=True)
class Origin:
    """Where a plan's local coordinates are all zero; x points east, y north, z up.

    Attributes
    ----------
    latitude : float
        Geodetic, WGS84 [°], -90 to 90.
    longitude : float
        [°], -180 to 180.
    height : float
        Above the WGS84 ellipsoid [m], at most 100 km up or down.

    Examples
    --------
    >>> import radmpc
    >>> radmpc.Origin(54.1234, 12.0987, height=38.0)
    Origin(latitude=54.1234, longitude=12.0987, height=38.0)
    """

    latitude: float
    longitude: float
    height: float = 0.0

    def __post_init__(self) -> None:
        """Refuse what is no place on earth."""
        # Beyond that height the formulas lose what they promise.
        for name, limit, unit in (
            ("latitude", 90.0, "°"),
            ("longitude", 180.0, "°"),
            ("height", 1e5, " m"),
        ):
            value = getattr(self, name)
            if not (is_number(value) and abs(value) <= limit):
                raise ScenarioError(
                    f"must lie between {-limit:g} and {limit:g}{unit}, got {value_text(value)}",
                    (name,),
                )
            object.__setattr__(self, name, float(value))


def to_geodetic(local: Matrix, origin: Origin) -> Matrix:
    """Return latitude [°], longitude [°] and height above the ellipsoid [m] of local points.

    Parameters
    ----------
    local : (k, 3) array
        East, north, up [m].
    origin : Origin
        Where they are zero.

    Returns
    -------
    (k, 3) array
        Within 0.1 mm for heights up to 100 km.
    """
    x, y, z = (_anchor(origin) + local @ _axes(origin)).T
    p = np.hypot(x, y)
    # Bowring's formula, once more from its own answer: the first is off by 0.3 mm far up.
    reduced = np.arctan2(z * _A, p * _B)
    for _ in range(2):
        latitude = np.arctan2(
            z + _EP2 * _B * np.sin(reduced) ** 3, p - _E2 * _A * np.cos(reduced) ** 3
        )
        reduced = np.arctan2((1.0 - _F) * np.sin(latitude), np.cos(latitude))
    # This form of the height holds at the poles too.
    height = p * np.cos(latitude) + z * np.sin(latitude)
    height -= _A * np.sqrt(1.0 - _E2 * np.sin(latitude) ** 2)
    return np.column_stack([np.degrees(latitude), np.degrees(np.arctan2(y, x)), height])


def to_local(geodetic: Matrix, origin: Origin) -> Matrix:
    """Return east, north and up [m] of points on earth; undoes `to_geodetic`.

    Parameters
    ----------
    geodetic : (k, 3) array
        Latitude [°], longitude [°], height above the ellipsoid [m].
    origin : Origin
        Where the local coordinates are zero.

    Returns
    -------
    (k, 3) array
        In the plane that touches the earth at the origin, not along the ground.
    """
    return np.asarray((_ecef(geodetic) - _anchor(origin)) @ _axes(origin).T)


def _ecef(geodetic: Matrix) -> Matrix:
    """Return earth-centered coordinates [m] of points, (k, 3)."""
    latitude, longitude = np.radians(geodetic[:, 0]), np.radians(geodetic[:, 1])
    height = geodetic[:, 2]
    normal = _A / np.sqrt(1.0 - _E2 * np.sin(latitude) ** 2)
    p = (normal + height) * np.cos(latitude)
    return np.column_stack(
        [
            p * np.cos(longitude),
            p * np.sin(longitude),
            ((1.0 - _E2) * normal + height) * np.sin(latitude),
        ]
    )


def _anchor(origin: Origin) -> Vector:
    """Return the origin's earth-centered coordinates [m], (3,)."""
    place = np.array([[origin.latitude, origin.longitude, origin.height]])
    return np.asarray(_ecef(place)[0])


def _axes(origin: Origin) -> Matrix:
    """Return east, north and up as rows in earth-centered coordinates, (3, 3)."""
    latitude, longitude = np.radians(origin.latitude), np.radians(origin.longitude)
    sin_lat, cos_lat = np.sin(latitude), np.cos(latitude)
    sin_lon, cos_lon = np.sin(longitude), np.cos(longitude)
    return np.array(
        [
            [-sin_lon, cos_lon, 0.0],
            [-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat],
            [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat],
        ]
    )
