"""Where on earth a plan lies: given by its scenario's source or by the caller."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from radmpc.arrays import Matrix
from radmpc.errors import ScenarioError
from radmpc.geodesy import Origin, to_geodetic
from radmpc.io.text.files import shown
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass

__all__ = ["Placement", "parse_origin", "scenario_origin"]

_FARTHEST = 1e5
"""Distance from the origin beyond which a plane is no picture of the ground [m]."""


@dataclass(frozen=True, slots=True)
class Placement:
    """A plan's local frame on earth.

    Attributes
    ----------
    origin : Origin
        Where local coordinates are zero.
    altitude : float
        Height of a 2-D plan above the origin [m].
    """

    origin: Origin
    altitude: float = 0.0

    def geodetic(self, points: Matrix) -> Matrix:
        """Return latitude [°], longitude [°] and height above the ellipsoid [m] of points.

        Parameters
        ----------
        points : (k, d) array
            Local coordinates [m]. Those of a 2-D plan all lie at its altitude.

        Returns
        -------
        (k, 3) array
            Rounded to a tenth of a millimeter, so that files do not depend on the last bits.

        Raises
        ------
        ScenarioError
            If a point lies farther from the origin than the local frame means anything.
        """
        # Not hypot: coordinates of 1e9 are valid, and no one flies them.
        if not np.all(np.abs(points) <= _FARTHEST):
            raise ScenarioError(
                f"the plan reaches {float(np.abs(points).max()):.6g} m from its origin: farther "
                f"than {_FARTHEST:g} m a flat map does not lie on the earth"
            )
        if points.shape[1] == 2:
            places = self._at_altitude(points)
        else:
            places = to_geodetic(points, self.origin)
        return _rounded(places)

    def levels(self, points: Matrix) -> list[float]:
        """Return the heights of points above the origin [m], each of (k, d)."""
        if points.shape[1] == 2:
            return [float(self.altitude)] * len(points)
        above = self.geodetic(points)[:, 2] - self.origin.height
        return [float(height) for height in np.round(above, 4) + 0.0]

    def _at_altitude(self, points: Matrix) -> Matrix:
        """Return the places with given east and north at one height above the ellipsoid."""
        # The plane of the map touches the earth only at the origin. Going down to the target
        # height, each round leaves an error smaller by distance over radius of the earth.
        target = self.origin.height + self.altitude
        up = np.full(len(points), self.altitude)
        for _ in range(4):
            places = to_geodetic(np.column_stack([points, up]), self.origin)
            up += target - places[:, 2]
        places[:, 2] = target
        return places


def _rounded(places: Matrix) -> Matrix:
    """Return places to 1e-9° and 1e-4 m, without negative zeros."""
    degrees, height = np.round(places[:, :2], 9), np.round(places[:, 2:], 4)
    # -0.0 and 0.0 are one place and must be one text.
    return np.asarray(np.column_stack([degrees, height]) + 0.0)


def parse_origin(text: str) -> Origin:
    """Return the origin that ``LAT,LON[,HEIGHT]`` describes.

    Parameters
    ----------
    text : str
        Degrees, degrees and meters above the WGS84 ellipsoid (0 where left out).

    Raises
    ------
    ScenarioError
        If it is no place on earth.
    """
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in {2, 3} or not all(math.isfinite(number) for number in numbers):
        raise ScenarioError(f"must be LAT,LON or LAT,LON,HEIGHT, got {shown(text)}", ("origin",))
    try:
        return Origin(*numbers)
    except ScenarioError as error:
        raise error.under("origin") from error


def scenario_origin(scenario: Scenario) -> Origin | None:
    """Return the origin that an importer noted in a scenario's source, None where it did not.

    Raises
    ------
    ScenarioError
        If what stands there is no place on earth.
    """
    noted = None if scenario.source is None else scenario.source.get("origin")
    if noted is None:
        return None
    path = ("source", "origin")
    if not isinstance(noted, Mapping):
        raise ScenarioError(f"must be a mapping, got {shown(noted)}", path)
    numbers = []
    for key in ("latitude", "longitude", "height"):
        value = noted.get(key, 0.0 if key == "height" else None)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise ScenarioError(f"must be a number, got {shown(value)}", (*path, key))
        numbers.append(value)
    try:
        return Origin(*numbers)
    except ScenarioError as error:
        raise error.under(*path) from error
